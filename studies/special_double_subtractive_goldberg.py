"""The double-subtractive-Goldberg 6R linkage with multiple operation forms: figure
5.2.5 of Song 2013.

Two subtractive Goldberg 5R linkages are merged, and tan(alpha/2) tan(gamma/2) =
tan(beta/2) tan(delta/2) is required (5.2.25), with alpha = 125, beta = 60, delta = 45
degrees (5.2.34). Form I stays a 6R linkage; in Form II joints 3 and 6 stand still at pi
and what moves is a Bennett 4R linkage. Two more forms, III and IV, are not built from
Goldberg linkages. The source draws theta5 against theta1.
"""

from __future__ import annotations

import math

import numpy as np

from bifurc import Atlas
from linkages import load, map_linkage
from studies.redrawing import Claim, Redrawing, angles_along, largest

ALPHA, BETA, DELTA = math.radians(125), math.radians(60), math.radians(45)


def compute() -> Atlas:
    """The transition map for the geometry of (5.2.34)."""
    return map_linkage(
        load("special-double-subtractive-goldberg", alpha=ALPHA, beta=BETA, delta=DELTA)
    )


def claims(atlas: Atlas) -> list[Claim]:
    """What the text says of the forms and of their meeting points."""
    (theta1, theta5) = angles_along(atlas, "Form I (constructive 6R)", 1, 5)
    (theta3, theta6) = angles_along(atlas, "Form II (Bennett 4R)", 3, 6)
    meeting = np.array([point.point.u for point in atlas.bifurcations])
    return [
        Claim(
            "Form I: theta1 + theta5 = +-pi, a straight line (5.2.35)",
            largest(np.cos((theta1 + theta5) / 2)),
        ),
        Claim(
            "Form II: theta3 = -theta6 = pi", largest(np.cos([theta3 / 2, theta6 / 2]))
        ),
        Claim(
            "four bifurcations join the four forms",
            abs(len(atlas.bifurcations) - 4) + abs(len(atlas.forms) - 4),
        ),
        Claim("at these all six links are collinear", largest(np.sin(meeting))),
    ]


main = Redrawing("figure_5_2_5", (1, 5), compute, claims).command()

if __name__ == "__main__":
    main()
