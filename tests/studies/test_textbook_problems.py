"""Problems of textbooks: the data are sound, a quick sample comes out right."""

from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bifurc.completeness import Doubt
from bifurc.equations.expression_problem import ExpressionProblem
from studies.textbook.comparison import Verdict, compare
from studies.textbook.discretised import DISCRETISED
from studies.textbook.fortran import fortran_of
from studies.textbook.problems import PointKind, PrintedPoint, load_problems
from studies.textbook_problems import run_problem
from studies.textbook_times import fastest_within
from studies.work_precision_runs import Run
from tests.samples import one_in

PROBLEMS = {problem.name: problem for problem in load_problems()}
FILES = Path(__file__).parents[2] / "data" / "problems"
SAMPLE = [
    "Freudenstein and Roth from (15, -2, 0)",
    "Powell from (3, 6, 0)",
    "Broyden",
    "Wacker, c = 1",
    "aircraft, elevator -0.008",
    "two bars, angle 0",
    "materially nonlinear",
    "Keller",
    "trigger circuit",
    "absorption of nitric acid",
    "A to B to C reaction",
    "two cells with an enzyme",
    "predator and prey",
    "oxidation of carbon monoxide",
]


@cache
def comparison_of(name):
    return run_problem(PROBLEMS[name], seed=0, budget=60.0)


def test_every_file_and_every_discretised_problem_is_used():
    used = {problem.file for problem in PROBLEMS.values() if problem.file}
    assert used == {path.name for path in FILES.glob("*.toml")}
    assert {p.discretised for p in PROBLEMS.values() if not p.file} == set(DISCRETISED)
    assert len(PROBLEMS) == len(load_problems())


@pytest.mark.parametrize("name", [p.name for p in PROBLEMS.values() if p.file])
def test_the_points_of_a_problem_are_of_its_unknowns(name):
    problem = PROBLEMS[name]
    names = set(problem.problem.domain.names)
    assert problem.source and problem.points
    for point in problem.points:
        assert set(point.at) <= names and set(point.misprints) <= names
        assert point.along in (names if point.along else {""})


@pytest.mark.parametrize("name", one_in(3, SAMPLE))
def test_the_points_that_the_source_prints_are_found_to_all_digits(name):
    comparison = comparison_of(name)
    assert comparison.verdict is Verdict.RIGHT, comparison.matches


def is_far_misprinted(point):
    pairs = point.misprints.items()
    return any(abs(point.at[name] - right) > Decimal("1e-5") for name, right in pairs)


def residual_at(problem, point, matched):
    values = {**comparison_point(problem, matched), **as_floats(point.values)}
    return np.linalg.norm(problem.problem.residuals(as_array(problem, values)))


def comparison_point(problem, point):
    matches = comparison_of(problem.name).matches
    (match,) = [match for match in matches if match.printed is point]
    return match.found


def as_floats(values):
    return {name: float(value) for name, value in values.items()}


def as_array(problem, values):
    return np.array([[values[name] for name in problem.problem.domain.names]])


@pytest.mark.parametrize(
    "name",
    [
        "Broyden",
        "aircraft, elevator -0.05",
        "aircraft, elevator 0.05",
        "aircraft, elevator 0.1",
        "two bars, angle 0",
        "two bars, angle 0.25",
    ],
)
def test_a_misprint_put_right_solves_the_equations_far_better(name):
    problem = PROBLEMS[name]
    points = [point for point in problem.points if is_far_misprinted(point)]
    assert points
    for point in points:
        before = residual_at(problem, replace(point, misprints={}), point)
        assert residual_at(problem, point, point) < 0.2 * before


def test_equal_cells_bifurcate_where_the_linear_theory_says():
    # A = I + the Laplacian of a chain of 5: its eigenvalues are 3 - 2 cos(k pi/5)
    problem = PROBLEMS["cell kinetics"]
    atlas = problem.explore(0, 60.0)
    points = np.array([point.point.u for point in atlas.bifurcations])
    are_equal = np.ptp(points[:, :5], axis=1) < 1e-9
    found = np.sort(points[are_equal, 0])
    expected = []
    for k in range(1, 5):
        eigenvalue = 3 - 2 * np.cos(k * np.pi / 5)
        square = np.polymul([1, 1, 1], [1, 1, 1])
        roots = np.roots(np.polyadd(eigenvalue * square, [-100, 0, 100]))
        expected += [root.real for root in roots if abs(root.imag) < 1e-9]
    expected = np.sort([root for root in expected if root > -1])
    assert found == pytest.approx(expected, abs=1e-10) and len(found) == 8


def test_a_printed_point_that_is_not_there_is_wrong_without_a_doubt():
    problem = PROBLEMS["cusp"]
    at = {"mu": Decimal("0.3860"), "x": Decimal("-0.5773")}
    other = PrintedPoint(PointKind.LIMIT, "mu", at, {}, "")
    atlas = problem.explore(0, 60.0)
    changed = replace(problem, points=(other,), accuracy=0.0)
    assert compare(changed, atlas, 0.0).verdict is Verdict.WRONG
    doubt = Doubt("something", "something may be otherwise")
    doubtful = replace(atlas.completeness, doubts=(doubt,))
    atlas = replace(atlas, completeness=doubtful)
    assert compare(changed, atlas, 0.0).verdict is Verdict.IN_DOUBT


def test_digits_are_counted_in_units_of_the_last_one_printed():
    at = {"x": Decimal("1.250"), "y": Decimal("-3")}
    point = PrintedPoint(PointKind.START, "", at, {"y": Decimal("3")}, "")
    assert point.units_off({"x": 1.2514, "y": 3.0}, 0.0) == pytest.approx(1.4)
    assert point.units_off({"x": 1.2514, "y": 3.0}, 0.01) < 0.1


def test_a_problem_as_fortran_has_every_derivative():
    problem = PROBLEMS["Boggs from (1, 0, 0)"].problem
    assert isinstance(problem, ExpressionProblem)
    text = fortran_of(problem)
    assert "pi" not in text
    for row in (1, 2):
        assert f"f({row}) =" in text
        assert all(f"jacobian({row}, {column}) =" in text for column in (1, 2, 3))


def test_the_time_at_an_error_is_the_least_that_reaches_it():
    runs = [
        Run("case", "method", 16, 1e-6, seconds, error, 10)
        for seconds, error in ((1.0, 1e-4), (3.0, 1e-9), (2.0, 1e-7))
    ]
    assert [fastest_within(runs, error) for error in (1e-6, 1e-8)] == [runs[2], runs[1]]
    assert fastest_within(runs, 1e-12) is None
