"""Normal forms, of which everything is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

import bifurc
from bifurc.diagrams.diagram import Stability
from bifurc.errors import ProblemError
from bifurc.singular.point import Kind

Function = Callable[[np.ndarray], Sequence[float]]


def diagram_of(function: Function, **options: bool) -> bifurc.Diagram:
    """The diagram of an equation in x and the parameter p."""
    problem = bifurc.FunctionProblem(
        function, [(-2, 2), (-2.1, 2.2)], names=["x", "p"], **options
    )
    diagram = bifurc.explore(problem, parameter="p").diagram
    assert diagram is not None
    return diagram


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize(
    "function, kind, unstable",
    [
        (
            lambda u: [u[1] * u[0] - u[0] ** 3],
            Kind.SUPERCRITICAL,
            [0, 0, 0, 1],
        ),
        (lambda u: [u[1] * u[0] + u[0] ** 3], Kind.SUBCRITICAL, [0, 1, 1, 1]),
        (
            lambda u: [u[1] * u[0] - u[0] ** 2],
            Kind.TRANSCRITICAL,
            [0, 0, 1, 1],
        ),
    ],
)
def test_crossings_are_told_apart(function, kind, unstable, is_recorded) -> None:
    diagram = diagram_of(function, is_recorded=is_recorded)
    assert [one.kind for one in diagram.branchings] == [kind]
    assert not diagram.folds
    assert sorted(one.unstable for one in diagram.stretches) == unstable


def test_a_fold_exchanges_stability() -> None:
    diagram = diagram_of(lambda u: [u[1] - u[0] ** 2])
    (fold,) = diagram.folds
    assert np.abs(fold.u).max() < 1e-14
    assert fold.value == pytest.approx(2.0, rel=1e-10)
    assert {one.stability for one in diagram.stretches} == {
        Stability.STABLE,
        Stability.UNSTABLE,
    }


def test_a_parameter_that_stands_still_and_goes_on_is_no_fold() -> None:
    diagram = diagram_of(lambda u: [u[1] - u[0] ** 3])
    assert not diagram.folds
    assert [one.stability for one in diagram.stretches] == [Stability.STABLE]


@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-6])
def test_an_imperfect_pitchfork_has_a_fold_and_no_crossing(size) -> None:
    diagram = diagram_of(lambda u: [size + u[1] * u[0] - u[0] ** 3])
    assert not diagram.branchings
    (fold,) = diagram.folds
    x = -((size / 2) ** (1 / 3))
    assert fold.u == pytest.approx([x, 3 * x**2], rel=1e-9)


@pytest.mark.parametrize("unfolding", [0.5, 1.0])
def test_the_folds_of_a_cusp_lie_on_its_edge(unfolding) -> None:
    diagram = diagram_of(lambda u: [u[1] + unfolding * u[0] - u[0] ** 3])
    x = math.sqrt(unfolding / 3)
    expected = [[-x, 2 * x**3], [x, -2 * x**3]]
    found = sorted(fold.u.tolist() for fold in diagram.folds)
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_the_brusselator_loses_stability_where_b_is_1_plus_a_squared() -> None:
    a = 1.3
    problem = bifurc.FunctionProblem(
        lambda u: [
            a - (u[2] + 1) * u[0] + u[0] ** 2 * u[1],
            u[2] * u[0] - u[0] ** 2 * u[1],
        ],
        [(0, 4), (0, 6), (0, 5)],
        names=["x", "y", "b"],
    )
    diagram = bifurc.explore(problem, parameter="b").diagram
    (hopf,) = diagram.hopf_points
    assert hopf.u == pytest.approx([a, (1 + a**2) / a, 1 + a**2], abs=1e-13)
    assert hopf.value == pytest.approx(a, rel=1e-13)
    # whichever way the form runs
    assert hopf.label == "becomes unstable as b grows"
    assert repr(diagram) == (
        "<Diagram in 'b': 0 folds, 1 Hopf point, 0 events, 0 touches, 0 branchings>"
    )
    assert sorted(one.unstable for one in diagram.stretches) == [0, 2]


@pytest.mark.parametrize("frequency", [1.0, 1.001, 2.0])
@pytest.mark.parametrize("rate", [1.0, -1.0, -3.0])
@pytest.mark.parametrize("center", [0.0, 0.3])
def test_every_pair_that_crosses_at_one_place_is_a_point(
    frequency, rate, center
) -> None:
    def two_oscillators(u):
        x, y, z, w, p = u
        first, second = p - center, rate * (p - center)
        return [
            first * x - y,
            x + first * y,
            second * z - frequency * w,
            frequency * z + second * w,
        ]

    problem = bifurc.FunctionProblem(two_oscillators, [(-1, 1)] * 4 + [(-1.1, 1)])
    diagram = bifurc.explore(problem, parameter="u5").diagram
    assert [point.u[4] for point in diagram.hopf_points] == pytest.approx([center] * 2)
    frequencies = sorted(point.value for point in diagram.hopf_points)
    assert frequencies == pytest.approx([1.0, frequency])
    changes = {point.label for point in diagram.hopf_points}
    assert len(changes) == (1 if rate > 0 else 2)
    unstable = sorted({one.unstable for one in diagram.stretches})
    assert unstable == ([0, 4] if rate > 0 else [2])
    assert any("two pairs cross at one place" in one for one in diagram.remarks)


def test_pairs_that_touch_the_axis_or_pass_beside_it_are_no_points() -> None:
    def two_oscillators(u):
        x, y, z, w, p = u
        near, far = p**2 + 1e-3, -(p**2) - 1e-3
        return [near * x - y, x + near * y, far * z - w, z + far * w]

    problem = bifurc.FunctionProblem(two_oscillators, [(-1, 1)] * 4 + [(-1.1, 1)])
    assert not bifurc.explore(problem, parameter="u5").diagram.hopf_points


def test_a_center_is_neutral() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1], -u[0] * (1 + u[2] ** 2)], [(-1, 1)] * 3, names=list("xyp")
    )
    diagram = bifurc.explore(problem, parameter="p").diagram
    assert [one.stability for one in diagram.stretches] == [Stability.NEUTRAL]
    assert not diagram.hopf_points


def test_a_real_eigenvalue_that_is_stiff_is_no_center() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [-1e8 * u[0], -u[1] + u[2]], [(-1, 1)] * 3, names=list("xyp")
    )
    diagram = bifurc.explore(problem, parameter="p").diagram
    assert [one.stability for one in diagram.stretches] == [Stability.STABLE]


def test_redundant_equations_have_folds_and_no_stability() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - u[0] ** 2, 2 * u[1] - 2 * u[0] ** 2], [(-2, 2)] * 2
    )
    diagram = bifurc.explore(problem, parameter="u2").diagram
    assert len(diagram.folds) == 1
    assert {one.stability for one in diagram.stretches} == {Stability.UNKNOWN}
    assert {one.unstable for one in diagram.stretches} == {-1}


def test_a_closed_form_has_two_folds_and_stretches_that_cover_it() -> None:
    diagram = diagram_of(lambda u: [u[0] ** 2 + u[1] ** 2 - 1])
    assert sorted(fold.u[1] for fold in diagram.folds) == pytest.approx([-1, 1])
    covered = sum(one.end - one.start for one in diagram.stretches)
    assert covered == pytest.approx(2 * math.pi, rel=1e-10)


# --- events ---------------------------------------------------------------------------

CIRCLE = bifurc.FunctionProblem(
    lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2, names=["x", "y"]
)


def test_events_are_zeros_of_functions_and_places_of_values() -> None:
    requests = {
        "diagonal": lambda u: u[0] - u[1],
        "half": ("x", 0.5),
        "two": (lambda u: 3 * u[1], [0.3, -0.6]),
    }
    diagram = bifurc.explore(CIRCLE, events=requests).diagram
    half = math.sqrt(0.5)
    diagonal = sorted(event.u.tolist() for event in diagram.events("diagonal"))
    np.testing.assert_allclose(
        diagonal, [[-half, -half], [half, half]], rtol=0, atol=1e-14
    )
    assert {event.value for event in diagram.events("two")} == {0.3, -0.6}
    y = sorted(event.u[1] for event in diagram.events("two"))
    np.testing.assert_allclose(y, [-0.2, -0.2, 0.1, 0.1], rtol=0, atol=1e-14)
    assert len(diagram.events("half")) == 2
    assert diagram.parameter == "" and not diagram.stretches


@pytest.mark.parametrize("seed", range(3))
def test_a_value_that_a_form_has_all_along_is_no_event(seed) -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [(u[0] - np.pi) * (u[0] - u[1])], [(-4, 4)] * 2, names=["x", "p"]
    )
    requests = {"on it": ("x", np.pi), "cosine": lambda u: np.cos(u[0]) + 1}
    diagram = bifurc.explore(problem, events=requests, seed=seed).diagram
    (event,) = diagram.events()
    assert event.label == "on it"
    assert event.u == pytest.approx([np.pi, np.pi], abs=1e-12)


@pytest.mark.parametrize("x, p", [(1.0, 1.0), (1e6, 1e-6), (1e-6, 1e6)])
def test_an_event_is_seen_whatever_unknowns_are_counted_in(x: float, p: float) -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] / p + u[0] / x - (u[0] / x) ** 3],
        [(-3 * x, 3 * x), (-2 * p, 2 * p)],
        names=["x", "p"],
    )
    requests = {"half": ("p", 0.5 * p), "one": ("x", x)}
    events = bifurc.explore(problem, events=requests).diagram.events()
    assert sorted(event.label for event in events) == ["half", "one"]


def test_a_pole_is_no_event() -> None:
    diagram = bifurc.explore(CIRCLE, events={"pole": lambda u: 1 / u[0]}).diagram
    assert not diagram.events()


@pytest.mark.parametrize(
    "options, message",
    [
        ({"parameter": "z"}, "parameter: 'z' is not allowed"),
        ({"parameter": "yy"}, "the nearest is y"),
        ({"parameter": 1}, "one of the unknowns x, y"),
        ({"events": {"a": 1}}, r"events\['a'\]: 1 .*a function"),
        ({"events": {"a": ("z", 1)}}, "one of the unknowns x, y"),
        ({"events": {"a": ("x", math.nan)}}, "finite"),
        ({"events": {"a": ("x",)}}, "the values that it shall take"),
        ({"events": [1]}, "a dict"),
        ({"events": {1: len}}, "name of an event"),
        ({"events": {"a": lambda u: u}}, "value of the event 'a'"),
    ],
)
def test_what_is_no_parameter_or_event_is_refused(options, message) -> None:
    with pytest.raises(ProblemError, match=message):
        bifurc.explore(CIRCLE, **options)
