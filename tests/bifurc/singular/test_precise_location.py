"""What the exact equations say of a point that doubles take for singular."""

import numpy as np
import pytest

from bifurc import FunctionProblem, explore
from bifurc.completeness import Level
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.precise_location import precisely_located

BOX = [(-3.03, 2.97), (-3.1, 2.9)]


def circles(radius, gap):
    """Two circles that are a ``gap`` apart on the x-axis."""
    center = 1 + radius + gap
    return FunctionProblem(
        lambda u: [
            (u[0] ** 2 + u[1] ** 2 - radius**2) * ((u[0] - center) ** 2 + u[1] ** 2 - 1)
        ],
        BOX,
    )


def located(x, y, error=3e-6):
    """A point of nullity 2 as doubles may give it."""
    return LocatedPoint(np.array([x, y]), np.eye(2), error)


def test_the_saddle_between_two_curves_is_no_singular_point():
    problem = FunctionProblem(lambda u: [u[0] * u[1] - 0.01], [(-1, 1)] * 2)
    assert precisely_located(problem, located(1e-4, 2e-4)) is None


def test_a_miss_that_doubles_do_not_see_leaves_the_point_in_doubt():
    problem = FunctionProblem(lambda u: [u[0] * u[1] - 1e-17], [(-1, 1)] * 2)
    exactly = precisely_located(problem, located(1e-4, 2e-4))
    assert exactly is not None
    assert not exactly.is_confirmed


@pytest.mark.parametrize("gap", [1e-11, 1e-12, 2e-13])
def test_curves_that_nearly_touch_are_in_doubt(gap):
    problem = FunctionProblem(
        lambda u: [(u[1] - u[0] ** 2) * (u[1] + gap)], [(-2, 2)] * 2
    )
    exactly = precisely_located(problem, located(1e-8, 1e-8))
    assert exactly is not None
    assert not exactly.is_confirmed


@pytest.mark.parametrize("center", [0.0, 3.0, 1000.0])
def test_curves_that_touch_far_from_the_origin_are_confirmed(center):
    problem = FunctionProblem(
        lambda u: [
            ((u[0] - center) ** 2 + u[1] ** 2 - 1)
            * (3 * (u[0] - center) + 4 * u[1] - 5)
        ],
        [(center - 2, center + 2), (-2, 2)],
    )
    exactly = precisely_located(problem, located(center + 0.6, 0.8))
    assert exactly is not None
    assert exactly.is_confirmed


def test_a_crossing_is_confirmed_where_coefficients_are_rounded():
    problem = FunctionProblem(
        lambda u: [u[1] ** 2 - u[0] ** 2 + 0.2 * u[0] - 0.01], [(-1, 1)] * 2
    )
    exactly = precisely_located(problem, located(0.1001, 2e-4))
    assert exactly is not None
    assert exactly.is_confirmed
    assert exactly.u == pytest.approx([0.1, 0.0], abs=1e-15)


def test_circles_that_do_not_meet_have_near_misses_and_no_bifurcation():
    atlas = explore(circles(0.06, 1e-5))
    assert len(atlas.forms) == 2
    assert not atlas.points
    assert atlas.near_misses


@pytest.mark.parametrize(("radius", "gap"), [(1.0, -1e-6), (0.3, -1e-7)])
def test_two_crossings_in_one_germ_are_two(radius, gap):
    distance = 1 + radius + gap
    x = (distance**2 + radius**2 - 1) / (2 * distance)
    y = np.sqrt(radius**2 - x**2)
    atlas = explore(circles(radius, gap))
    places = sorted(point.point.u.tolist() for point in atlas.points)
    heights = sorted(place[1] for place in places)
    assert heights == pytest.approx([-y, y], rel=1e-4)


@pytest.mark.parametrize(
    "function",
    [
        lambda u: [u[0] * u[1] - 1e-15],
        lambda u: [
            ((u[0] - 0.3) ** 2 + (u[1] - 0.2) ** 2 + 1e-13)
            * (u[0] ** 2 + u[1] ** 2 - 1)
        ],
    ],
    ids=["hyperbola", "no lone point"],
)
def test_no_point_is_certified_that_the_equations_do_not_have(function):
    atlas = explore(FunctionProblem(function, BOX))
    is_certified = atlas.completeness.level in (Level.CERTIFIED, Level.COUNTED)
    assert not (atlas.points and is_certified)
