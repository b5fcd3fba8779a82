"""Curves along which contradictory equations are nearly solved."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.curves import continuation, near_motion
from bifurc.curves.continuation import trace_branch
from bifurc.curves.near_motion import trace_near_motion
from bifurc.decisions import nearly_closes
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings, TraceSettings
from bifurc.system import relative_gaps

SETTINGS = TraceSettings()


def circle_missed(error, tilt=0.0):
    """Two circles that meet where x = ``tilt``, their centres ``error`` / 2 apart."""
    return FunctionProblem(
        lambda u: np.array([u @ u - 1.0, u @ u - 1.0 + error * (u[0] - tilt)]),
        [[-2, 2], [-2, 2]],
    )


def crossing_missed(error):
    """Two lines that cross at 0, by two equations that miss it by different errors."""
    return FunctionProblem(
        lambda u: np.array([u[0] * u[1] + error, 2 * u[0] * u[1] + error]),
        [[-2, 2], [-2, 2]],
    )


def drop_missed(error):
    """A line along which the rank drops at 0, missed by an error."""
    return FunctionProblem(
        lambda u: np.array([u[0] * u[1] + error, u[1] ** 2 - error]),
        [[-2, 2], [-2, 2]],
    )


@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-9])
def test_a_near_motion_is_followed_all_round_and_closes_where_it_passes_zero(error):
    problem = circle_missed(error)
    near = trace_near_motion(problem, np.array([0.6, 0.8]), SETTINGS)
    assert near.branch.closed
    assert near.branch.length == pytest.approx(2 * np.pi, rel=error)
    largest = error / np.sqrt(2.0) / problem.magnitude
    assert near.misclosure == pytest.approx(largest, rel=1e-5 + error)
    crossings = near.assemblies[np.argsort(near.assemblies[:, 1])]
    # the place of a zero is known to rounding over the error
    expected = [[0.0, -1.0], [0.0, 1.0]]
    assert crossings == pytest.approx(np.array(expected), abs=1e-14 / error + 1e-9)


def test_a_near_motion_may_begin_where_the_system_is_solved():
    near = trace_near_motion(circle_missed(1e-4), np.array([0.0, 1.0]), SETTINGS)
    assert near.branch.closed
    assert len(near.assemblies) == 2


def test_a_near_motion_that_misses_everywhere_has_no_assembly():
    near = trace_near_motion(circle_missed(1e-6, 3.0), np.array([1.0, 0.0]), SETTINGS)
    assert near.branch.closed
    assert not len(near.assemblies)


def test_beside_a_stiff_solution_there_is_no_near_motion():
    problem = FunctionProblem(
        lambda u: np.array([u @ u - 1.0, u[0] - 0.3]), [[-2, 2], [-2, 2]]
    )
    solution = np.array([0.3, np.sqrt(0.91)])
    assert trace_near_motion(problem, solution, SETTINGS).is_short


def test_where_a_near_motion_is_traced_from_makes_no_difference():
    problem = crossing_missed(1e-4)
    traces = [
        trace_near_motion(problem, np.array(start), SETTINGS)
        for start in ([1.0, -1e-4], [0.3, -4e-4], [0.01, -0.01], [1e-4, -1.0])
    ]
    lengths = [trace.branch.length for trace in traces]
    assert lengths == pytest.approx([lengths[0]] * 4, rel=1e-7)
    misclosures = [trace.misclosure for trace in traces]
    assert misclosures == pytest.approx([misclosures[0]] * 4, rel=1e-7)
    # of two lines that crossed, the near motion has half of each
    ends = np.abs(np.array([traces[0].branch(0.0), traces[0].branch(lengths[0])]))
    assert np.sort(ends, axis=1)[:, 1] == pytest.approx([2.0, 2.0], rel=1e-6)
    assert np.argmax(ends[0]) != np.argmax(ends[1])


@pytest.mark.parametrize("error", [3e-12, 1e-11, 1e-9])
def test_a_near_motion_turns_where_forms_crossed_however_little_it_misses(error):
    problem = crossing_missed(error)
    for x in (1.0, 0.3, -1.0):
        near = trace_near_motion(problem, np.array([x, -error / x]), SETTINGS)
        # it leaves the bounds on either line, and cuts the corner between them
        ends = np.abs(near.branch(np.array([0.0, near.branch.length])))
        assert np.argmax(ends[0]) != np.argmax(ends[1])
        assert near.branch.length == pytest.approx(4.0, abs=5.0 * np.sqrt(error))
        assert not near.is_repeated


def test_a_near_motion_needs_no_bridge_where_forms_crossed(monkeypatch):
    def no_bridge(*arguments):
        raise AssertionError("a bridge was tried")

    monkeypatch.setattr(continuation, "locate_singular_point", no_bridge)
    monkeypatch.setattr(continuation, "bridge_by_collocation", no_bridge)
    near = trace_near_motion(crossing_missed(1e-10), np.array([1.0, -1e-10]), SETTINGS)
    assert not near.has_loose_end


def test_a_near_motion_that_passes_stretches_twice_is_said_to(monkeypatch):
    def twice_round(*arguments, **others):
        branch = trace_branch(*arguments, **others)
        pieces = len(branch.pieces)
        return replace(
            branch,
            pieces=np.tile(branch.pieces, (2, 1, 1)),
            centers=np.append(branch.centers, branch.centers + branch.length),
            radii=np.tile(branch.radii, 2),
            breaks=np.append(branch.breaks[:pieces], branch.breaks + branch.length),
            residuals=np.tile(branch.residuals, 2),
        )

    start = np.array([0.6, 0.8])
    assert not trace_near_motion(circle_missed(1e-6), start, SETTINGS).is_repeated
    monkeypatch.setattr(near_motion, "trace_branch", twice_round)
    assert trace_near_motion(circle_missed(1e-6), start, SETTINGS).is_repeated


def test_a_near_motion_goes_straight_on_where_the_rank_of_its_form_drops():
    near = trace_near_motion(drop_missed(1e-6), np.array([1.0, 0.0]), SETTINGS)
    assert near.is_blurred
    assert not near.has_loose_end
    ends = near.branch(np.array([0.0, near.branch.length]))
    assert np.sort(ends[:, 0]) == pytest.approx([-2.0, 2.0], abs=1e-6)


def test_a_near_motion_ends_where_it_misses_too_much():
    problem = FunctionProblem(
        lambda u: np.array([u[1], u[1] + 1e-3 * u[0] ** 2]), [[-10, 10], [-10, 10]]
    )
    near = trace_near_motion(problem, np.array([0.1, 0.0]), SETTINGS)
    ends = near.branch(np.array([0.0, near.branch.length]))
    missed = nearly_closes.threshold
    assert relative_gaps(problem, ends) == pytest.approx([missed, missed], rel=1e-6)
    assert near.misclosure == pytest.approx(missed, rel=1e-6)
    assert not near.has_loose_end


@pytest.mark.parametrize("error", [1e-13, 1e-11, 1e-8, 1e-4])
def test_one_tolerance_decides_whether_a_curve_is_a_motion(error):
    problem = circle_missed(error)
    atlas = explore(problem, settings=SearchSettings(starts=30))
    largest = error / np.sqrt(2.0) / problem.magnitude
    if largest < 1e-12:
        assert [form.branch.closed for form in atlas.forms] == [True]
        assert atlas.forms[0].misclosure == pytest.approx(largest, rel=0.1)
        assert not atlas.near_motions
        assert not len(atlas.rigid)
    else:
        assert not atlas.forms
        assert len(atlas.near_motions) == 1
        assert atlas.closure_gap == atlas.near_motions[0].misclosure
        assert len(atlas.rigid) == 2


def test_a_single_unknown_that_nearly_closes_everywhere_is_a_near_motion():
    almost = FunctionProblem(lambda u: np.array([1e-9 + 0.0 * u[0]]), [(0.0, 1.0)])
    atlas = explore(almost)
    assert len(atlas.near_motions) == 1


def test_a_near_motion_is_followed_with_pieces_of_the_order_that_it_needs():
    # the tolerance is that of the misclosure, for which order 3 is too low
    settings = TraceSettings(order=3, tolerance=1e-7)
    near = trace_near_motion(circle_missed(1e-6), np.array([0.6, 0.8]), settings)
    assert near.branch.closed
    assert near.branch.pieces.shape[1] == 5


@pytest.mark.parametrize("height", [1e-2, 1e-6])
def test_a_near_motion_ends_where_it_bulges_out_of_the_bounds(height):
    problem = FunctionProblem(
        lambda u: np.array([u @ u - 1.0, u @ u - 1.0 + 1e-6 * u[0]]),
        [[-2, 2], [-2, 1 - height]],
    )
    near = trace_near_motion(problem, np.array([0.6, -0.8]), SETTINGS)
    assert not near.branch.closed
    ends = near.branch(np.array([0.0, near.branch.length]))
    assert ends[:, 1] == pytest.approx([1 - height] * 2, abs=1e-9)


def test_what_nearly_moves_beyond_the_bounds_is_no_near_motion():
    def nearly_a_plane(u):
        x, y, z = u
        off = x - 1.5
        first = off * y + 1e-7 * (y + 3.0)
        second = off * (z - x + 0.5) + 2e-7
        return [first, second, off * (y + z - 0.2) + 1e-7]

    within = explore(FunctionProblem(nearly_a_plane, [(-1.0, 1.0)] * 3))
    beyond = explore(FunctionProblem(nearly_a_plane, [(-2.0, 2.0)] * 3))
    assert len(within.rigid) == 1 and not within.near_motions
    assert [near.mobility for near in beyond.near_motions] == [2]
