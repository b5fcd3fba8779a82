"""Every comparison of this package on which a count, a name or a word hangs, in one
table; those of the search stand in `bifurc.decisions`."""

from __future__ import annotations

from bifurc.decisions import Decision, decisions_in

__all__ = ["TABLE"]

matches_pattern = Decision(
    "form of a source",
    "a form satisfies the equations by which a source tells it",
    "largest residual of the equations along the form",
    1e-8,
    "a form is exact to 1e-12, and another form misses them by 1e-2 and more",
)
keeps_angle = Decision(
    "inactive joint",
    "a joint keeps its angle along a form, or two joints have the same angle",
    "largest difference of angles along the form, rad",
    1e-7,
    "a form is exact to 1e-12",
)
is_alike_in_geometry = Decision(
    "kind of a four-bar",
    "a four-bar is planar, spherical or a Bennett linkage",
    "sine of a twist, or difference of lengths over the characteristic length",
    1e-7,
    "the geometry of a smaller linkage comes from that of the larger one, with rounding",
)
is_same_dead_point = Decision(
    "same dead point",
    "two dead points lie at one angle of a joint, or a joint does not turn",
    "difference of the angles, rad",
    1e-7,
    "dead points are exact to half the digits",
)

TABLE = decisions_in(globals())
