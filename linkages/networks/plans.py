"""The networks of section 5.4 of Song (2013), numbered as there."""

from __future__ import annotations

from linkages.networks.plan import Cell, Plan

A = Cell("A", ("8", "1", "2", "0"), ("c", "a"))
B = Cell("B", ("2", "3", "4", "0"), ("b", "c"))
C = Cell("C", ("4", "5", "6", "0"), ("d", "b"))
D = Cell("D", ("6", "7", "8", "0"), ("a", "d"))

FOUR_BENNETT = Plan(
    "four-bennett-network",
    "Four Bennett loops around a common axis",
    ("1", "2", "3", "4", "5", "6", "7", "8"),
    (A, B, C, D),
    ("0",),
)
L_SHAPE = Plan(
    "l-shape-bennett-network",
    "Three Bennett loops around a common axis",
    ("8", "1", "2", "3", "4", "5", "6", "0"),
    (A, B, C),
)
SERIAL = Plan(
    "serial-bennett-network",
    "Three Bennett loops in a row",
    ("U0", "U1", "U2", "U3", "V3", "V2", "V1", "V0"),
    (
        Cell("A", ("U0", "U1", "V1", "V0"), ("a", "d")),
        Cell("B", ("U1", "U2", "V2", "V1"), ("b", "d")),
        Cell("C", ("U2", "U3", "V3", "V2"), ("c", "d")),
    ),
)
PLANS = {plan.name: plan for plan in (FOUR_BENNETT, L_SHAPE, SERIAL)}
