"""Atlases in other unknowns: another order, other signs, another origin."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.isometry import Isometry, recount_atlas
from bifurc.system import jacobian_at, relative_gaps
from bifurc.torus import difference
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from tests.maps import map_of

TURN = 2 * np.pi
ROUNDING = 1e-14


@pytest.fixture
def isometry():
    columns = np.array([3, 0, 5, 1, 4, 2])
    signs = np.array([1, -1, -1, 1, -1, 1])
    return Isometry(columns, signs, np.array([0.3, -2.0, 3.1, 0.0, 1.5, -0.7]))


@pytest.fixture(scope="module")
def crossing_forms():
    return map_of(entry("special-double-subtractive-goldberg").build())


def arrays_of(value, path=""):
    """All arrays of numbers in nested records, by their paths."""
    if isinstance(value, np.ndarray):
        yield path, value
    elif isinstance(value, tuple):
        for number, part in enumerate(value):
            yield from arrays_of(part, f"{path}[{number}]")
    elif is_dataclass(value):
        for field in fields(value):
            yield from arrays_of(getattr(value, field.name), f"{path}.{field.name}")


def test_a_point_goes_there_and_back(isometry):
    points = np.random.default_rng(0).normal(size=(4, 6))
    there = isometry.points(points)
    assert there[2, 1] == -(points[2, 0] + 2.0)
    assert isometry.inverse.points(there) == pytest.approx(points, abs=ROUNDING)
    assert isometry.inverse.directions(isometry.directions(points)).tolist() == (
        points.tolist()
    )
    assert [isometry.columns[isometry.index(k)] for k in range(6)] == list(range(6))


def test_what_is_no_isometry_is_refused():
    zeros = np.zeros(2)
    with pytest.raises(ProblemError, match="a permutation of 0 to 1"):
        Isometry(np.array([0, 0]), np.ones(2), zeros)
    with pytest.raises(ProblemError, match="1 or -1"):
        Isometry(np.arange(2), np.array([1.0, 2.0]), zeros)
    with pytest.raises(ProblemError, match="origin"):
        Isometry(np.arange(2), np.ones(2), np.zeros(3))


def test_forms_and_points_are_the_same_in_other_unknowns(crossing_forms, isometry):
    atlas = recount_atlas(crossing_forms, isometry, list("abcdef"))
    problem = LoopClosure(entry("special-double-subtractive-goldberg").build())
    for form, before in zip(atlas.forms, crossing_forms.forms, strict=True):
        branch = form.branch
        places = np.linspace(0.0, branch.length, 200)
        assert branch.length == before.branch.length
        assert np.abs(branch(0.0)).max() <= TURN / 2
        expected = isometry.points(before.branch(places))
        gaps = difference(branch(places), expected, branch.periods)
        assert np.abs(gaps).max() < ROUNDING
        back = isometry.inverse.points(branch(places))
        assert relative_gaps(problem, back).max() < 1e-12
        turns = isometry.directions(before.branch.winding)
        assert branch.winding.tolist() == turns.tolist()
    for point, before in zip(atlas.points, crossing_forms.points, strict=True):
        for tangent, (form, s) in zip(point.tangents, point.passes, strict=True):
            there = atlas.forms[form].branch(s)
            gap = difference(there, point.point.u, atlas.periods)
            assert np.abs(gap).max() < 1e-7
            velocity = atlas.forms[form].branch(s, 1)
            assert abs(velocity @ tangent) == pytest.approx(1.0, abs=1e-6)
        jacobian = jacobian_at(problem, isometry.inverse.points(point.point.u))
        null_space = isometry.inverse.directions(point.point.null_space.T).T
        assert np.abs(jacobian @ null_space).max() < 1e-12
        assert before.name == point.name
    for event, before in zip(
        atlas.dead_points, crossing_forms.dead_points, strict=True
    ):
        rate = atlas.forms[event.form].branch(event.s, 1)[event.index]
        assert abs(rate) < 1e-7
        assert isometry.columns[event.index] == before.index


def test_charts_are_the_same_in_other_unknowns(folded_sarrus, isometry):
    atlas = recount_atlas(folded_sarrus, isometry, list("abcdef"))
    charts = [surface.charts for surface in atlas.surfaces if surface.charts]
    before = [one.charts for one in folded_sarrus.surfaces if one.charts]
    assert charts
    for chart, old in zip(charts, before, strict=True):
        assert chart.area == pytest.approx(old.area, rel=1e-12)
        assert chart.euler_characteristic == old.euler_characteristic
        back = isometry.inverse.directions(np.swapaxes(chart.bases, 1, 2))
        assert np.array_equal(np.swapaxes(back, 1, 2), old.bases)


def test_everything_comes_back(crossing_forms, folded_sarrus, isometry):
    for atlas in (crossing_forms, folded_sarrus):
        there = recount_atlas(atlas, isometry, list("abcdef"))
        back = recount_atlas(there, isometry.inverse, atlas.names)
        assert back.names == atlas.names
        pairs = zip(arrays_of(back), arrays_of(atlas), strict=True)
        for (path, value), (_, expected) in pairs:
            gaps = value - expected
            if gaps.ndim and gaps.shape[-1] == len(atlas.names):
                gaps -= TURN * np.round(gaps / TURN)
            assert np.abs(gaps).max(initial=0.0) < 1e-13, path


def test_an_atlas_with_a_diagram_and_too_few_names_are_refused(folded_sarrus, isometry):
    with pytest.raises(ProblemError, match="names and an isometry of 6 unknowns"):
        recount_atlas(folded_sarrus, isometry, ["a"])
    with pytest.raises(ProblemError, match="without one"):
        recount_atlas(replace(folded_sarrus, diagram=object()), isometry, "abcdef")
