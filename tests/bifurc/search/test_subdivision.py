"""Boxes that hold nothing, or a single arc: what they prove, find and refute."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc import FunctionProblem, Level, SearchSettings, explore
from bifurc.limits import Deadline, until
from bifurc.search.subdivision import can_be_subdivided, subdivide
from bifurc.system import relative_gaps

MANY = 20_000
PATIENT = SearchSettings(boxes=MANY)
BOX = [(-2.03, 1.97), (-1.91, 2.07)]


def circle(u):
    return [u[0] ** 2 + u[1] ** 2 - 1]


def problem(function, bounds=BOX, **options):
    return FunctionProblem(function, bounds, **options)


KNOWN = {
    "circle": (circle, BOX, 1, Level.COUNTED),
    "a line that leaves through a corner": (
        lambda u: [u[0] - u[1]],
        [(-1, 1), (-1, 1)],
        1,
        Level.COUNTED,
    ),
    "an arc in the corner of the bounds": (circle, [(0, 2), (0, 2)], 1, Level.COUNTED),
    "node": (
        lambda u: [(u[0] ** 2 + u[1] ** 2) ** 2 - u[0] ** 2 + u[1] ** 2],
        BOX,
        1,
        Level.CERTIFIED,
    ),
    "curve in space": (
        lambda u: [u @ u - 1, u[0] ** 2 + u[1] ** 2 - 0.3 * u[0] - 0.2],
        [*BOX, (-2, 2)],
        2,
        Level.COUNTED,
    ),
    "curve of four unknowns": (
        lambda u: [
            u[0] ** 2 + u[1] ** 2 - 1,
            u[2] ** 2 + u[1] ** 2 - 1.1,
            u[3] - u[0] * u[2],
        ],
        [*BOX, *BOX],
        2,
        Level.COUNTED,
    ),
    "a domain with an end": (
        lambda u: [np.log(u[0]) - u[1]],
        [(0.1, 2), (-2, 2)],
        1,
        Level.COUNTED,
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_all_boxes_are_settled_by_the_forms(name):
    function, bounds, forms, level = KNOWN[name]
    atlas = explore(problem(function, bounds), settings=PATIENT)
    assert len(atlas.forms) == forms
    assert atlas.completeness.level is level
    assert "each one holds no solution, or a single arc" in atlas.completeness.statement


def test_circles_are_divided_over_one_period():
    torus = problem(
        lambda u: [np.sin(2 * u[0] - 3 * u[1])],
        [(0, 2 * np.pi)] * 2,
        periods=[2 * np.pi] * 2,
    )
    atlas = explore(torus, settings=PATIENT)
    assert len(atlas.forms) == 2
    assert atlas.completeness.level is Level.COUNTED


def test_next_to_singular_points_nothing_is_claimed():
    lemniscate = KNOWN["node"][0]
    atlas = explore(problem(lemniscate), settings=PATIENT)
    assert atlas.completeness.level is Level.CERTIFIED
    assert "within 1e-05 of a quarter of the region" in atlas.completeness.statement


def test_what_random_starts_miss_is_found():
    def two_ovals(u):
        x, y = u
        ovals = (x**2 + y**2 - 1) * ((x - 0.5) ** 2 + y**2 - 1e-6)
        return [ovals + 1e-15 * np.exp(x)]  # of no two factors

    few = SearchSettings(starts=3, boxes=MANY)
    missing = explore(problem(two_ovals), settings=replace(few, boxes=0))
    assert len(missing.forms) == 1
    atlas = explore(problem(two_ovals), settings=few)
    assert sorted(form.branch.length for form in atlas.forms) == pytest.approx(
        [2 * np.pi * 1e-3, 2 * np.pi]
    )
    assert atlas.completeness.level is Level.COUNTED


@pytest.mark.parametrize(("width", "height"), [(1e-4, 1), (3e-3, 1), (0.01, 0.01)])
@pytest.mark.parametrize("seed", [1, 3])
def test_a_march_does_not_leap_over_a_narrow_bump(width, height, seed):
    def bump(u):
        x, y = u
        return [y - height * np.exp(-(((x - 0.3) / width) ** 2)) - 0.2 * x]

    (form,) = explore(problem(bump, [(-2, 2)] * 2), seed=seed).forms
    x = np.concatenate([np.linspace(-2, 2, 9), 0.3 + width * np.linspace(-6, 6, 4001)])
    x.sort()
    points = np.column_stack(
        [x, height * np.exp(-(((x - 0.3) / width) ** 2)) + 0.2 * x]
    )
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert form.branch.length == pytest.approx(length, rel=1e-4)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("apart", [1e-4, 3e-4])
def test_crossings_next_to_each_other_are_all_found(apart, seed):
    def lines(u):
        x, y = u
        return [(y - apart) * (y - x) * (y + x)]

    atlas = explore(problem(lines, [(-1, 1)] * 2), settings=PATIENT, seed=seed)
    assert len(atlas.forms) == 3
    places = sorted(point.point.u[0] for point in atlas.bifurcations)
    assert np.allclose(places, [-apart, 0, apart], rtol=0, atol=1e-9)


def test_forms_that_touch_are_told_apart_beside_the_contact():
    atlas = explore(problem(lambda u: [u[1] ** 2 - u[0] ** 6], [(-1, 1.1), (-1.2, 1)]))
    assert len(atlas.forms) == 2
    assert atlas.completeness.level is Level.CERTIFIED


def test_a_tear_beside_a_cusp_refutes_nothing():
    def conchoid(u):
        return [(u[0] - 1) ** 2 * (u @ u) - u[0] ** 2]

    atlas = explore(problem(conchoid, [(-4, 4.1), (-4, 4.2)]))
    assert len(atlas.forms) == 3
    assert atlas.completeness.level is Level.CERTIFIED


def test_a_branch_that_is_none_is_refuted():
    (form,) = explore(problem(circle)).forms
    other = problem(lambda u: [u[0] ** 2 + 1.02 * u[1] ** 2 - 1])
    division = subdivide(other, [form.branch], [], MANY)
    (refuted,) = division.refuted
    number, s = refuted
    assert number == 0
    assert relative_gaps(other, form.branch(s)[None])[0] > 1e-6
    assert len(division.found)
    assert not division.is_complete


def test_an_arc_that_is_not_known_is_found_where_it_is():
    division = subdivide(problem(circle), [], [], MANY)
    assert len(division.found)
    assert np.allclose(np.linalg.norm(division.found, axis=1), 1, rtol=0, atol=1e-12)


def test_boxes_that_stay_open_show_what_is_smaller_than_they_are():
    def line_and_oval(u):
        oval = (u[0] - 0.31) ** 2 + (u[1] + 0.22) ** 2 - 1e-4
        return [oval * (u[0] - u[1] + 0.7), u[2] - 5.3 + 0.2 * u[0]]

    long = problem(line_and_oval, [(-1, 1), (-1, 1), (-9, 9)])
    forms = explore(long, settings=PATIENT).forms
    line = max((form.branch for form in forms), key=lambda branch: branch.length)
    division = subdivide(long, [line], [], 100)
    assert len(division.left)
    from_middle = division.seeds[:, :2] - (0.31, -0.22)
    assert np.linalg.norm(from_middle, axis=1) == pytest.approx([0.01] * 4)


def test_seeds_beside_crossings_make_no_form_twice():
    # next to its seven nodes boxes stay open, and solutions are known to 1e-6 only
    def two_cubics(u):
        x, y = u
        second = (x - 0.1) ** 2 - (y - 0.2) ** 2 * (y + 0.8)
        return [(y**2 - x**2 * (x + 1)) * second]

    atlas = explore(problem(two_cubics, [(-3, 3), (-3, 3)]), settings=PATIENT)
    assert len(atlas.forms) == 2
    assert len(atlas.bifurcations) == 7


def test_curves_of_multiplicity_take_too_many_boxes():
    double = problem(lambda u: [(u[0] ** 2 + u[1] ** 2 - 1) ** 2])
    assert can_be_subdivided(double)
    division = subdivide(double, [], [], 1000)
    assert 500 < division.count <= 1000
    assert not division.is_complete


@pytest.mark.parametrize(
    "unfit",
    [
        problem(circle, [(-np.inf, np.inf)] * 2),
        problem(lambda u: [u[0] - u[i] for i in range(1, 5)], [(-1, 1)] * 5),
        problem(lambda u: [u[0] - u[1], u[1] - u[0]]),
        problem(lambda u: [float(u[0].real) - u[1]]),
    ],
    ids=["no bounds", "five unknowns", "redundant", "not recorded"],
)
def test_some_problems_are_not_divided(unfit):
    assert not can_be_subdivided(unfit)
    assert explore(unfit).completeness.level is not Level.COUNTED


def test_a_budget_that_is_over_leaves_nothing_proved():
    atlas = explore(problem(circle), settings=SearchSettings(budget=1e-4))
    assert atlas.completeness.level is Level.OUT_OF_TIME


BUMPS = {
    "in the face of a box": (0.5, 0.6, 1e-3, 0.0, 2),
    "at a slant": (0.0, 1.2, 3e-4, 0.2, 2),
    "beyond the bounds": (0.0, 1.2, 1e-3, 0.0, 2),
}


@pytest.mark.parametrize("name", BUMPS)
def test_a_straight_line_is_not_listed_beside_what_it_leaps_over(name):
    level, height, width, slope, forms = BUMPS[name]

    def bump(u):
        x, y = u
        rise = height * np.exp(-(((x - 0.3) / width) ** 2))
        return [y - level - slope * x - rise]

    one = problem(bump, [(-1, 1)] * 2)
    atlas = explore(one, settings=PATIENT)
    gaps = [relative_gaps(one, form.branch.sample(9001)).max() for form in atlas.forms]
    assert max(gaps) < 1e-9
    assert len(atlas.forms) == forms


@pytest.mark.parametrize("bulge", [1e-6, 3e-7])
def test_a_form_that_leaves_the_bounds_for_a_moment_is_not_proved_to_be_one(bulge):
    def arc(u):
        return [u[1] - 1 + (u[0] - 0.1) ** 2 - bulge]

    atlas = explore(problem(arc, [(-1, 1)] * 2))
    is_right = len(atlas.forms) == 2
    assert is_right or atlas.completeness.level is Level.ESTIMATED


@pytest.mark.parametrize("a", [0.15, 0.18, 0.19, 0.199])
def test_a_curve_that_leaves_and_comes_back_close_to_a_corner_is_two_forms(a):
    def bend(u):
        return [u[0] - 0.82 - 0.9 * u[1], u[2] - 1 - 1e-6 + 4 * (u[1] - a) ** 2]

    atlas = explore(problem(bend, [(-1, 1)] * 3), settings=SearchSettings(starts=5))
    assert len(atlas.forms) == 2
    assert atlas.completeness.level is Level.COUNTED


def test_where_an_angle_jumps_nothing_is_proved():
    def ray(u):
        return [np.arctan2(u[1], u[0]) + 3.14]

    one = problem(ray, [(-2, -1), (-0.09, 1.11)])
    assert not can_be_subdivided(one)
    assert len(explore(one).forms) == 1


def test_the_budget_ends_a_subdivision():
    def dense(u):
        return [np.sin(300 * u[0]) * np.sin(300 * u[1]) - 0.01]

    with until(Deadline(0.1)):
        division = subdivide(problem(dense), [], [], 10**7)
    assert 64 < division.count < 10**6
    assert not division.is_complete
