"""Routes through an atlas, on curves drawn by hand so that every number is known."""

from itertools import pairwise

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.function_problem import FunctionProblem
from bifurc.graphs import arc_graph
from bifurc.routes.route import Leg, Route, find_route
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.torus import wrap
from tests.bifurc.drawn_atlas import PERIOD, bridge, draw, figure_eight, polygon, ring


def assert_is_walk(atlas: Atlas, route: Route) -> None:
    """The path lies on the forms, has no jump, starts and ends where the legs say, and
    the legs hang together."""
    samples = [form.branch.sample(6001) for form in atlas.forms]  # about 1e-3 apart
    differences = wrap(route.path[::10, None] - np.concatenate(samples), atlas.periods)
    gaps = np.linalg.norm(differences, axis=-1)
    assert gaps.min(axis=1).max() < 1e-3
    steps = np.linalg.norm(np.diff(route.path, axis=0), axis=1)
    assert steps.max() < 3 * route.length / len(route.path)
    assert steps.min() > 0
    assert steps.sum() == pytest.approx(route.length, rel=1e-6)
    for before, after in pairwise(route.legs):
        end, start = end_of(atlas, before), start_of(atlas, after)
        assert np.abs(wrap(end - start, atlas.periods)).max() < 1e-9
    assert route.legs[-1].at == ""
    assert all(leg.at for leg in route.legs[:-1])


def start_of(atlas: Atlas, leg: Leg) -> np.ndarray:
    return atlas.forms[atlas.form(leg.form)].branch(leg.start)


def end_of(atlas: Atlas, leg: Leg) -> np.ndarray:
    return atlas.forms[atlas.form(leg.form)].branch(leg.end)


def forms_of(route: Route) -> list[str]:
    return [leg.form for leg in route.legs]


def two_rings_and_a_bridge() -> Atlas:
    return draw(
        {"a": ring(0.0), "b": bridge(1.0), "c": ring(2.0)},
        {"B1": [("a", 1.0), ("b", 0.0)], "B2": [("b", 2.0), ("c", 1.0)]},
    )


@pytest.mark.parametrize("start", [0.2, 1.0, 3.7, 5.9])
@pytest.mark.parametrize("goal", [0.1, 1.0, 2.9, 4.4])
@pytest.mark.parametrize("stops", [0, 1, 2, 3])
def test_along_a_ring_a_route_takes_the_shorter_way(
    start: float, goal: float, stops: int
) -> None:
    points = {f"B{i}": [("ring", 0.5 + 2 * i)] for i in range(stops)}
    atlas = draw({"ring": ring(0.0)}, points)
    route = find_route(atlas, np.array([start, 0.0]), np.array([goal, 0.0]))
    way = abs((goal - start + PERIOD / 2) % PERIOD - PERIOD / 2)
    assert route.length == pytest.approx(way, abs=1e-12)
    assert route.travel == pytest.approx([way, 0.0], abs=1e-12)
    np.testing.assert_allclose(route.path[0], [start, 0.0], atol=1e-12)
    gap = wrap(route.path[-1] - [goal, 0.0], atlas.periods)
    np.testing.assert_allclose(gap, 0.0, atol=1e-12)
    if way:
        assert_is_walk(atlas, route)


def test_no_way_at_all_has_no_legs_and_one_configuration() -> None:
    atlas = draw({"ring": ring(0.0)}, {})
    for where in (np.array([2.0, 0.0]), "ring"):
        route = find_route(atlas, where, where)
        assert route.legs == ()
        assert route.length == 0
        assert route.path.shape == (1, 2)
        assert route.travel.tolist() == [0.0, 0.0]


def test_a_route_changes_form_at_bifurcations() -> None:
    atlas = two_rings_and_a_bridge()
    route = find_route(atlas, np.array([0.25, 0.0]), np.array([5.75, 2.0]))
    assert forms_of(route) == ["a", "b", "c"]
    assert [leg.at for leg in route.legs] == ["B1", "B2", ""]
    ways = [leg.end - leg.start for leg in route.legs]
    assert ways == pytest.approx([0.75, 2.0, -1.25])
    assert route.travel == pytest.approx([2.0, 2.0])
    assert_is_walk(atlas, route)


def test_a_route_back_is_the_route_there_reversed() -> None:
    atlas = two_rings_and_a_bridge()
    there = find_route(atlas, "a", "c")
    back = find_route(atlas, "c", "a")
    assert back.length == pytest.approx(there.length)
    assert forms_of(back) == forms_of(there)[::-1]


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
    assert [leg.at for leg in route.legs] == ["B1", ""]
    assert route.length == pytest.approx(0.75)


def test_of_arcs_of_equal_length_between_two_points_one_is_taken() -> None:
    atlas = draw(
        {"a": ring(0.0), "b": bridge(0.0), "c": bridge(3.0)},
        {"B1": [("a", 0.0), ("b", 0.0)], "B2": [("a", 3.0), ("c", 0.0)]},
    )
    route = find_route(atlas, np.array([0.0, 1.0]), np.array([3.0, 1.0]))
    assert route.length == pytest.approx(5.0)
    assert forms_of(route) == ["b", "a", "c"]
    assert_is_walk(atlas, route)


def test_a_start_at_a_bifurcation_needs_no_leg_to_reach_it() -> None:
    atlas = draw({"a": ring(0.0), "b": bridge(1.0)}, {"B1": [("a", 1.0), ("b", 0.0)]})
    for goal, form in (((2.0, 0.0), "a"), ((1.0, 1.0), "b")):
        route = find_route(atlas, np.array([1.0, 0.0]), np.array(goal))
        assert forms_of(route) == [form]
        assert route.length == pytest.approx(1.0)


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


def test_a_route_found_by_exploring_solves_the_equations_all_along() -> None:
    def circle_and_line(u: np.ndarray) -> np.ndarray:
        x, y = u
        return np.array([(x**2 + y**2 - 1) * (x - 0.3 * y)])

    problem = FunctionProblem(circle_and_line, [[-2, 2], [-2, 2]])
    atlas = explore(problem, settings=SearchSettings(starts=60))
    (circle,) = (form.name for form in atlas.forms if form.branch.closed)
    (line,) = (form.name for form in atlas.forms if not form.branch.closed)
    assert len(atlas.bifurcations) == 2
    assert arc_graph(atlas).number_of_edges() == 5
    route = find_route(atlas, np.array([-0.6, -2.0]), np.array([1.0, 0.0]))
    assert forms_of(route) == [line, circle]
    assert np.abs(problem.residuals(route.path)).max() < 1e-10
    steps = np.linalg.norm(np.diff(route.path, axis=0), axis=1)
    assert steps.max() < 2 * route.length / len(route.path)


# --- how routes are shown -----------------------------------------------------------------


def test_a_route_is_shown_as_a_line_for_every_leg() -> None:
    atlas = two_rings_and_a_bridge()
    route = find_route(atlas, np.array([0.25, 0.0]), np.array([5.75, 2.0]), count=100)
    lines = repr(route).splitlines()
    assert lines[0] == "Route(3 legs, length 4, 101 configurations)"
    assert lines[1] == "  Leg(a from 6.25 to 7, at B1, length 0.75)"
    assert lines[3].endswith("at the goal, length 1.25)")
    assert repr(route.legs[0]) == lines[1].strip()


def test_a_notebook_shows_a_route_as_a_table_of_legs_with_names_escaped() -> None:
    atlas = draw({"a<b": ring(0.0)}, {})
    route = find_route(atlas, np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    table = route._repr_html_()
    assert "<tr><th>form</th><th>from</th><th>to</th><th>at</th>" in table
    assert "<td>a&lt;b</td><td>0</td><td>1</td><td>goal</td><td>1</td>" in table
    assert "<td>total</td>" in table


def test_a_place_that_is_neither_name_nor_configuration_is_refused() -> None:
    atlas = draw({"ring": ring(0.0)}, {})
    for place in (atlas.forms[0], None, ["a", "b"]):
        with pytest.raises(RouteError, match=r"name of a form|finite numbers"):
            find_route(atlas, place, "ring")
