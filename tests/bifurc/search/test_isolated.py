"""Isolated solutions of as many polynomials as unknowns are counted."""

import numpy as np
import pytest

import bifurc
from bifurc.completeness import Level
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.settings import SearchSettings

FEW = SearchSettings(starts=5, near_motions=False)
NO_BOXES = SearchSettings(starts=5, near_motions=False, boxes=0)


def explored(function, bounds, settings=FEW, **more):
    return bifurc.explore(
        bifurc.FunctionProblem(function, bounds, **more), settings=settings
    )


def claims_of(atlas, kind):
    return [one for one in atlas.completeness.claims if kind.is_kind_of(one)]


def economics(x):
    """Five equations with 8 complex solutions."""
    return [
        (x[0] + x[0] * x[1] + x[1] * x[2] + x[2] * x[3]) * x[4] - 1,
        (x[1] + x[0] * x[2] + x[1] * x[3]) * x[4] - 2,
        (x[2] + x[0] * x[3]) * x[4] - 3,
        x[3] * x[4] - 4,
        x[0] + x[1] + x[2] + x[3] + 1,
    ]


def test_five_equations_are_counted():
    atlas = explored(economics, [(-30, 30)] * 5)
    (claim,) = claims_of(atlas, SearchClaim.ALL_ISOLATED)
    assert claim.data["complex"] == 8
    assert claim.data["real"] == claim.data["inside"] == len(atlas.rigid)
    for point in atlas.rigid:
        assert np.abs(economics(point)).max() < 1e-9
    assert atlas.completeness.level is Level.CERTIFIED


def test_solutions_outside_the_bounds_are_counted_and_not_listed():
    atlas = explored(lambda x: [x[0] ** 2 - 4, x[1] - x[0]], [(-1, 3)] * 2)
    (claim,) = claims_of(atlas, SearchClaim.ALL_ISOLATED)
    assert (claim.data["real"], claim.data["inside"], len(atlas.rigid)) == (2, 1, 1)


def two_links(angles):
    a, b = angles
    x = 2 * np.cos(a) + 1.5 * np.cos(b) - 1.2
    return [x, 2 * np.sin(a) + 1.5 * np.sin(b) - 0.7]


@pytest.mark.parametrize("turns", [1, 2])
def test_angles_are_found_at_all_whole_turns_within_bounds(turns):
    bounds = [(-np.pi, (2 * turns - 1) * np.pi)] * 2
    atlas = explored(two_links, bounds)
    (claim,) = claims_of(atlas, SearchClaim.ALL_ISOLATED)
    assert claim.data["complex"] == 2
    assert len(atlas.rigid) == 2 * turns**2


NOT_COUNTED = {
    "no polynomial": lambda x: [x[0] ** 2 + np.exp(x[1]) - 1.5, x[0] - 0.5],
    "an angle and its sine": lambda x: [x[0] - np.sin(x[0]) - 0.1, x[1] - x[0]],
}


@pytest.mark.parametrize("name", NOT_COUNTED)
def test_what_is_not_known_to_be_all_is_not_certified(name):
    atlas = explored(NOT_COUNTED[name], [(-4, 4)] * 2, NO_BOXES)
    assert not claims_of(atlas, SearchClaim.ALL_ISOLATED)
    assert atlas.completeness.level is Level.ESTIMATED


FAR_AWAY = {
    "one solution": lambda x: [
        980 * x[0] + 3200 * x[1] * x[2] ** 2 + 5.7e-5 * x[1] * x[2],
        9.5e-4 * x[0] * x[1] - 5.6e6,
        -7e-4 * x[1] * x[2] + 8.9e7 * x[2] + 1.3e7,
    ],
    "four solutions": lambda x: [
        7e-3 - 1.1e-4 * x[0] ** 2 * x[1] ** 2,
        (4e7 * x[0] ** 2 + 8.6e4 * x[0]) * x[1] ** 3
        - 3.6e6 * x[1]
        - 5.6e-7 * x[0] ** 3,
        x[2],
    ],
}


@pytest.mark.parametrize("name", FAR_AWAY)
def test_solutions_too_far_away_to_be_told_from_infinity_are_not_denied(name):
    atlas = explored(FAR_AWAY[name], [(-40, 40)] * 3, NO_BOXES)
    assert not claims_of(atlas, SearchClaim.ALL_ISOLATED)
    (claim,) = claims_of(atlas, SearchClaim.PATHS_FAR_AWAY)
    assert claim.data["far"] > 0
    assert atlas.completeness.level is Level.ESTIMATED


DOUBLE = {
    "a tangent": lambda x: [x[0] ** 2 + x[1] ** 2 - 1, x[0] - 1],
    "a steep one": lambda x: [x[1] - 3 * x[0] ** 2 + 2, 30 * (x[1] + 2)],
}


@pytest.mark.parametrize("name", DOUBLE)
def test_a_double_solution_is_one_point_in_doubt(name):
    atlas = explored(DOUBLE[name], [(-3, 3.1)] * 2)
    (point,) = atlas.points
    assert np.abs(DOUBLE[name](point.point.u)).max() < 1e-9
    assert len(atlas.rigid) == len(atlas.forms) == 0
    assert atlas.completeness.is_in_doubt


NEARLY_DOUBLE = {
    "none": lambda x: [x[0] ** 2 + 3 * x[0] + 2.25 + 1e-12, x[1] - 2.6 * x[0]],
    "none with others": lambda x: [
        ((x[0] + 0.25) ** 2 + 1e-18) * (x[0] - 2.4),
        x[1] ** 2 - x[0] - 0.6,
    ],
}


@pytest.mark.parametrize("name", NEARLY_DOUBLE)
def test_places_where_equations_are_nearly_zero_are_in_doubt(name):
    atlas = explored(NEARLY_DOUBLE[name], [(-5, 5.1)] * 2, NO_BOXES)
    assert atlas.completeness.is_in_doubt
    assert atlas.completeness.level is Level.ESTIMATED


@pytest.mark.parametrize("paths", [0, 4])
def test_no_more_paths_are_followed_than_are_asked_for(paths):
    settings = SearchSettings(starts=5, near_motions=False, paths=paths)
    atlas = explored(economics, [(-30, 30)] * 5, settings)
    assert atlas.completeness.level is Level.ESTIMATED


def test_solutions_beyond_bounds_that_nobody_gave_are_a_doubt():
    problem = bifurc.FunctionProblem(
        lambda u: [(u[0] - 1) * (u[0] - 1e9), u[1] - u[0]], [(-np.inf, np.inf)] * 2
    )
    completeness = bifurc.explore(problem).completeness
    (doubt,) = completeness.doubts
    assert doubt.kind == SearchDoubt.BEYOND_ASSUMED_BOUNDS.name
    assert doubt.data["count"] == 1
