"""Curves that are a product are those of its factors, and cross where these do."""

from collections import Counter

import numpy as np
import pytest

import bifurc
from bifurc import Level
from bifurc.search.answer.completeness import SearchDoubt
from bifurc.search.crossings import crossings_with
from tests.samples import one_in

BOX = [(-2, 2)] * 2


def line(angle, place):
    c, s = np.cos(angle), np.sin(angle)
    return lambda u: c * (u[0] - place[0]) + s * (u[1] - place[1])


def circle(radius, middle):
    return lambda u: (u[0] - middle[0]) ** 2 + (u[1] - middle[1]) ** 2 - radius**2


def product_of(curves, size=1.0, shift=(0.0, 0.0)):
    """The problem of all ``curves``, with unknowns in other units."""
    shift = np.array(shift)

    def values(u):
        place = (u[0] / size - shift[0], u[1] / size - shift[1])
        return [np.prod([curve(place) for curve in curves])]

    bounds = size * (np.array(BOX) + shift[:, None])
    return bifurc.FunctionProblem(values, bounds.tolist())


def angles_of(count, rng):
    return np.pi * (np.arange(count) + rng.uniform(0.1, 0.9, count)) / count


def halves_of(atlas):
    return Counter(len(point.point.half_branches) for point in atlas.bifurcations)


@pytest.mark.parametrize("count", [3, 12, 40])
@pytest.mark.parametrize("size", one_in(2, [1e-6, 1.0, 1e5]))
def test_lines_through_one_point_meet_once(count, size):
    rng = np.random.default_rng(count)
    place = (0.3, -0.2)
    lines = [line(angle, place) for angle in angles_of(count, rng)]
    atlas = bifurc.explore(product_of(lines, size, (1.7, -2.6)))
    assert len(atlas.forms) == count
    (point,) = atlas.bifurcations
    assert len(point.passes) == count
    assert len(point.point.half_branches) == 2 * count
    assert point.point.invariants.milnor_number == (count - 1) ** 2
    expected = size * np.array([2.0, -2.8])
    assert point.point.u == pytest.approx(expected, abs=1e-12 * size)
    assert atlas.completeness.level is Level.COUNTED


@pytest.mark.parametrize("count", [5, 20])
def test_lines_in_general_position_cross_two_by_two(count):
    rng = np.random.default_rng(count)
    places = rng.uniform(-1, 1, (count, 2))
    angles = angles_of(count, rng)
    lines = [line(*each) for each in zip(angles, places, strict=True)]
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    distances = (normals * places).sum(axis=1)
    inside = 0
    for k in range(count):
        for j in range(k):
            rows = [k, j]
            point = np.linalg.solve(normals[rows], distances[rows])
            inside += bool(np.all(np.abs(point) < 2))
    atlas = bifurc.explore(product_of(lines))
    assert len(atlas.forms) == count
    assert halves_of(atlas) == {4: inside}
    assert not atlas.completeness.is_in_doubt


@pytest.mark.parametrize("seed", one_in(5, range(10)))
@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-6])
def test_a_small_triangle_is_three_crossings(size, seed):
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-0.5, 0.5, 2)
    angles = rng.uniform(0, 6) + np.array([0.0, 1.1, 2.2]) + rng.uniform(-0.3, 0.3, 3)
    sides = []
    for angle in angles:
        off = size * np.array([np.cos(angle), np.sin(angle)])
        sides.append(line(angle, middle + off))
    atlas = bifurc.explore(product_of(sides), seed=seed)
    assert len(atlas.forms) == 3
    assert halves_of(atlas) == {4: 3}
    assert not atlas.completeness.is_in_doubt


def test_circles_and_lines_through_one_point():
    curves = [
        circle(0.5, (0.5, 0.0)),
        circle(0.8, (0.0, 0.8)),
        line(0.4, (0, 0)),
        line(2.0, (0, 0)),
    ]
    atlas = bifurc.explore(product_of(curves))
    assert len(atlas.forms) == 4
    # the circles meet once more, and each line meets each circle once more
    assert halves_of(atlas) == {8: 1, 4: 5}
    assert sum(form.branch.closed for form in atlas.forms) == 2


def test_factors_of_a_polynomial_are_found():
    def values(u):
        x, y = u
        return [x**3 + x * y**2 - x**2 - y**2 - 0.25 * x + 0.25]  # (x - 1)(r^2 - 1/4)

    atlas = bifurc.explore(bifurc.FunctionProblem(values, BOX))
    assert len(atlas.forms) == 2
    assert not atlas.points


def test_powers_of_factors_are_multiplicities():
    problem = bifurc.FunctionProblem(lambda u: [u[0] * u[1] ** 3], BOX)
    atlas = bifurc.explore(problem)
    assert sorted(form.multiplicity for form in atlas.forms) == [1, 3]
    assert halves_of(atlas) == {4: 1}


def test_factors_that_touch_are_explored_together():
    def values(u):
        x, y = u
        return [(x**2 + y**2 - 1) * (y - 1) * (2 * x - 1)]

    atlas = bifurc.explore(bifurc.FunctionProblem(values, BOX))
    assert len(atlas.forms) == 3
    contacts = [point.point.invariants.contacts for point in atlas.bifurcations]
    assert sorted(contacts) == [(1,), (1,), (1,), (2,)]


def test_curves_that_two_factors_share_are_one():
    def values(u):
        x, y = u
        return [(y - np.sin(x)) * (y**2 - np.sin(x) ** 2) * (x - 1)]

    atlas = bifurc.explore(bifurc.FunctionProblem(values, [(-2.1, 2), (-2, 2)]))
    assert len(atlas.forms) == 3
    assert sorted(form.multiplicity for form in atlas.forms) == [1, 1, 2]


def test_a_line_that_passes_a_cusp_is_explored_with_it():
    problem = bifurc.FunctionProblem(
        lambda u: [(u[1] ** 2 - u[0] ** 3) * (u[0] + 2 * u[1])], BOX
    )
    atlas = bifurc.explore(problem)
    sizes = halves_of(atlas)
    assert sizes[4] >= 1
    assert len(atlas.forms) >= 3


def test_lines_that_nearly_meet_in_one_point_are_in_doubt():
    lines = [line(0.2, (0, 0)), line(1.2, (0, 0)), line(2.2, (3e-13, 0))]
    atlas = bifurc.explore(product_of(lines))
    kinds = [doubt.kind for doubt in atlas.completeness.doubts]
    assert SearchDoubt.CROSSINGS_TOGETHER.name in kinds


def test_what_there_was_no_time_for_is_said():
    rng = np.random.default_rng(0)
    lines = [line(angle, rng.uniform(-1, 1, 2)) for angle in angles_of(40, rng)]
    settings = bifurc.SearchSettings(budget=0.05)
    atlas = bifurc.explore(product_of(lines), settings=settings)
    assert atlas.completeness.level is Level.OUT_OF_TIME


# --- where a function vanishes along curves -------------------------------------------


def crossings_of(function, curve):
    problem = bifurc.FunctionProblem(function, BOX)
    (form,) = bifurc.explore(bifurc.FunctionProblem(curve, BOX)).forms
    return crossings_with(problem.recording.tape, [form.branch], np.ones(2))


@pytest.mark.parametrize("distance", [1e-1, 1e-3, 1e-5])
def test_two_crossings_next_to_each_other_are_two(distance):
    crossings = crossings_of(
        lambda u: [u[1] + u[0] ** 2 - distance**2], lambda u: [u[1]]
    )
    assert not crossings.unclear
    low, high = sorted(crossing.s for crossing in crossings.zeros)
    assert high - low == pytest.approx(2 * distance, rel=1e-6)


def test_a_touch_is_unclear():
    crossings = crossings_of(lambda u: [u[1] + u[0] ** 2], lambda u: [u[1]])
    assert crossings.unclear == {0}


def test_a_curve_along_the_zeros_is_unclear():
    crossings = crossings_of(lambda u: [u[1] * (u[0] + 3)], lambda u: [u[1]])
    assert crossings.unclear == {0}
