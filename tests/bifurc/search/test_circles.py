"""Unknowns with a period: circles where their bounds leave nothing out."""

from __future__ import annotations

import math

import numpy as np
import pytest

import bifurc
from tests.samples import one_in

TURN = 2 * math.pi
BOUNDS_OF_A_CIRCLE = [
    (-math.pi, math.pi),
    (0.0, TURN),
    (1.0, 1.0 + TURN),
    (-math.inf, math.inf),
    (-20.0, 20.0),
    (-3.1415927, 3.1415927),
]


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("bounds", one_in(2, BOUNDS_OF_A_CIRCLE))
def test_a_curve_round_a_torus_is_closed_and_found_once(bounds, is_recorded) -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(2 * u[0] - 3 * u[1])],
        [bounds, bounds],
        periods=[TURN, TURN],
        is_recorded=is_recorded,
    )
    forms = bifurc.explore(problem).forms
    # 2 a - 3 b = 0 and = pi
    assert len(forms) == 2
    for form in forms:
        assert form.branch.closed
        assert form.branch.winding.tolist() == [3, 2]
        assert form.branch.length == pytest.approx(TURN * math.sqrt(13), rel=1e-12)


def test_a_period_other_than_a_full_turn() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - np.cos(TURN * u[0])], [(0, 1), (-2, 2)], periods=[1, math.inf]
    )
    (form,) = bifurc.explore(problem).forms
    assert form.branch.closed
    assert form.branch.winding.tolist() == [1, 0]


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_a_narrower_interval_is_a_limit_wherever_it_is_written(turns) -> None:
    low, high = 0.5 + turns * TURN, 5.5 + turns * TURN
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - np.cos(u[0])],
        [(low, high), (-2, 2)],
        periods=[TURN, math.inf],
    )
    (form,) = bifurc.explore(problem).forms
    assert not form.branch.closed
    assert form.branch.outcome is bifurc.Outcome.LEFT_REGION
    ends = form.branch(np.array([0.0, form.branch.length]))[:, 0]
    assert sorted(ends) == pytest.approx([low, high], abs=1e-9)


def test_a_closed_curve_beside_the_seam_is_found_once() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [4 * np.sin((u[0] - 3) / 2) ** 2 + u[1] ** 2 - 0.25],
        [(-math.pi, math.pi), (-2, 2)],
        periods=[TURN, math.inf],
    )
    (form,) = bifurc.explore(problem).forms
    assert form.branch.closed
    assert form.branch.winding.tolist() == [0, 0]


def test_crossings_on_a_torus_are_found_once() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[0]) * np.sin(u[1])],
        [(0, TURN), (0, TURN)],
        periods=[TURN, TURN],
    )
    atlas = bifurc.explore(problem)
    assert len(atlas.forms) == 4
    assert len(atlas.bifurcations) == 4
    assert all(form.branch.closed for form in atlas.forms)
