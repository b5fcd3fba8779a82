"""Hopf points of large problems: those that are known in closed form."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array, eye_array

from bifurc import LargeProblem, LargeSettings, ProblemError, trace_large_branch
from studies.methods.fields import Brusselator


def constant_branch(points, highest=8.0, **settings):
    """The branch of constant solutions of a Brusselator, and its equations."""
    field = Brusselator(points)
    problem = LargeProblem(
        field.residual, field.n, (4.0, highest), pattern=field.pattern, size=2.0
    )
    branch = trace_large_branch(
        problem, field.constant(4.2), settings=LargeSettings(**settings)
    )
    return branch, field


@pytest.mark.parametrize(
    ("points", "count", "shift"),
    [(20, 12, 0.0), (60, 12, 0.0), (60, 8, 2j), (60, 8, 0.1 + 2j)],
    ids=["dense", "about zero", "on the axis", "beside the axis"],
)
def test_hopf_points_are_those_of_sine_waves(points, count, shift):
    branch, field = constant_branch(points, eigenvalues=count, shift=shift)
    parameters, frequencies = field.hopf_points_below(8.0)
    assert len(parameters) == 5
    found = [(point.parameter, point.frequency) for point in branch.hopf_points]
    expected = np.column_stack([parameters, frequencies])
    assert np.allclose(found, expected, rtol=1e-9)
    assert not branch.unsettled
    assert branch.eigenvalues.unstable[0] == 0
    assert branch.eigenvalues.unstable[-1] == (10 if shift == 0.0 else 5)


def test_the_last_stretch_before_the_bounds_is_looked_at() -> None:
    parameter = Brusselator(30).hopf_points_below(8.0)[0][0]
    branch, _ = constant_branch(30, parameter + 1e-3, eigenvalues=6)
    assert [point.parameter for point in branch.hopf_points] == [
        pytest.approx(parameter, rel=1e-9)
    ]


def test_with_too_few_eigenvalues_it_is_said_where_they_do_not_tell() -> None:
    branch, field = constant_branch(60, eigenvalues=3)
    _, frequencies = field.hopf_points_below(8.0)
    assert branch.unsettled
    # more than these are beyond what is known
    assert branch.eigenvalues.reach.min() < frequencies[1]


def oscillators(rates, frequencies):
    """u' = (J + rate p) u for each of some pairs, nothing else: an eigenvalue
    rate * (p - p0) + i frequency each, p0 = 0.3 for all."""
    blocks = [[[0.0, -w], [w, 0.0]] for w in frequencies]
    turns = csr_array(block_diag(blocks))
    growth = np.repeat(rates, 2)

    def residual(x):
        return turns @ x[:-1] + growth * (x[-1] - 0.3) * x[:-1]

    n = 2 * len(rates) + 1
    pattern = abs(turns) + eye_array(n - 1)
    return LargeProblem(residual, n, (0.0, 1.0), pattern=pattern)


def test_pairs_that_pass_in_opposite_directions_at_one_place_are_two() -> None:
    frequencies = [1.0, 1.5, *range(5, 50)]
    rates = [1.0, -1.0, *([0.0] * 45)]
    # others stay on the left
    problem = oscillators(np.array(rates), frequencies)

    def residual(x, inner=problem.function):
        value = inner(x)
        value[4:] -= x[4:-1]
        return value

    problem.function = residual
    branch = trace_large_branch(
        problem, np.zeros(problem.n), settings=LargeSettings(eigenvalues=6)
    )
    assert [point.parameter for point in branch.hopf_points] == pytest.approx([0.3] * 2)
    assert sorted(point.frequency for point in branch.hopf_points) == pytest.approx(
        [1.0, 1.5]
    )


def test_a_shift_that_is_no_number_is_refused() -> None:
    for shift in (np.nan, np.inf * 1j, "0", None):
        with pytest.raises(ProblemError, match="shift"):
            LargeSettings(eigenvalues=4, shift=shift)
    with pytest.raises(ProblemError, match="eigenvalues"):
        LargeSettings(eigenvalues=-1)
