"""Meshes of quadrilaterals: flat, folded, and against their closed form."""

import numpy as np
import pytest

import linkages
from bifurc import trace_branch
from linkages import Closure
from linkages.sheets.entries import MESHES
from linkages.sheets.quad_mesh import QuadMesh
from linkages.values import GeometryError


def lengths(points):
    """Those of the sides and the diagonals of all panels."""
    pairs = [
        (points[1:], points[:-1]),
        (points[:, 1:], points[:, :-1]),
        (points[1:, 1:], points[:-1, :-1]),
        (points[1:, :-1], points[:-1, 1:]),
    ]
    return np.concatenate([np.linalg.norm(a - b, axis=-1).ravel() for a, b in pairs])


@pytest.mark.parametrize("name", ["miura-ori", "lang-howell-mesh"])
@pytest.mark.parametrize("t", [0.1, 0.8, 6.0])
def test_panels_stay_what_they_are_in_every_folded_state(name, t):
    mesh = MESHES[name].mesh(rows=5, columns=4)
    # rotations are multiplied along ten panels
    assert lengths(mesh.folded(t)) == pytest.approx(lengths(mesh.flat), abs=1e-13)


def test_opposite_sectors_of_every_vertex_add_up_to_half_a_turn():
    mesh = MESHES["lang-howell-mesh"].mesh(rows=4, columns=5)
    flat = mesh.flat
    a, b = mesh.sectors
    for i, j in np.ndindex(a.shape):
        vertex = flat[i + 1, j + 1]
        beside = [
            flat[i + 2, j + 1],
            flat[i + 1, j + 2],
            flat[i, j + 1],
            flat[i + 1, j],
        ]
        angles = [np.arctan2(*(one - vertex)[::-1]) for one in beside]
        sectors = np.remainder(np.diff([*angles, angles[0]]), 2 * np.pi)
        expected = [a[i, j], b[i, j], np.pi - a[i, j], np.pi - b[i, j]]
        assert sectors == pytest.approx(expected, abs=1e-12)


def test_a_miura_ori_has_parallelograms_and_the_ratio_of_its_fold_angles():
    mesh = MESHES["miura-ori"].mesh(rows=3, columns=3, angle=np.radians(70))
    assert np.ptp(mesh.sectors[0] + mesh.sectors[1]) < 1e-14
    along, up = mesh.folds(0.5)
    ratio = np.tan(0.5 * along) / np.tan(0.5 * up[0, 0])
    assert abs(ratio) == pytest.approx(np.cos(np.radians(70)), abs=1e-14)


def test_the_form_of_a_mesh_is_its_closed_form_all_along():
    side = 4
    sheet = MESHES["lang-howell-mesh"]
    mechanism = sheet.build(rows=side, columns=side)
    problem = Closure(mechanism)
    branch = trace_branch(problem, problem.reference)
    mesh = sheet.mesh(rows=side, columns=side)
    angles = np.array([crease.angle for crease in mechanism.creases])
    names = [crease.joint.split("-") for crease in mechanism.creases]
    places = [sorted(divmod(int(end), side + 2) for end in ends) for ends in names]
    first = places.index([(0, 1), (1, 1)])
    for point in branch.sample(100):
        folds = point + angles
        along, up = mesh.folds(np.tan(0.5 * folds[first]) / mesh.columns[0])
        exact = [
            up[i - 1, j] if i == last_i else along[i, last_j - 1]
            for (j, i), (last_j, last_i) in places
        ]
        # a curve in 40 unknowns is within 5e-13 of closure; next to the flat state that
        # is some ten times farther from it
        gaps = np.remainder(folds - exact + np.pi, 2 * np.pi) - np.pi
        assert np.abs(gaps).max() < 1e-11


def test_thick_panels_of_miura_ori_fold_as_paper_does():
    sheet = MESHES["thick-miura-ori"]
    mechanism = sheet.build(rows=3, columns=3, thickness=0.3)
    (form,) = linkages.map_linkage(mechanism).forms
    thin = {crease.joint for crease in MESHES["miura-ori"].build().creases}
    angles = {crease.joint: crease.angle for crease in mechanism.creases}
    assert angles.keys() == thin
    folds = form.branch.sample(40)[5:-5] + np.array(list(angles.values()))
    half = np.abs(np.tan(0.5 * folds))
    ratios = half / half.max(axis=1, keepdims=True)
    smaller = np.cos(sheet.defaults["angle"])
    is_along = np.abs(ratios - smaller) < 1e-9
    assert np.all(is_along | (np.abs(ratios - 1.0) < 1e-9))
    assert np.all(is_along.sum(axis=1) == 12)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"rows": 2.5}, "rows: 2.5 is not allowed; it must be a whole number"),
        ({"columns": 0}, "columns: 0 is not allowed"),
        ({"fold": np.pi}, "fold: 180 is not allowed; it must be between 0 and 180"),
        ({"angle": 2.0}, "it must be between 0 and 90 degrees"),
    ],
)
def test_what_makes_no_sheet_is_named_in_one_line(values, words):
    with pytest.raises(GeometryError) as raised:
        linkages.load("miura-ori", **values)
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


def test_panels_that_cross_are_refused():
    rows = np.cos(np.radians(70)) * (1 + 0.3 * np.arange(6)) / 3
    signs = (-1.0) ** np.arange(6)
    sectors = np.radians(np.linspace(20, 160, 6))
    with pytest.raises(GeometryError):
        QuadMesh(signs * rows, signs, sectors, sectors[::-1])
