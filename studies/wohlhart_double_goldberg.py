"""Wohlhart's double-Goldberg 6R linkage with multiple operation forms: figure 5.2.7 of
Song 2013.

The counterpart of the double-subtractive-Goldberg linkage of figure 5.2.5, from the
same basic links: lengths and twists of the shared pair are added instead of subtracted.
Now Form I is the Bennett 4R form, with theta3 = theta6 = 0, and Form II the 6R form
that is a straight line in the figure, theta1 + theta5 = 0. The source draws theta5
against theta1.
"""

from __future__ import annotations

import math

import numpy as np

from bifurc import Atlas
from linkages import load, map_linkage
from studies.redrawing import Claim, Redrawing, angles_along, largest

ALPHA, BETA, DELTA = math.radians(125), math.radians(60), math.radians(45)


def compute() -> Atlas:
    """The transition map for the basic links of (5.2.34)."""
    return map_linkage(
        load("special-wohlhart-double-goldberg", alpha=ALPHA, beta=BETA, delta=DELTA)
    )


def claims(atlas: Atlas) -> list[Claim]:
    """What the text says of the forms and of their meeting points."""
    (theta1, theta5) = angles_along(atlas, "Form II (constructive 6R)", 1, 5)
    (theta3, theta6) = angles_along(atlas, "Form I (Bennett 4R)", 3, 6)
    meeting = np.array([point.point.u for point in atlas.bifurcations])
    return [
        Claim(
            "Form II: theta1 + theta5 = 0, a straight line",
            largest(np.sin((theta1 + theta5) / 2)),
        ),
        Claim("Form I: theta3 = theta6 = 0", largest(np.sin([theta3 / 2, theta6 / 2]))),
        Claim(
            "four bifurcations join the four forms",
            abs(len(atlas.bifurcations) - 4) + abs(len(atlas.forms) - 4),
        ),
        Claim("at these all six links are collinear", largest(np.sin(meeting))),
    ]


main = Redrawing("figure_5_2_7", (1, 5), compute, claims).command()

if __name__ == "__main__":
    main()
