"""Which creases of a flat sheet stay flat, beside the bird's foot and beside samples."""

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import least_squares

import linkages
from bifurc import Level
from linkages.closure.closure import Closure
from linkages.structure.flat_sheet import creases_that_fold
from linkages.structure.structure import Structure
from tests.linkages.files.test_fold import has_birds_foot, read, vertex_of
from tests.samples import one_in


def random_vertex(rng, has_line):
    """Directions of 4 to 8 creases, two of them along a line if it ``has_line``, and
    their signs."""
    while True:
        turns = rng.uniform(0.0, 2 * np.pi, size=rng.integers(4, 9))
        if has_line:
            turns[1] = (turns[0] + np.pi) % (2 * np.pi)
        turns = np.sort(turns)
        gaps = np.diff([*turns, turns[0] + 2 * np.pi])
        if gaps.min() > 0.05 and gaps.max() < np.pi - 0.05:
            return turns, rng.choice([-1, 1], size=len(turns))


def folding(turns, signs):
    return creases_that_fold(np.transpose([np.cos(turns), np.sin(turns)]), signs)


@pytest.mark.parametrize("seed", one_in(10, range(20)))
def test_a_vertex_folds_if_it_has_a_birds_foot(seed):
    rng = np.random.default_rng(seed)
    for _ in range(100):
        turns, signs = random_vertex(rng, has_line=False)
        folds = folding(turns, signs)
        assert folds.all() == folds.any() == has_birds_foot(turns, signs.tolist())


def lines_of(turns, signs):
    """The pairs of creases along a line that fold the same way."""
    return [
        (i, j)
        for i, j in combinations(range(len(turns)), 2)
        if signs[i] == signs[j] and abs(abs(turns[i] - turns[j]) - np.pi) < 1e-9
    ]


@pytest.mark.parametrize("seed", one_in(10, range(20)))
def test_no_state_nearby_has_a_crease_folded_that_stays_flat(seed, tmp_path):
    """Each of them is folded a little, and the others are to close that as assigned."""
    rng = np.random.default_rng(seed)
    while True:
        turns, signs = random_vertex(rng, has_line=True)
        folds = folding(turns, signs)
        if lines_of(turns, signs) and not folds.all():
            break
    letters = ["V" if sign > 0 else "M" for sign in signs]
    sheet = read(tmp_path, vertex_of(turns, letters))
    problem = Closure(replace(sheet, with_flat_creases=True))
    for crease in np.flatnonzero(~folds).tolist():
        lowest = np.zeros(len(turns))
        lowest[crease] = 0.05
        missed = []
        for start in rng.uniform(0.05, 0.5, size=(8, len(turns))):
            end = least_squares(
                lambda u: problem.residuals((signs * u)[None])[0],
                np.maximum(start, lowest + 1e-3),
                bounds=(lowest, 0.6),
                xtol=1e-14,
                ftol=1e-14,
                gtol=1e-14,
            )
            missed.append(np.abs(end.fun).max())
        assert min(missed) > 1e-6
    # and the line folds by itself
    line = np.zeros(len(turns))
    line[list(lines_of(turns, signs)[0])] = 0.3
    assert folds[line > 0.0].all()
    assert np.abs(problem.residuals((signs * line)[None])).max() < 1e-15


def sheet_of(tmp_path, vertices, creases, letters):
    """A sheet without faces, from its creases and letters, "B" for the boundary."""
    path = tmp_path / "sheet.fold"
    content = {
        "vertices_coords": vertices,
        "edges_vertices": creases,
        "edges_assignment": letters,
    }
    path.write_text(json.dumps(content))
    return linkages.load(path)


# a square twist would begin at either of two vertices side by side; 6 is in neither
CORNERS = [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1), (3, 1)]
CORNERS += [(0, 2), (1, 2), (2, 2), (3, 2)]
RIM = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 7),
    (7, 11),
    (11, 10),
    (10, 9),
    (9, 8),
    (8, 4),
    (4, 0),
]
INNER = [(1, 5), (5, 9), (2, 6), (6, 10), (4, 5), (5, 6), (6, 7)]


@pytest.mark.parametrize(
    ("letters", "flat"),
    [
        # at one vertex three of four fold the other way: nothing but the line above it,
        ("MVVVVVV", {"1-5", "5-9"}),
        # and where the crease between the two is held, its line is
        ("MVMVVVM", None),
    ],
)
def test_what_stays_flat_at_one_vertex_is_no_crease_at_the_next(
    tmp_path, letters, flat
):
    kinds = ["B"] * len(RIM) + list(letters)
    sheet = sheet_of(tmp_path, CORNERS, RIM + INNER, kinds)
    structure = Structure(sheet)
    whole = Structure(replace(sheet, with_flat_creases=True))
    assert not whole.stay_flat
    if flat is None:
        assert structure.is_held_flat
        assert len(structure.unknowns) == len(whole.unknowns) == len(INNER)
    else:
        assert set(structure.stay_flat) == flat
        assert len(structure.unknowns) == len(INNER) - len(flat)
        assert structure.held == flat


def test_a_sheet_that_is_held_flat_is_rigid_at_once(tmp_path):
    kinds = ["B"] * len(RIM) + list("MVMVVVM")
    sheet = sheet_of(tmp_path, CORNERS, RIM + INNER, kinds)
    seeds = Closure(sheet).seeds(np.random.default_rng(0), 1000, None)
    assert not seeds.random.any() and seeds.more is None
    assert seeds.know_isolated(Closure(sheet).reference)
    atlas = linkages.map_linkage(sheet)
    assert np.array_equal(atlas.rigid, np.zeros((1, len(INNER))))
    # of so few creases folded states are built as well: one motion begins folded over
    assert atlas.forms[0].branch.sample(9).max() == pytest.approx(np.pi)


def test_what_is_held_flat_is_said_and_leaves_the_answer_estimated(tmp_path):
    kinds = ["B"] * len(RIM) + list("MVVVVVV")
    sheet = sheet_of(tmp_path, CORNERS, RIM + INNER, kinds)
    completeness = linkages.map_linkage(sheet).completeness
    assert completeness.level is Level.ESTIMATED
    assert any("2 creases stay flat" in claim.text for claim in completeness.claims)


def test_an_atlas_without_the_word_has_all_creases_as_unknowns(tmp_path):
    """As those have that were written before any was held."""
    kinds = ["B"] * len(RIM) + list("MVVVVVV")
    atlas = linkages.map_linkage(sheet_of(tmp_path, CORNERS, RIM + INNER, kinds))
    assert linkages.mechanism_of(atlas).with_flat_creases is False
    del atlas.subject["mechanism"]["with_flat_creases"]
    assert linkages.mechanism_of(atlas).with_flat_creases is True
