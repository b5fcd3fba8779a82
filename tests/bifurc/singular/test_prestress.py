"""Stresses that hold a solution against its flexes, on equations whose answers are known."""

import numpy as np
import pytest
from scipy.optimize import linprog

from bifurc import FunctionProblem, ProblemError, explore, second_order_at
from bifurc.singular.prestress import positive_combination


def at_origin(function, n=2):
    return second_order_at(FunctionProblem(function, [(-2, 2)] * n), np.zeros(n))


def test_a_regular_solution_is_isolated_by_first_order():
    second = at_origin(lambda u: [u[0] + u[1] ** 2, u[1] - u[0] ** 2, u[0] - u[1]])
    assert len(second.flexes) == 0 and len(second.stresses) == 1
    assert second.is_rigid and second.is_prestress_stable and second.holding is None


def test_spheres_that_touch_are_held_in_every_direction():
    second = at_origin(
        lambda u: [u[2] - u[0] ** 2, u[2] + u[0] ** 2 + 2 * u[1] ** 2], 3
    )
    assert len(second.flexes) == 2 and second.is_rigid
    weights = second.holding / second.holding[1]
    assert weights == pytest.approx([-1.0, 1.0])


def test_a_saddle_holds_nothing():
    second = at_origin(lambda u: [u[2] - u[0] ** 2, u[2] - u[1] ** 2], 3)
    assert second.holding is None and second.is_rigid is None


def test_two_saddles_without_a_common_line_are_rigid_and_not_prestress_stable():
    second = at_origin(lambda u: [u[0] ** 2 - u[1] ** 2, u[0] * u[1]])
    assert second.holding is None and second.is_rigid is True


def test_a_flex_that_goes_on_to_higher_order_is_left_open():
    second = at_origin(lambda u: [u[0], u[1] ** 3])
    assert second.holding is None and second.is_rigid is None


def test_mixed_equations_and_other_unknowns_change_nothing():
    rng = np.random.default_rng(4)
    for _ in range(20):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        mix = rng.normal(size=(4, 3))

        def mixed(u, turn=turn, mix=mix):
            x, y, z = turn @ np.array(list(u))
            return list(mix @ np.array([z - x**2 + x * z, z + y**2, x * z + y * z**2]))

        def saddle(u, turn=turn, mix=mix):
            x, y, z = turn @ np.array(list(u))
            return list(mix @ np.array([z - x**2 + x * z, z - y**2, x * z + y * z**2]))

        held, loose = at_origin(mixed, 3), at_origin(saddle, 3)
        assert len(held.flexes) == 2 and len(held.stresses) == 3
        assert held.is_prestress_stable and not loose.is_prestress_stable


@pytest.mark.parametrize("size", [2, 3, 5])
def test_a_positive_sum_is_found_where_there_is_one(size):
    """Against the smallest eigenvalue over all ratios of two forms."""
    rng = np.random.default_rng(size)
    angles = np.linspace(0.0, 2.0 * np.pi, 3601)
    found = set()
    for _ in range(60):
        forms = rng.normal(size=(2, size, size))
        forms += forms.swapaxes(1, 2)
        forms[0] += rng.choice([0.0, 1.0, 4.0]) * np.eye(size)
        sums = np.einsum(
            "tw,wab->tab", np.stack([np.cos(angles), np.sin(angles)], axis=1), forms
        )
        best = np.linalg.eigvalsh(sums)[:, 0].max() / np.abs(forms).max()
        weights, margin = positive_combination(forms)
        if abs(best) < 1e-3:
            continue
        assert (weights is not None) == (best > 0.0)
        found.add(best > 0.0)
        if weights is not None:
            values = np.linalg.eigvalsh(np.einsum("w,wab->ab", weights, forms))
            assert margin == pytest.approx(values[0] / np.abs(forms).max())
            assert margin > 0.0
    assert found == {True, False}


def test_of_equations_of_a_user_it_stays_open_whether_a_double_solution_is_there():
    touching = FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1, (u[0] - 2) ** 2 + u[1] ** 2 - 1],
        [(-3, 3), (-3, 3)],
    )
    (doubt,) = explore(touching).completeness.doubts
    assert doubt.kind == "double solutions"


def test_a_point_of_another_shape_is_refused():
    problem = FunctionProblem(lambda u: [u[0], u[1]], [(-1, 1)] * 2)
    with pytest.raises(ProblemError, match="shape of the point"):
        second_order_at(problem, np.zeros(3))
    with pytest.raises(ProblemError, match="point"):
        second_order_at(problem, np.array([0.0, np.nan]))


def at_corner(function, bounds):
    """At the origin, which is in those of the bounds that are 0."""
    return second_order_at(FunctionProblem(function, bounds), np.zeros(len(bounds)))


def test_bounds_hold_what_leads_out_of_them_to_first_order():
    second = at_corner(lambda u: [u[0] + u[1], u[0] * u[1]], [(0, 2), (0, 2)])
    assert len(second.flexes) == 1 and len(second.within) == 0
    assert second.is_rigid and second.is_prestress_stable and second.holding is None


def test_bounds_leave_the_flexes_that_lead_inside():
    second = at_corner(lambda u: [u[0] + u[1] - u[2]], [(0, 2), (-2, 0), (-2, 2)])
    assert len(second.flexes) == len(second.within) == 2


def test_a_stress_holds_the_flexes_that_bounds_leave():
    """The saddle is none where one of its unknowns stands still."""
    bounds = [(-2, 2), (0, 2), (0, 2)]
    second = at_corner(lambda u: [u[1] + u[2], u[0] ** 2 - u[1] ** 2], bounds)
    assert len(second.flexes) == 2
    assert np.abs(second.within) == pytest.approx(np.array([[1.0, 0.0, 0.0]]))
    assert second.holding is not None


@pytest.mark.parametrize("seed", range(10))
def test_unknowns_move_that_one_flex_within_bounds_moves(seed):
    """Against a linear program for each unknown."""
    rng = np.random.default_rng(seed)
    n, m = 9, 4
    matrix = rng.normal(size=(m, n))
    matrix[:, 5] = -matrix[:, :3] @ rng.uniform(0.5, 1.5, size=3)  # one way inside
    signs = np.where(np.arange(n) < 7, 1.0, 0.0)
    bounds = [(0, 2) if sign else (-2, 2) for sign in signs]
    second = at_corner(lambda u: list(matrix @ np.array(u)), bounds)
    limits = [(0.0, 1.0) if sign else (None, None) for sign in signs]
    farthest = [
        linprog(-np.eye(n)[k], matrix, np.zeros(m), matrix, np.zeros(m), limits).x[k]
        for k in range(7)
    ]
    moves = np.abs(second.within[:, :7]).max(axis=0, initial=0.0) > 1e-9
    assert moves.tolist() == (np.array(farthest) > 1e-9).tolist()
    assert moves.any()
