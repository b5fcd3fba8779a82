"""Every comparison of this package on which a count, a name or a word hangs, in one
table; those of the search stand in `bifurc.decisions`."""

from __future__ import annotations

from bifurc.decisions import Decision, decisions_in

matches_pattern = Decision(
    "form of a source",
    "a form satisfies the equations by which a source tells it",
    "largest residual of the equations along the form",
    1e-4,
    "a form is exact to 1e-12, beside a surface to 1e-6, and another form misses them by "
    "1e-1",
)
has_symmetry = Decision(
    "symmetry of a form",
    "the angles of joints some places apart are equal or opposite along a form",
    "largest sine of half their difference",
    1e-4,
    "a form is exact to 1e-12, beside a surface to 1e-6; others differ by 1e-1",
)
keeps_angle = Decision(
    "inactive joint",
    "a joint keeps its angle along a form",
    "largest difference of angles along the form, rad; over what rounding may make of it "
    "where that is more",
    1e-8,
    "a form is exact to 1e-12",
    third_answer="a joint whose angle may change by rounding alone is in doubt",
)
is_alike_in_geometry = Decision(
    "kind of a four-bar",
    "a four-bar is planar, spherical or a Bennett linkage",
    "sine of a twist, or difference of lengths over the characteristic length",
    1e-7,
    "the geometry of a smaller linkage comes from that of the larger one, with rounding",
)
is_same_length = Decision(
    "equal links",
    "two links of a planar four-bar have the same length",
    "difference of their lengths over the mean length",
    1e-12,
    "the closing tolerance: forms that need them equal miss closure by the difference",
)
is_same_dead_point = Decision(
    "same dead point",
    "two dead points lie at one angle of a joint, or a joint does not turn",
    "difference of the angles, rad",
    1e-7,
    "dead points are exact to half the digits",
    third_answer="a joint whose angle may change by rounding alone is in doubt, and "
    "nothing is proved then",
)
is_singular_end = Decision(
    "singular end of a path",
    "a path ended at a configuration of lower rank, on a motion or shaky",
    "smallest singular value there",
    1e-7,
    "rounding moves such an end by the root of it, which leaves 1e-8",
    third_answer="one below that of a regular end is counted in the statement, and "
    "nothing is complete then",
)
is_nearly_singular_end = Decision(
    "regular end of a path",
    "a path ended where the rank is low or nearly low",
    "smallest singular value there",
    1e-6,
    "another end may be as near as that, and so near two ends count as one",
    third_answer="one above that of a singular end is counted in the statement, and "
    "nothing is complete then",
)
is_real_end = Decision(
    "real end of a path",
    "a configuration at which a path ended is an assembly",
    "largest imaginary part of an angle, rad",
    1e-6,
    "ends are exact to rounding over the singular value",
)
is_same_end = Decision(
    "same end of two paths",
    "two paths ended at one configuration",
    "largest difference of an angle, rad",
    1e-6,
    "ends are exact to rounding over the singular value",
)
is_near_its_end = Decision(
    "end of a path",
    "a path that stopped is where it ends, at a configuration of lower rank",
    "what is left of it",
    1e-3,
    "rounding stops a path to such a configuration at 1e-4 and later",
)
is_in_reach = Decision(
    "path to infinity",
    "a path that stopped on the way was lost, and was not on its way to infinity",
    "largest imaginary part of an angle, rad",
    6.0,
    "paths are followed up to 12; of isolated configurations 9 is the largest one seen",
    third_answer="a lost path is counted in the statement, and nothing is proved then",
)
is_parallel_axis = Decision(
    "parallel axes",
    "axes of a chain are parallel, or a slide is parallel or perpendicular to them",
    "sine of the angle between them, or between the slide and the plane",
    1e-11,
    "the rounding of coordinates; a chain whose axes are off by more gets all six "
    "equations, and misses them by as much",
)
meets_in_one_point = Decision(
    "axes through one point",
    "the axes of a chain pass through one point",
    "largest distance of an axis from the point nearest to all, over the "
    "characteristic length",
    1e-11,
    "the rounding of coordinates; a chain whose axes are off by more gets all six "
    "equations, and misses them by as much",
)
cancels_in_whole_turns = Decision(
    "whole turns that cancel",
    "whole turns of several joints advance nothing, so that configurations that differ "
    "by them are one but for whole turns",
    "what they advance, over the largest advance of a joint in one turn",
    1e-11,
    "the rounding of pitches, some 1e-16 a turn; turns that do not cancel miss by a "
    "share of a turn",
)
is_moved_by_whole_turns = Decision(
    "same place up to whole turns",
    "two configurations, or points of two forms, are one but for whole turns",
    "their distance after these turns, rad and characteristic lengths",
    1e-6,
    "forms are closed to 1e-12, shaky assemblies found to 1e-8; others are apart by a "
    "share of a turn",
)
is_rounding_of_zero = Decision(
    "equation without unknowns",
    "a closure equation that holds no unknown is satisfied",
    "its value",
    1e-12,
    "the closing tolerance",
)
is_bar_assembled = Decision(
    "assembled bars",
    "bars have the lengths that are given for them",
    "largest difference of a length, over the extent of the points",
    1e-13,
    "the rounding of coordinates: bars that can be assembled are to 1e-15, singular "
    "assemblies among them",
)
is_dependent_constraint = Decision(
    "redundant constraint",
    "a constraint of a loop follows from its others",
    "singular value of the loop's Jacobian, over the magnitude",
    1e-8,
    "constraints that depend on each other give 1e-15",
)
is_file_closed = Decision(
    "file that closes",
    "the joints of a mechanism in a file of another program fit in a configuration",
    "largest distance of a joint's points over the characteristic length, or sine",
    1e-10,
    "joints of exact numbers fit to 1e-14, of numbers with 8 digits to 1e-8",
)
is_file_nearly_closed = Decision(
    "file of rounded numbers",
    "what the joints of a mechanism in a file miss each other by is from rounding",
    "largest distance of a joint's points over the characteristic length, or sine",
    1e-2,
    "three digits are rounded to 1e-3; what cannot be closed misses by 1e-1 and more",
)
is_one_anchor = Decision(
    "one anchor",
    "points that two bodies of an MJCF file share are one point, or on one line",
    "distance, over the largest coordinate",
    1e-9,
    "rounding of poses gives 1e-15; anchors that make an axis are 1e-3 and more apart",
)
is_one_joint = Decision(
    "axes of one joint",
    "joints of an MJCF body make a cylindrical, universal, planar or helical joint",
    "sine of an angle, or distance over the largest coordinate, that is to be 0",
    1e-12,
    "rounding of poses gives 1e-15; read as joints one after the other, they move alike",
)

is_closed_as_it_stands = Decision(
    "numbers of a file",
    "the joints of a mechanism in a file fit as they stand, and their numbers are kept",
    "largest distance of a joint's points over the characteristic length, or sine",
    1e-13,
    "joints of exact numbers fit to 1e-14; others are moved by as much as they miss",
)
is_one_direction = Decision(
    "one direction twice",
    "the second direction of a joint is along the first one, and the joint is refused",
    "sine of the angle between them",
    1e-9,
    "directions of a file have 8 digits and more; what is meant to be different is 1e-2 "
    "and more apart",
)
is_degenerate_dyad = Decision(
    "degenerate dyad",
    "a dyad closes in a whole curve of configurations: two equal circles are one, or a "
    "circle of no radius is on a line, or two lines are one direction, or a body has both "
    "joints on one axis",
    "distance over the characteristic length, or sine",
    1e-7,
    "lengths of a file that are meant to be equal agree to 1e-12; beside it a motion "
    "turns back within twice that of the driver",
    third_answer="such a dyad makes no slices, and nothing is certified by them",
)
is_stopped = Decision(
    "driver that is stopped",
    "with joints held for it, a driver stays in a singular reference configuration",
    "largest way of the driver from there to what random starts reach, rad or "
    "characteristic lengths",
    1e-3,
    "starts 0.1 beside end 1e-5 beside a driver that is stopped, a double root, and 1e-2 "
    "and more away where it moves",
)

is_network_closed = Decision(
    "closed network",
    "cells of a network close around an axis, or have a joint at its lock",
    "angle that is missing, rad",
    1e-9,
    "bisection leaves 1e-15 times the slope; where there is no configuration 1e-2",
)
is_dependent_lock = Decision(
    "redundant lock",
    "a lock of a network holds nothing that the others do not, or a joint stands still",
    "singular value, or rate of a joint, of the closed form with unit states",
    1e-8,
    "what depends on each other gives 1e-15",
)
is_same_network_place = Decision(
    "same place of a network",
    "two configurations of a network are one",
    "largest difference of the states of cells, rad",
    1e-7,
    "roots are exact to 1e-15 times the slope, double ones to 1e-8",
)

is_near_origin = Decision(
    "near the origin",
    "coordinates are no larger than the mechanism, but for a few times",
    "largest coordinate of a point over the largest difference of two",
    8.0,
    "rounding of a coordinate is then 1e-15 of the mechanism at most, as that of F; beyond, "
    "coordinates of a file are counted from its first point, and those of a mechanism "
    "that is made otherwise are said to be rounded",
    third_answer="on either side what rounding of the coordinates explains is in doubt",
)
passes_reference = Decision(
    "reference configuration of a form",
    "a form passes through the reference configuration, and its angles are 0 there",
    "distance of the form from it, rad or characteristic lengths",
    1e-3,
    "a file of four digits closes 1e-4 beside its reference; whole turns alone hang on it",
)

TABLE = decisions_in(globals())
