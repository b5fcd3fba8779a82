"""What an atlas says of the linkage that it is of."""

from __future__ import annotations

from dataclasses import dataclass

from bifurc.atlas import Atlas, Form
from linkages.app.exit_codes import CommandError
from linkages.loop import GeometryError, Loop

__all__ = ["FormLabels", "labels_of", "loop_of"]


@dataclass(frozen=True)
class FormLabels:
    """What `linkages.mapping.map_linkage` says of a form: the joints (from 1) that
    stand still and their angles (rad), an equation of symmetry or nothing, and the
    largest closure error along the form, relative to the characteristic length."""

    inactive_joints: tuple[int, ...]
    inactive_angles: tuple[float, ...]
    symmetry: str
    max_residual: float


def labels_of(form: Form) -> FormLabels:
    """The labels of a form of a linkage."""
    labels = form.labels
    return FormLabels(
        inactive_joints=tuple(labels["inactive_joints"]),
        inactive_angles=tuple(labels["inactive_angles"]),
        symmetry=labels["symmetry"],
        max_residual=float(labels["max_residual"]),
    )


def loop_of(atlas: Atlas) -> Loop:
    """The loop that an atlas is of; raises `CommandError` for an atlas of something
    else."""
    subject = atlas.subject
    try:
        return Loop(
            subject["lengths"], subject["twists"], subject["offsets"], subject["name"]
        )
    except (KeyError, TypeError, GeometryError):
        raise CommandError("the atlas is of no linkage: it holds no loop") from None
