"""The line-symmetric Bricard 6R linkage with zero offsets: figure 4.4.7 of Song 2013.

Opposite links are alike and all offsets vanish, so that the geometry is at once that of
the original line-symmetric Bricard linkage (theta_i = theta_{i+3}, Forms I and II) and
of the revised one (theta_i = -theta_{i+3}, Forms I' and II'). Lengths and twists are
those of (4.2.25). The four forms meet where theta1 is 0 or pi, original with revised
ones, never two of a kind. The source draws theta5 against theta1.
"""

from __future__ import annotations

import numpy as np

from bifurc import Atlas
from linkages import load, map_linkage
from studies.redrawing import Claim, Redrawing, largest

ORIGINAL, REVISED = "theta_i = theta_{i+3}", "theta_i = -theta_{i+3}"


def compute() -> Atlas:
    """The transition map for the geometry of (4.2.25) without offsets, the default of
    the catalogue."""
    return map_linkage(load("bricard-line-symmetric-zero-offset"))


def claims(atlas: Atlas) -> list[Claim]:
    """What the text says of the forms and of their meeting points."""
    symmetries = [form.labels["symmetry"] for form in atlas.forms]
    theta1 = np.array([point.point.u[0] for point in atlas.bifurcations])
    alike = 0  # bifurcations of forms of one kind
    for point in atlas.bifurcations:
        kinds = {symmetries[index] for index, _ in point.passes}
        alike += kinds != {ORIGINAL, REVISED}
    return [
        Claim("two original forms", abs(symmetries.count(ORIGINAL) - 2)),
        Claim("two revised forms", abs(symmetries.count(REVISED) - 2)),
        Claim("they meet in four bifurcations", abs(len(atlas.bifurcations) - 4)),
        Claim("these are at theta1 = 0 or pi", largest(np.sin(theta1))),
        Claim("an original form meets a revised one at each", alike),
        Claim("all four forms are connected", atlas.components - 1),
    ]


main = Redrawing("figure_4_4_7", (1, 5), compute, claims).command()

if __name__ == "__main__":
    main()
