"""Nothing depends on the unit of the unknowns."""

from __future__ import annotations

import math

import numpy as np
import pytest

import bifurc


def lemniscate(size: float) -> bifurc.FunctionProblem:
    """Bernoulli's, of half width ``size``."""
    return bifurc.FunctionProblem(
        lambda u: [(u[0] ** 2 + u[1] ** 2) ** 2 - size**2 * (u[0] ** 2 - u[1] ** 2)],
        [(-2 * size, 2 * size)] * 2,
        names=["x", "y"],
    )


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3, 30.0, 1e6, 1e9])
def test_a_lemniscate_of_any_size_is_the_same(size) -> None:
    atlas = bifurc.explore(lemniscate(size), parameter="x")
    reference = bifurc.explore(lemniscate(1.0), parameter="x")
    assert len(atlas.forms) == len(reference.forms) == 1
    (form,), (expected,) = atlas.forms, reference.forms
    assert form.branch.closed
    assert form.branch.length == pytest.approx(size * expected.branch.length, rel=1e-9)
    s = expected.branch.arclengths(20)
    gaps = form.branch(size * s) - size * expected.branch(s)
    assert np.abs(gaps).max() < 1e-8 * size
    (point,) = atlas.bifurcations
    assert np.abs(point.point.u).max() < 1e-9 * size
    assert len(atlas.dead_points) == len(reference.dead_points)
    assert len(atlas.diagram.folds) == 2
    largest = form.profile.values.max()
    assert largest == pytest.approx(expected.profile.values.max(), rel=1e-2)


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("radius", [1e-2, 1.0, 1e6])
def test_a_circle_without_bounds_is_found_whatever_its_size(radius, is_recorded):
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - radius**2],
        [(-math.inf, math.inf)] * 2,
        is_recorded=is_recorded,
    )
    (form,) = bifurc.explore(problem, settings=bifurc.SearchSettings(starts=40)).forms
    assert form.branch.closed
    assert form.branch.length == pytest.approx(2 * math.pi * radius, rel=1e-11)


def test_a_curve_without_bounds_is_one_form_and_says_that_it_goes_on() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - u[0] ** 2], [(-math.inf, math.inf)] * 2
    )
    (form,) = bifurc.explore(problem).forms
    assert form.branch.outcome is bifurc.Outcome.LEFT_REGION
    ends = form.branch(np.array([0.0, form.branch.length]))
    assert np.abs(ends[:, 1]).min() > 10


def test_bounds_on_one_side_are_kept() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - u[0] ** 2], [(500.0, math.inf), (-math.inf, math.inf)]
    )
    assert problem.bounds[0, 0] == 500.0
    assert problem.bounds[0, 1] > 1000.0


@pytest.mark.parametrize("unit", [1e-4, 1e5])
def test_seeds_that_are_given_are_counted_in_the_unit_of_the_problem(unit) -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - unit**2], [(-3 * unit, 3 * unit)] * 2
    )
    nothing = np.empty((0, 2))
    seeds = bifurc.Seeds(
        np.array([[unit, 0.0]]), np.array([True]), np.empty(0), nothing
    )
    (form,) = bifurc.explore(problem, seeds=seeds).forms
    assert form.branch.length == pytest.approx(2 * math.pi * unit, rel=1e-11)
