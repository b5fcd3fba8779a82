"""Periods of unknowns, and those that are none of the equations."""

import math

import numpy as np
import pytest

from bifurc import FunctionProblem, SymbolicProblem, explore
from bifurc.errors import ProblemError

TURN = 2 * math.pi
BOUNDS = [(-math.pi, math.pi), (-2, 2)]
NAMES = ["phi", "y"]

NOT_PERIODIC = {
    "a parabola": lambda u: [u[0] ** 2 - u[1]],
    "half the angle": lambda u: [np.sin(u[0] / 2) - u[1]],
    "one equation of two": lambda u: [np.sin(u[0]) - u[1], u[0] ** 3 - u[1]],
}
PERIODIC = {
    "a wave": lambda u: [np.sin(u[0]) - u[1]],
    "a fast wave": lambda u: [np.sin(40 * u[0]) - u[1]],
    "a large wave": lambda u: [1e9 * (np.sin(u[0]) - u[1])],
    "the other sign": lambda u: [np.sin(u[0] / 2) * (2 + u[1])],
    "an equation between angles": lambda u: [u[0] - 2 * u[1]],
    "undefined here and there": lambda u: [np.sqrt(np.sin(u[0])) - u[1]],
}


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("name", NOT_PERIODIC)
def test_a_period_that_is_none_is_refused(name: str, is_recorded: bool) -> None:
    with pytest.raises(ProblemError, match=r"period of phi: 6\.28.*equation \d is"):
        FunctionProblem(
            NOT_PERIODIC[name],
            BOUNDS,
            names=NAMES,
            periods=[TURN, math.inf],
            is_recorded=is_recorded,
        )


@pytest.mark.parametrize("period", [TURN, 6.283185])
@pytest.mark.parametrize("name", PERIODIC)
def test_a_period_up_to_rounding_is_taken(name: str, period: float) -> None:
    problem = FunctionProblem(
        PERIODIC[name], BOUNDS, names=NAMES, periods=[period, math.inf]
    )
    assert problem.domain.periods[0] == period


def test_an_expression_is_asked_too() -> None:
    import sympy

    phi, y = sympy.symbols("phi y")
    with pytest.raises(ProblemError, match="period of phi"):
        SymbolicProblem([phi**2 - y], [phi, y], BOUNDS, periods=[TURN, math.inf])


def test_a_wave_closes_on_its_circle() -> None:
    wave = FunctionProblem(
        PERIODIC["a wave"], BOUNDS, names=NAMES, periods=[TURN, math.inf]
    )
    [form] = explore(wave).forms
    assert form.branch.closed
