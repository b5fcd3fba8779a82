"""The bank of surfaces is sound, and a quick sample of it comes out right."""

from dataclasses import replace

import numpy as np
import pytest

from studies.curve_bank import Verdict, changes_of
from studies.known_surfaces import (
    Piece,
    crossing_surfaces,
    load_surfaces,
    pairs_with_gaps,
)
from studies.surface_bank import judge, run_surface
from studies.surface_measures import area_along_lines, shape_on_grid

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


def test_random_planes_that_cross_come_out_with_their_lines():
    for known in list(crossing_surfaces(2, seed=1)):
        plain = next(changes_of(known.system))
        run = run_surface(known, plain, seed=0, budget=60.0)
        assert run.verdict is Verdict.RIGHT, run.answer
        other = replace(known, note="singular points of rank 0 form 3 open curves")
        assert judge(other, run.answer, 1.0) is Verdict.WRONG


# --- without charts -------------------------------------------------------------------

MEASURED = [
    "torus",
    "band of a sphere",
    "three parallel planes",
    "Schwarz P, nodal",
    pytest.param("gyroid, nodal", marks=pytest.mark.exhaustive),
    pytest.param("I-WP, nodal", marks=pytest.mark.exhaustive),
]


@pytest.mark.parametrize("name", MEASURED)
def test_areas_and_shapes_are_those_along_lines_and_on_a_grid(name):
    known = SURFACES[name]
    area = area_along_lines(known.system, 120, 4, np.random.default_rng(0))
    known_area = sum(piece.area for piece in known.pieces)
    assert area.value == pytest.approx(known_area, rel=1e-4)
    assert abs(area.value - known_area) < 6 * area.error + 1e-6 * known_area
    shape = shape_on_grid(known.system, 48)
    assert shape.pieces == len(known.pieces)
    assert shape.euler == sum(piece.euler for piece in known.pieces)


def test_areas_of_planes_in_a_cube_are_those_along_lines():
    for known in list(crossing_surfaces(2, seed=3)):
        (equation,) = known.system.equations
        planes = equation[1:-1].split(")*(")
        for plane, piece in zip(planes, known.pieces, strict=True):
            system = replace(known.system, equations=(plane,))
            area = area_along_lines(system, 120, 4, np.random.default_rng(0))
            assert area.value == pytest.approx(piece.area, rel=1e-2)
