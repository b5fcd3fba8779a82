"""What of a bifurcation diagram goes into which variable of a dataset, and back."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.diagrams.diagram import (
    Branching,
    Diagram,
    DiagramPoint,
    Stability,
    Stretch,
)
from bifurc.files.table import JOINT, UNIT, Column, Row, Table
from bifurc.singular.point import Kind

NOTHING = Diagram("", (), (), ())


def _diagram(atlas: Atlas) -> Diagram:
    return atlas.diagram or NOTHING


DIAGRAM_POINTS: Table[DiagramPoint] = Table(
    "diagram_point",
    lambda atlas: _diagram(atlas).points,
    (
        Column("diagram_point", lambda p: p.name, "name of the point", dtype=str),
        Column(
            "diagram_point_kind", lambda p: p.kind.name, "what happens there", dtype=str
        ),
        Column(
            "diagram_point_label", lambda p: p.label, "name of the event", dtype=str
        ),
        Column(
            "diagram_point_form",
            lambda p: p.form,
            "index of the form, from 0",
            dtype=int,
            index_of="form",
        ),
        Column(
            "diagram_point_arclength", lambda p: p.s, "arclength along the form", UNIT
        ),
        Column(
            "diagram_point_configuration",
            lambda p: p.u,
            "unknowns there",
            UNIT,
            dimensions=(JOINT,),
        ),
        Column(
            "diagram_point_value",
            lambda p: p.value,
            "second derivative of the parameter at a fold, angular frequency at a Hopf "
            "point, value of the function at an event",
            "1",
        ),
        Column(
            "diagram_point_error",
            lambda p: p.error,
            "arclength to either side within which rounding hides the point",
            UNIT,
        ),
    ),
)

STRETCHES: Table[Stretch] = Table(
    "stretch",
    lambda atlas: _diagram(atlas).stretches,
    (
        Column(
            "stretch_form",
            lambda s: s.form,
            "index of the form, from 0",
            dtype=int,
            index_of="form",
        ),
        Column("stretch_start", lambda s: s.start, "arclength where it begins", UNIT),
        Column(
            "stretch_end",
            lambda s: s.end,
            "arclength where it ends; may exceed the length of a closed form",
            UNIT,
        ),
        Column("stretch_stability", lambda s: s.stability.name, "stability", dtype=str),
        Column(
            "stretch_unstable",
            lambda s: s.unstable,
            "number of eigenvalues with positive real part, -1: not known",
            dtype=int,
        ),
    ),
)

BRANCHINGS: Table[Branching] = Table(
    "branching",
    lambda atlas: _diagram(atlas).branchings,
    (
        Column(
            "branching_point",
            lambda b: b.point,
            "index of the singular point, from 0",
            dtype=int,
            index_of="point",
        ),
        Column(
            "branching_kind",
            lambda b: b.kind.name,
            "what it is along the parameter",
            dtype=str,
        ),
    ),
)

REMARKS: Table[str] = Table(
    "diagram_remark",
    lambda atlas: _diagram(atlas).remarks,
    (
        Column(
            "diagram_remark",
            lambda remark: remark,
            "what is to be said of an event",
            dtype=str,
        ),
    ),
)


def read_diagram_point(row: Row) -> DiagramPoint:
    """The point of a row of `DIAGRAM_POINTS`."""
    return DiagramPoint(
        name=str(row["diagram_point"]),
        kind=Kind[str(row["diagram_point_kind"])],
        form=int(row["diagram_point_form"]),
        s=float(row["diagram_point_arclength"]),
        u=row["diagram_point_configuration"],
        value=float(row["diagram_point_value"]),
        label=str(row["diagram_point_label"]),
        error=float(row["diagram_point_error"]),
    )


def read_remark(row: Row) -> str:
    """The remark of a row of `REMARKS`."""
    return str(row["diagram_remark"])


def read_stretch(row: Row) -> Stretch:
    """The stretch of a row of `STRETCHES`."""
    return Stretch(
        form=int(row["stretch_form"]),
        start=float(row["stretch_start"]),
        end=float(row["stretch_end"]),
        stability=Stability[str(row["stretch_stability"])],
        unstable=int(row["stretch_unstable"]),
    )


def read_branching(row: Row) -> Branching:
    """The branching of a row of `BRANCHINGS`."""
    return Branching(
        point=int(row["branching_point"]),
        kind=Kind[str(row["branching_kind"])],
    )
