"""Where curves enter and leave a disc tells how often they cross inside."""

import numpy as np
import pytest

import bifurc
from bifurc.search.answer.completeness import SearchDoubt
from bifurc.search.strands import missing_crossings


def nodes(size, shift=0.0, turn=0.0):
    """A curve of degree 4 with three crossings in a triangle of a ``size``, none of which
    is that of two factors."""
    angles = turn + np.array([0.1, 2.0, 4.2])
    normals = np.column_stack([np.cos(angles), np.sin(angles)])

    def values(u):
        a, b, c = (
            n[0] * (u[0] - shift) + n[1] * (u[1] + shift) - size for n in normals
        )
        bend = 0.7 * (a * b) ** 2 + 0.4 * (b * c) ** 2 + 0.9 * (c * a) ** 2
        return [a * b * c + 0.2 * bend]

    return bifurc.FunctionProblem(values, [(-2, 2)] * 2)


@pytest.fixture(scope="module")
def atlas():
    return bifurc.explore(nodes(1e-3))


@pytest.mark.parametrize("left_out", range(3))
def test_a_crossing_that_is_left_out_is_missed(atlas, left_out):
    points = [point.point for point in atlas.points]
    branches = [form.branch for form in atlas.forms]
    problem = nodes(1e-3)
    assert not list(missing_crossings(problem, points, branches))
    gone = points.pop(left_out)
    missing = list(missing_crossings(problem, points, branches))
    assert missing
    for one in missing:
        assert np.linalg.norm(one.place - gone.u) < 1e-3


@pytest.mark.parametrize("size", [1e-2, 1e-4, 4e-6])
@pytest.mark.parametrize("seed", range(3))
def test_three_crossings_next_to_each_other_are_found_or_in_doubt(size, seed):
    atlas = bifurc.explore(nodes(size, 0.1 * seed, 0.7 * seed), seed=seed)
    sizes = [len(point.point.half_branches) for point in atlas.bifurcations]
    assert sizes == [4, 4, 4] or atlas.completeness.is_in_doubt


def test_two_curves_that_touch_are_not_said_to_cross_once_more():
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] * (u[1] - u[0] ** 2) * (u[1] + u[0] ** 3)], [(-1, 1)] * 2
    )
    atlas = bifurc.explore(problem)
    kinds = [doubt.kind for doubt in atlas.completeness.doubts]
    assert SearchDoubt.CROSSING_MISSING.name not in kinds
