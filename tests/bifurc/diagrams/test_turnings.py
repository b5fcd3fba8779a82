"""Folds are where the parameter turns back, and nowhere else."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

import bifurc
from bifurc.diagrams.diagram import Stability
from bifurc.singular.point import Kind
from tests.samples import one_in

Function = Callable[[np.ndarray], Sequence[float]]


def diagram_of(function: Function, seed: int = 0) -> bifurc.Diagram:
    """The diagram of an equation in x and the parameter p."""
    problem = bifurc.FunctionProblem(function, [(-2, 2)] * 2, names=["x", "p"])
    diagram = bifurc.explore(problem, parameter="p", seed=seed).diagram
    assert diagram is not None
    return diagram


@pytest.mark.parametrize("e, seed", [(2e-3, 0), (2e-3, 3), (2e-3, 5), (1e-5, 0)])
def test_two_folds_close_together_are_two(e, seed) -> None:
    diagram = diagram_of(lambda u: [u[1] - u[0] ** 3 + 3 * e**2 * u[0]], seed)
    folds = sorted(fold.u[0] for fold in diagram.folds)
    assert folds == pytest.approx([-e, e], rel=1e-9)
    stability = [one.stability for one in diagram.stretches]
    assert stability == [Stability.STABLE, Stability.UNSTABLE, Stability.STABLE]


def test_folds_beside_a_pitchfork_are_both_found() -> None:
    diagram = diagram_of(lambda u: [u[0] * (u[1] + 1e-4 * u[0] ** 2 - u[0] ** 4)])
    x = np.sqrt(0.5e-4)
    assert sorted(fold.u[0] for fold in diagram.folds) == pytest.approx([-x, x])
    assert [one.kind for one in diagram.branchings] == [Kind.SUBCRITICAL]


@pytest.mark.parametrize("power", [4, 6, 8])
def test_a_flat_pitchfork_has_no_fold_of_its_own(power) -> None:
    diagram = diagram_of(lambda u: [u[0] * (u[1] - u[0] ** power)])
    assert [one.kind for one in diagram.branchings] == [Kind.SUPERCRITICAL]
    assert not diagram.folds
    assert sorted(one.unstable for one in diagram.stretches) == [0, 0, 0, 1]


def test_a_flat_subcritical_pitchfork_is_one() -> None:
    diagram = diagram_of(lambda u: [u[0] * (u[1] + u[0] ** 4 - u[0] ** 6)])
    assert [one.kind for one in diagram.branchings] == [Kind.SUBCRITICAL]
    assert [fold.u[1] for fold in diagram.folds] == pytest.approx([-4 / 27] * 2)


def test_a_parameter_that_slows_down_and_goes_on_crosses() -> None:
    diagram = diagram_of(lambda u: [u[0] * (u[1] - u[0] ** 3)])
    assert [one.kind for one in diagram.branchings] == [Kind.TRANSCRITICAL]
    assert not diagram.folds


def test_a_form_on_which_the_parameter_rests_makes_a_branch_point() -> None:
    diagram = diagram_of(lambda u: [(u[1] - 0.5) * (u[0] - u[1] ** 2)])
    assert [one.kind for one in diagram.branchings] == [Kind.OTHER]


def test_a_pitchfork_is_one_whatever_the_unknowns_are_counted_in() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [1e9 * u[0] * (u[2] - u[1] / 1e6), 1e-6 * u[1] - (1e9 * u[0]) ** 2],
        [(-2e-9, 2e-9), (-1e6, 3e6), (-1, 2)],
        names=["x", "z", "p"],
    )
    diagram = bifurc.explore(problem, parameter="p").diagram
    assert diagram is not None
    (branching,) = diagram.branchings
    assert branching.kind in (
        Kind.PITCHFORK,
        Kind.SUPERCRITICAL,
        Kind.SUBCRITICAL,
    )


@pytest.mark.parametrize("power, least", [(4, 1e-6), (8, 1e-4)])
def test_a_flat_fold_says_how_well_it_is_known(power, least) -> None:
    (fold,) = diagram_of(lambda u: [u[1] - u[0] ** power]).folds
    assert abs(fold.u[0]) < fold.error
    assert least < fold.error < 0.05


@pytest.mark.parametrize("seed", one_in(2, [0, 2]))
@pytest.mark.parametrize(
    "cusp",
    [lambda u: [u[1] ** 2 - u[0] ** 3], lambda u: [u[0] ** 2 - u[1] ** 3]],
)
def test_a_cusp_is_no_fold(cusp, seed) -> None:
    diagram = diagram_of(cusp, seed)
    assert not diagram.folds
    assert len(diagram.stretches) == 2


def test_a_fold_beside_a_cusp_stays() -> None:
    diagram = diagram_of(lambda u: [(u[1] - u[0] ** 2) ** 2 - u[0] ** 5])
    (fold,) = diagram.folds
    assert fold.u == pytest.approx([0.64, 0.08192], abs=1e-12)


def test_a_sharp_fold_has_its_exact_bend() -> None:
    (fold,) = diagram_of(lambda u: [u[1] - 1e6 * u[0] ** 2]).folds
    assert fold.value == pytest.approx(2e6, rel=1e-12)
    assert np.abs(fold.u).max() < 1e-20
