"""What of singular points, near misses and dead points goes into which variable of a
dataset, and back."""

from __future__ import annotations

from bifurc.atlas import Event, MeetingPoint
from bifurc.files.table import JOINT, UNIT, Column, Row, Table
from bifurc.singular.point import Invariants, Kind, SingularPoint

POINTS: Table[MeetingPoint] = Table(
    "point",
    lambda atlas: atlas.points,
    (
        Column("point", lambda p: p.name, "name of the singular point", dtype=str),
        Column(
            "point_kind", lambda p: p.kind.name, "what the singular point is", dtype=str
        ),
        Column("point_note", lambda p: p.note, "remark", dtype=str),
        Column(
            "point_configuration",
            lambda p: p.point.u,
            "singular point",
            UNIT,
            dimensions=(JOINT,),
        ),
        Column(
            "point_rank", lambda p: p.point.rank, "rank of F' at the point", dtype=int
        ),
        Column(
            "point_error", lambda p: p.point.error, "estimated error of the point", UNIT
        ),
        Column(
            "point_dimension",
            lambda p: p.point.dimension,
            "dimension of the solutions nearby",
            dtype=int,
        ),
        Column(
            "point_order",
            lambda p: p.point.order,
            "order that decided; 0: the section alone",
            dtype=int,
        ),
        Column("point_radius", lambda p: p.point.radius, "radius of the section", UNIT),
        Column(
            "point_multiplicity",
            lambda p: _invariant(p, "multiplicity"),
            "multiplicity of the plane curve at the point; -1: not known",
            dtype=int,
        ),
        Column(
            "point_branches",
            lambda p: _invariant(p, "branches"),
            "branches through the point, complex ones counted; -1: not known",
            dtype=int,
        ),
        Column(
            "point_delta",
            lambda p: _invariant(p, "delta"),
            "delta invariant of the point; -1: not known",
            dtype=int,
        ),
        Column(
            "contact",
            lambda p: () if p.point.invariants is None else p.point.invariants.contacts,
            "order of contact of two of the real branches through the point",
            dtype=int,
            entries="contact_pair",
        ),
        Column(
            "met_surface",
            lambda p: p.surfaces,
            "index of a surface it lies on",
            dtype=int,
            entries="meeting",
            index_of="surface",
        ),
        Column(
            "pass_form",
            lambda p: [form for form, _ in p.passes],
            "index of the form that passes, from 0",
            dtype=int,
            entries="pass",
            index_of="form",
        ),
        Column(
            "pass_arclength",
            lambda p: [s for _, s in p.passes],
            "arclength at which it passes",
            UNIT,
            entries="pass",
        ),
        Column(
            "pass_tangent",
            lambda p: p.tangents,
            "unit tangent of the form that passes",
            "1",
            dimensions=(JOINT,),
            entries="pass",
        ),
        Column(
            "null_vector",
            lambda p: p.point.null_space.T,
            "orthonormal basis of the null space of F'",
            "1",
            dimensions=(JOINT,),
            entries="null",
        ),
        Column(
            "half_branch",
            lambda p: p.point.half_branches,
            "unit direction in which solutions leave",
            "1",
            dimensions=(JOINT,),
            entries="half",
        ),
        Column(
            "cone_tangent",
            lambda p: p.point.tangents,
            "unit tangent from the second-order equations",
            "1",
            dimensions=(JOINT,),
            entries="cone",
        ),
    ),
)


def _invariant(point: MeetingPoint, name: str) -> int:
    """An invariant of a point by its name, -1 where it is not known."""
    return int(getattr(point.point.invariants, name, -1))


def _read_invariants(row: Row) -> Invariants | None:
    if row["point_delta"] < 0:
        return None
    return Invariants(
        multiplicity=int(row["point_multiplicity"]),
        branches=int(row["point_branches"]),
        delta=int(row["point_delta"]),
        contacts=tuple(row["contact"].tolist()),
    )


def read_point(row: Row) -> MeetingPoint:
    """The singular point of a row of `POINTS`."""
    point = SingularPoint(
        u=row["point_configuration"],
        rank=int(row["point_rank"]),
        null_space=row["null_vector"].T,
        error=float(row["point_error"]),
        half_branches=row["half_branch"],
        tangents=row["cone_tangent"],
        dimension=int(row["point_dimension"]),
        order=int(row["point_order"]),
        radius=float(row["point_radius"]),
        invariants=_read_invariants(row),
    )
    forms = row["pass_form"].tolist()
    arclengths = row["pass_arclength"].tolist()
    return MeetingPoint(
        name=str(row["point"]),
        kind=Kind[str(row["point_kind"])],
        point=point,
        passes=tuple(zip(forms, arclengths, strict=True)),
        tangents=row["pass_tangent"],
        note=str(row["point_note"]),
        surfaces=tuple(row["met_surface"].tolist()),
    )


# --- events along the forms -----------------------------------------------------------


def _event_columns(owner: str) -> tuple[Column[Event], ...]:
    """The columns that near misses and dead points have in common."""
    return (
        Column(
            f"{owner}_form",
            lambda e: e.form,
            "index of the form, from 0",
            dtype=int,
            index_of="form",
        ),
        Column(f"{owner}_arclength", lambda e: e.s, "arclength along the form", UNIT),
        Column(
            f"{owner}_configuration",
            lambda e: e.u,
            "unknowns there",
            UNIT,
            dimensions=(JOINT,),
        ),
    )


NEAR_MISSES: Table[Event] = Table(
    "near_miss",
    lambda atlas: atlas.near_misses,
    (
        *_event_columns("near_miss"),
        Column(
            "near_miss_value",
            lambda e: e.value,
            "smallest regular singular value there",
            "1",
        ),
        Column("near_miss_error", lambda e: e.error, "bound of its error", "1"),
    ),
)

DEAD_POINTS: Table[Event] = Table(
    "dead_point",
    lambda atlas: atlas.dead_points,
    (
        *_event_columns("dead_point"),
        Column(
            "dead_point_index",
            lambda e: e.index,
            "index of the unknown that turns back, from 0",
            dtype=int,
            index_of=JOINT,
        ),
    ),
)


def read_near_miss(row: Row) -> Event:
    """The near miss of a row of `NEAR_MISSES`."""
    return Event(
        form=int(row["near_miss_form"]),
        s=float(row["near_miss_arclength"]),
        u=row["near_miss_configuration"],
        value=float(row["near_miss_value"]),
        error=float(row["near_miss_error"]),
    )


def read_dead_point(row: Row) -> Event:
    """The dead point of a row of `DEAD_POINTS`."""
    return Event(
        form=int(row["dead_point_form"]),
        s=float(row["dead_point_arclength"]),
        u=row["dead_point_configuration"],
        index=int(row["dead_point_index"]),
    )
