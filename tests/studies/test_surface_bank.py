"""The bank of surfaces is sound, and a quick sample of it comes out right."""

from dataclasses import replace

import numpy as np
import pytest

from studies.curve_bank import Verdict, changes_of
from studies.surface_bank import (
    Piece,
    judge,
    load_surfaces,
    pairs_with_gaps,
    run_surface,
)

SURFACES = {known.name: known for known in load_surfaces()}
SAMPLE = [
    ("sphere cut by a bound", "unknowns 0.001"),
    ("cap of height 1e-3 inside a bound", "shifted"),
    ("sphere that touches its bounds", "first equation 1e+06"),
    ("hyperboloid of two sheets", "plain"),
    ("three parallel planes", "last unknown 1000"),
    ("cone", "plain"),
    ("paraboloid", "unknowns 1e+06"),
]


@pytest.mark.parametrize(("name", "change"), SAMPLE)
def test_a_surface_of_the_bank_comes_out_right_in_any_units(name, change):
    known = SURFACES[name]
    (chosen,) = [c for c in changes_of(known.system) if c.name == change]
    run = run_surface(known, chosen, seed=0, budget=60.0)
    assert run.verdict is Verdict.RIGHT, run.answer


def test_another_number_shape_or_area_without_a_doubt_is_wrong():
    known = SURFACES["plane"]
    plain = next(changes_of(known.system))
    found = run_surface(known, plain, seed=0, budget=60.0).answer
    for pieces in ((), (Piece(2, 6.0),), (Piece(1, 6.001),), (Piece(1, 3.0),) * 2):
        other = replace(known, pieces=pieces)
        assert judge(other, found, 1.0) is Verdict.WRONG
        assert judge(other, found._replace(doubt=True), 1.0) is Verdict.IN_DOUBT


def test_every_pair_has_two_pieces_and_its_gap():
    pairs = list(pairs_with_gaps(50, seed=0))
    assert len({pair.name for pair in pairs}) == 50
    for pair in pairs:
        assert len(pair.pieces) == 2
        assert np.all(pair.system.bounds[:, 0] < pair.system.bounds[:, 1])


# --- areas by another quadrature ------------------------------------------------------

TURN = 2 * np.pi
LINES = 200  # each way


def _schwarz_p(x, y, z):
    return np.array([-np.sin(x), -np.sin(y), -np.sin(z)])


def _gyroid(x, y, z):
    turned = [(x, y, z), (y, z, x), (z, x, y)]
    return np.array(
        [np.cos(a) * np.cos(b) - np.sin(c) * np.sin(a) for a, b, c in turned]
    )


@pytest.mark.parametrize(
    ("name", "gradient"),
    [("Schwarz P, nodal", _schwarz_p), ("gyroid, nodal", _gyroid)],
)
def test_areas_of_periodic_surfaces_are_those_along_lines(name, gradient):
    """Every line along an unknown crosses the surface where a sine is zero; over all
    lines of the three directions the crossings are weighted by a partition of unity."""
    known = SURFACES[name]
    function = known.system.function()
    places = (np.arange(LINES) + 0.37) * TURN / LINES
    a, b = np.meshgrid(places, places + 0.11)
    area = 0.0
    for axis in range(3):
        values = []
        for angle in (0.0, np.pi / 2, np.pi):
            values.append(function(np.insert([a, b], axis, angle, axis=0))[0])
        mean = (values[0] + values[2]) / 2
        cosine, sine = values[0] - mean, values[1] - mean
        with np.errstate(invalid="ignore", divide="ignore"):
            aside = np.arccos(-mean / np.hypot(cosine, sine))
        for sign in (-1, 1):
            crossing = np.arctan2(sine, cosine) + sign * aside
            normal = gradient(*np.insert([a, b], axis, crossing, axis=0))
            normal /= np.linalg.norm(normal, axis=0)
            weights = normal[axis] ** 8 / (normal**8).sum(axis=0)
            area += np.nansum(weights / np.abs(normal[axis])) * (TURN / LINES) ** 2
    (piece,) = known.pieces
    assert piece.area == pytest.approx(area, rel=1e-9)
