"""Graphs and routes of an atlas, on curves drawn by hand so that every number is
known."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bifurc.atlas import Atlas, Event, Form, MeetingPoint
from bifurc.branch import Branch, Outcome
from bifurc.curves.monitor import Profile
from bifurc.errors import ProblemError, RouteError
from bifurc.function_problem import FunctionProblem
from bifurc.graphs import arc_graph, transition_graph
from bifurc.routes.route import find_route
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Completeness, Level
from bifurc.singular.locate import Kind, SingularPoint
from bifurc.torus import wrap

PERIOD = 6.0


def polygon(*corners: tuple[float, float], closed: bool = True) -> Branch:
    """The curve along straight pieces from corner to corner; a closed one ends where it
    began, modulo the period."""
    points = np.array(corners, dtype=float)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    breaks = np.concatenate([[0.0], np.cumsum(lengths)])
    pieces = np.stack([0.5 * (points[:-1] + points[1:]), 0.5 * steps], axis=1)
    outcome = Outcome.CLOSED if closed else Outcome.LEFT_REGION
    centers = 0.5 * (breaks[:-1] + breaks[1:])
    return Branch(
        pieces, centers, lengths / 2, breaks, 0 * lengths, np.full(2, PERIOD), outcome
    )


def test_wrapped_angles_lie_within_half_a_period_and_its_ends_are_one():
    periods = np.array([2 * np.pi, np.inf])
    angles = np.pi * np.array([-1, -1 + 1e-14, -1 - 1e-14, 1 + 1e-14, 3, -5, 1])
    points = np.stack([angles, angles], axis=1)
    wrapped = wrap(points, periods)
    assert np.all(wrapped[:, 0] == np.pi)
    assert np.all(wrapped[:, 1] == angles)
    beside = wrap(np.array([-np.pi + 1e-9, 7.0]), periods)
    assert beside == pytest.approx([-np.pi + 1e-9, 7.0], abs=1e-15)


def draw(
    branches: dict[str, Branch],
    points: dict[str, list[tuple[str, float]]],
    dead: tuple[Event, ...] = (),
) -> Atlas:
    """An atlas of these branches and of singular points, each given by the forms that
    pass it and where."""
    profile = Profile(np.array([[0.5]]), np.ones((1, 1, 2)), 1)
    forms = tuple(Form(name, branch, profile, 1.0) for name, branch in branches.items())
    names = list(branches)
    meeting = []
    for name, passes in points.items():
        u = branches[passes[0][0]](passes[0][1])
        point = SingularPoint(u, 0, np.eye(2), 0.0, np.eye(2), np.eye(2), 1, 2, 1e-2)
        indices = tuple((names.index(form), s) for form, s in passes)
        meeting.append(
            MeetingPoint(
                name, Kind.BIFURCATION, point, indices, np.ones((len(passes), 2))
            )
        )
    return Atlas(
        ("x", "y"),
        ("rad", "rad"),
        np.full(2, PERIOD),
        forms,
        tuple(meeting),
        (),
        dead,
        np.empty((0, 2)),
        (),
        Completeness(Level.ESTIMATED, "", 0.0),
    )


def ring(y: float) -> Branch:
    """A closed curve once around x at constant y, of length `PERIOD`."""
    return polygon(*((float(x), y) for x in range(7)))


def bridge(x: float) -> Branch:
    """A closed curve once around y at constant x, of length `PERIOD`."""
    return polygon(*((x, float(y)) for y in range(7)))


def assert_is_walk(atlas: Atlas, route) -> None:
    """The path lies on the forms, has no jump, starts and ends where the legs say, and
    the legs hang together."""
    on_forms = np.concatenate(
        [form.branch.sample(6001) for form in atlas.forms]
    )  # about 1e-3 apart
    gaps = np.linalg.norm(
        wrap(route.path[::10, None] - on_forms, atlas.periods), axis=-1
    )
    assert gaps.min(axis=1).max() < 1e-3
    steps = np.linalg.norm(np.diff(route.path, axis=0), axis=1)
    assert steps.max() < 3 * route.length / len(route.path) and steps.min() > 0
    assert steps.sum() == pytest.approx(route.length, rel=1e-6)
    ends = [
        atlas.forms[atlas.form(leg.form)].branch(np.array([leg.start, leg.end]))
        for leg in route.legs
    ]
    for (_, before), (after, _) in pairwise(ends):
        assert np.abs(wrap(before - after, atlas.periods)).max() < 1e-9
    assert route.legs[-1].at == "" and all(leg.at for leg in route.legs[:-1])


# --- graphs -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("stops", [0, 1, 2, 3])
def test_a_closed_form_with_stops_is_cut_into_as_many_arcs(stops: int) -> None:
    atlas = draw(
        {"ring": ring(0.0)}, {f"B{i}": [("ring", 0.5 + i)] for i in range(stops)}
    )
    arcs = [arc for *_, arc in arc_graph(atlas).edges(data=True)]
    assert len(arcs) == max(stops, 1)
    assert sum(arc["length"] for arc in arcs) == pytest.approx(PERIOD)
    assert sum(arc["travel"] for arc in arcs) == pytest.approx([PERIOD, 0.0])
    assert len(arc_graph(atlas)) == max(stops, 1)


def test_an_open_form_has_its_ends_as_nodes_unless_singular_points_lie_there() -> None:
    line = polygon((0, 0), (1, 0), (2, 0), closed=False)
    assert set(arc_graph(draw({"line": line}, {}))) == {"line start", "line end"}
    atlas = draw({"line": line}, {"S1": [("line", 2.0 - 1e-9)], "B1": [("line", 1.0)]})
    assert (
        set(arc_graph(atlas)) == {"S1", "B1", "line start"}
        and arc_graph(atlas).number_of_edges() == 2
    )


def test_arcs_name_the_nodes_at_their_start_and_end() -> None:
    atlas = draw({"ring": ring(0.0)}, {"B1": [("ring", 1.0)], "B2": [("ring", 4.5)]})
    for *_, arc in arc_graph(atlas).edges(data=True):
        for node, s in ((arc["first"], arc["start"]), (arc["last"], arc["end"])):
            gap = wrap(
                atlas.forms[0].branch(s) - arc_graph(atlas).nodes[node]["u"],
                atlas.periods,
            )
            assert np.abs(gap).max() < 1e-12


def test_travel_counts_the_way_there_and_back() -> None:
    square = polygon((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
    dead = tuple(
        Event(0, s, square(s), index=i)
        for i, s in ((0, 1.5), (0, 3.5), (1, 0.5), (1, 2.5))
    )
    (arc,) = (
        arc
        for *_, arc in arc_graph(
            draw({"square": square}, {"B1": [("square", 1.75)]}, dead)
        ).edges(data=True)
    )
    assert arc["travel"] == pytest.approx([2.0, 2.0], abs=1e-15)


def test_the_graph_of_forms_joins_all_pairs_at_a_bifurcation_once() -> None:
    branches = {"a": ring(0.0), "b": bridge(1.0), "c": polygon((1, 0), (4, 3), (7, 6))}
    atlas = draw(
        branches,
        {"B1": [("a", 1.0), ("b", 0.0), ("c", 0.0)], "B2": [("a", 4.0), ("b", 3.0)]},
    )
    edges = sorted(
        (*sorted((a, b)), key) for a, b, key in transition_graph(atlas).edges(keys=True)
    )
    assert edges == [
        ("a", "b", "B1"),
        ("a", "b", "B2"),
        ("a", "c", "B1"),
        ("b", "c", "B1"),
    ]


def test_a_form_that_crosses_itself_is_a_loop_in_the_graph_of_forms() -> None:
    atlas = draw({"eight": figure_eight()}, {"B1": [("eight", 0.0), ("eight", 4.0)]})
    assert list(transition_graph(atlas).edges(keys=True)) == [("eight", "eight", "B1")]
    assert sorted(arc["length"] for *_, arc in arc_graph(atlas).edges(data=True)) == [
        4.0,
        4.0,
    ]


def figure_eight() -> Branch:
    """Two unit squares run one after the other, which meet in the origin."""
    return polygon(
        (0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (-1, 0), (-1, -1), (0, -1), (0, 0)
    )


# --- routes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [0.2, 1.0, 3.7, 5.9])
@pytest.mark.parametrize("goal", [0.1, 1.0, 2.9, 4.4])
@pytest.mark.parametrize("stops", [0, 1, 2, 3])
def test_along_a_ring_a_route_takes_the_shorter_way(
    start: float, goal: float, stops: int
) -> None:
    atlas = draw(
        {"ring": ring(0.0)}, {f"B{i}": [("ring", 0.5 + 2 * i)] for i in range(stops)}
    )
    route = find_route(atlas, np.array([start, 0.0]), np.array([goal, 0.0]))
    way = abs((goal - start + PERIOD / 2) % PERIOD - PERIOD / 2)
    assert route.length == pytest.approx(way, abs=1e-12)
    assert route.travel == pytest.approx([way, 0.0], abs=1e-12)
    np.testing.assert_allclose(route.path[0], [start, 0.0], atol=1e-12)
    np.testing.assert_allclose(
        wrap(route.path[-1] - [goal, 0.0], atlas.periods), 0.0, atol=1e-12
    )
    if way:
        assert_is_walk(atlas, route)


def test_no_way_at_all_has_no_legs_and_one_configuration() -> None:
    atlas = draw({"ring": ring(0.0)}, {})
    for where in (np.array([2.0, 0.0]), "ring"):
        route = find_route(atlas, where, where)
        assert route.legs == () and route.length == 0 and route.path.shape == (1, 2)
        assert route.travel.tolist() == [0.0, 0.0]


def test_a_route_changes_form_at_bifurcations() -> None:
    atlas = draw(
        {"a": ring(0.0), "b": bridge(1.0), "c": ring(2.0)},
        {"B1": [("a", 1.0), ("b", 0.0)], "B2": [("b", 2.0), ("c", 1.0)]},
    )
    route = find_route(atlas, np.array([0.25, 0.0]), np.array([5.75, 2.0]))
    assert [(leg.form, leg.at) for leg in route.legs] == [
        ("a", "B1"),
        ("b", "B2"),
        ("c", ""),
    ]
    assert [leg.end - leg.start for leg in route.legs] == pytest.approx(
        [0.75, 2.0, -1.25]
    )
    assert route.travel == pytest.approx([2.0, 2.0])
    assert_is_walk(atlas, route)


def test_a_route_back_is_the_route_there_reversed() -> None:
    atlas = draw(
        {"a": ring(0.0), "b": bridge(1.0), "c": ring(2.0)},
        {"B1": [("a", 1.0), ("b", 0.0)], "B2": [("b", 2.0), ("c", 1.0)]},
    )
    there, back = find_route(atlas, "a", "c"), find_route(atlas, "c", "a")
    assert back.length == pytest.approx(there.length)
    assert [leg.form for leg in back.legs] == [leg.form for leg in there.legs][::-1]


def test_a_form_is_left_at_the_nearer_of_the_passes_of_one_point() -> None:
    atlas = draw(
        {"eight": figure_eight(), "diagonal": polygon((0, 0), (3, -3), (6, -6))},
        {"B1": [("eight", 0.0), ("eight", 4.0), ("diagonal", 0.0)]},
    )
    for s, way in ((0.5, 0.5), (3.25, 0.75), (4.5, 0.5), (7.5, 0.5)):
        start, goal = atlas.forms[0].branch(s), np.array([0.1, -0.1])
        route = find_route(atlas, start, goal)
        assert route.length == pytest.approx(way + 0.1 * np.sqrt(2))
        assert_is_walk(atlas, route)
    # across the crossing point, from one loop of the form to the other
    route = find_route(atlas, atlas.forms[0].branch(3.5), atlas.forms[0].branch(7.75))
    assert [leg.at for leg in route.legs] == [
        "B1",
        "",
    ] and route.length == pytest.approx(0.75)


def test_of_arcs_of_equal_length_between_two_points_one_is_taken() -> None:
    atlas = draw(
        {"a": ring(0.0), "b": bridge(0.0), "c": bridge(3.0)},
        {"B1": [("a", 0.0), ("b", 0.0)], "B2": [("a", 3.0), ("c", 0.0)]},
    )
    route = find_route(atlas, np.array([0.0, 1.0]), np.array([3.0, 1.0]))
    assert route.length == pytest.approx(5.0) and [leg.form for leg in route.legs] == [
        "b",
        "a",
        "c",
    ]
    assert_is_walk(atlas, route)


def test_a_start_at_a_bifurcation_needs_no_leg_to_reach_it() -> None:
    atlas = draw({"a": ring(0.0), "b": bridge(1.0)}, {"B1": [("a", 1.0), ("b", 0.0)]})
    for goal, form in (((2.0, 0.0), "a"), ((1.0, 1.0), "b")):
        route = find_route(atlas, np.array([1.0, 0.0]), np.array(goal))
        assert [leg.form for leg in route.legs] == [
            form
        ] and route.length == pytest.approx(1.0)


def test_a_path_stays_near_its_start_however_often_the_start_is_turned() -> None:
    atlas = draw({"ring": ring(0.0)}, {})
    path = find_route(atlas, np.array([12.5, -6.0]), np.array([1.5, 0.0])).path
    np.testing.assert_allclose(path[[0, -1]], [[12.5, -6.0], [13.5, -6.0]], atol=1e-12)


def test_components_that_do_not_meet_have_no_route_between_them() -> None:
    atlas = draw(
        {"a": ring(0.0), "b": ring(2.0), "c": bridge(0.0)},
        {"B1": [("a", 0.0), ("c", 0.0)]},
    )
    with pytest.raises(
        RouteError, match=r"no route from 'a' to 'b'.* only 'a', 'c' can be reached"
    ):
        find_route(atlas, "a", "b")


def test_what_is_no_place_of_the_atlas_is_refused_by_name() -> None:
    atlas = draw({"Form I": ring(0.0), "Form II": bridge(1.0)}, {})
    with pytest.raises(
        RouteError, match=r"form 'Form III': it must be one of 'Form I', 'Form II'"
    ):
        find_route(atlas, "Form III", "Form I")
    with pytest.raises(
        RouteError, match=r"it lies 0\.5 away from the nearest form, 'Form I'"
    ):
        find_route(atlas, np.array([3.0, 0.5]), "Form I")
    with pytest.raises(RouteError, match="it must be 2 finite numbers"):
        find_route(atlas, np.array([3.0]), "Form I")
    with pytest.raises(RouteError, match="the atlas has no forms"):
        find_route(draw({}, {}), np.zeros(2), np.zeros(2))


def test_a_form_is_found_by_its_name_or_an_unambiguous_part() -> None:
    atlas = draw(
        {"Form I": ring(0.0), "Form II": ring(1.0), "Bennett 4R": ring(2.0)}, {}
    )
    assert [atlas.form(name) for name in ("Form I", "form ii", "bennett", "4R")] == [
        0,
        1,
        2,
        2,
    ]
    with pytest.raises(RouteError):
        atlas.form("Form")


def test_forms_keep_everything_but_their_names_when_renamed() -> None:
    atlas = draw({"a": ring(0.0), "b": ring(1.0)}, {})
    renamed = atlas.renamed(["Form I", "Form II"], [{"symmetry": "line"}, {}])
    assert [f.name for f in renamed.forms] == ["Form I", "Form II"] and renamed.forms[
        0
    ].labels["symmetry"] == "line"
    assert renamed.forms[0].branch is atlas.forms[0].branch
    with pytest.raises(ProblemError, match="2 different names"):
        atlas.renamed(["same", "same"])


def test_the_components_are_counted() -> None:
    atlas = draw({"a": ring(0.0), "b": ring(1.0)}, {})
    assert (
        replace(
            atlas, forms=(atlas.forms[0], replace(atlas.forms[1], component=1))
        ).components
        == 2
    )


def test_angles_are_taken_to_within_half_a_period_and_pi_stays_pi() -> None:
    periods = np.array([2 * np.pi, np.inf])
    points = np.array(
        [[-np.pi, -50.0], [np.pi, 50.0], [7.0, 0.0], [-np.pi + 1e-3, 0.0]]
    )
    expected = np.array(
        [[np.pi, -50.0], [np.pi, 50.0], [7.0 - 2 * np.pi, 0.0], [-np.pi + 1e-3, 0.0]]
    )
    np.testing.assert_allclose(wrap(points, periods), expected, atol=1e-14)


def test_a_route_found_by_exploring_solves_the_equations_all_along() -> None:
    problem = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2 - 1) * (u[0] - 0.3 * u[1])]),
        [[-2, 2], [-2, 2]],
    )
    atlas = explore(problem, settings=SearchSettings(starts=60))
    circle, line = (
        next(i for i, f in enumerate(atlas.forms) if f.branch.closed is closed)
        for closed in (True, False)
    )
    assert len(atlas.bifurcations) == 2 and arc_graph(atlas).number_of_edges() == 5
    route = find_route(atlas, np.array([-0.6, -2.0]), np.array([1.0, 0.0]))
    assert [leg.form for leg in route.legs] == [
        atlas.forms[line].name,
        atlas.forms[circle].name,
    ]
    assert np.abs(problem.residuals(route.path)).max() < 1e-10
    assert np.linalg.norm(
        np.diff(route.path, axis=0), axis=1
    ).max() < 2 * route.length / len(route.path)
