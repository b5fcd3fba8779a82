"""Components of dimension 2 and more of loops, and the dimension at a configuration."""

import time

import networkx as nx
import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import ProblemError
from bifurc.graphs import transition_graph
from bifurc.problem import Problem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.point import Kind
from bifurc.surfaces.chart_atlas import Covering
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.geodesic import shortest_path
from linkages.closure.closure import Closure
from linkages.loop import Loop
from tests.bifurc.known_surfaces import seeds
from tests.linkages.loops_with_surfaces import (
    equal_double_goldberg,
    general,
    planar,
    spherical,
)


def test_a_double_goldberg_loop_with_equal_links_never_meets_its_torus() -> None:
    problem = equal_double_goldberg()
    atlas = explore(problem)
    assert len(atlas.forms) == 2
    assert len(atlas.bifurcations) == 2
    assert len(atlas.points) == 2
    (surface,) = atlas.surfaces
    assert surface.dimension == 2
    assert surface.complete
    assert surface.charts is not None
    assert surface.charts.euler_characteristic == 0
    # theta3 = theta6 = pi, theta4 = -theta2, theta5 = -theta1
    theta3 = surface.samples[:, 2] - np.pi
    theta2_and_4 = surface.samples[:, 1] + surface.samples[:, 3]
    assert np.abs(np.sin(theta3 / 2)).max() < 1e-9
    assert np.abs(np.sin(theta2_and_4 / 2)).max() < 1e-9
    jacobians = problem.jacobians(surface.charts.centers)
    smallest_regular = np.linalg.svd(jacobians, compute_uv=False)[:, 3]
    # rank 4 all over: no singular point, and so no way out
    assert smallest_regular.min() > 0.1
    assert not nx.has_path(transition_graph(atlas), atlas.forms[0].name, surface.name)


def test_a_sarrus_loop_with_folded_legs_changes_mobility_where_its_forms_meet_the_torus(
    folded_sarrus: Atlas,
) -> None:
    assert len(folded_sarrus.forms) == 2
    assert [surface.dimension for surface in folded_sarrus.surfaces] == [2]
    assert len(folded_sarrus.points) == 4
    for point in folded_sarrus.points:
        assert point.kind is Kind.DIMENSION_CHANGE
        assert len(point.point.half_branches) == 2
        assert len(point.passes) == 1
        assert point.surfaces == (0,)
        assert point.note == ""
    assert nx.is_connected(transition_graph(folded_sarrus))
    assert len({form.component for form in folded_sarrus.forms}) == 1


@pytest.mark.parametrize(
    ("problem", "dimension"),
    [
        (planar(1, 1.2, 0.9, 1.3, 1.1, 0.8), 3),
        (planar(1, 2, 1, 2, 1, 2, 1, 2), 5),
        (general(9), 3),
        (general(12), 6),
    ],
    ids=["planar 6R", "planar 8R", "9R", "12R"],
)
def test_components_of_higher_dimension_are_reported_with_it_and_nothing_else(
    problem: Problem, dimension: int
) -> None:
    atlas = explore(problem)
    assert [surface.dimension for surface in atlas.surfaces] == [dimension]
    assert not atlas.forms
    assert not atlas.points
    assert not len(atlas.rigid)


def test_a_search_ends_when_its_budget_is_used_up_and_says_so() -> None:
    began = time.perf_counter()
    atlas = explore(general(8), settings=SearchSettings(budget=0.2))
    assert time.perf_counter() - began < 5.0
    assert atlas.provenance.out_of_time
    assert atlas.completeness.level == "out of time"
    # how far the covering comes in that time hangs on the machine, but not to its end
    coverings = [s.charts for s in atlas.surfaces if s.charts is not None]
    assert {charts.outcome for charts in coverings} <= {Covering.OUT_OF_TIME}


def test_a_search_that_ends_before_its_budget_says_nothing_of_it() -> None:
    atlas = explore(planar(1, 2, 1.4, 2.2), settings=SearchSettings(budget=60.0))
    assert not atlas.provenance.out_of_time
    with pytest.raises(ProblemError, match="budget"):
        explore(general(8), settings=SearchSettings(budget=0.0))


def test_the_charts_of_a_planar_5r_loop_form_a_surface_of_genus_four() -> None:
    # Havel 1991, Some examples of the use of distances as coordinates for Euclidean
    # geometry: the equilateral pentagon
    problem = planar(1, 1, 1, 1, 1)
    charts = cover_surface(problem, seeds(problem)[:1], radius=0.7)
    assert charts.complete
    assert charts.euler_characteristic == -6
    assert len(charts.parts()) == 1


def test_the_trivial_component_of_the_double_goldberg_loop_is_a_flat_torus() -> None:
    start = np.array([[0.3, 0.5, np.pi, -0.5, -0.3, np.pi]])
    charts = cover_surface(equal_double_goldberg(), start, radius=1.0)
    assert charts.complete
    assert charts.euler_characteristic == 0
    # theta1 and theta2 turn freely, each with another joint
    assert charts.area == pytest.approx(8 * np.pi**2, rel=1e-6)


def test_a_path_on_a_torus_of_angles_has_no_jump_where_a_period_ends() -> None:
    problem = equal_double_goldberg()
    start = np.array([3.0, 0.2, np.pi, -0.2, -3.0, np.pi])
    goal = np.array([-3.0, 0.4, np.pi, -0.4, 3.0, np.pi])
    charts = cover_surface(problem, start[None], radius=1.0)
    path = shortest_path(problem, charts, start, goal, 0.1)
    assert np.abs(np.diff(path, axis=0)).max() < 0.2
    assert path[-1, 0] == pytest.approx(2 * np.pi - 3)


COINCIDENT_AXES = Closure(Loop((0, 1, 0, 1), (0, 0.7, 0, 0.7), (0, 0, 0, 0)))


LOOPS = {  # name: loop, its mobility
    "planar 5R": (planar(1, 1.2, 0.9, 1.3, 1.1), 2),
    "planar 6R": (planar(1, 1.2, 0.9, 1.3, 1.1, 0.8), 3),
    "planar 8R": (planar(1, 2, 1, 2, 1, 2, 1, 2), 5),
    "spherical 5R": (spherical(0.9, 1.1, 1.3, 1.0, 1.2), 2),
    "7R": (general(7), 1),
    "8R": (general(8), 2),
    "9R": (general(9), 3),
    "12R": (general(12), 6),
    "two pairs of coincident axes": (COINCIDENT_AXES, 2),
}


@pytest.mark.parametrize("name", LOOPS)
def test_every_seed_of_a_loop_lies_on_a_component_of_the_right_dimension(
    name: str,
) -> None:
    problem, dimension = LOOPS[name]
    local = local_dimensions(problem, seeds(problem, 60)[-200:])
    assert len(local.dimension) > 20
    assert np.all(local.dimension == dimension)
    assert np.all(local.regular)
