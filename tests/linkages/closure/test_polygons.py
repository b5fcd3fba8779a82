"""Planar polygons, of which the number of components is known."""

import itertools

import numpy as np
import pytest

from bifurc.surfaces.covering import cover_component
from linkages.app.answer.verdict import judge
from linkages.loop import Loop
from linkages.mapping import map_linkage
from tests.linkages.loops_with_surfaces import planar
from tests.samples import one_in


def components(lengths) -> int:
    """Kapovich and Millson 1995: two where of three links each two are longer than half of
    all, else one."""
    longest = sorted(lengths)[-3:]
    pairs = itertools.combinations(longest, 2)
    return 1 + all(sum(pair) > 0.5 * sum(lengths) for pair in pairs)


def random_hexagon(number: int) -> np.ndarray:
    """Lengths (6,) of links of which none is longer than all others; every other one has
    two components."""
    rng = np.random.default_rng(number)
    while True:
        lengths = rng.uniform(0.2, 1.5, 6)
        if number % 2:
            lengths[:3] = rng.uniform(2.0, 3.0, 3)
        is_closed = 2 * lengths.max() < lengths.sum()
        if is_closed and components(lengths) == 1 + number % 2:
            return lengths


@pytest.mark.parametrize("number", one_in(10, [*range(1, 20, 2), *range(0, 20, 2)]))
def test_a_planar_hexagon_has_as_many_components_as_its_long_links_say(
    number: int,
) -> None:
    lengths = random_hexagon(number)
    problem = planar(*lengths)
    angles = np.random.default_rng(0).uniform(-np.pi, np.pi, (60, 6))
    points, gaps = problem.project(angles)
    charts = cover_component(problem, points[gaps < 1e-12], 3, charts=20_000)
    assert charts.complete
    assert len(charts.parts()) == components(lengths)


def test_the_verdict_says_by_how_many_charts_the_components_are_covered() -> None:
    zeros = (0.0,) * 6
    atlas = map_linkage(Loop((3, 3.1, 2.9, 0.5, 0.4, 0.3), zeros, zeros))
    charts = sum(len(surface.charts) for surface in atlas.surfaces)
    words = f"mobility 3 in 2 components, covered by {charts} charts."
    assert words in judge(atlas).sentence
    assert [surface.dimension for surface in atlas.surfaces] == [3, 3]
