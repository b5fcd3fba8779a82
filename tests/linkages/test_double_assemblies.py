"""Assemblies that come together, and motions too small to be seen."""

import math

import numpy as np
import pytest

from bifurc.atlas import Kind
from bifurc.completeness import Level
from linkages.app.answer.document import make_document
from linkages.app.answer.verdict import judge
from linkages.axes import loop_from_axes
from linkages.loop import Loop
from tests.maps import map_of
from tests.samples import one_in


def loop_with_double_assembly(draw, opening=0.0):
    """Five random axes and a sixth in their linear complex: the six screws depend on
    each other, so that two assemblies come together. The ``opening`` (rad) turns the
    sixth axis out of it."""
    rng = np.random.default_rng(draw)
    points = rng.normal(size=(6, 3))
    directions = rng.normal(size=(6, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    moments = np.cross(points, directions)
    _, _, right = np.linalg.svd(np.hstack([directions, moments])[:5])
    force, couple = np.split(right[-1], 2)
    normal = force + np.cross(couple, points[5])
    within = np.cross(normal, rng.normal(size=3))
    within /= np.linalg.norm(within)
    directions[5] = within + opening * normal / np.linalg.norm(normal)
    return loop_from_axes(points, directions)[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_double_assembly_is_one_and_in_doubt(seed):
    atlas = map_of(loop_with_double_assembly(5), seed=seed)
    assert len(atlas.rigid) == 4
    (point,) = atlas.points
    assert point.kind is Kind.ISOLATED
    assert point.point.rank == 5
    assert point.point.error < 1e-9
    assert atlas.completeness.level is Level.ESTIMATED
    assert "a double solution from two, or none: S1" in atlas.completeness.statement
    assert "5 isolated assemblies, 1 of them shaky" in judge(atlas).sentence
    document = make_document(atlas)
    assert len(document["rigid_assemblies"]) == 5
    (other,) = document["other_singular_points"]
    assert other["kind"] == "isolated"
    assert other["theta"] == document["rigid_assemblies"][-1]


@pytest.mark.parametrize(
    ("opening", "rigid", "double"), [(1e-5, 6, 0), (1e-6, 6, 0), (1e-7, 4, 1)]
)
def test_two_assemblies_are_told_apart_or_said_to_be_in_doubt(opening, rigid, double):
    # the two lie 2.7 openings apart
    atlas = map_of(loop_with_double_assembly(5, opening))
    assert (len(atlas.rigid), len(atlas.points)) == (rigid, double)
    is_in_doubt = "in doubt" in atlas.completeness.statement
    assert is_in_doubt is bool(double)


@pytest.mark.parametrize("missing", [1e-6, 1e-9, 1e-12])
def test_a_motion_however_small_is_a_form(missing):
    # joint 1 swings by acos of the law of cosines about the stretched configuration
    atlas = map_of(Loop((1.0, 1.0, 1.0, 3.0 - missing), (0.0,) * 4, (0.0,) * 4))
    assert not len(atlas.rigid)
    (form,) = atlas.forms
    assert form.branch.closed
    turn = form.branch(np.linspace(0.0, form.branch.length, 2001))[:, 0]
    swing = math.sqrt(4.0 * missing / 3.0)
    assert np.ptp(turn) / 2 == pytest.approx(swing, rel=1e-3 + 1e-9 / swing)


def loop_with_triple_assembly(error):
    """Three assemblies or so lie ``error`` apart about (180, 180, 180, 0, 180, 0)
    degrees."""
    right = math.pi / 2
    twists = (right, right, -right, right, right, -right)
    return Loop((1, 2, 2, 2, 1, 2), twists, (-1.0, error, 1.0, 0, 0, 0))


@pytest.mark.parametrize("seed", one_in(2, range(2)))
@pytest.mark.parametrize("error", [1.6e-6, 1e-6, 3e-7])
def test_assemblies_that_rounding_hides_count_as_one_and_are_in_doubt(error, seed):
    # starts stop up to 1.6e-4 from them, where F is below 1e-12 already
    atlas = map_of(loop_with_triple_assembly(error), seed=seed)
    assert len(atlas.forms) == 1
    assert len(atlas.rigid) == 6
    place = np.array([math.pi, math.pi, math.pi, 0.0, math.pi, 0.0])
    off = np.abs(np.sin((atlas.rigid - place) / 2)).max(axis=1)
    assert np.count_nonzero(off < 1e-4) == 1
    assert atlas.completeness.level is Level.ESTIMATED
    statement = atlas.completeness.statement
    assert statement.startswith("in doubt: rounding does not tell how many isolated")
