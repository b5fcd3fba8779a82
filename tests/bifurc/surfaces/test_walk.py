"""Solutions outside unfinished charts walk to them."""

import numpy as np

from bifurc.limits import Deadline
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.walk import reached_charts
from tests.bifurc.known_surfaces import SPHERE, seeds, two_spheres


def test_from_everywhere_on_a_sphere_a_walk_comes_to_its_few_charts() -> None:
    few = cover_surface(SPHERE, seeds(SPHERE, 1), charts=30)
    points = seeds(SPHERE, 40)
    assert np.count_nonzero(~few.covers(points)) > 10
    assert np.all(reached_charts(SPHERE, few, points, Deadline()) >= 0)


def test_no_walk_comes_from_one_sphere_to_another() -> None:
    problem = two_spheres(1.0)
    charts = cover_surface(problem, np.array([[-0.5, 0.0, 0.0]]), radius=0.4)
    points = np.array([[-1.5, 0.0, 0.0], [0.4, 0.0, 0.0]])
    reached = reached_charts(problem, charts, points, Deadline())
    assert reached[0] >= 0
    assert reached[1] == -1


def test_when_the_time_is_over_no_walk_arrives() -> None:
    few = cover_surface(SPHERE, seeds(SPHERE, 1), charts=30)
    reached = reached_charts(SPHERE, few, seeds(SPHERE, 40), Deadline(1e-9))
    assert np.all(reached == -1)
