"""Routes of loops over their surfaces, where their length is known."""

from pathlib import Path

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.files.graphml import plain_graph
from bifurc.graphs import arc_graph
from bifurc.routes.route import find_route, spread_route
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.torus import wrap
from tests.bifurc.routes.walks import assert_is_walk, dimensions_of, forms_of
from tests.linkages.loops_with_surfaces import equal_double_goldberg, planar, sarrus

SARRUS = sarrus()


GOLDBERG = equal_double_goldberg()


@pytest.fixture(scope="module")
def goldberg() -> Atlas:
    return explore(GOLDBERG)


def on_torus(theta1: float, theta2: float) -> np.ndarray:
    return np.array([theta1, theta2, np.pi, -theta2, -theta1, np.pi])


def test_a_sarrus_loop_goes_from_form_to_form_over_its_torus(
    folded_sarrus: Atlas,
) -> None:
    route = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    assert forms_of(route) == ["Form 1", "surface 1", "Form 2"]
    # two joints turn by half a turn each
    assert route.legs[1].length == pytest.approx(np.sqrt(2) * np.pi, abs=1e-6)
    assert route.legs[-1].at == ""
    assert {leg.at for leg in route.legs} < {"", "D1", "D2", "D3", "D4"}
    assert_is_walk(folded_sarrus, SARRUS, route)
    back = find_route(folded_sarrus, "Form 2", "Form 1", problem=SARRUS)
    assert back.length == pytest.approx(route.length, abs=1e-9)


def test_the_middle_of_a_surface_stands_for_its_name(folded_sarrus: Atlas) -> None:
    route = find_route(folded_sarrus, "surface 1", "Form 2", problem=SARRUS)
    assert forms_of(route) == ["surface 1", "Form 2"]
    gap = wrap(route.path[0] - folded_sarrus.points[0].point.u, folded_sarrus.periods)
    assert np.linalg.norm(gap) > 1.0
    none = find_route(folded_sarrus, "surface 1", "surface 1", problem=SARRUS)
    assert none.legs == ()
    assert none.path.shape == (1, 6)


def test_a_path_stays_near_its_start_however_often_the_start_is_turned(
    folded_sarrus: Atlas,
) -> None:
    start, goal = folded_sarrus.surfaces[0].samples[[0, -1]] + 4 * np.pi
    route = find_route(folded_sarrus, start, goal, problem=SARRUS)
    np.testing.assert_allclose(route.path[0], start, atol=1e-9)
    end = route.path[-1]
    assert np.abs(wrap(end - goal, folded_sarrus.periods)).max() < 1e-9
    # the torus is flat
    assert route.length == pytest.approx(np.linalg.norm(end - start), rel=1e-9)


def test_a_start_at_a_dimension_change_lies_on_form_and_surface(
    folded_sarrus: Atlas,
) -> None:
    point = folded_sarrus.points[0]
    form, s = point.passes[0]
    on_form = folded_sarrus.forms[form].branch(s + 0.5)
    along = find_route(folded_sarrus, point.point.u, on_form, problem=SARRUS)
    assert dimensions_of(along) == [1]
    on_surface = folded_sarrus.surfaces[0].samples[0]
    over = find_route(folded_sarrus, point.point.u, on_surface, problem=SARRUS)
    assert dimensions_of(over) == [2]


def test_a_route_does_not_depend_on_how_densely_it_is_drawn(
    folded_sarrus: Atlas,
) -> None:
    few, many = (
        find_route(folded_sarrus, "Form 1", "Form 2", count=count, problem=SARRUS)
        for count in (20, 1000)
    )
    assert few.length == many.length
    assert len(few.path) < 30
    assert len(many.path) > 900
    np.testing.assert_array_equal(few.travel, many.travel)


def test_the_graphs_of_an_atlas_are_those_of_its_forms_after_a_route(
    folded_sarrus: Atlas,
) -> None:
    find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    for *_, arc in arc_graph(folded_sarrus).edges(data=True):
        assert "form" in arc
    for *_, edge in plain_graph(folded_sarrus).edges(data=True):
        assert edge["layer"] in ("forms", "arcs")


def test_an_atlas_from_a_file_needs_its_problem_for_legs_over_surfaces(
    folded_sarrus: Atlas, tmp_path: Path
) -> None:
    again = load_atlas(save_atlas(folded_sarrus, tmp_path / "sarrus.nc"))
    needed = "'surface 1': the problem of the atlas is needed there.*as problem="
    with pytest.raises(RouteError, match=needed):
        find_route(again, "Form 1", "Form 2")
    on_surface = folded_sarrus.surfaces[0].samples[0]
    perhaps = "perhaps on 'surface 1': only the problem of the atlas can tell"
    with pytest.raises(RouteError, match=perhaps):
        find_route(again, on_surface, "Form 2")
    route = find_route(again, "Form 1", "Form 2", problem=SARRUS)
    expected = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    np.testing.assert_allclose(route.path, expected.path, atol=1e-9)
    # along forms it needs none
    on_form = folded_sarrus.forms[0].branch(0.3)
    assert find_route(again, "Form 1", on_form).length > 0


def test_of_the_ways_round_a_torus_the_shortest_is_taken(goldberg: Atlas) -> None:
    # theta1 and theta2 turn freely, each with another joint: the torus is flat, its
    # sides are sqrt(2) 2 pi long
    pairs = np.random.default_rng(0).uniform(-np.pi, np.pi, (25, 2, 2))
    for start, goal in pairs:
        route = find_route(
            goldberg, on_torus(*start), on_torus(*goal), count=60, problem=GOLDBERG
        )
        turned = wrap(goal - start, np.full(2, 2 * np.pi))
        length = np.sqrt(2) * np.linalg.norm(turned)
        assert route.length == pytest.approx(length, rel=1e-9)


def test_without_charts_no_route_goes_over_a_component_of_four_dimensions() -> None:
    problem = planar(1, 1.2, 0.9, 1.3, 1.1, 0.8, 0.7)
    atlas = explore(problem, settings=SearchSettings(starts=20, charts=0))
    sampled = r"surface 1 \(dimension 4\): it is only sampled"
    with pytest.raises(RouteError, match=sampled):
        find_route(atlas, "surface 1", "surface 1", problem=problem)
    sample = atlas.surfaces[0].samples[0]
    with pytest.raises(RouteError, match=f"the atlas has no forms.*{sampled}"):
        find_route(atlas, sample, "surface 1", problem=problem)


def test_forms_that_never_meet_a_torus_have_no_route_to_it(goldberg: Atlas) -> None:
    with pytest.raises(RouteError, match="only 'Form 1', 'Form 2' can be reached"):
        find_route(goldberg, "Form 1", on_torus(0.3, 0.5), problem=GOLDBERG)


COUNTS = (2, 3, 7, 10, 361)


@pytest.mark.parametrize("count", COUNTS)
def test_over_surfaces_they_are_solutions_at_even_steps(
    folded_sarrus: Atlas, count: int
) -> None:
    route = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    spread = spread_route(folded_sarrus, route, count, SARRUS)
    assert spread.configurations.shape == (count, 6)
    assert np.abs(SARRUS.residuals(spread.configurations)).max() < 1e-12
    ends = spread.configurations[[0, -1]]
    np.testing.assert_allclose(ends, route.path[[0, -1]], atol=1e-9)
    steps = np.linalg.norm(np.diff(spread.configurations, axis=0), axis=1)
    step = route.length / (count - 1)
    assert steps.max() < step * (1 + 1e-6)
    # shorter only where a form is left, and along the bend of a form
    assert np.median(steps) > 0.99 * step or count < 20


def test_a_route_over_a_surface_is_spread_with_its_problem_only(
    folded_sarrus: Atlas,
) -> None:
    route = find_route(folded_sarrus, "Form 1", "Form 2", problem=SARRUS)
    with pytest.raises(RouteError, match="problem"):
        spread_route(folded_sarrus, route, 5)
