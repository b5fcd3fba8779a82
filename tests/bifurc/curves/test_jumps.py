"""Signs that a curve has jumped."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.jumps import changes_of_course, kinks, repeats_itself
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore

BOX = [(-2.0, 2.0), (-2.0, 2.0)]


def polyline(corners) -> Branch:
    """An open branch of straight pieces from corner to corner."""
    corners = np.array(corners, dtype=float)
    halves = np.diff(corners, axis=0) / 2
    radii = np.linalg.norm(halves, axis=1)
    breaks = np.concatenate([[0.0], np.cumsum(2 * radii)])
    pieces = np.zeros((len(halves), 3, corners.shape[1]))
    pieces[:, 0] = corners[:-1] + halves
    pieces[:, 1] = halves
    endless = np.full(corners.shape[1], np.inf)
    return Branch(
        pieces=pieces,
        centers=breaks[:-1] + radii,
        radii=radii,
        breaks=breaks,
        residuals=np.zeros(len(pieces)),
        periods=endless,
        outcome=Outcome.LEFT_REGION,
    )


def twice(branch: Branch) -> Branch:
    """A closed branch that runs along itself a second time before it closes."""
    return replace(
        branch,
        pieces=np.concatenate([branch.pieces, branch.pieces]),
        centers=np.concatenate([branch.centers, branch.centers + branch.length]),
        radii=np.tile(branch.radii, 2),
        breaks=np.concatenate([branch.breaks, branch.breaks[1:] + branch.length]),
        residuals=np.tile(branch.residuals, 2),
    )


def test_a_curve_that_runs_along_itself_repeats_itself_and_a_closed_one_does_not():
    circle = FunctionProblem(lambda u: [u[0] ** 2 + u[1] ** 2 - 1.0], BOX)
    branch = trace_branch(circle, np.array([1.0, 0.0]))
    assert branch.closed
    assert not repeats_itself(circle, branch)
    assert repeats_itself(circle, twice(branch))


def test_a_curve_that_comes_back_the_other_way_repeats_itself():
    line = FunctionProblem(lambda u: [u[1]], BOX)
    assert repeats_itself(line, polyline([(-1, 0), (1, 0), (-1, 0)]))
    assert not repeats_itself(line, polyline([(-1, 0), (1, 0)]))


def test_a_curve_that_crosses_itself_does_not_repeat_itself():
    figure_eight = FunctionProblem(
        lambda u: [u[1] ** 2 - u[0] ** 2 * (1.0 - u[0] ** 2)], BOX
    )
    (form,) = explore(figure_eight).forms
    assert not repeats_itself(figure_eight, form.branch)


def test_a_curve_that_goes_on_in_another_direction_has_a_kink():
    assert not len(kinks(polyline([(-1, 0), (0, 0), (1, 0)])))
    assert kinks(polyline([(-1, 0), (0, 0), (1, 0.1)])) == pytest.approx([1.0])


@pytest.mark.parametrize(
    "corners, expected",
    [
        ([(-1, 0), (0, 0), (0, 1)], [1.0]),
        ([(-1, 0), (0, 0), (1, 0)], []),
    ],
)
def test_a_curve_that_turns_off_at_a_crossing_changes_its_course(corners, expected):
    cross = FunctionProblem(lambda u: [u[0] * u[1]], BOX)
    branch = polyline(corners)
    profile = profile_branch(cross, branch)
    changes = changes_of_course(branch, profile, np.array([1.0]))
    assert changes.tolist() == expected


def test_kinks_near_the_ends_may_be_left_out():
    branch = polyline([(-1, 0), (0, 0), (0, 1)])
    assert kinks(branch).tolist() == [1.0]
    assert kinks(branch, from_ends=0.5).tolist() == [1.0]
    assert not len(kinks(branch, from_ends=1.5))
