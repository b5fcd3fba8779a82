"""Curve pieces from nothing but F and F'."""

import numpy as np
import pytest

from bifurc.branch import points_on_piece
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.collocation import bridge_by_collocation, march_by_collocation
from bifurc.system import MarchSettings, MarchStatus


@pytest.fixture
def ellipse():
    return FunctionProblem(
        lambda u: np.array([u[0] ** 2 / 4 + u[1] ** 2 - 1.0]), [(-3, 3)] * 2
    )


def test_pieces_are_solutions_by_arclength_and_follow_each_other(ellipse):
    settings = MarchSettings(16, tolerance=1e-13, shortest=1e-9, longest=2.0, count=8)
    march = march_by_collocation(
        ellipse, np.array([2.0, 0.0]), np.array([0.0, 1.0]), settings
    )
    pieces, steps, radii = march.pieces, march.steps, march.radii
    assert march.status is MarchStatus.RAN
    assert len(pieces) == 8
    assert (
        march.residuals.max() < 3e-12
    )  # 30 times the tolerance is what a piece may have
    x = np.linspace(-1, 1, 101)
    powers = np.vander(x, 17, increasing=True)
    for i, piece in enumerate(pieces):
        points = powers @ piece
        assert np.abs(points[:, 0] ** 2 / 4 + points[:, 1] ** 2 - 1).max() < 1e-11
        slope = powers[:, :-1] @ (piece[1:] * np.arange(1, 17)[:, None]) / radii[i]
        assert np.linalg.norm(slope, axis=1) == pytest.approx(1.0, abs=1e-9)
        if i:
            assert powers[0] @ piece == pytest.approx(
                powers[-1] @ pieces[i - 1], abs=1e-12
            )
            assert steps[i] == pytest.approx(radii[i] + radii[i - 1], abs=1e-12)


def test_a_start_off_the_curve_is_corrected_and_one_without_a_curve_is_open(ellipse):
    settings = MarchSettings(12, tolerance=1e-12, shortest=1e-9, longest=1.0, count=1)
    march = march_by_collocation(
        ellipse, np.array([2.01, 0.0]), np.array([0.0, 1.0]), settings
    )
    start = (-1.0) ** np.arange(13) @ march.pieces[0]
    assert start == pytest.approx([2.0, 0.0], abs=1e-11)
    nothing = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 + 1.0]), [(-3, 3)] * 2
    )
    march = march_by_collocation(nothing, np.ones(2), np.array([0.6, -0.8]), settings)
    assert march.status is MarchStatus.OPEN
    assert not len(march.pieces)
    assert march.residuals[-1] * nothing.magnitude >= 1.0


def test_a_bridge_passes_a_crossing_on_its_own_branch():
    # from (-0.2, 0) along the x-axis over the crossing with x^2 = y at the origin
    problem = FunctionProblem(
        lambda u: np.array([u[1] * (u[1] - u[0] ** 2 - u[0])]), [(-1, 1)] * 2
    )
    bridge = bridge_by_collocation(
        problem, np.array([-0.2, 0.0]), np.array([1.0, 0.0]), 16, 1e-12, 0.4
    )
    assert bridge is not None
    assert bridge.length == pytest.approx(0.4, abs=1e-10)
    assert bridge.residual < 3e-11
    points = points_on_piece(bridge.coefficients, np.linspace(-1, 1, 101))
    assert points == pytest.approx(
        np.stack([np.linspace(-0.2, 0.2, 101), np.zeros(101)], axis=1), abs=1e-9
    )
