"""By how much contradictory equations are missed along a curve."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.misclosure import largest_misclosure, misclosures
from bifurc.function_problem import FunctionProblem
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop

START = np.array([0.6, 0.8])


def two_circles(error):
    """The unit circle, and one whose radius is another."""
    return FunctionProblem(
        lambda u: np.array([u @ u - 1.0, u @ u - 1.0 + error]), [[-2, 2], [-2, 2]]
    )


def bennett_off(error):
    loop = entry("bennett").build()
    lengths, twists, offsets = loop.arrays
    twists[0] += error
    return LoopClosure(Loop(tuple(lengths), tuple(twists), tuple(offsets)))


@pytest.mark.parametrize("error", [1e-3, 1e-7, 1e-11])
def test_what_contradicts_itself_is_missed_whatever_the_place(error):
    problem = two_circles(error)
    expected = error / np.sqrt(2.0) / problem.magnitude
    points = np.array([START, START + 1e-9, [1.0, 0.0]])
    assert misclosures(problem, points) == pytest.approx(expected, rel=1e-4)


def test_a_system_of_fewer_equations_than_unknowns_misses_nothing():
    problem = FunctionProblem(lambda u: np.array([u @ u - 1.0]), [[-2, 2], [-2, 2]])
    off = np.array([[1.1, 0.0], [0.0, 2.0]])
    assert np.all(misclosures(problem, off) == 0.0)


@pytest.mark.parametrize("error", [1e-6, 1e-10, 1e-12, 1e-13, 2e-14])
def test_the_misclosure_of_a_linkage_is_measured_below_what_doubles_tell(error):
    # of a Bennett linkage with a twist off by e it is e at the worst place
    problem = bennett_off(error)
    start, _ = problem.project(np.array([[0.3, 0.9, -0.2, 0.4]]))
    branch = trace_branch(problem, start[0], closing=1e-2)
    assert largest_misclosure(problem, branch) == pytest.approx(error, rel=0.02)


def test_the_misclosure_of_a_true_motion_is_rounding():
    problem = bennett_off(0.0)
    start, _ = problem.project(np.array([[0.3, 0.9, -0.2, 0.4]]))
    assert largest_misclosure(problem, trace_branch(problem, start[0])) < 5e-15
