"""Values of near misses, with bounds of their errors."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.near_miss import near_miss_value
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.mapping import map_linkage


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8, 1e-10])
def test_the_bound_of_a_near_miss_holds_on_a_hyperbola(gap):
    # on x y = e the singular value is (x, y), at least sqrt(2 e)
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[1] - gap]), [[-2, 2], [-2, 2]]
    )
    atlas = explore(problem, settings=SearchSettings(starts=30))
    assert len(atlas.near_misses) == 2
    exact = np.sqrt(2 * gap) / problem.magnitude
    for event in atlas.near_misses:
        assert abs(event.value - exact) <= event.error
        assert event.error < 1e-4 * exact


@pytest.mark.parametrize("power", [6, 7, 8, 10, 11])
def test_a_near_miss_that_doubles_resolve_is_no_rank_drop(power):
    # with R1 = R4 = e the singular values there are proportional to e
    base = entry("bricard-line-symmetric-zero-offset").build()
    offset = 10.0**-power
    loop = Loop(base.lengths, base.twists, (offset, 0.0, 0.0, offset, 0.0, 0.0))
    atlas = map_linkage(loop)
    assert not atlas.points
    assert len(atlas.forms) == 2
    ratios = sorted(event.value / offset for event in atlas.near_misses)
    expected = [0.12289117, 0.14503899, 0.25317093, 0.35926642]
    bound = max(event.error for event in atlas.near_misses) / offset
    assert ratios == pytest.approx(expected, abs=bound + 1e-8)


def test_small_near_misses_are_found_in_many_digits():
    base = entry("bricard-line-symmetric-zero-offset").build()
    ratios = []
    for offset in (1e-4, 1e-5, 1e-6):
        loop = Loop(base.lengths, base.twists, (offset, 0.0, 0.0, offset, 0.0, 0.0))
        near_misses = map_linkage(loop).near_misses
        assert all(event.error < 1e-9 * event.value for event in near_misses)
        ratios.append(np.sort([event.value / offset for event in near_misses]))
    # the ratios change in proportion to the offset; doubles miss the last by 2e-9
    expected = ratios[1] + 0.1 * (ratios[1] - ratios[0])
    assert ratios[2] == pytest.approx(expected, rel=5e-10)


def test_where_the_singular_value_is_zero_the_value_is_bounded():
    axes = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [[-2, 2], [-2, 2]])
    branch = trace_branch(axes, [1.0, 0.0])
    value, error = near_miss_value(axes, branch, 1, branch.length / 2)
    assert value < 1e-12
    assert np.isfinite(error)
