"""Planes of two unknowns: lines break only where they leave the frame, and the plane
that is chosen tells forms apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.figures.planes import (
    Scale,
    choose_plane,
    copies_in_frame,
    cut_to_frame,
    place_in_frame,
    plane_of,
    scale_of,
)
from bifurc.figures.quantities import quantity_of
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings

TORUS = (Scale(180 / np.pi, 180.0, "x"), Scale(180 / np.pi, 180.0, "y"))
PLAIN = (Scale(1.0, np.inf, "x"), Scale(1.0, np.inf, "y"))


def pieces_of(rows: np.ndarray) -> list[np.ndarray]:
    """The unbroken stretches of a line."""
    broken = np.flatnonzero(np.isnan(rows[:, 0]))
    return [
        part[~np.isnan(part[:, 0])] for part in np.split(rows, broken) if len(part) > 1
    ]


# --- lines on the torus ---------------------------------------------------------------


def test_a_line_is_broken_where_it_leaves_the_frame_and_nowhere_else() -> None:
    s = np.linspace(0.0, 4 * np.pi, 301)
    parts = pieces_of(cut_to_frame(np.stack([s + 1.0, 0.5 * np.sin(s)], axis=1), TORUS))
    for part in parts:
        assert np.abs(part).max() <= 180 * (1 + 1e-8)
        assert np.linalg.norm(np.diff(part, axis=0), axis=1).max() < 5
        assert part[0, 0] == pytest.approx(-180) or part[0, 0] == pytest.approx(
            np.rad2deg(1.0)
        )
    drawn = sum(np.abs(np.diff(part[:, 0])).sum() for part in parts)
    assert drawn == pytest.approx(720)


def test_a_line_along_the_edge_is_drawn_on_both_edges() -> None:
    s = np.linspace(-np.pi, np.pi, 101)
    parts = pieces_of(cut_to_frame(np.stack([s, np.full(101, np.pi)], axis=1), TORUS))
    assert sorted(round(part[0, 1]) for part in parts) == [-180, 180]


def test_a_closed_curve_inside_the_frame_stays_in_one_piece() -> None:
    t = np.linspace(0, 2 * np.pi, 100)
    for scales in (TORUS, PLAIN):
        rows = np.stack([np.cos(t), np.sin(t)], axis=1)
        (part,) = pieces_of(cut_to_frame(rows, scales))
        np.testing.assert_allclose(part, rows * scales[0].factor, atol=1e-12)


def test_a_point_at_pi_is_drawn_at_both_edges_and_a_corner_at_all_four() -> None:
    spots = place_in_frame(
        np.array([[3 * np.pi, 0.5], [-np.pi, np.pi], [0.1, -7.0]]), TORUS
    )
    np.testing.assert_allclose(spots[0], [180, np.rad2deg(0.5)])
    assert [len(copies_in_frame(spot, TORUS)) for spot in spots] == [2, 4, 1]
    np.testing.assert_allclose(spots[2], np.rad2deg([0.1, 2 * np.pi - 7.0]))


def test_a_point_next_to_the_lower_edge_is_placed_on_the_upper_one() -> None:
    error = 1e-8
    spots = place_in_frame(np.array([[-np.pi + error, np.pi - error]]), TORUS)
    np.testing.assert_allclose(spots, 180.0)
    inside = place_in_frame(np.array([[-3.1, 3.1]]), TORUS)
    np.testing.assert_allclose(inside, np.rad2deg([[-3.1, 3.1]]))


# --- the choice of a plane ------------------------------------------------------------


def test_the_plane_avoids_a_constant_unknown(parallelogram: Atlas) -> None:
    assert choose_plane(parallelogram) == (0, 1)


def test_the_plane_tells_forms_apart_that_look_alike_in_others(circle: Atlas) -> None:
    def lines(u: np.ndarray) -> np.ndarray:
        return np.array([u[0] - u[1], u[2] ** 2 - 1.0])

    atlas = explore(
        FunctionProblem(lines, [[-2, 2]] * 3), settings=SearchSettings(starts=20)
    )
    assert len(atlas.forms) == 2 and 2 in choose_plane(atlas)


def test_the_plane_shows_no_form_as_a_line_that_goes_there_and_back() -> None:
    def closure(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        return np.array([x**2 + (3 * z) ** 2 - 1, y + 0.9 * x + 0.05 * x**3])

    atlas = explore(
        FunctionProblem(closure, [[-2, 2]] * 3), settings=SearchSettings(starts=20)
    )
    assert len(atlas.forms) == 1 and 2 in choose_plane(atlas)


def test_lengths_are_shown_in_the_unit_of_the_user_where_it_is_known(
    circle: Atlas,
) -> None:
    sized = replace(circle, units=("", "size"))
    assert scale_of(sized, 1) == Scale(1.0, np.inf, "y (size)")
    scaled = replace(sized, subject={"scale": [1.0, 0.8]})
    assert scale_of(scaled, 1) == Scale(0.8, np.inf, "y (lengths)")
    quantity = quantity_of(scaled, "y")
    assert quantity.label == "y (lengths)"
    assert quantity.values(np.array([[7.0, -1.5]])) == pytest.approx([-1.2])


def test_angles_without_a_period_are_shown_in_degrees(circle: Atlas) -> None:
    scale = scale_of(replace(circle, units=("", "rad")), 1)
    assert scale == Scale(180 / np.pi, np.inf, "y (deg)")


def test_angles_are_shown_in_degrees_and_other_units_as_they_are(
    parallelogram: Atlas, circle: Atlas
) -> None:
    assert scale_of(parallelogram, 0).label == "θ₁ (deg)" and scale_of(
        parallelogram, 0
    ).half == pytest.approx(180)
    assert scale_of(circle, 1) == Scale(1.0, np.inf, "y (m)")


def test_a_plane_shows_a_point_where_its_scales_say(parallelogram: Atlas) -> None:
    plane = plane_of(parallelogram, 2, 0)
    point = np.array([np.pi, 9.0, 0.5])
    np.testing.assert_allclose(plane.spot(point), [np.rad2deg(0.5), 180.0])
    assert len(plane.copies(point)) == 2
