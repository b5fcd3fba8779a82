"""What is true of every route, and what is read from one."""

from itertools import pairwise

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.problem import Problem
from bifurc.routes.route import Route
from bifurc.torus import wrap


def forms_of(route: Route) -> list[str]:
    return [leg.form for leg in route.legs]


def dimensions_of(route: Route) -> list[int]:
    return [leg.dimension for leg in route.legs]


def assert_is_walk(atlas: Atlas, problem: Problem, route: Route) -> None:
    """The path solves the equations, has no jump, is as long as the legs say, and the
    legs hang together."""
    assert np.abs(problem.residuals(route.path)).max() < 1e-12
    turns = np.diff(route.path, axis=0)
    steps = np.linalg.norm(turns, axis=1)
    assert steps.max() < 2 * route.length / len(steps)
    assert steps.sum() == pytest.approx(route.length, rel=1e-4)  # chords of 400 steps
    travel = np.abs(turns).sum(axis=0)
    assert travel == pytest.approx(route.travel, rel=1e-3, abs=1e-9)
    assert route.legs[-1].at == ""
    assert all(leg.at for leg in route.legs[:-1])
    points = {p.name: p.point.u for p in atlas.points}
    for before, after in pairwise(route.legs):
        end = before.path[-1]
        np.testing.assert_array_equal(end, after.path[0])
        assert np.abs(wrap(end - points[before.at], atlas.periods)).max() < 1e-9
    legs = [leg.path[1:] for leg in route.legs]
    np.testing.assert_array_equal(np.concatenate([route.path[:1], *legs]), route.path)
    for leg in route.legs:
        assert leg.path.shape[0] >= 2
        if leg.dimension > 1:
            assert (leg.start, leg.end) == (0.0, leg.length)
