"""The first reconfigurable line-symmetric Bricard 6R linkage: figure 5.3.16 of Song
2013.

Two identical spatial triangles are bridged by a Bennett linkage in asymmetric set-up.
The result has the geometry of a general line-symmetric Bricard linkage, with its two 6R
forms I and II, which have nothing in common. The Bennett form, in which joints 2 and 5
stand still at the angle of the triangle, -70 degrees, is the bridge between them: it
meets Form I at one bifurcation and Form II at another. The text does not name the axes
of the figure; those are taken that tell the forms apart best.
"""

from __future__ import annotations

import math

import numpy as np

from bifurc import Atlas
from linkages import load, map_linkage
from studies.redrawing import Claim, Redrawing, angles_along, largest

BENNETT, KINK = "Bennett 4R form", math.radians(-70)


def compute() -> Atlas:
    """The transition map for the geometry of (5.3.12), the default of the catalogue."""
    return map_linkage(load("reconfigurable-bricard-1", kink=KINK))


def claims(atlas: Atlas) -> list[Claim]:
    """What the text says of the forms and of their meeting points."""
    bridge = atlas.form(BENNETT)
    inactive = np.array(angles_along(atlas, BENNETT, 2, 5)) - KINK
    pairs = {frozenset(i for i, _ in point.passes) for point in atlas.bifurcations}
    others = {frozenset((bridge, i)) for i in range(len(atlas.forms)) if i != bridge}
    return [
        Claim(
            "Bennett form: theta2 = theta5 = -70 degrees", largest(np.sin(inactive / 2))
        ),
        Claim("three forms", abs(len(atlas.forms) - 3)),
        Claim(
            "two bifurcations, each with the Bennett form",
            len(pairs ^ others) + abs(len(atlas.bifurcations) - 2),
        ),
        Claim("through these Forms I and II are connected", atlas.components - 1),
    ]


main = Redrawing("figure_5_3_16", None, compute, claims).command()

if __name__ == "__main__":
    main()
