"""Curves that run in a bound: concentrations and populations are not negative, and the
branch along which one of them is zero lies in its bound."""

import math

import numpy as np
import pytest

from bifurc import FunctionProblem, explore
from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.seeds import Seeds
from bifurc.singular.point import Kind
from bifurc.systems.verdict import verdict_of

SEEDS = range(4)


def constructed_seeds(points) -> Seeds:
    points = np.array(points)
    return Seeds(points, np.zeros(len(points), bool), np.empty(0), points[:0])


def lengths(atlas):
    return sorted(form.branch.length for form in atlas.forms)


@pytest.mark.parametrize("seed", SEEDS)
def test_extinction_is_a_form_beside_an_allee_effect(seed: int) -> None:
    def growth(u):
        x, harvest = u
        return [x * (x - 0.2) * (1 - x) - harvest * x]

    problem = FunctionProblem(growth, [(0, 1.5), (0, 1)])
    atlas = explore(problem, seed=seed)
    assert len(atlas.forms) == 2
    extinct = max(atlas.forms, key=lambda form: form.branch.length).branch
    assert extinct.length == pytest.approx(1.0, abs=1e-12)
    assert np.abs(extinct(np.linspace(0.0, 1.0, 9))[:, 0]).max() < 1e-12


@pytest.mark.parametrize("seed", SEEDS)
def test_all_three_forms_of_a_predator_and_its_prey(seed: int) -> None:
    def growth(u):
        x, y, capacity = u
        eaten = x / (1 + x)
        return [x * (1 - x / capacity) - y * eaten, y * (eaten - 0.5)]

    problem = FunctionProblem(growth, [(0, 5), (0, 5), (0.1, 5)])
    atlas = explore(problem, seed=seed)
    assert len(atlas.forms) == 3
    assert len(atlas.bifurcations) == 1
    assert lengths(atlas)[1:] == pytest.approx([4.9, 4.9 * math.sqrt(2)], abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_competitors_of_which_either_may_be_missing(seed: int) -> None:
    def growth(u):
        x, y, rate = u
        return [x * (1 - x - 0.5 * y), y * (rate - y - 0.7 * x)]

    atlas = explore(FunctionProblem(growth, [(0, 3)] * 3), seed=seed)
    assert len(atlas.forms) == 4
    assert len(atlas.bifurcations) == 3


@pytest.mark.parametrize("seed", SEEDS)
def test_four_species_of_which_any_may_be_missing(seed: int) -> None:
    coupling = np.array(
        [[1, 0.3, 0.2, 0.1], [0.4, 1, 0.1, 0.2], [0.3, 0.2, 1, 0.3], [0.2, 0.3, 0.1, 1]]
    )

    def growth(u):
        rates = [1.0, u[4], 1.2, 0.9]
        return [
            u[i] * (rates[i] - sum(coupling[i, j] * u[j] for j in range(4)))
            for i in range(4)
        ]

    atlas = explore(FunctionProblem(growth, [(0, 3)] * 5), seed=seed)
    assert len(atlas.forms) == 16  # one for each set of species
    assert len(atlas.bifurcations) == 13


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("power", "kind"),
    [(1, Kind.TRANSCRITICAL), (2, Kind.SUPERCRITICAL)],
)
def test_a_branch_that_ends_in_the_other_one(seed: int, power: int, kind) -> None:
    problem = FunctionProblem(
        lambda u: [u[0] * (u[1] - u[0] ** power)], [(0, 2), (-1, 2)], names=["x", "p"]
    )
    atlas = explore(problem, seed=seed, parameter="p")
    trivial = max(form.branch.length for form in atlas.forms)
    assert trivial == pytest.approx(3.0, abs=1e-12)
    assert [one.kind for one in atlas.diagram.branchings] == [kind]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_parameter_that_turns_at_a_bound_turns(seed: int) -> None:
    parabola = FunctionProblem(
        lambda u: [u[1] - u[0] ** 2], [(0, 2), (-1, 2)], names=["x", "p"]
    )
    atlas = explore(parabola, seed=seed, parameter="p")
    assert [one.u.tolist() for one in atlas.diagram.folds] == [
        pytest.approx([0.0, 0.0], abs=1e-12)
    ]


def test_a_closed_curve_that_touches_its_bounds_is_closed() -> None:
    circle = FunctionProblem(lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-1, 1)] * 2)
    [form] = explore(circle).forms
    assert form.branch.closed


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("beside", [0.0, 1e-14, -1e-14])
def test_a_curve_in_a_bound_leaves_where_it_crosses_another(
    is_recorded: bool, beside: float
) -> None:
    line = FunctionProblem(
        lambda u: [u[0] - beside], [(0, 1), (-1, 2)], is_recorded=is_recorded
    )
    branch = trace_branch(line, np.array([0.0, 0.3]))
    assert branch.length == pytest.approx(3.0, abs=1e-12)


@pytest.mark.parametrize("slope", [1.0, 0.01])
def test_a_curve_from_a_bound_outwards_ends_there(slope: float) -> None:
    line = FunctionProblem(lambda u: [u[0] - slope * u[1]], [(0, 1), (-1, 2)])
    branch = trace_branch(line, np.zeros(2), np.array([-slope, -1.0]))
    ends = branch(np.array([0.0, branch.length]))
    assert np.abs(ends).min(axis=1)[0] < 1e-14 or np.abs(ends).min(axis=1)[1] < 1e-14
    assert ends[:, 0].min() > -1e-14


@pytest.mark.parametrize("height", [1e-2, 1e-6, 1e-8])
def test_a_curve_that_bulges_out_of_its_bounds_is_two_forms(height: float) -> None:
    def arch(u):
        return [u[1] - 1 - height + u[0] ** 2]

    for seed in SEEDS:
        atlas = explore(FunctionProblem(arch, [(-1, 1)] * 2), seed=seed)
        assert len(atlas.forms) == 2
        assert atlas.completeness.level.value == "counted"
        inner = min(np.abs(form.branch.sample(2)[:, 0]).min() for form in atlas.forms)
        side = math.sqrt(height)
        assert inner == pytest.approx(side, abs=1e-12 / side)


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("width", [1e-3, 1e-4, 1e-6, 1e-8])
def test_an_arc_in_a_corner_of_its_bounds_is_a_form_however_short(
    width: float, is_recorded: bool
) -> None:
    bounds = [(0, 0.6 + width), (0, 0.8 + width)]
    circle = FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], bounds, is_recorded=is_recorded
    )
    atlas = explore(circle, seeds=constructed_seeds([[0.6, 0.8]]))
    [form] = atlas.forms
    length = math.asin(0.8 + width) - math.acos(0.6 + width)
    assert form.branch.length == pytest.approx(length, abs=1e-14)
    assert form.branch.outcome is Outcome.LEFT_REGION
    assert form.rank == 1
    assert len(atlas.points) + len(atlas.rigid) == 0


def test_two_short_arcs_next_to_each_other_are_two_forms() -> None:
    def lines(u):
        along = u[0] + u[1] - 1.4
        return [along * (along - 5e-6)]

    problem = FunctionProblem(lines, [(0, 0.6 + 1e-5), (0, 0.8 + 1e-5)])
    expected = [1.5e-5 * math.sqrt(2), 2e-5 * math.sqrt(2)]
    assert lengths(explore(problem)) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("beyond", [0.0, 1e-12])
def test_a_curve_that_touches_its_bounds_from_outside_is_no_form(beyond: float) -> None:
    parabola = FunctionProblem(lambda u: [u[1] - u[0] ** 2], [(-2, 2), (-1, beyond)])
    assert not explore(parabola, seeds=constructed_seeds([[0.0, 0.0]])).forms


@pytest.mark.parametrize("beyond", [1e-10, 1e-7])
def test_an_isolated_solution_next_to_its_bounds_is_no_form(beyond: float) -> None:
    problem = FunctionProblem(
        lambda u: [u[0] ** 2, u[1] - u[0]], [(-beyond, 2), (-beyond, 2)]
    )
    atlas = explore(problem, seeds=constructed_seeds([[0.0, 0.0]]))
    assert not atlas.forms
    assert len(atlas.rigid) + len(atlas.points) == 1


def test_a_crossing_of_which_bounds_leave_almost_nothing_is_no_missing_solution() -> (
    None
):
    def lines(u):
        x, y = u[0] - 0.6, u[1] - 0.8
        return [(x + y) * (x + 2 * y)]

    problem = FunctionProblem(lines, [(0, 0.6 + 1e-8), (0, 0.8 + 1e-8)])
    atlas = explore(problem, seeds=constructed_seeds([[0.6, 0.8]]))
    assert len(atlas.points) == 1
    assert "no solution" not in verdict_of(atlas)


# name: equations, bounds, what is touched
TOUCHED = {
    "the corners of a square": (
        lambda u: [u[0] ** 2 + u[1] ** 2 - 2],
        [(-1, 1)] * 2,
        [(-1, -1), (-1, 1), (1, -1), (1, 1)],
    ),
    "two corners, in other units": (
        lambda u: [1e6 * (u[0] - 5e-3) * u[1] - 1e-2],
        [(5e-3 - 1e-4, 5e-3 + 1e-4), (-1e-4, 1e-4)],
        [(5e-3 - 1e-4, -1e-4), (5e-3 + 1e-4, 1e-4)],
    ),
    "a bound": (lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(1, 2), (-1, 1)], [(1, 0)]),
    "a corner of a cube": (
        lambda u: [u[0] + u[1] + u[2] - 3, u[0] - u[1]],
        [(-1, 1)] * 3,
        [(1, 1, 1)],
    ),
    "a corner of two rims": (
        lambda u: [np.sqrt(u[0]) + np.sqrt(u[1] - 0.5)],
        [(-2, 2)] * 2,
        [(0, 0.5)],
    ),
    "a rim and a line": (
        lambda u: [np.sqrt(1 - u[0] ** 2 - u[1] ** 2) + np.sqrt(u[0] + u[1] - 1)],
        [(-2, 2)] * 2,
        [(0, 1), (1, 0)],
    ),
}


@pytest.mark.parametrize("name", TOUCHED)
def test_where_curves_only_touch_the_region_there_are_single_solutions(name) -> None:
    function, bounds, expected = TOUCHED[name]
    atlas = explore(FunctionProblem(function, bounds))
    assert not atlas.forms
    found = sorted(tuple(point.point.u) for point in atlas.points)
    size = np.diff(bounds).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * size)
    assert atlas.completeness.doubts


@pytest.mark.parametrize(("power", "seed"), [(3, 0), (3, 1), (5, 0), (5, 5), (7, 1)])
def test_a_curve_that_touches_the_bound_where_it_ends_is_listed_once(power, seed):
    """Beyond the bound rounding lets it go on for 6e-4 to 0.04."""
    flat = FunctionProblem(lambda u: [u[1] - u[0] ** power], [(-2, 2), (0, 2)])
    assert len(explore(flat, seed=seed).forms) == 1


def test_a_curve_that_is_beyond_a_bound_but_for_its_end_is_none():
    """It touches the bound from outside, and is within its slack for 5e-4."""
    outside = FunctionProblem(lambda u: [u[1] + u[0] ** 3], [(0, 2), (0, 2)])
    atlas = explore(outside, seed=1)
    assert not atlas.forms and atlas.points
    assert atlas.completeness.doubts
