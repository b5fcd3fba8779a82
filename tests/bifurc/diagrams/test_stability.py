"""Stability is told by each eigenvalue against what rounding makes of it."""

from __future__ import annotations

import numpy as np
import pytest

import bifurc
from bifurc.diagrams.diagram import Stability, Stretch


def atlas_of(function, bounds, names) -> bifurc.Atlas:
    problem = bifurc.FunctionProblem(function, bounds, names=list(names))
    return bifurc.explore(problem, parameter="p")


def middle_of(atlas: bifurc.Atlas, stretch: Stretch) -> np.ndarray:
    branch = atlas.forms[stretch.form].branch
    return branch(0.5 * (stretch.start + stretch.end))


@pytest.mark.parametrize("e", [1e-2, 1e-3, 1e-4])
def test_a_hopf_point_beside_a_fold_is_found(e) -> None:
    diagram = atlas_of(
        lambda u: [u[1], -u[2] + u[0] ** 2 + (u[0] + e) * u[1]], [(-2, 2)] * 3, "xyp"
    ).diagram
    (hopf,) = diagram.hopf_points
    assert hopf.u == pytest.approx([-e, 0.0, e**2], abs=1e-13)
    assert hopf.value == pytest.approx(np.sqrt(2 * e), rel=1e-10)
    assert sorted(one.unstable for one in diagram.stretches) == [0, 1, 2]


@pytest.mark.parametrize("rate", [1.0, 1e8, 1e12])
def test_a_fast_direction_hides_no_hopf_point(rate) -> None:
    diagram = atlas_of(
        lambda u: [u[3] * u[0] - u[1], u[0] + u[3] * u[1], -rate * u[2]],
        [(-1, 1)] * 4,
        "xyzp",
    ).diagram
    (hopf,) = diagram.hopf_points
    assert abs(hopf.u[3]) < 1e-14 and hopf.value == pytest.approx(1.0)
    assert sorted(one.unstable for one in diagram.stretches) == [0, 2]


def test_two_hopf_points_close_together_are_two() -> None:
    diagram = atlas_of(
        lambda u: [
            (u[2] ** 2 - 1e-8) * u[0] - u[1],
            u[0] + (u[2] ** 2 - 1e-8) * u[1],
        ],
        [(-1, 1)] * 3,
        "xyp",
    ).diagram
    assert sorted(one.u[2] for one in diagram.hopf_points) == pytest.approx(
        [-1e-4, 1e-4]
    )


@pytest.mark.parametrize("beside", [0.0, 1e-6])
def test_a_pair_that_crosses_at_a_fold_is_a_hopf_point(beside) -> None:
    place = 1 / np.sqrt(3)

    def s_curve(u):
        x, y, z, p = u
        rate = x - place - beside
        return [p + x - x**3, rate * y - z, y + rate * z]

    diagram = atlas_of(s_curve, [(-2, 2)] * 4, "xyzp").diagram
    assert len(diagram.folds) == 2
    (hopf,) = diagram.hopf_points
    assert hopf.u[0] == pytest.approx(place + beside, abs=1e-9)
    assert hopf.label == "where p turns back"
    counts = [0, 1, 2] if beside == 0.0 else [0, 0, 1, 2]
    assert sorted(one.unstable for one in diagram.stretches) == counts


def test_pairs_that_cross_at_both_folds_of_a_closed_form_are_hopf_points() -> None:
    diagram = atlas_of(
        lambda u: [1 - u[0] ** 2 - u[3] ** 2, u[0] * u[1] - u[2], u[1] + u[0] * u[2]],
        [(-2, 2)] * 4,
        "xyzp",
    ).diagram
    assert sorted(hopf.u[3] for hopf in diagram.hopf_points) == pytest.approx([-1, 1])


def test_a_pair_that_stays_on_the_axis_hides_no_hopf_points() -> None:
    def two_oscillators(u):
        x, y, z, w, p = u
        rate = p**2 - 1e-6
        return [rate * x - y, x + rate * y, -3 * w, 3 * z]

    diagram = atlas_of(two_oscillators, [(-1, 1)] * 4 + [(-1, 1.1)], "xyzwp").diagram
    places = sorted(hopf.u[4] for hopf in diagram.hopf_points)
    assert places == pytest.approx([-1e-3, 1e-3])
    assert [one.unstable for one in diagram.stretches] == [2, 0, 2]
    assert diagram.stretches[1].stability is Stability.NEUTRAL


@pytest.mark.parametrize(("power", "error"), [(1, 1e-9), (3, 1e-3)])
def test_a_hopf_point_is_as_exact_as_it_says(power, error) -> None:
    def oscillator(u):
        x, y, p = u
        rate = (p - 0.123) ** power
        return [rate * x - y, x + rate * y]

    (hopf,) = atlas_of(oscillator, [(-2, 2)] * 3, "xyp").diagram.hopf_points
    assert abs(hopf.u[2] - 0.123) < hopf.error < error


def test_opposite_real_eigenvalues_are_no_hopf_point() -> None:
    atlas = atlas_of(
        lambda u: [(1 + u[2]) * u[0], (-1 + u[2]) * u[1]], [(-0.9, 0.8)] * 3, "xyp"
    )
    assert not atlas.diagram.hopf_points
    assert [one.unstable for one in atlas.diagram.stretches] == [1]


@pytest.mark.parametrize(
    "function",
    [lambda u: [u[0] * u[1]], lambda u: [(u[1] - 0.5) * (u[0] - u[1] ** 2)]],
)
def test_a_form_along_which_the_parameter_rests_is_neutral(function) -> None:
    atlas = atlas_of(function, [(-2, 2)] * 2, "xp")
    words = {Stability.NEUTRAL: 0, Stability.STABLE: 0, Stability.UNSTABLE: 0}
    for stretch in atlas.diagram.stretches:
        words[stretch.stability] += 1
    assert words == {
        Stability.NEUTRAL: 2,
        Stability.STABLE: 1,
        Stability.UNSTABLE: 1,
    }


def test_a_double_curve_is_neutral() -> None:
    diagram = atlas_of(lambda u: [(u[1] - u[0] ** 2) ** 2], [(-2, 2)] * 2, "xp").diagram
    assert {one.stability for one in diagram.stretches} == {Stability.NEUTRAL}
    assert len(diagram.stretches) == 2


def test_a_saddle_and_a_center_are_told_apart() -> None:
    atlas = atlas_of(lambda u: [u[1], -u[3] * u[0], -u[2]], [(-2, 2)] * 4, "xyzp")
    for stretch in atlas.diagram.stretches:
        p = middle_of(atlas, stretch)[3]
        is_saddle = p < -1e-9
        expected = Stability.UNSTABLE if is_saddle else Stability.NEUTRAL
        assert stretch.stability is expected


def test_a_jordan_block_is_stable() -> None:
    diagram = atlas_of(
        lambda u: [-u[0] + u[1], -u[1] + u[2]], [(-1, 1)] * 3, "xyp"
    ).diagram
    assert [one.stability for one in diagram.stretches] == [Stability.STABLE]


def test_rounding_beside_a_cusp_makes_no_stretches() -> None:
    diagram = atlas_of(
        lambda u: [(u[1] - u[0] ** 2) ** 2 - u[0] ** 5], [(-2, 2)] * 2, "xp"
    ).diagram
    long = [one for one in diagram.stretches if one.end - one.start > 0.1]
    assert sorted(one.unstable for one in long) == [0, 0, 1]
    assert len(diagram.stretches) <= 4
