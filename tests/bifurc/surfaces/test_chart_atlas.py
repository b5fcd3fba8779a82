"""What an atlas of charts says of the surface that it covers."""

from dataclasses import replace

import numpy as np

from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.covering import cover_surface
from tests.bifurc.known_surfaces import CONE


def test_every_point_of_a_covered_surface_lies_in_a_chart_and_none_outside_it(
    sphere_charts: ChartAtlas,
) -> None:
    points = np.random.default_rng(2).normal(size=(500, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    at = sphere_charts.chart_at(points)
    assert np.all(at >= 0)
    distance = np.linalg.norm(sphere_charts.centers[at] - points, axis=1)
    assert np.all(distance < 1.2 * sphere_charts.radii[at])
    assert np.all(sphere_charts.covers(points))
    assert not np.any(sphere_charts.covers(1.3 * points))
    for k in range(20):
        assert at[k] in sphere_charts.charts_about(points[k])


def test_a_sphere_is_one_part_with_all_charts(sphere_charts: ChartAtlas) -> None:
    assert np.all(sphere_charts.part == 0)
    (part,) = sphere_charts.parts()
    assert np.array_equal(part.centers, sphere_charts.centers)
    assert part.area == sphere_charts.area


def test_about_the_tip_of_a_cone_there_is_no_chart_but_next_to_it() -> None:
    charts = cover_surface(CONE, np.array([[0.3, 0.4, 0.5]]))
    tip = np.zeros(3)
    assert not len(charts.charts_about(tip))
    near = charts.charts_next_to(tip)
    assert len(near) > 2
    assert not len(charts.charts_next_to(np.array([-1.0, 0.0, 0.0])))
    nearest = int(charts.nearest_charts(tip[None])[0])
    assert nearest in near


def test_an_atlas_of_charts_is_shown_in_two_lines(sphere_charts: ChartAtlas) -> None:
    first, second = repr(sphere_charts).splitlines()
    assert first == f"ChartAtlas({len(sphere_charts)} charts, COMPLETE,"
    assert second.strip().startswith("area 12.")
    assert second.endswith("Euler characteristic 2)")
    cut = replace(sphere_charts, outcome=Covering.CHART_LIMIT)
    assert repr(cut).endswith("Euler characteristic unknown)")
