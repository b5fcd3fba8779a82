"""Zeros along a curve are those that the function has, however close they are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import bifurc
from bifurc.branch import Branch
from bifurc.diagrams.zeros import ZeroKind, Zeros, zeros_along


@pytest.fixture(scope="module")
def circle() -> Branch:
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2
    )
    (form,) = bifurc.explore(problem).forms
    return form.branch


def zeros_of(circle: Branch, function: Callable[[np.ndarray], np.ndarray]) -> Zeros:
    """The zeros of a function of x on the unit circle."""

    def along(s: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            return function(circle(s)[:, 0])

    return zeros_along(circle, along)


def counts_of(zeros: Zeros) -> tuple[int, int]:
    kinds = [zero.kind for zero in zeros.zeros]
    return kinds.count(ZeroKind.CROSSING), kinds.count(ZeroKind.TOUCH)


@pytest.mark.parametrize(
    "function, crossings, touches",
    [
        (lambda x: x**2 - 1e-4, 4, 0),
        (lambda x: x - 0.9999995, 2, 0),
        (lambda x: (x - 0.3) * (x - 0.301), 4, 0),
        (lambda x: np.sin(30 * x), 38, 0),
        (lambda x: np.sin(100 * x), 126, 0),
        (lambda x: x**3, 2, 0),
        (lambda x: np.cbrt(x), 2, 0),
        (lambda x: 1e12 * x, 2, 0),
        (lambda x: (x + 1e6) - 1e6, 2, 0),
        (lambda x: np.log(x) - np.log(0.5), 2, 0),
        (lambda x: x - 1, 0, 1),
        (lambda x: (x - 0.5) ** 2, 0, 2),
        (lambda x: np.abs(x), 0, 2),
        (lambda x: x**8, 0, 2),
        (lambda x: x**2 + 1e-9, 0, 0),
        (lambda x: np.full(len(x), np.nan), 0, 0),
    ],
)
def test_every_zero_is_found_with_what_it_is(
    circle, function, crossings, touches
) -> None:
    zeros = zeros_of(circle, function)
    assert counts_of(zeros) == (crossings, touches)
    assert zeros.is_resolved and not zeros.jumps and not zeros.held


@pytest.mark.parametrize("function", [lambda x: np.floor(x) + 0.5, lambda x: 1 / x])
def test_a_jump_is_no_zero(circle, function) -> None:
    zeros = zeros_of(circle, function)
    assert not zeros.zeros and len(zeros.jumps) == 2
    assert (
        np.abs(circle(np.array([jump.s for jump in zeros.jumps]))[:, 0]).max() < 1e-12
    )


def test_a_stretch_of_zeros_is_no_zero(circle) -> None:
    zeros = zeros_of(circle, lambda x: np.floor(3 * x))
    assert not zeros.zeros
    ends = np.sort(circle(np.array(zeros.held).ravel())[:, 0])
    assert ends == pytest.approx([0, 0, 1 / 3, 1 / 3], abs=1e-12)


def test_a_function_without_a_course_is_said_to_be_open(circle) -> None:
    rng = np.random.default_rng(0)
    zeros = zeros_of(circle, lambda x: rng.uniform(-1, 1, len(x)))
    assert not zeros.is_resolved


def test_the_error_of_a_zero_grows_with_its_order(circle) -> None:
    widths = []
    for power in (1, 3, 5):
        zeros = zeros_of(circle, lambda x, power=power: x**power).zeros
        assert len(zeros) == 2
        for zero in zeros:
            assert zero.low <= zero.s <= zero.high
            widths.append(zero.high - zero.low)
    assert widths[0] < 1e-11 < 1e-5 < widths[2] < 1e-3 < widths[4] < 0.1


def test_a_half_turn_of_phase_is_no_zero() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[0]) - u[1]],
        [(-np.pi, np.pi), (-2, 2)],
        periods=[2 * np.pi, np.inf],
    )
    branch = bifurc.explore(problem).forms[0].branch
    zeros = zeros_along(branch, lambda s: np.sin(0.5 * branch(s)[:, 0] - 0.5)).zeros
    (phi,) = (branch(zero.s)[0] for zero in zeros)
    assert np.cos(phi) == pytest.approx(np.cos(1), abs=1e-14)
