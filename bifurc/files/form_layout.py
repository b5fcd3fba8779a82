"""What of a form goes into which variable of a dataset, and back."""

from __future__ import annotations

from typing import cast

import numpy as np

from bifurc.atlas import Form
from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate, CertificateValues
from bifurc.curves.monitor import Profile
from bifurc.files.json_values import mapping_from_text, to_text
from bifurc.files.table import JOINT, UNIT, Column, Row, Table


def _samples(form: Form) -> np.ndarray:
    """Points (k, n) at which the singular values were taken."""
    if not len(form.branch.pieces):
        return np.empty((0, form.branch.n))
    return form.branch(form.profile.arclength.ravel())


def _singular_values(form: Form) -> np.ndarray:
    return form.profile.values.reshape(-1, form.branch.n)


def _certificate_text(form: Form) -> str:
    return "" if form.certificate is None else to_text(form.certificate.as_values())


def _labels_text(form: Form) -> str:
    return to_text(dict(form.labels))


FORMS: Table[Form] = Table(
    "form",
    lambda atlas: atlas.forms,
    (
        Column("form", lambda f: f.name, "name of the form", dtype=str),
        Column(
            "arclength",
            lambda f: f.profile.arclength.ravel(),
            "arclength along the form",
            UNIT,
            entries="sample",
            is_padded=True,
        ),
        Column(
            "configuration",
            _samples,
            "unknowns along the form",
            UNIT,
            dimensions=(JOINT,),
            entries="sample",
            is_padded=True,
        ),
        Column(
            "singular_values",
            _singular_values,
            "singular values of F' over its magnitude",
            "1",
            dimensions=("singular_value",),
            entries="sample",
            is_padded=True,
        ),
        Column(
            "sample_nodes",
            lambda f: f.profile.arclength.shape[1],
            "samples on each piece",
            dtype=int,
        ),
        Column(
            "length", lambda f: f.branch.length, "arclength of the whole form", UNIT
        ),
        Column(
            "closed",
            lambda f: f.branch.closed,
            "whether the form is a closed curve",
            dtype=bool,
        ),
        Column(
            "winding",
            lambda f: f.branch.winding,
            "turns along a closed form",
            dtype=int,
            dimensions=(JOINT,),
        ),
        Column(
            "max_residual",
            lambda f: f.branch.max_residual,
            "largest relative residual",
            "1",
        ),
        Column(
            "min_singular_value",
            lambda f: f.min_singular_value,
            "smallest regular singular value along the form",
            "1",
        ),
        Column(
            "misclosure",
            lambda f: f.misclosure,
            "largest relative residual that no correction removes",
            "1",
        ),
        Column("rank", lambda f: f.rank, "rank of F' along the form", dtype=int),
        Column(
            "multiplicity",
            lambda f: f.multiplicity,
            "how often the equations are solved all along the form",
            dtype=int,
        ),
        Column(
            "component",
            lambda f: f.component,
            "number of the connected component",
            dtype=int,
        ),
        Column("labels", _labels_text, "what was recognised, as JSON", dtype=str),
        Column(
            "certificate",
            _certificate_text,
            "what is certified, as JSON; empty where nothing is",
            dtype=str,
        ),
        Column(
            "outcome", lambda f: f.branch.outcome.name, "why tracing ended", dtype=str
        ),
        Column("gap", lambda f: f.branch.gap, "residual at an uncorrected start", "1"),
        Column(
            "piece_order",
            lambda f: f.branch.pieces.shape[1] - 1,
            "degree of the pieces",
            dtype=int,
        ),
        Column(
            "coefficient",
            lambda f: f.branch.pieces,
            "coefficients in (s - center) / radius",
            UNIT,
            dimensions=("power", JOINT),
            entries="piece",
        ),
        Column(
            "center",
            lambda f: f.branch.centers,
            "arclength at its centre",
            UNIT,
            entries="piece",
        ),
        Column(
            "radius",
            lambda f: f.branch.radii,
            "radius in which it is trusted",
            UNIT,
            entries="piece",
        ),
        Column(
            "piece_residual",
            lambda f: f.branch.residuals,
            "largest relative residual",
            "1",
            entries="piece",
        ),
        Column(
            "break_arclength",
            lambda f: f.branch.breaks,
            "where pieces hand over",
            UNIT,
            entries="break",
        ),
    ),
)


def read_form(row: Row, periods: np.ndarray) -> Form:
    """The form of a row of `FORMS`, of unknowns with ``periods`` (n,).

    Raises `ValueError` or `KeyError` where the values of the row do not fit together.
    """
    order = int(row["piece_order"])
    branch = Branch(
        pieces=row["coefficient"][:, : order + 1],
        centers=row["center"],
        radii=row["radius"],
        breaks=row["break_arclength"],
        residuals=row["piece_residual"],
        periods=periods,
        outcome=Outcome[str(row["outcome"])],
        gap=float(row["gap"]),
    )
    nodes = int(row["sample_nodes"])
    profile = Profile(
        row["arclength"].reshape(-1, nodes),
        row["singular_values"].reshape(-1, nodes, branch.n),
        int(row["rank"]),
    )
    return Form(
        name=str(row["form"]),
        branch=branch,
        profile=profile,
        min_singular_value=float(row["min_singular_value"]),
        component=int(row["component"]),
        misclosure=float(row["misclosure"]),
        multiplicity=int(row["multiplicity"]),
        certificate=_read_certificate(str(row["certificate"])),
        labels=mapping_from_text(str(row["labels"])),
    )


def _read_certificate(text: str) -> Certificate | None:
    if not text:
        return None
    return Certificate.from_values(cast(CertificateValues, mapping_from_text(text)))
