"""Events on circles, close to each other, and where functions jump or touch."""

from __future__ import annotations

import numpy as np
import pytest

import bifurc
from bifurc.systems.equation_file import read_equations

TURN = 2 * np.pi


@pytest.fixture(scope="module")
def wave() -> bifurc.Problem:
    return bifurc.FunctionProblem(
        lambda u: [np.sin(u[0]) - u[1]],
        [(-np.pi, np.pi), (-2, 2)],
        names=["phi", "y"],
        periods=[TURN, np.inf],
    )


def test_a_value_on_a_circle_is_taken_once_a_turn(wave) -> None:
    values = {str(value): ("phi", value) for value in (0, 1, 3, 3 * np.pi, 100)}
    events = bifurc.explore(wave, events=values).diagram.events()
    assert len(events) == len(values)
    for event in events:
        assert event.value == pytest.approx(event.u[0], abs=1e-13)
        assert np.exp(1j * event.u[0]) == pytest.approx(np.exp(1j * float(event.label)))


def test_values_a_turn_apart_are_one(wave) -> None:
    requests = {"list": ("phi", [1, 1 + TURN]), "half": ("y", [0.5, 0.5 + TURN])}
    diagram = bifurc.explore(wave, events=requests).diagram
    (event,) = diagram.events("list")
    assert (event.value, event.u[0]) == pytest.approx((1.0, 1.0), abs=1e-13)
    assert len(diagram.events("half")) == 2


def test_forms_that_wind_pass_a_value_in_every_turn() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[1] - 3 * u[0])],
        [(-np.pi, np.pi)] * 2,
        names=["a", "b"],
        periods=[TURN, TURN],
    )
    requests = {"a": ("a", 1), "b": ("b", 1), "sum": lambda u: u[0] + u[1] - 1}
    diagram = bifurc.explore(problem, events=requests).diagram
    counts = {name: len(diagram.events(name)) for name in requests}
    assert counts == {"a": 2, "b": 6, "sum": 8}


def test_a_function_that_is_none_on_a_circle_is_cut_and_said(wave) -> None:
    diagram = bifurc.explore(wave, events={"one": lambda u: u[0] ** 2 - 1}).diagram
    phi = sorted(event.u[0] for event in diagram.events())
    assert phi == pytest.approx([-1, 1], abs=1e-13)
    (remark,) = diagram.remarks
    assert "no function on circles" in remark


def test_events_of_a_file_are_taken_on_circles(tmp_path) -> None:
    path = tmp_path / "torus.toml"
    path.write_text("""
equations = ["sin(3*a - 2*b)"]
[unknowns]
a = { period = "2*pi" }
b = { period = "2*pi" }
[events]
zero = "a = 0"
one = "a = 1"
both = "b = 1"
""")
    diagram = read_equations(path).explore().diagram
    counts = {name: len(diagram.events(name)) for name in ("zero", "one", "both")}
    assert counts == {"zero": 4, "one": 4, "both": 6}


def test_touches_and_jumps_are_told_from_events() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2, names=["x", "y"]
    )
    requests = {
        "near": ("x", 0.9999995),
        "top": ("x", 1),
        "pole": lambda u: 1 / u[0],
        "step": lambda u: np.floor(3 * u[0]),
    }
    diagram = bifurc.explore(problem, events=requests).diagram
    assert len(diagram.events("near")) == 2
    assert len(diagram.events()) == 2
    (touch,) = diagram.touches()
    assert touch.label == "top"
    assert abs(touch.u[1]) < touch.error < 1e-5
    assert any("'pole'" in one and "jumps" in one for one in diagram.remarks)
    assert any("'step'" in one and "keeps" in one for one in diagram.remarks)
