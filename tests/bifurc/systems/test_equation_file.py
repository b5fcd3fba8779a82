"""Files of equations: what is in them, and what is wrong with them."""

from __future__ import annotations

import math
import re

import mpmath
import numpy as np
import pytest

import bifurc
from bifurc.diagrams.diagram import Stability
from bifurc.systems.equation_file import (
    EquationFileError,
    holds_equations,
    read_equations,
)
from bifurc.systems.summary import make_summary

REACTION = """
name = "reaction"
parameter = "p"

[unknowns]
x = [0, 1]
y = { bounds = [0, "2*4"], unit = "K" }
p = [0, 0.16]

[parameters]
B = 14
beta = "B/7"

[definitions]
rate = "p*(1 - x)*exp(y)"

[equations]
heat = "y' = B*rate - (1 + beta)*y"
mass = "x' = rate - x"

[events]
half = "x = 0.5"
"""


@pytest.fixture
def path(tmp_path):
    """A file with the reaction."""
    file = tmp_path / "reaction.toml"
    file.write_text(REACTION, encoding="utf-8")
    return file


def refused(path, text: str) -> str:
    """What is said of a file with a text."""
    path.write_text(text, encoding="utf-8")
    with pytest.raises(bifurc.EquationFileError) as error:
        read_equations(path)
    assert error.value.path == str(path)
    return error.value.message


def test_a_file_says_what_is_solved(path) -> None:
    system = read_equations(path)
    assert system.name == "reaction"
    assert system.parameter == "p"
    assert system.is_flow
    assert system.values == {"B": 14.0, "beta": 2.0}
    problem = system.problem
    assert problem.domain.names == ("x", "y", "p")
    assert problem.domain.units == ("", "K", "")
    np.testing.assert_array_equal(problem.domain.bounds, [[0, 1], [0, 8], [0, 0.16]])
    point = np.array([0.25, 1.0, 0.1])
    rate = 0.1 * 0.75 * math.e
    # the rates stand in the order of the unknowns, whatever their order in the file
    expected = [rate - 0.25, 14 * rate - 3]
    np.testing.assert_allclose(problem.residuals(point[None])[0], expected, rtol=1e-14)
    assert system.events["half"](point) == -0.25


def test_the_atlas_of_a_file_says_what_was_solved(path) -> None:
    atlas = read_equations(path).explore(seed=3)
    assert atlas.subject["name"] == "reaction"
    assert atlas.subject["equations"]["mass"] == "x' = rate - x"
    assert len(atlas.diagram.folds) == 2
    assert len(atlas.diagram.hopf_points) == 1
    assert atlas.diagram.events("half")[0].u[0] == pytest.approx(0.5, abs=1e-15)
    assert bifurc.to_dataset(atlas).attrs["system_name"] == "reaction"


def test_decimals_are_exact(tmp_path) -> None:
    path = tmp_path / "third.toml"
    path.write_text(
        'equations = ["x = k*y"]\n[unknowns]\nx = [0, 1]\ny = [0, 1]\n'
        "[parameters]\nk = 0.1\n"
    )
    system = read_equations(path)
    with mpmath.workdps(50):
        tenth = mpmath.mpf(1) / 10
        assert system.problem.precise_residual()([tenth, mpmath.mpf(1)]) == [0]
    assert system.name == "third"
    assert system.parameter is None and not system.is_flow


OF_POSITIVE_X = [
    "sqrt(x)^2 = p",
    "sqrt(x)*sqrt(x) = p",
    "exp(log(x)) = p",
    "exp(2*log(x)) = p",
    "x^1.5/x^0.5 = p",
    "log(x) - log(x) + p = x",
    "-log(x) + p + log(x) = x",
    "log(x) + p = log(x) + x",
    "0*log(x) + p = x",
    "sqrt(x)*0 + p = x",
    "log(x)^0*x = p",
    "sqrt(x)/sqrt(x)*x = p",
]


def in_x_and_p(path, equation: str):
    """The system of one equation in x and p."""
    text = f'equations = ["{equation}"]\n[unknowns]\nx = [-2, 2]\np = [-2, 3]\n'
    path.write_text(text, encoding="utf-8")
    return read_equations(path)


@pytest.mark.parametrize("equation", OF_POSITIVE_X)
def test_an_equation_is_defined_where_its_text_is(tmp_path, equation) -> None:
    problem = in_x_and_p(tmp_path / "one.toml", equation).problem
    points = np.array([[-1.0, -1.0], [1.0, 1.0]])
    residuals = problem.residuals(points)[:, 0]
    np.testing.assert_array_equal(np.isnan(residuals), [True, False])
    assert residuals[1] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    "equation",
    ["sqrt(x)^2 = p", "0*log(x) + p = x", "sin(asin(x)) = p"],
)
def test_forms_end_where_the_equation_does(tmp_path, equation) -> None:
    atlas = in_x_and_p(tmp_path / "one.toml", equation).explore(seed=1)
    (form,) = atlas.forms
    # x from 0 to 2, or from -1 to 1
    assert form.branch.length == pytest.approx(2.0 * math.sqrt(2.0), abs=0.02)
    assert atlas.completeness.level is not bifurc.Level.COUNTED


@pytest.mark.parametrize(
    "equation", ["log(x) = log(x)", "x*p + 1 = 1 + p*x", "1 = 0*x"]
)
def test_an_equation_that_cancels_holds_no_unknown(tmp_path, equation) -> None:
    with pytest.raises(bifurc.EquationFileError, match="holds no unknown"):
        in_x_and_p(tmp_path / "one.toml", equation)


def test_values_of_parameters_may_be_replaced(path) -> None:
    system = read_equations(path, {"B": 12.0})
    assert system.values["B"] == 12.0
    with pytest.raises(bifurc.EquationFileError, match=r"parameters\.b: .*in the file"):
        read_equations(path, {"b": 1.0})


def test_equations_that_are_no_rates_have_no_stability(path) -> None:
    text = REACTION.replace("x' = rate - x", "x = rate")
    text = text.replace("y' = B*rate - (1 + beta)*y", "B*rate = 3*y")
    path.write_text(text, encoding="utf-8")
    diagram = read_equations(path).explore().diagram
    assert len(diagram.folds) == 2
    assert {one.stability for one in diagram.stretches} == {Stability.UNKNOWN}


def test_an_unknown_may_be_a_circle(tmp_path) -> None:
    path = tmp_path / "torus.toml"
    path.write_text(
        'equations = ["a = 2*b"]\n[unknowns]\na = { period = "2*pi" }\n'
        'b = { period = "2*pi", bounds = ["-pi", "pi"] }\n'
    )
    (form,) = read_equations(path).explore().forms
    assert form.branch.closed
    assert form.branch.winding.tolist() == [2, 1]


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("exp(y)", "exq(y)", r"definitions\.rate: .*'exq' at column 11; .*'exp'"),
        ("(1 + beta)", "(1 + bta)", r"equations\.heat: .*'bta' at .*nearest is 'beta'"),
        ("rate - x", "rate - x = 1", r"equations\.mass: .* more than one sign ="),
        ("x' = rate - x", "rate = x", r"equations\.mass: it says no rate"),
        ("x' = rate", "z' = rate", r"equations\.mass: 'z' is no unknown"),
        ("x' = rate", "p' = rate", r"equations\.mass: the parameter p has no rate"),
        ("x' = rate", "y' = rate", r"y has a rate already"),
        ('mass = "x\' = rate - x"', "", "there is no rate of x"),
        ('parameter = "p"', "", "a rate, and no unknown is the parameter"),
        ('parameter = "p"', 'parameter = "B"', "parameter: .*it has a value"),
        ('parameter = "p"', 'parameter = "q"', "parameter: 'q' is no unknown"),
        ('parameter = "p"', "parameter = 1", "parameter: 1 is no text"),
        (
            "[unknowns]",
            "[unknown]",
            "key: 'unknown' is none of .*nearest is 'unknowns'",
        ),
        ("x = [0, 1]", "x = [1, 0]", r"unknowns\.x\.bounds: 1 is not below 0"),
        ("x = [0, 1]", "x = [0]", r"unknowns\.x\.bounds: \[0\] is no \[low, high\]"),
        ("x = [0, 1]", "x = 0.5", r"unknowns\.x: '0\.5' is no \[low, high\]"),
        ("x = [0, 1]", "x = [0, true]", r"unknowns\.x\.bounds: True is no number"),
        ("x = [0, 1]", "x = [0, nan]", r"unknowns\.x\.bounds: 'nan'"),
        ("x = [0, 1]", 'x = [0, "p"]', r"unknowns\.x\.bounds: 'p': there is no symbol"),
        ("x = [0, 1]", "x = { priod = 1 }", "'priod' is none of .*nearest is 'period'"),
        (
            "x = [0, 1]",
            "x = { period = -1 }",
            r"unknowns\.x\.period: -1 is not positive",
        ),
        ("x = [0, 1]", "x = { unit = 1 }", r"unknowns\.x\.unit: 1 is no text"),
        ("x = [0, 1]", "sin = [0, 1]", r"unknowns\.sin: .* has a meaning already"),
        ("x = [0, 1]", '"a b" = [0, 1]', r"unknowns\.a b: .*is no name"),
        ("B = 14", "B = 14\nx = 14", r"unknowns\.x: there is another 'x' above"),
        ("B = 14", "B = inf", r"parameters\.B: 'inf'"),
        ("B = 14", 'B = "beta"', r"parameters\.B: .*no symbol 'beta'"),
        ("x = 0.5", "1 = 2", r"events\.half: '1 = 2' holds no unknown"),
        ("x = 0.5", "x > 0.5", r"events\.half: .*'>' at column 3 cannot be read"),
        ("x = [0, 1]", "x = [0, 1", "is not valid TOML"),
    ],
)
def test_what_is_wrong_is_named(path, old, new, message) -> None:
    assert old in REACTION
    said = refused(path, REACTION.replace(old, new, 1))
    assert re.search(message, said), said


def test_files_that_are_none_are_refused(tmp_path) -> None:
    with pytest.raises(bifurc.EquationFileError, match="there is no such file"):
        read_equations(tmp_path / "nothing.toml")
    with pytest.raises(bifurc.EquationFileError, match="is a folder"):
        read_equations(tmp_path)
    path = tmp_path / "bytes.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(bifurc.EquationFileError, match="is not UTF-8"):
        read_equations(path)
    for text in ("", "equations = []", "[unknowns]\nx=[0,1]", "unknowns = 3"):
        assert refused(path, text)
    assert "unknowns: it is missing" in refused(path, 'equations = ["x"]')
    assert "[[[" not in refused(path, "a = " + "[" * 100000)


def test_code_in_a_file_is_not_run(tmp_path) -> None:
    path, witness = tmp_path / "hostile.toml", tmp_path / "witness"
    code = f"__import__('pathlib').Path('{witness}').touch()"
    for key in ("equations", "events", "definitions", "parameters"):
        text = REACTION.replace(f"[{key}]", f'[{key}]\nbad = "{code}"')
        message = refused(path, text)
        assert f"{key}.bad" in message
    assert not witness.exists()


@pytest.mark.parametrize(
    "equation, message",
    [
        ("y = 2x", r"missing at column 6"),
        ("y == 2x", r"missing at column 7"),
        ("y = x(x - 1)", r"column 5"),
        ("y = foo(x)", r"'foo' at column 5"),
        ("x' = y + $1", r"column 10"),
        ("2x = y", r"missing at column 2"),
    ],
)
def test_columns_count_from_the_begin_of_an_equation(tmp_path, equation, message):
    path = tmp_path / "one.toml"
    path.write_text(
        f'parameter = "y"\nequations = ["{equation}"]\n'
        "[unknowns]\nx = [-1, 1]\ny = [-1, 1]\n",
        encoding="utf-8",
    )
    with pytest.raises(bifurc.EquationFileError, match=message) as caught:
        read_equations(path)
    assert repr(equation) in str(caught.value)


@pytest.mark.parametrize("value", [float("inf"), float("nan")])
def test_a_parameter_that_is_not_finite_is_refused(path, value) -> None:
    with pytest.raises(
        bifurc.EquationFileError, match=r"parameters\.B: .* not a finite"
    ):
        read_equations(path, {"B": value})


def test_a_period_that_is_none_of_the_equations_is_refused(tmp_path) -> None:
    path = tmp_path / "parabola.toml"
    path.write_text(
        'equations = ["y = a^2"]\n[unknowns]\na = { period = "2*pi" }\ny = [-9, 9]\n'
    )
    with pytest.raises(bifurc.EquationFileError, match=r"period of a: 6\.28"):
        read_equations(path)


def test_columns_of_unknowns_are_told_apart_from_the_programs_own(tmp_path) -> None:
    path = tmp_path / "names.toml"
    path.write_text(
        'parameter = "error"\nequations = ["kind^3 = error*kind"]\n'
        "[unknowns]\nkind = [-2, 2]\nerror = [-2, 2]\n"
        '[events]\none = "error = 1"\n'
    )
    text = make_summary(read_equations(path).explore())
    heads = [
        line.split("  ") for line in text.splitlines() if line.startswith("  name")
    ]
    columns = [[head.strip() for head in row if head.strip()] for row in heads]
    assert ["name", "kind", "kind (unknown)", "error (unknown)", "error"] in [
        row[:5] for row in columns
    ]
    assert ["name", "event", "kind", "error", "form"] in columns
    assert all(len(set(row)) == len(row) for row in columns)


def test_constants_can_be_free(tmp_path):
    path = tmp_path / "circle.toml"
    text = "[unknowns]\nx = [-2, 2]\ny = [-2, 2]\n"
    text += '[parameters]\nr = 1\n[equations]\na = "x^2 + y^2 = r^2"\n'
    path.write_text(text)
    problem = read_equations(path, free={"r": (0.5, 3.0)}).problem
    assert problem.domain.names == ("x", "y", "r")
    assert problem.domain.bounds[2].tolist() == [0.5, 3.0]
    assert problem.residuals(np.array([[3.0, 4.0, 5.0]])).tolist() == [[0.0]]
    assert holds_equations(path)
    path.write_text("lengths = [1, 2]")
    assert not holds_equations(path)
    with pytest.raises(EquationFileError):
        read_equations(path, free={"q": (0.0, 1.0)})
