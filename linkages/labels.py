"""What an atlas of a linkage says beyond the equations: the loop that was mapped, and
what each form is.

`bifurc` keeps both as plain values (``atlas.subject`` and ``form.labels``); here they
are written and read back.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypedDict, cast

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.branch import Branch
from bifurc.checks import check_type
from bifurc.errors import BifurcError
from bifurc.problem import Problem
from linkages.loop import Loop
from linkages.values import GeometryError

# where on every piece of a form its closure is checked
CLOSING = np.linspace(0.0, 1.0, 24, endpoint=False)


class LoopTable(TypedDict):
    """What every loop has, in values that JSON can hold, twists in rad."""

    name: str
    lengths: list[float]
    twists: list[float]
    offsets: list[float]


class LabelValues(TypedDict):
    """`FormLabels` in values that JSON can hold."""

    inactive_joints: list[int]
    inactive_angles: list[float]
    symmetry: str
    max_residual: float


class NoLinkageError(BifurcError, ValueError):
    """The atlas is not of a linkage, so that it holds no loop."""

    def __init__(self, reason: str):
        self.reason = reason
        super().__init__(f"this atlas is not of a linkage: {reason}")


def table_values(loop: Loop) -> LoopTable:
    """The name and the table of a loop."""
    lengths, twists, offsets = loop.arrays
    return {
        "name": loop.name,
        "lengths": lengths.tolist(),
        "twists": twists.tolist(),
        "offsets": offsets.tolist(),
    }


def subject_of(loop: Loop) -> dict[str, Any]:
    """The ``subject`` of an atlas of ``loop``, with its ``rounding`` where it has one."""
    rounding = {"rounding": loop.rounding} if loop.rounding else {}
    return {**table_values(loop), **rounding}


def loop_of(atlas: Atlas) -> Loop:
    """The loop that an atlas is of. Raises `NoLinkageError` where it is of something
    else, also of a mechanism that is a single loop: its unknowns are others.

    >>> import linkages
    >>> linkages.loop_of(linkages.map_linkage(linkages.load("bennett"))).name
    'bennett'
    """
    check_type("atlas", atlas, Atlas)
    subject = atlas.subject
    if "mechanism" in subject:
        raise NoLinkageError(
            "it is of a mechanism, no Denavit-Hartenberg table; where that is a single "
            "loop, `linkages.Readout(mechanism).single_loop` has the table"
        )
    missing = [key for key in LoopTable.__annotations__ if key not in subject]
    if missing:
        raise NoLinkageError(f"its subject has no {', '.join(missing)}")
    try:
        return Loop(
            subject["lengths"],
            subject["twists"],
            subject["offsets"],
            str(subject["name"]),
            float(subject.get("rounding", 0.0)),
        )
    except GeometryError as error:
        raise NoLinkageError(str(error)) from None


class Symmetry(StrEnum):
    """The equation between all joint angles of a form and those some joints further on.

    With half the joints as the step, equal angles are those of a line symmetry.
    """

    # No such equation holds.
    NONE = ""
    # Every angle is that of the joint so many further on.
    EQUAL_1 = "theta_i = theta_{i+1}"
    EQUAL_2 = "theta_i = theta_{i+2}"
    EQUAL_3 = "theta_i = theta_{i+3}"
    EQUAL_4 = "theta_i = theta_{i+4}"
    EQUAL_5 = "theta_i = theta_{i+5}"
    EQUAL_6 = "theta_i = theta_{i+6}"
    # Every angle is minus that of the joint so many further on.
    OPPOSITE_1 = "theta_i = -theta_{i+1}"
    OPPOSITE_2 = "theta_i = -theta_{i+2}"
    OPPOSITE_3 = "theta_i = -theta_{i+3}"
    OPPOSITE_4 = "theta_i = -theta_{i+4}"
    OPPOSITE_5 = "theta_i = -theta_{i+5}"
    OPPOSITE_6 = "theta_i = -theta_{i+6}"

    @staticmethod
    def of_step(step: int, sign: int) -> Symmetry:
        """The equation theta_i = ``sign`` theta_{i + ``step``}, with a step from 1 to
        6."""
        relation = "EQUAL" if sign > 0 else "OPPOSITE"
        return Symmetry[f"{relation}_{step}"]


@dataclass(frozen=True)
class FormLabels:
    """What a form is: the joints that stand still (from 1) and their angles (rad), its
    symmetry, and the largest closure error seen along it, relative to the
    characteristic length (nan where nobody looked)."""

    inactive_joints: tuple[int, ...] = ()
    inactive_angles: tuple[float, ...] = ()
    symmetry: Symmetry = Symmetry.NONE
    max_residual: float = float("nan")

    def as_values(self) -> LabelValues:
        """The labels in values that JSON can hold, as ``form.labels`` keeps them."""
        return {
            "inactive_joints": list(self.inactive_joints),
            "inactive_angles": list(self.inactive_angles),
            "symmetry": self.symmetry.value,
            "max_residual": self.max_residual,
        }

    @staticmethod
    def of(form: Form) -> FormLabels:
        """The labels of a form of a linkage; those of a form without labels say
        nothing."""
        nothing = FormLabels().as_values()
        values = cast(LabelValues, {**nothing, **form.labels})
        return FormLabels(
            inactive_joints=tuple(values["inactive_joints"]),
            inactive_angles=tuple(values["inactive_angles"]),
            symmetry=Symmetry(values["symmetry"]),
            max_residual=float(values["max_residual"]),
        )


def largest_residual(problem: Problem, branch: Branch) -> float:
    """The largest closure error at places all along a branch: the norm over rotation
    and translation."""
    lengths = np.diff(branch.breaks)
    places = branch.breaks[:-1, None] + lengths[:, None] * CLOSING
    residuals = problem.residuals(branch(places.ravel()))
    return float(np.linalg.norm(residuals, axis=1).max(initial=0.0))
