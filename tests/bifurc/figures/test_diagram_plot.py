"""The bifurcation diagram: lines, marks and names say what the diagram says."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from matplotlib.figure import Figure

import bifurc
from bifurc.errors import ProblemError
from bifurc.figures.diagram_plot import plot_diagram
from bifurc.figures.plotting import plot_transition_map
from bifurc.figures.selection import Selection


@pytest.fixture(scope="module")
def pitchfork() -> bifurc.Atlas:
    """A supercritical pitchfork, and where |x| = 1."""
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] * u[0] - u[0] ** 3], [(-2, 2)] * 2, names=["x", "p"]
    )
    events = {"unit": (lambda u: u[0] ** 2, 1.0)}
    return bifurc.explore(problem, parameter="p", events=events)


def legend_of(figure: Figure) -> list[str]:
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


def curves_of(figure: Figure):
    return [line for line in figure.axes[0].lines if len(line.get_xdata()) > 1]


def test_stable_is_solid_and_unstable_dashed(pitchfork) -> None:
    figure = plot_diagram(pitchfork, "p", "x")
    styles = {}
    for line in curves_of(figure):
        middle = line.get_xydata()[len(line.get_xdata()) // 2]
        is_unstable = abs(middle[1]) < 1e-9 and middle[0] > 0
        styles.setdefault(is_unstable, set()).add(line.get_linestyle())
    assert styles == {False: {"-"}, True: {"--"}}
    assert legend_of(figure) == [
        "Form 1",
        "Form 2",
        "stable",
        "unstable",
        "supercritical pitchfork",
        "unit",
    ]


def test_points_are_marked_where_they_are(pitchfork) -> None:
    figure = plot_diagram(pitchfork, "p", "|x|")
    marks = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 1]
    spots = sorted(tuple(np.round(line.get_xydata()[0], 9) + 0.0) for line in marks)
    assert spots == [(0.0, 0.0), (1.0, 1.0), (1.0, 1.0)]
    names = {text.get_text() for text in figure.axes[0].texts}
    assert names == {"B1", "E1, E2"}


def test_the_parameter_is_drawn_where_nothing_is_said(pitchfork) -> None:
    axes = plot_diagram(pitchfork).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("p", "|x|")


def test_the_norm_is_not_taken_for_the_size_of_an_unknown() -> None:
    u, v, p = sympy.symbols("u v p")
    problem = bifurc.SymbolicProblem([u - p, v - 2 * p], [u, v, p], [(-2, 2)] * 3)
    atlas = bifurc.explore(problem, parameter=p, events={"one": (u, 1.0)})
    assert atlas.diagram.parameter == "p" and len(atlas.diagram.events()) == 1
    reach = {}
    for request in (None, "|u|", v):
        axes = plot_diagram(atlas, p, request).axes[0]
        highest = max(np.max(line.get_ydata()) for line in axes.lines)
        reach[axes.get_ylabel()] = pytest.approx(highest)
    assert reach == {"|(u, v)|": np.sqrt(5), "|u|": 1.0, "v": 2.0}


def test_unknowns_are_taken_by_their_symbols(pitchfork) -> None:
    x, p, q = sympy.symbols("x p q")
    axes = plot_diagram(pitchfork, p, x).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("p", "x")
    selection = Selection(overlay={x: [0.5], p: [0.25]})
    axes = plot_transition_map(pitchfork, joints=(p, x), selection=selection).axes[0]
    assert (0.25, 0.5) in [tuple(line.get_xydata()[0]) for line in axes.lines]
    with pytest.raises(ProblemError, match=r"'q' is not allowed.*unknowns x, p"):
        plot_diagram(pitchfork, q)


def test_an_axis_may_be_a_function(pitchfork) -> None:
    def energy(u):
        return 0.5 * u[0] ** 2

    axes = plot_diagram(pitchfork, "p", energy).axes[0]
    assert axes.get_ylabel() == "energy"
    assert min(line.get_ydata().min() for line in axes.lines) >= 0


def test_an_atlas_without_a_diagram_is_drawn_solid() -> None:
    circle = bifurc.FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2, names=["x", "y"]
    )
    figure = plot_diagram(bifurc.explore(circle), "x", "y")
    assert [line.get_linestyle() for line in curves_of(figure)] == ["-"]
    assert not figure.legends


def test_a_line_breaks_where_an_unknown_comes_round() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] - 2 * u[1]],
        [(-np.inf, np.inf)] * 2,
        names=["a", "b"],
        periods=[2 * np.pi] * 2,
    )
    figure = plot_diagram(bifurc.explore(problem), "b", "a")
    (line,) = curves_of(figure)
    rows = line.get_xydata()
    steps = np.abs(np.diff(rows, axis=0))
    assert np.nanmax(steps) < 1.0
    assert np.isnan(rows).any()


def test_rounding_is_not_drawn_as_large_as_the_frame() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] * np.cos(u[0]), u[0] - 2 * u[1] - u[2]], [(-1, 1)] * 3
    )
    axes = plot_diagram(bifurc.explore(problem), "u1", "u2").axes[0]
    assert np.ptp(axes.get_ylim()) > 0.1


@pytest.mark.parametrize("axis", ["z", "|z|", "", 3])
def test_an_axis_that_is_nothing_is_refused(pitchfork, axis) -> None:
    with pytest.raises(ProblemError, match=r"axis: .* unknowns x, p"):
        plot_diagram(pitchfork, axis, "x")


@pytest.mark.parametrize("value", ["text", None, [1.0, 2.0]])
def test_an_axis_function_must_give_numbers(pitchfork, value) -> None:
    def height(u):
        return value

    with pytest.raises(ProblemError, match=r"axis function height: .* a number"):
        plot_diagram(pitchfork, "p", height)


def test_an_axis_function_must_be_finite_somewhere(pitchfork) -> None:
    def height(u):
        return float("nan")

    with pytest.raises(ProblemError, match=r"axis function height: nan .* finite"):
        plot_diagram(pitchfork, "p", height)


def test_marks_lie_on_the_curve_of_an_unknown_with_a_period() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [np.sin(u[0]) - u[1]],
        [(-np.pi, np.pi), (-2, 2)],
        names=["phi", "p"],
        periods=[2 * np.pi, np.inf],
    )
    atlas = bifurc.explore(problem, parameter="p", events={"one": ("phi", 1)})
    axes = plot_diagram(atlas, "p", "phi").axes[0]
    lines = [line.get_xydata() for line in axes.lines]
    curves = np.concatenate([rows for rows in lines if len(rows) > 1])
    curves = curves[np.isfinite(curves).all(axis=1)]
    marks = [rows[0] for rows in lines if len(rows) == 1]
    assert len(marks) == 3
    for mark in marks:
        assert np.linalg.norm(curves - mark, axis=1).min() < 0.03
    assert np.ptp(curves[:, 1]) <= 2 * np.pi + 1e-9
