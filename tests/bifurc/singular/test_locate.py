"""Singular points: location, tangents, kinds, with known answers."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.singular.locate import (
    Kind,
    classify_singular_point,
    locate_singular_point,
    second_order_tangents,
)


def plane(function, repeat=1):
    return FunctionProblem(
        lambda u: np.concatenate([np.atleast_1d(function(*u))] * repeat), [(-2, 2)] * 2
    )


def classified(problem, near, nullity=2):
    found = locate_singular_point(problem, np.asarray(near, dtype=float), nullity, 0.5)
    assert found is not None
    u, null_space, error = found
    return classify_singular_point(problem, u, null_space, error)


def up_to_sign(tangents, expected, within):
    for t in np.asarray(expected, dtype=float):
        t = t / np.linalg.norm(t)
        assert (
            min(min(np.abs(t - v).max(), np.abs(t + v).max()) for v in tangents)
            < within
        )


CROSSINGS = {
    "two lines": (
        lambda x, y: (x - y) * (x + 2 * y - 0.3),
        (0.1, 0.1),
        [(1, 1), (2, -1)],
    ),
    "pitchfork": (lambda x, y: x * (y - x * x), (0.0, 0.0), [(0, 1), (1, 0)]),
    "transcritical": (lambda x, y: x * (y - np.sin(x)), (0.0, 0.0), [(0, 1), (1, 1)]),
    "sharp crossing": (
        lambda x, y: y * (y - 0.05 * x),
        (0.0, 0.0),
        [(1, 0), (1, 0.05)],
    ),
    "lemniscate": (
        lambda x, y: (x * x + y * y) ** 2 - x * x + y * y,
        (0.0, 0.0),
        [(1, 1), (1, -1)],
    ),
}


@pytest.mark.parametrize("name", CROSSINGS)
@pytest.mark.parametrize("repeat", [1, 3])
def test_crossings_are_located_to_rounding_with_their_tangents(name, repeat):
    function, exact, tangents = CROSSINGS[name]
    point = classified(plane(function, repeat), np.add(exact, (0.02, -0.03)))
    off = np.linalg.norm(point.u - exact)
    assert off < 1e-12
    assert off <= point.error
    assert point.error < 1e-11
    assert (point.kind, point.rank, point.order) == (Kind.BIFURCATION, 0, 2)
    assert len(point.tangents) == 2
    up_to_sign(point.tangents, tangents, 1e-9)
    assert len(point.half_branches) == 4


def test_the_error_estimate_bounds_the_error_in_random_crossings_of_known_place():
    rng = np.random.default_rng(5)
    for _ in range(40):
        place, mix = rng.uniform(-0.5, 0.5, 2), rng.normal(size=(2, 2))
        curvature = rng.uniform(-1, 1, 2)

        def function(x, y, place=place, mix=mix, curvature=curvature):
            p, q = mix @ np.array([x - place[0], y - place[1]])
            return (
                (p - curvature[0] * q * q)
                * (q - curvature[1] * p * p)
                * np.exp(0.3 * p)
            )

        found = locate_singular_point(
            plane(function), place + rng.uniform(-0.01, 0.01, 2), 2, 0.5
        )
        assert found is not None
        off = np.linalg.norm(found[0] - place)
        assert off <= found[2]
        assert off < 1e-12


def test_three_branches_at_one_point_give_six_half_branches():
    point = classified(plane(lambda x, y: x * (x - y) * (x + y)), (0.02, 0.01))
    assert len(point.half_branches) == 6
    assert point.kind is Kind.BIFURCATION
    # second order says nothing here, so convergence is linear and the accuracy only
    # what the estimate says
    assert np.linalg.norm(point.u) <= point.error
    up_to_sign(point.half_branches, [(0, 1), (1, 1), (1, -1)], 1e-5)


def test_an_isolated_point_has_no_half_branch():
    point = classified(plane(lambda x, y: x * x + 2 * y * y), (0.02, 0.01))
    assert point.kind is Kind.ISOLATED
    assert len(point.half_branches) == 0
    assert point.order == 2


def test_a_rank_drop_has_a_single_branch_and_is_no_bifurcation():
    # y = 0 and x = 0: the second equation alone is singular; and a factor that vanishes
    # at the origin only
    problem = plane(lambda x, y: np.array([x * y, y * (y + x)]))
    point = classified(problem, (0.02, 0.01))
    assert np.linalg.norm(point.u) < 1e-12
    assert len(point.half_branches) == 2
    assert point.kind is Kind.RANK_DROP
    up_to_sign(point.half_branches, [(1, 0)], 1e-6)


def test_second_order_tangents_satisfy_all_forms_together():
    # two quadratic forms x y and y (x + y) with the single common root y = 0
    problem = plane(lambda x, y: np.array([x * y, y * (y + x)]))
    tangents = second_order_tangents(problem, np.zeros(2), np.eye(2))
    assert tangents is not None
    assert len(tangents) == 1
    up_to_sign(tangents, [(1, 0)], 1e-9)


def test_second_order_leaves_tangential_branches_undecided():
    assert (
        second_order_tangents(
            plane(lambda x, y: y * (y - x * x)), np.zeros(2), np.eye(2)
        )
        is None
    )


def test_no_singular_point_is_located_where_there_is_none():
    for gap in (1e-1, 1e-3, 1e-5):
        assert (
            locate_singular_point(
                plane(lambda x, y, g=gap: x * y - g),
                np.array([np.sqrt(gap)] * 2),
                2,
                0.5,
            )
            is None
        )


def test_no_point_farther_than_the_reach_is_returned():
    problem = plane(lambda x, y: x * y)
    assert locate_singular_point(problem, np.array([0.3, 0.3]), 2, 0.1) is None
    assert locate_singular_point(problem, np.array([0.3, 0.3]), 2, 0.5) is not None


def test_a_crossing_in_space_of_redundant_equations_is_located():
    # the plane z = x y and two crossing lines in it, four equations of rank two
    problem = FunctionProblem(
        lambda u: np.array(
            [u[2] - u[0] * u[1], u[0] * u[1], 1e3 * u[2], u[2] + u[0] * u[1]]
        ),
        [(-2, 2)] * 3,
    )
    found = locate_singular_point(problem, np.array([0.02, -0.01, 0.01]), 2, 0.5)
    assert found is not None
    point = classify_singular_point(problem, *found)
    assert np.linalg.norm(point.u) < 1e-12
    assert point.rank == 1
    up_to_sign(point.tangents, [(1, 0, 0), (0, 1, 0)], 1e-9)
