"""Crease patterns that repeat: flat vertices, ways out of flat, and their closed form."""

from itertools import pairwise

import numpy as np
import pytest

import linkages
from linkages import Closure
from linkages.sheets.entries import PATTERNS
from linkages.structure.structure import Structure
from linkages.values import GeometryError

FLAT_FOLDABLE = ["waterbomb", "square-twist", "kokotsakis-tiling"]
OF_FOUR_CREASES = ["square-twist", "kokotsakis-tiling"]
TRIANGULATED = {"waterbomb": 3, "resch": 4}  # vertices of a cell


def pattern(name, rows, columns, **values):
    """The vertices (v, 2) of a pattern, its inner ones, and the directions in which
    creases leave each of these, in order, with their letters."""
    content = PATTERNS[name].fold_content(rows=rows, columns=columns, **values)
    points = np.array(content["vertices_coords"])
    around = {k: [] for k in range(len(points))}
    for ends, letter in zip(
        content["edges_vertices"], content["edges_assignment"], strict=True
    ):
        for start, end in (ends, ends[::-1]):
            turn = np.arctan2(*(points[end] - points[start])[::-1])
            around[start].append((turn, letter))
    inner = {
        k: sorted(one) for k, one in around.items() if "B" not in {x for _, x in one}
    }
    return content, points, inner


@pytest.mark.parametrize("name", PATTERNS)
def test_its_inner_vertices_are_those_of_its_cells(name):
    content, points, inner = pattern(name, 2, 3)
    assert len(inner) == 6 * len(PATTERNS[name].points)
    corners, edges = len(points), len(content["edges_vertices"])
    assert corners - edges + len(content["faces_vertices"]) == 1


@pytest.mark.parametrize("name", FLAT_FOLDABLE)
def test_every_vertex_folds_flat_as_it_is_assigned(name):
    """Its sectors add up to half a turn in turn (Kawasaki), and there are two more of
    one letter (Maekawa)."""
    _, _, inner = pattern(name, 2, 2)
    for creases in inner.values():
        turns = [turn for turn, _ in creases]
        sectors = np.diff([*turns, turns[0] + 2 * np.pi])
        assert np.sum(sectors[::2]) == pytest.approx(np.pi, abs=1e-12)
        letters = [letter for _, letter in creases]
        assert abs(letters.count("M") - letters.count("V")) == 2


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (1, 2), (2, 2), (2, 3), (3, 3)])
def test_the_ways_out_of_square_twists_are_counted(rows, columns):
    sheet = linkages.load("square-twist", rows=rows, columns=columns)
    free = Structure(sheet.with_free_creases())
    assert len(free.ways_by_modes) == 4**rows + 4**columns - 2
    (way,) = Structure(sheet).ways_by_modes
    assert np.array_equal(np.sign(way), Structure(sheet).fold_signs)


@pytest.mark.parametrize("name", OF_FOUR_CREASES)
def test_every_way_keeps_the_ratios_of_its_half_tangents(name):
    """At flat vertices of four creases that fold flat, the half tangents of fold angles
    are those of leading order, all the way."""
    problem = Closure(linkages.load(name, rows=2, columns=2).with_free_creases())
    ways = problem.structure.ways_by_modes
    for t in (0.1, 1.0, 20.0):
        folds = 2.0 * np.arctan(t * ways)
        points = folds[:, list(problem.structure.column_of)]
        assert np.abs(problem.residuals(points)).max() < 1e-12


@pytest.mark.parametrize("name", TRIANGULATED)
def test_triangles_move_with_as_many_freedoms_as_there_are_creases_too_many(name):
    problem = Closure(linkages.load(name, rows=1, columns=1))
    (way,) = problem.flat_state.ways
    rank = np.linalg.matrix_rank(problem.jacobians(way.point[None])[0], tol=1e-9)
    assert rank == 3 * TRIANGULATED[name]


def test_a_square_twist_moves_from_flat_to_flat_as_its_closed_form_says():
    sheet = linkages.load("square-twist")
    (form,) = linkages.map_linkage(sheet).forms
    problem = Closure(sheet)
    (way,) = problem.structure.ways_by_modes
    way = way[list(problem.structure.column_of)]
    points = form.branch.sample(50)
    half = np.tan(points[5:-5] / 2)
    ratios = half / way
    assert np.ptp(ratios, axis=1) == pytest.approx(0.0, abs=1e-8 * ratios.max())
    assert sorted(np.abs(points[[0, -1]]).max(axis=1)) == pytest.approx([0.0, np.pi])


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("waterbomb", {"rows": 0}, "rows: 0 is not allowed; it must be a whole number"),
        (
            "square-twist",
            {"twist": 2.0},
            "twist: 114.592 is not allowed; it must be from",
        ),
        (
            "square-twist",
            {"size": 0.6},
            "size: 0.6 is not allowed; it must be from 0.1 to",
        ),
        ("kokotsakis-tiling", {"A": 0.1}, "it must be from 40 to 80 degrees"),
    ],
)
def test_what_makes_no_pattern_is_named_in_one_line(name, values, words):
    with pytest.raises(GeometryError) as raised:
        linkages.load(name, **values)
    assert words in str(raised.value)


def test_the_corners_of_parameters_make_panels_that_do_not_cross():
    for name in PATTERNS:
        angles = [
            p for p in PATTERNS[name].parameters if p.name not in ("rows", "columns")
        ]
        for one, other in pairwise([*angles, *angles[:1]]):
            for x in (one.low, one.high):
                for y in (other.low, other.high):
                    values = {one.name: x, other.name: y}
                    _, _, inner = pattern(name, 1, 1, **values)
                    assert len(inner) == len(PATTERNS[name].points), values
