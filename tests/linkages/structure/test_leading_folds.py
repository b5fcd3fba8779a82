"""Ways out of the flat state of a sheet, and that there are none, beside the bird's foot,
least squares and maps."""

from itertools import permutations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial import Delaunay

import linkages
from linkages.app.answer.verdict import judge
from linkages.closure.closure import Closure
from linkages.structure.flat_boxes import first_fold
from linkages.structure.flat_sheet import FlatVertex
from linkages.structure.fold_modes import ways_by_modes
from linkages.structure.leading_folds import LeadingFolds
from linkages.structure.structure import Structure
from linkages.subject import as_subject
from studies.miura import miura
from tests.linkages.files.test_fold import has_birds_foot, read
from tests.linkages.files.test_rounded_creases import twist
from tests.linkages.structure.test_flat_sheet import random_vertex, sheet_of
from tests.samples import one_in


def random_sheet(rng, tmp_path):
    """Triangles about 2 to 4 inner vertices, assigned so that some vertices may fold."""
    while True:
        turns = np.sort(rng.uniform(0.0, 2 * np.pi, size=rng.integers(5, 8)))
        if np.diff([*turns, turns[0] + 2 * np.pi]).max() < 2.2:
            break
    rim = 2.0 * np.transpose([np.cos(turns), np.sin(turns)])
    inner = rng.uniform(-0.9, 0.9, size=(rng.integers(2, 5), 2))
    triangles = Delaunay(np.concatenate([rim, inner]))
    hull = {tuple(sorted(edge)) for edge in triangles.convex_hull.tolist()}
    sides = [
        tuple(sorted((face[k], face[k - 1])))
        for face in triangles.simplices.tolist()
        for k in range(3)
    ]
    edges = list(dict.fromkeys(sides))
    while True:
        letters = ["B" if edge in hull else rng.choice(["M", "V"]) for edge in edges]
        sheet = sheet_of(tmp_path, triangles.points.tolist(), edges, letters)
        if not Structure(sheet).is_held_flat:
            return sheet


def folds_of(turns, signs):
    directions = np.transpose([np.cos(turns), np.sin(turns)])
    return LeadingFolds([FlatVertex(tuple(range(len(turns))), directions)], signs)


def test_derivatives_are_those_of_differences():
    rng = np.random.default_rng(0)
    turns, signs = random_vertex(rng, has_line=False)
    directions = np.transpose([np.cos(turns), np.sin(turns)])
    last = len(turns) - 1
    vertices = [
        FlatVertex(tuple(range(last + 1)), directions),
        FlatVertex((last, last + 1, last + 2), directions[:3]),
    ]
    folds = LeadingFolds(vertices, np.append(signs, [1, 1]))
    angles = rng.uniform(-1.0, 1.0, size=last + 3)
    steps = np.eye(last + 3)  # the equations are quadratic
    differences = [
        0.5 * (folds.residuals(angles + step) - folds.residuals(angles - step))
        for step in steps
    ]
    assert np.allclose(folds.jacobian(angles), np.transpose(differences), atol=1e-14)


@pytest.mark.parametrize("seed", one_in(10, range(20)))
def test_a_vertex_has_no_fold_if_it_has_no_birds_foot(seed):
    rng = np.random.default_rng(seed)
    for _ in range(25):
        turns, signs = random_vertex(rng, has_line=False)
        folds = folds_of(turns, signs)
        angles, is_none = first_fold(folds)
        assert is_none != has_birds_foot(turns, signs.tolist())
        if angles is not None:
            assert np.abs(folds.residuals(angles)).max() < 1e-10
            assert (angles * signs >= 0.0).all()


@pytest.mark.parametrize("seed", one_in(20, range(60)))
def test_a_flat_state_is_left_or_isolated(seed, tmp_path):
    """Where it is told to be isolated no small fold within the assignment closes, from
    random starts; where a way leads out of it, that closes."""
    rng = np.random.default_rng(seed)
    problem = Closure(random_sheet(rng, tmp_path))
    ways, is_isolated = problem.flat_state
    low, high = problem.domain.bounds.T
    for way in ways:
        assert np.abs(problem.residuals(way.point[None])).max() < 1e-13
        assert (way.point >= low).all() and (way.point <= high).all()
        assert np.array_equal(way.point == 0.0, way.rest)
        assert 0.01 < np.abs(way.point).max() < 0.6
    if is_isolated:
        missed = []
        for start in rng.uniform(low / np.pi, high / np.pi, size=(20, problem.n)):
            end = least_squares(
                lambda u: np.append(problem.residuals(u[None])[0], u @ u - 0.01),
                0.1 * start / np.linalg.norm(start),
                bounds=(low - 1e-15, high + 1e-15),
            )
            missed.append(np.linalg.norm(end.fun))
        assert min(missed) > 1e-6


def test_what_folds_in_a_way_out_is_mapped_with_the_others_at_rest(tmp_path):
    sheet = random_sheet(np.random.default_rng(25), tmp_path)
    simpler = as_subject(sheet).simpler()
    at_rest = simpler.mechanism.at_rest
    assert at_rest and simpler.readout.structure.held >= set(at_rest)
    assert simpler.readout.structure.ways_out is None
    atlas = linkages.map_linkage(simpler.mechanism)
    assert linkages.mechanism_of(atlas).at_rest == at_rest
    assert any("held flat" in one.text for one in atlas.completeness.doubts)
    assert " at least" in judge(atlas).sentence
    (surface,) = atlas.surfaces
    readout = simpler.readout
    names = readout.labels()
    values = readout.values(surface.samples)
    assert not values[:, [names.index(one) for one in at_rest]].any()
    whole = Closure(sheet)
    columns = [names.index(one.label) for one in whole.structure.unknowns]
    assert np.abs(whole.residuals(values[:, columns])).max() < 1e-9


def test_a_line_that_cannot_fold_as_a_whole_is_held(tmp_path):
    """Its signs do not agree across the crease between that folds either way."""
    corners = [(i, j) for j in range(4) for i in range(4)]
    across = [(4 * j + i, 4 * j + i + 1) for j in range(4) for i in range(3)]
    upright = [(4 * j + i, 4 * j + i + 4) for j in range(3) for i in range(4)]
    letters = dict.fromkeys([*across, *upright], "B")
    letters.update(zip([(4, 5), (5, 6), (6, 7)], "MUV", strict=True))
    letters.update(zip([(8, 9), (9, 10), (10, 11)], "MUM", strict=True))
    inner = [pair for pair in upright if pair[0] % 4 in (1, 2)]
    letters.update(zip(inner, "MMVVMM", strict=True))
    sheet = sheet_of(tmp_path, corners, list(letters), list(letters.values()))
    structure = Structure(sheet)
    assert {"4-5", "5-6", "6-7"} < set(structure.stay_flat)
    assert structure.ways_out == 1


@pytest.mark.parametrize("order", list(permutations(range(4))))
def test_what_rests_first_rests_in_whatever_order_vertices_come(order):
    """A triangle of vertices of four creases, on one side of which is a vertex of a line:
    it would have to fold by the same angle on both sides, and does so in no way."""
    creases = [(8, 6), (0, 9, 5, 1), (4, 10, 8, 5), (6, 9, 11, 7)]
    turns = [
        (176.6737, -3.3263),
        (147.809, 29.8143, -34.1964, -142.191),
        (-131.0027, 138.9973, 28.9973, -28.9973),
        (149.7421, -152.2633, -55.2579, 39.7421),
    ]
    vertices = []
    for k in order:
        along = np.radians(turns[k])
        directions = np.transpose([np.cos(along), np.sin(along)])
        vertices.append(FlatVertex(creases[k], directions))
    assert not len(ways_by_modes(vertices, np.zeros(12, dtype=int)))


def test_a_sheet_whose_vertices_fold_one_by_one_and_not_together_is_rigid(tmp_path):
    sheet = random_sheet(np.random.default_rng(6), tmp_path)
    structure = Structure(sheet)
    assert not structure.stay_flat
    problem = Closure(sheet)
    assert problem.flat_state.is_isolated
    seeds = problem.seeds(np.random.default_rng(0), 1000, None)
    assert seeds.know_isolated(problem.reference)
    atlas = linkages.map_linkage(sheet)
    assert len(atlas.rigid) == 1 and not (atlas.forms or atlas.surfaces or atlas.points)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_ways_out_of_miura_ori_are_counted(k, tmp_path):
    """All straight lines fold with some of the zigzags, or one of them by itself."""
    sheet = read(tmp_path, miura(k + 1, k + 1))
    assigned = Structure(sheet)
    free = Structure(sheet.with_free_creases())
    assert len(free.ways_by_modes) == 2**k + k - 1
    (way,) = assigned.ways_by_modes
    assert np.array_equal(np.sign(way), assigned.fold_signs)
    folds = LeadingFolds(free.flat_vertices, free.fold_signs)
    missed = [folds.residuals(fold)[:-1] for fold in free.ways_by_modes]
    assert np.abs(missed).max() < 1e-13


def test_every_way_out_of_miura_ori_closes(tmp_path):
    problem = Closure(read(tmp_path, miura(4, 4)).with_free_creases())
    ways = problem.flat_state.ways
    assert len(ways) == 2**3 + 3 - 1
    points = np.array([way.point for way in ways])
    assert np.abs(problem.residuals(points)).max() < 1e-14


def test_a_large_flat_sheet_is_followed_along_its_way_out(tmp_path):
    sheet = read(tmp_path, miura(9, 9))
    (form,) = linkages.map_linkage(sheet).forms
    ends = form.branch(np.array([0.0, form.branch.length]))
    assert np.abs(ends).min(axis=0).max() < 1e-6  # flat at one end
    assert np.abs(ends).max(axis=0).min() > np.pi - 1e-6  # and folded flat
    assert len(ends[0]) == 144


def test_vertices_of_more_creases_have_no_modes():
    turns = np.arange(6) * np.pi / 3
    folds = folds_of(turns, np.ones(6, dtype=int))
    assert ways_by_modes(folds.vertices, folds.signs) is None


def test_a_square_twist_that_turns_one_way_round_is_isolated(tmp_path):
    """Its vertices have modes that fold as assigned, which do not agree all round."""
    content = twist(np.random.default_rng(0))
    content["edges_assignment"] = [*"MMMMVVVVMMMMBBBBBBBB"]
    problem = Closure(read(tmp_path, content))
    structure = problem.structure
    assert structure.ways_by_modes is not None and not structure.stay_flat
    assert problem.flat_state.is_isolated
