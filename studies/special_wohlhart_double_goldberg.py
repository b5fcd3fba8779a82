"""The special Wohlhart double-Goldberg 6R linkage among 4R and 6R forms: figure 5.4 of
Song and Chen 2012.

Wohlhart's double-Goldberg linkage is two Goldberg 5R linkages merged on a shared pair
of links a/alpha, c/gamma. Under

    tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2)                                    (5.10)

joints 3 and 6 stand still at 0 in Form I, which becomes a Bennett 4R linkage of joints
1, 2, 4 and 5. It is connected with the other forms through configurations in which all
links are collinear. The source draws theta5 against theta1; it has b/beta as link 23
and d/delta as link 34, the catalogue (as Song 2013) the other way round. Numbers are
not given there: those of Song 2013, eq. (5.2.34), are used.
"""

from __future__ import annotations

import math

import numpy as np

from bifurc import Atlas
from linkages import load, map_linkage
from studies.redrawing import Claim, Redrawing, angles_along, largest

ALPHA, BETA, DELTA = math.radians(125), math.radians(60), math.radians(45)


def compute() -> Atlas:
    """The transition map, links named as in the source."""
    return map_linkage(
        load("special-wohlhart-double-goldberg", alpha=ALPHA, beta=DELTA, delta=BETA)
    )


def claims(atlas: Atlas) -> list[Claim]:
    """What the text says of the forms and of their meeting points."""
    (theta3, theta6) = angles_along(atlas, "Form I (Bennett 4R)", 3, 6)
    meeting = np.array([point.point.u for point in atlas.bifurcations])
    return [
        Claim(
            "Form I: theta3 = theta6 = 0 all along",
            largest(np.sin([theta3 / 2, theta6 / 2])),
        ),
        Claim(
            "the forms are connected through four bifurcations",
            abs(len(atlas.bifurcations) - 4),
        ),
        Claim("at these all links are collinear", largest(np.sin(meeting))),
        Claim("all forms can be reached from each other", atlas.components - 1),
    ]


main = Redrawing("figure_5_4", (1, 5), compute, claims).command()

if __name__ == "__main__":
    main()
