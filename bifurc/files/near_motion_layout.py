"""What of a near motion goes into which variable of a dataset, and back."""

from __future__ import annotations

from bifurc.atlas import NearMotion
from bifurc.files.table import JOINT, UNIT, Column, Row, Table

NEAR_MOTIONS: Table[NearMotion] = Table(
    "near_motion",
    lambda atlas: atlas.near_motions,
    (
        Column(
            "near_motion_misclosure",
            lambda m: m.misclosure,
            "largest of the least relative residuals across it",
            "1",
        ),
        Column("near_motion_length", lambda m: m.length, "arclength", UNIT),
        Column(
            "near_motion_closed",
            lambda m: m.is_closed,
            "whether it comes back to its start",
            dtype=bool,
        ),
        Column(
            "near_motion_mobility",
            lambda m: m.mobility,
            "1 for a curve, 2 or more for a surface",
            dtype=int,
        ),
        Column(
            "near_motion_configuration",
            lambda m: m.sample,
            "a point of it",
            UNIT,
            dimensions=(JOINT,),
        ),
    ),
)


def read_near_motion(row: Row) -> NearMotion:
    """The near motion of a row of `NEAR_MOTIONS`."""
    return NearMotion(
        misclosure=float(row["near_motion_misclosure"]),
        length=float(row["near_motion_length"]),
        is_closed=bool(row["near_motion_closed"]),
        sample=row["near_motion_configuration"],
        mobility=int(row["near_motion_mobility"]),
    )
