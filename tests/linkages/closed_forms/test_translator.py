"""Wohlhart's symmetric mechanism as a translator: the closed forms against closure,
geometry and measured values."""

import json
from pathlib import Path

import numpy as np
import pytest

from linkages.closed_forms.translator import (
    Stroke,
    contact_angle,
    joint_axes,
    joint_centres,
    meeting_points,
    plane_distance,
    slide,
    stroke_angles,
    upright,
)
from linkages.families.wohlhart import wohlhart_symmetric
from linkages.values import GeometryError

DATA = Path(__file__).parents[3] / "data" / "translator_samples.json"
MEASURED = json.loads(DATA.read_text(encoding="utf-8"))
TWISTS = (20, 60, 75, 90, 105, 120, 150, 170)
EXACT = 1e-12


def angles(sample):
    degrees = [sample["alpha_deg"], sample["theta_deg"], sample["phi_deg"]]
    return np.radians(degrees)


def test_the_closed_forms_give_the_42_measured_values():
    assert len(MEASURED["samples"]) == 42
    for sample in MEASURED["samples"]:
        alpha, theta, phi = angles(sample)
        centres = joint_centres(theta, phi, alpha)
        assert plane_distance(theta, phi, alpha) == pytest.approx(
            sample["H_over_a"], abs=EXACT
        )
        assert slide(theta) == pytest.approx(sample["b_over_a"], abs=EXACT)
        assert centres[2, 2] == pytest.approx(sample["z_O3_over_a"], abs=EXACT)
        odd = np.linalg.norm(centres[0] - centres[2])
        even = np.linalg.norm(centres[1] - centres[3])
        assert odd == pytest.approx(sample["side_O1O3_over_a"], abs=EXACT)
        assert even == pytest.approx(sample["side_O2O4_over_a"], abs=EXACT)


@pytest.mark.parametrize("stroke", Stroke)
def test_strokes_begin_end_and_lift_as_measured(stroke):
    for known in MEASURED["strokes"]:
        alpha = np.radians(known["alpha_deg"])
        theta, phi = stroke_angles(alpha, stroke, 2001)
        expected = known[stroke.value]
        start = np.degrees([theta[0], phi[0]])
        np.testing.assert_allclose(start, expected["start"], atol=1e-9)
        if "end" in expected:
            end = np.degrees([theta[-1], phi[-1]])
            np.testing.assert_allclose(end, expected["end"], atol=1e-6)
        highest = plane_distance(theta, phi, alpha).max()
        assert highest == pytest.approx(expected["Hmax_over_a"], abs=1e-6)


@pytest.mark.parametrize("stroke", Stroke)
@pytest.mark.parametrize("twist", TWISTS)
def test_every_configuration_of_a_stroke_closes_the_loop(twist, stroke):
    alpha = np.radians(twist)
    theta, phi = stroke_angles(alpha, stroke)
    loop = wohlhart_symmetric(1.0, alpha)
    errors = loop.closure_error(np.stack([theta, phi] * 3, axis=-1))
    # the arc cosine costs half the digits where the stroke is flat or folded
    assert errors.max() < 1e-7
    assert np.median(errors) < EXACT


def test_the_input_output_equation_is_a_square():
    rng = np.random.default_rng(3)
    for _ in range(50):
        alpha, x, y = rng.uniform(0, np.pi, 3)
        c = np.cos(alpha)
        printed = (
            np.cos(x) * np.cos(y) * (1 + c * c)
            + (np.cos(x) + np.cos(y)) * np.sin(alpha) ** 2
            - 2 * np.sin(x) * np.sin(y) * c
            + c * c
        )
        half = np.cos(x / 2) * np.cos(y / 2) - c * np.sin(x / 2) * np.sin(y / 2)
        assert printed == pytest.approx(4 * half**2 - 1, abs=EXACT)


def test_the_distance_is_that_of_parallel_planes_to_which_the_line_of_meetings_is_normal():
    alpha = np.radians(105)
    theta, phi = stroke_angles(alpha, Stroke.LONG, 41)
    theta, phi = theta[3:-3], phi[3:-3]
    centres = joint_centres(theta, phi, alpha, a=2.0)
    even, odd = meeting_points(theta, phi, alpha, a=2.0)
    distances = plane_distance(theta, phi, alpha, a=2.0)
    for points, line, distance in zip(centres, even - odd, distances, strict=True):
        level = upright(points, points)
        np.testing.assert_allclose(level[0::2, 2], 0, atol=EXACT)
        np.testing.assert_allclose(level[1::2, 2], distance, atol=EXACT)
        turned = upright(np.stack([0 * line, line]), points)
        direction = turned[1] - turned[0]
        np.testing.assert_allclose(direction[:2], 0, atol=1e-10)


def test_the_odd_joints_slide_on_three_lines():
    alpha = np.radians(90)
    theta, phi = stroke_angles(alpha, Stroke.SHORT, 21)
    for k in range(1, 20):
        centres = joint_centres(theta[k], phi[k], alpha)
        radius = np.linalg.norm(upright(centres, centres)[0])
        assert radius == pytest.approx(2 / np.sqrt(3) - slide(theta[k]), abs=EXACT)


def test_axes_pass_through_their_meeting_points():
    alpha = np.radians(120)
    theta, phi = np.array([np.radians(60)]), np.array([np.radians(144.82409245201245)])
    centres = joint_centres(theta, phi, alpha)[0]
    axes = joint_axes(theta, phi, alpha)[0]
    even, odd = (point[0] for point in meeting_points(theta, phi, alpha))
    for k in range(6):
        meeting = even if k % 2 else odd
        across = np.cross(meeting - centres[k], axes[k])
        np.testing.assert_allclose(across, 0, atol=EXACT)


def test_thin_links_touch_where_the_even_joints_meet():
    assert contact_angle(np.radians(90)) is None
    assert np.degrees(contact_angle(np.radians(150))) == pytest.approx(
        70.528779, abs=1e-6
    )
    assert contact_angle(np.radians(120)) == pytest.approx(np.pi, abs=1e-7)
    touch = contact_angle(np.radians(150))
    centres = joint_centres(touch, np.pi, np.radians(150))
    np.testing.assert_allclose(centres[1], centres[3], atol=EXACT)
    np.testing.assert_allclose(centres[1], centres[5], atol=EXACT)


@pytest.mark.parametrize("alpha", [0.0, np.pi, -1.0, np.nan])
def test_a_twist_that_makes_no_mechanism_is_refused(alpha):
    with pytest.raises(GeometryError, match="twist alpha"):
        stroke_angles(alpha, Stroke.SHORT)
