"""Configurations evenly spread along routes: as many as asked for, at even
arclengths."""

import numpy as np
import pytest

from bifurc.errors import BifurcError, RouteError
from bifurc.routes.route import find_route, spread_route
from tests.bifurc.drawn_atlas import bridge, draw, ring

COUNTS = (2, 3, 7, 10, 361)


def corner_route(s: np.ndarray) -> np.ndarray:
    """Where the route below is at arclengths s (k,)."""
    corners = [[0.25, 0.0], [1.0, 0.0], [1.0, 2.0], [-0.25, 2.0]]
    at = [0.0, 0.75, 2.75, 4.0]
    return np.stack([np.interp(s, at, x) for x in np.transpose(corners)], axis=1)


@pytest.mark.parametrize("count", COUNTS)
def test_the_count_is_that_of_the_whole_route_whatever_its_legs(count: int) -> None:
    atlas = draw(
        {"a": ring(0.0), "b": bridge(1.0), "c": ring(2.0)},
        {"B1": [("a", 1.0), ("b", 0.0)], "B2": [("b", 2.0), ("c", 1.0)]},
    )
    route = find_route(atlas, np.array([0.25, 0.0]), np.array([5.75, 2.0]))
    assert len(route.legs) == 3
    spread = spread_route(atlas, route, count)
    expected = np.linspace(0.0, 4.0, count)
    np.testing.assert_allclose(spread.arclengths, expected, atol=1e-12)
    np.testing.assert_allclose(spread.configurations, corner_route(expected), atol=1e-9)


def test_what_cannot_be_spread_is_refused_by_name() -> None:
    atlas = draw({"ring": ring(0.0)}, {})
    with pytest.raises(RouteError, match="no length"):
        spread_route(atlas, find_route(atlas, "ring", "ring"), 5)
    route = find_route(atlas, np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    with pytest.raises(BifurcError, match="count"):
        spread_route(atlas, route, 1)
