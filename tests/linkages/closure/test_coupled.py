"""Loops with locked and geared joints: derivatives at 50 digits, dense closure, and
what a locked joint must give."""

import mpmath
import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.search.branches.certification import certify_atlas
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.axes import loop_from_axes
from linkages.catalogue import entry
from linkages.closure.coupled import CoupledClosure, locked_joints
from linkages.closure.loop_closure import LoopClosure
from linkages.closure.precise import precise_residual
from linkages.loop import Loop
from linkages.values import GeometryError

DIGITS = 50


def general_loop(joints, seed):
    rng = np.random.default_rng(seed)
    lengths = rng.uniform(0.5, 1.5, joints)
    twists = rng.uniform(0.6, 2.5, joints)
    offsets = rng.uniform(0.0, 0.4, joints)
    return Loop(lengths, twists, offsets)


def geared(joints, ratios=(-1.0, 1.0)):
    """A loop whose joints from the eighth on are geared to the first ones, with
    phases."""
    matrix = np.vstack([np.eye(7), np.zeros((joints - 7, 7))])
    for i in range(7, joints):
        matrix[i, i - 7] = ratios[i % len(ratios)]
    phases = np.linspace(0.0, 1.0, joints)
    return CoupledClosure(general_loop(joints, joints), matrix, phases)


def closed_point(problem, seed=0):
    starts = np.random.default_rng(seed).uniform(-np.pi, np.pi, (20, problem.n))
    points, gaps = problem.project(starts)
    return points[gaps < 1e-12][0]


def precisely(problem, v, *shifts):
    """The residual at 50 digits at v shifted along the unknowns: from M, c and the
    quaternions alone."""
    moved = mpmath.matrix([float(x) for x in v])
    for j, step in shifts:
        moved[j] += step
    matrix = mpmath.matrix(problem.matrix.tolist())
    theta = matrix * moved + mpmath.matrix(problem.offset.tolist())
    return mpmath.matrix(precise_residual(problem.loop)(list(theta)))


def largest_difference(values, precise_values):
    return np.abs(values - [float(x) for x in precise_values]).max()


def sum_of(pair):
    return pair[0] + pair[1]


@pytest.mark.parametrize("joints", [8, 12])
def test_residual_and_derivatives_agree_with_50_digits(joints):
    problem = geared(joints, ratios=(-0.7, 2.5))
    v = np.random.default_rng(3).uniform(-np.pi, np.pi, 7)
    residual = problem.residuals(v[None])[0]
    jacobian = problem.jacobians(v[None])[0]
    hessian = problem.hessian(v)
    # rounding of theta = M v + c, up to 10 rad, and products of n rotations
    bound = 1e-13 * joints
    with mpmath.workdps(DIGITS):
        assert largest_difference(residual, precisely(problem, v)) < bound
        h = mpmath.mpf(10) ** -15  # central differences: errors of 1e-30 and of 1e-20
        for j in range(7):
            ahead, back = precisely(problem, v, (j, h)), precisely(problem, v, (j, -h))
            slope = (ahead - back) / (2 * h)
            assert largest_difference(jacobian[:, j], slope) < bound
            for i in range(j + 1):
                alike = [precisely(problem, v, (i, a), (j, a)) for a in (h, -h)]
                unlike = [precisely(problem, v, (i, a), (j, -a)) for a in (h, -h)]
                second = (sum_of(alike) - sum_of(unlike)) / (4 * h**2)
                assert largest_difference(hessian[:, i, j], second) < 10 * bound


@pytest.mark.parametrize("joints", [8, 12])
def test_a_geared_loop_closes_everywhere_on_its_curve(joints):
    problem = geared(joints)
    branch = trace_branch(problem, closed_point(problem))
    assert branch.closed
    s = np.linspace(0.0, branch.length, 5000)
    gap = problem.loop.frames(problem.angles(branch(s)))[:, -1] - np.eye(4)
    gap[:, :3, 3] /= problem.loop.characteristic_length
    assert np.abs(gap).max() < 1e-13
    # the tolerance 1e-13 of the last terms of the series, times their order, is what
    # the speed may be off
    assert np.linalg.norm(branch(s, 1), axis=1) == pytest.approx(1.0, abs=1e-11)


def test_a_locked_joint_gives_the_curve_of_the_loop_with_its_two_links_made_one():
    loop, locked = general_loop(8, 1), 3
    matrix, offset = locked_joints(8, {locked: 0.4})
    problem = CoupledClosure(loop, matrix, offset)
    start = closed_point(problem)
    frames = np.delete(loop.frames(problem.angles(start))[:8], locked - 1, axis=0)
    merged, angles = loop_from_axes(frames[:, :3, 3], frames[:, :3, 2])
    assert merged.n == 7
    branch = trace_branch(problem, start)
    other = trace_branch(LoopClosure(merged), angles)
    assert branch.closed
    assert other.closed
    assert branch.length == pytest.approx(other.length, rel=1e-12)
    same_way = np.sign(branch(0.0, 1) @ other(0.0, 1))
    s = np.linspace(0.0, branch.length, 200)
    turned, apart = branch(s) - start, other(same_way * s % other.length) - angles
    # rounding of 1e-13 over the smallest singular value of the two curves
    assert np.abs(np.angle(np.exp(1j * (turned - apart)))).max() < 1e-10


def test_the_symmetric_motion_of_a_line_symmetric_bricard_needs_three_unknowns():
    loop = entry("bricard-line-symmetric").build()
    problem = CoupledClosure(loop, np.vstack([np.eye(3), np.eye(3)]))
    branch = trace_branch(problem, closed_point(problem))
    assert branch.closed
    theta = problem.angles(branch(np.linspace(0.0, branch.length, 300)))
    whole = trace_branch(LoopClosure(loop), theta[0])
    # every unknown turns two joints
    assert whole.length == pytest.approx(np.sqrt(2) * branch.length, rel=1e-12)
    assert whole.nearest(theta)[0].max() < 1e-10


def test_the_map_of_a_coupled_loop_has_the_symmetric_forms_and_certifies_them():
    loop = entry("bricard-line-symmetric").build()
    problem = CoupledClosure(loop, np.vstack([np.eye(3), np.eye(3)]))
    atlas = certify_atlas(problem, explore(problem, settings=SearchSettings(starts=40)))
    whole = explore(LoopClosure(loop), settings=SearchSettings(starts=40))
    lengths = [np.sqrt(2) * form.branch.length for form in atlas.forms]
    whole_lengths = [form.branch.length for form in whole.forms]
    assert lengths == pytest.approx(whole_lengths, rel=1e-10)
    assert [f.certificate.status for f in atlas.forms] == ["certified"] * 2


def test_an_unknown_comes_round_when_all_joints_that_it_turns_do():
    ratios = [(1.0, 0.0), (1.0, 0.5), (2.0, -4.0), (1 / 3, 0.5), (np.sqrt(2.0), 1.0)]
    turns = []
    for a, b in ratios:
        matrix = np.array([[a, 0.0], [b, 0.0], [0.0, 1.0], [0.0, 0.0]])
        problem = CoupledClosure(general_loop(4, 0), matrix)
        turns.append(problem.periods / (2 * np.pi))
    assert [first for first, _ in turns] == [1.0, 2.0, 0.5, 6.0, np.inf]
    assert all(second == 1.0 for _, second in turns)


@pytest.mark.parametrize(
    ("matrix", "offset", "said"),
    [
        (np.eye(5), None, r"shape of the coupling matrix: \(5, 5\)"),
        (np.ones((8, 9)), None, r"shape of the coupling matrix: \(8, 9\)"),
        (np.eye(8)[0], None, "shape of the coupling matrix"),
        (np.eye(8), np.zeros(7), r"shape of the coupling offset: \(7,\)"),
        (np.full((8, 1), np.nan), None, "coupling matrix: nan"),
        (np.eye(8), np.full(8, np.inf), "coupling offset: inf"),
        (np.ones((8, 2)), None, "rank of the coupling matrix: 1"),
    ],
)
def test_a_coupling_that_is_none_is_refused_with_its_value(matrix, offset, said):
    with pytest.raises(GeometryError, match=said):
        CoupledClosure(general_loop(8, 0), matrix, offset)


def test_a_joint_that_the_loop_does_not_have_cannot_be_locked():
    with pytest.raises(
        GeometryError, match="locked joint: 9 is not allowed; it must be from 1 to 8"
    ):
        locked_joints(8, {9: 0.0})
