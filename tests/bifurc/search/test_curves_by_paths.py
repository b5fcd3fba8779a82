"""Curves of polynomials in any number of unknowns are counted, and found whole."""

from dataclasses import replace

import numpy as np
import pytest

import bifurc
from bifurc.completeness import Level
from bifurc.search.answer.completeness import SearchClaim
from bifurc.settings import SearchSettings
from tests.samples import one_in

# five random starts miss what is small, and boxes would find it
FEW = SearchSettings(starts=5, near_motions=False, boxes=0)


def explored(function, bounds, settings=FEW, **more):
    problem = bifurc.FunctionProblem(function, bounds, **more)
    return bifurc.explore(problem, settings=settings)


def claim_of(atlas, kind):
    (claim,) = [one for one in atlas.completeness.claims if kind.is_kind_of(one)]
    return claim


def viviani(u):
    x, y, z = u
    return [x**2 + y**2 + z**2 - 4, (x - 1) ** 2 + y**2 - 1]


def test_one_curve_of_degree_4_is_whole():
    atlas = explored(viviani, [(-3, 3)] * 3)
    claim = claim_of(atlas, SearchClaim.DEGREES)
    assert claim.data["degrees"] == [4]
    assert "1 irreducible curve, of degree 4" in claim.text
    assert atlas.completeness.level is Level.CERTIFIED
    assert len(atlas.forms) == len(atlas.points) == 1


def small_oval(radius, n):
    """A circle of radius 1 and a small one beside it, in n unknowns, the others being
    quadratic in the first two, and all turned."""
    rng = np.random.default_rng(n)
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
    slopes = rng.normal(size=(n - 2, 2))

    def equations(u):
        x, y, *others = turn @ np.asarray(u)
        large = x**2 + y**2 - 1
        small = (x - 1.6) ** 2 + (y - 0.3) ** 2 - radius**2
        rows = [one - a * x - b * y for one, (a, b) in zip(others, slopes, strict=True)]
        return [large * small, *rows]

    return equations


@pytest.mark.parametrize("n", one_in(2, [5, 6]))
@pytest.mark.parametrize("radius", [1e-2, 1e-4])
def test_an_oval_that_starts_miss_is_found(radius, n):
    atlas = explored(small_oval(radius, n), [(-9, 9.1)] * n)
    assert [form.branch.closed for form in atlas.forms] == [True, True]
    lengths = sorted(form.branch.length for form in atlas.forms)
    assert lengths[0] < 100 * radius
    degrees = claim_of(atlas, SearchClaim.DEGREES).data["degrees"]
    # nearly a pair of lines, and no such pair
    assert degrees == [2, 2]
    assert atlas.completeness.level is Level.CERTIFIED or atlas.completeness.doubts


def test_arcs_that_only_pass_a_corner_of_the_bounds_are_found():
    # a parabola that closes nowhere, and a line on the other side of the bounds
    atlas = explored(
        lambda u: [(u[1] - 40 * (u[0] - 0.9) ** 2 - 0.9) * (u[0] + u[1] + 1.8), u[2]],
        [(-1, 1)] * 3,
    )
    assert len(atlas.forms) == 2
    assert atlas.completeness.level is Level.CERTIFIED


def four_bar(angles):
    a, b, c = angles
    x = 2 * np.cos(a) + 3 * np.cos(b) - 2.5 * np.cos(c) - 3
    return [x, 2 * np.sin(a) + 3 * np.sin(b) - 2.5 * np.sin(c)]


@pytest.mark.parametrize("is_circle", [False, True])
def test_angles_are_coordinates_on_circles(is_circle):
    turns = {"periods": [2 * np.pi] * 3} if is_circle else {}
    bounds = [(-np.pi, np.pi)] * 3
    atlas = explored(four_bar, bounds, **turns)
    # the coupler curve's six circular points are not among the configurations
    assert claim_of(atlas, SearchClaim.DEGREES).data["degrees"] == [6]
    assert atlas.completeness.level is Level.CERTIFIED


def test_isolated_solutions_beside_a_curve_are_counted():
    # the line x = 0, and the point (2, 1)
    atlas = explored(lambda u: [u[0] * (u[1] - 1), u[0] * (u[0] - 2)], [(-4, 4)] * 2)
    assert claim_of(atlas, SearchClaim.DEGREES).data["degrees"] == [1]
    beside = claim_of(atlas, SearchClaim.ALL_ISOLATED_BESIDE_CURVES)
    assert (beside.data["real"], beside.data["inside"]) == (1, 1)
    assert len(atlas.forms) == len(atlas.rigid) == 1
    assert atlas.completeness.level is Level.CERTIFIED


def test_more_equations_than_curves_need_leave_isolated_solutions_open():
    def twisted(u):
        x, y, z = u
        return [y - x**2, z - x * y, x * z - y**2, (z - x * y) * (x - 5)]

    atlas = explored(twisted, [(-2, 2)] * 3)
    assert claim_of(atlas, SearchClaim.DEGREES).data["degrees"] == [3]
    assert claim_of(atlas, SearchClaim.ISOLATED_NOT_COUNTED)
    assert atlas.completeness.level is Level.ESTIMATED


def test_what_is_proved_by_boxes_has_a_degree_where_it_is_asked_for():
    def ellipse(u):
        return [u[0] ** 2 + 2 * u[1] ** 2 - 1]

    settings = SearchSettings(starts=5, near_motions=False)
    atlas = explored(ellipse, [(-2, 2)] * 2, settings)
    assert atlas.completeness.level is Level.COUNTED
    assert not [
        c for c in atlas.completeness.claims if SearchClaim.DEGREES.is_kind_of(c)
    ]
    more = explored(ellipse, [(-2, 2)] * 2, replace(settings, paths=201))
    assert claim_of(more, SearchClaim.DEGREES).data["degrees"] == [2]
    assert more.completeness.level is Level.COUNTED


def test_parts_outside_of_bounds_that_were_assumed_are_said():
    # an oval about the origin and another one far away
    def ovals(u):
        x, y, z = u
        return [(x**2 + y**2 - 1) * ((x - 1e6) ** 2 + y**2 - 1), z - x]

    atlas = explored(ovals, [(-np.inf, np.inf)] * 3)
    assert atlas.completeness.level is Level.ESTIMATED


def test_of_too_many_paths_the_degree_of_the_curve_of_a_form_is_stated():
    settings = SearchSettings(starts=50, near_motions=False, boxes=0, paths=5)

    def quadrics(u):
        x, y, z, w = u
        return [
            x**2 + y**2 + z**2 + w**2 - 4,
            x * y + z * w - 0.5,
            x**2 - 2 * y**2 + z,
        ]

    atlas = explored(quadrics, [(-3, 3)] * 4, settings)
    assert atlas.completeness.level is Level.ESTIMATED
    more = explored(quadrics, [(-3, 3)] * 4)
    assert claim_of(more, SearchClaim.DEGREES).data["degrees"] == [8]


def test_a_multiple_curve_is_no_reason_for_doubt_where_its_factor_is_known():
    atlas = explored(lambda u: [(u[0] ** 2 + u[1] ** 2 - 1) ** 2, u[2]], [(-2, 2)] * 3)
    assert atlas.completeness.level is Level.CERTIFIED
    assert claim_of(atlas, SearchClaim.DEGREES).data["degrees"] == [2]


def test_surfaces_are_not_counted_as_curves():
    atlas = explored(lambda u: [u[0] * u[1], u[0] * (u[2] - 1)], [(-2, 2)] * 3)
    assert atlas.completeness.level is not Level.CERTIFIED
