"""Problems from sympy expressions."""

import copy
import pickle

import mpmath
import numpy as np
import pytest
import sympy

from bifurc.equations.symbolic import SymbolicProblem
from bifurc.errors import ProblemError
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.confirm import Convergence, confirm_singular_point
from bifurc.system import jacobian_at

X, Y, Z = sympy.symbols("x y z")
BOX = [(-2.0, 2.0)] * 2


def test_a_pitchfork_from_expressions_is_that_of_a_callable():
    problem = SymbolicProblem([sympy.Eq(X**3, X * Y)], [X, Y], BOX)
    assert problem.domain.names == ("x", "y")
    assert problem.accuracy.equations == "recorded (4 operations)"
    atlas = explore(problem, settings=SearchSettings(starts=30))
    assert len(atlas.forms) == 2
    assert len(atlas.bifurcations) == 1
    assert np.linalg.norm(atlas.bifurcations[0].point.u) < 1e-12


def test_every_function_has_the_value_and_the_slope_that_sympy_gives():
    parts = [
        sympy.sin(X) / 3,
        sympy.exp(-X * Y) * sympy.pi,
        sympy.sqrt(X + Y) ** 3,
        sympy.atan2(Y, X),
        sympy.cot(X) + sympy.sec(Y) + sympy.csc(X) + sympy.coth(Y),
        sympy.log(X / Y) + sympy.Rational(1, 3) ** X,
        X ** sympy.Rational(2, 5) * Y**-4,
        sympy.asinh(X) + sympy.acosh(1 + Y) + sympy.atanh(X / 3),
    ]
    problem = SymbolicProblem(parts, [X, Y], [(0.2, 1.0)] * 2)
    place = {X: 0.3, Y: 0.7}
    values = [float(part.subs(place)) for part in parts]
    slopes = [[float(part.diff(s).subs(place)) for s in (X, Y)] for part in parts]
    point = np.array([0.3, 0.7])
    assert problem.residuals(point)[0] == pytest.approx(values, rel=1e-14)
    assert jacobian_at(problem, point) == pytest.approx(np.array(slopes), rel=1e-13)


def test_common_parts_are_evaluated_once():
    part = sympy.sin(X * Y)
    problem = SymbolicProblem([part + 1, part**2 - X], [X, Y], BOX)
    assert problem.recording.tape.size == 5


def test_at_high_precision_a_third_is_a_third():
    third = sympy.Rational(1, 3)
    problem = SymbolicProblem([(X - third) * (Y - third)], [X, Y], BOX)
    point = np.full(2, 1 / 3)
    confirmation = confirm_singular_point(
        problem.precise_residual(), point, np.eye(2), magnitude=problem.magnitude
    )
    assert confirmation.convergence is Convergence.QUADRATIC
    with mpmath.workdps(50):
        assert abs(confirmation.u[0] - mpmath.mpf(1) / 3) < mpmath.mpf(10) ** -49


def test_a_symbolic_problem_is_copied_and_pickled():
    wave = X - sympy.sin(2 * sympy.pi * Y / 7)
    problem = SymbolicProblem([wave], [X, Y], BOX, periods=[np.inf, 7.0])
    points = np.array([[0.1, 0.2]])
    for twin in (pickle.loads(pickle.dumps(problem)), copy.deepcopy(problem)):
        assert np.array_equal(twin.residuals(points), problem.residuals(points))
        assert np.array_equal(twin.domain.periods, problem.domain.periods)


def test_the_sides_of_an_equation_are_not_cancelled_where_they_are_not_defined():
    equation = sympy.Eq(sympy.log(X) + Y, sympy.log(X) + X)
    problem = SymbolicProblem([equation], [X, Y], BOX)
    values = problem.residuals(np.array([[-1.0, -1.0], [1.0, 1.0]]))[:, 0]
    np.testing.assert_array_equal(values, [np.nan, 0.0])


@pytest.mark.parametrize(
    ("expressions", "unknowns", "message"),
    [
        ([X + Z], [X, Y], r"expressions\[0\]: x \+ z .* it holds the symbol z"),
        ([X, sympy.Abs(Y)], [X, Y], r"expressions\[1\]: Abs\(y\) .* it holds Abs"),
        ([sympy.gamma(X)], [X, Y], r"expressions\[0\]: gamma\(x\)"),
        ([X * sympy.I], [X, Y], r"expressions\[0\]: I\*x .* the number I"),
        (["x + y"], [X, Y], r"expressions\[0\]: 'x \+ y' .* a sympy expression"),
        ([X > 0], [X, Y], r"expressions\[0\]: x > 0"),
        ([], [X, Y], "one expression or more"),
        ([X], [X, X], r"unknowns\[1\]: x"),
        ([X], ["x", "y"], r"unknowns\[0\]: 'x' .* a sympy Symbol"),
        ([X], [X], "number of bounds: 2 is not allowed; it must be 1"),
    ],
)
def test_what_cannot_be_used_is_named(expressions, unknowns, message):
    with pytest.raises(ProblemError, match=message):
        SymbolicProblem(expressions, unknowns, BOX)


def test_symbols_and_expressions_stand_wherever_names_do():
    bounds = {Z: (0, 0.16), X: (0, 1), Y: (0, 8)}
    rate = Z * (1 - X) * sympy.exp(Y)
    problem = SymbolicProblem([rate - X, 14 * rate - 3 * Y], [X, Y, Z], bounds)
    events = {
        "named": ("x", 0.5),
        "symbol": (X, 0.5),
        "expression": X - sympy.Rational(1, 2),
        "equation": sympy.Eq(2 * X, 1),
        X: (X, 0.25),
    }
    diagram = explore(problem, parameter=Z, events=events).diagram
    assert diagram.parameter == "z" and len(diagram.folds) == 2
    for label in ("named", "symbol", "expression", "equation"):
        (event,) = diagram.events(label)
        assert event.u == pytest.approx([0.5, 7 / 3, np.exp(-7 / 3)], rel=1e-12)
    assert diagram.events("x")[0].u[0] == pytest.approx(0.25)


@pytest.mark.parametrize(
    "request_, words",
    [
        (sympy.Symbol("q"), "events.*'q' is not allowed; it must be a function or one"),
        (X * sympy.Symbol("q"), "it holds the symbol q"),
        (sympy.gamma(X), "it holds gamma"),
    ],
)
def test_an_event_that_is_no_function_of_the_unknowns_is_named(request_, words):
    problem = SymbolicProblem([X - Y], [X, Y], BOX)
    with pytest.raises(ProblemError, match=words):
        explore(problem, events={"mine": request_})
