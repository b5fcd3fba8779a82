"""What an atlas leaves out of its near misses."""

import numpy as np
import pytest

from bifurc.atlas import MeetingPoint
from bifurc.branch import Branch
from bifurc.curves.continuation import trace_branch
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.answer.assemble import near_misses_of
from bifurc.search.records import TracedBranch
from bifurc.singular.point import Kind, SingularPoint

ERROR = 1e-2  # of a singular point that is hardly placed
PERIODS = np.full(2, np.inf)
# a straight line along which the singular value is smallest at one place
HOLLOW = FunctionProblem(lambda u: [u[1] * (0.01 + u[0] ** 2)], [(-1, 1)] * 2)


def line() -> Branch:
    return trace_branch(HOLLOW, np.array([0.3, 0.0]), np.array([1.0, 0.0]))


def met_at(form: int, passed: float) -> MeetingPoint:
    """A point known to `ERROR`, farther than that from the line, which a form meets at
    an arclength."""
    point = SingularPoint(
        u=np.array([0.0, 0.5]),
        rank=0,
        null_space=np.eye(2),
        error=ERROR,
        half_branches=np.empty((0, 2)),
        tangents=np.empty((0, 2)),
        dimension=1,
        order=0,
        radius=ERROR,
    )
    return MeetingPoint("S1", Kind.CUSP, point, ((form, passed),), np.empty((1, 2)))


@pytest.mark.parametrize(
    ("form", "beside", "count"),
    [(0, 0.5, 0), (0, -0.5, 0), (0, 2.0, 1), (0, -2.0, 1), (1, 0.5, 1)],
)
def test_a_minimum_where_its_form_meets_a_point_is_no_near_miss(form, beside, count):
    branch = line()
    profile = profile_branch(HOLLOW, branch)
    s = branch.length / 2
    minima = (np.array([s]), np.array([0.01]))
    traced = [TracedBranch(branch, profile, minima, ())]
    met = met_at(form, s + beside * ERROR)
    misses = near_misses_of(HOLLOW, traced, [met.point], [met], PERIODS)
    assert len(misses) == count
