"""The closure problem of a loop: its residual, its units, its seeds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.loop import Loop
from linkages.statements import LinkageClaim

ANGLES = st.floats(-np.pi, np.pi)
# what is smaller is lost where lengths are scaled down
LENGTHS = st.one_of(st.just(0.0), st.floats(1e-9, 2.0))


@st.composite
def loops(draw):
    n = draw(st.integers(4, 8))
    lengths = draw(st.lists(LENGTHS, min_size=n, max_size=n))
    twists = draw(st.lists(ANGLES, min_size=n, max_size=n))
    offsets = draw(st.lists(st.floats(-1.0, 1.0), min_size=n, max_size=n))
    theta = draw(st.lists(ANGLES, min_size=n, max_size=n))
    # next to the smallest double a length is 0 in another unit
    lengths, offsets = (np.round(values, 12) for values in (lengths, offsets))
    return Loop(lengths, twists, offsets), np.array(theta)


@settings(max_examples=200, derandomize=True, deadline=None)
@given(loops())
def test_the_residual_measures_the_whole_rotation_and_the_translation(case):
    # |2 q_v| = 2 sin(phi / 2) = |R - I| / sqrt(2) for a rotation by phi: zero for the
    # identity alone, largest for half turns
    loop, theta = case
    gap = loop.frames(theta)[-1] - np.eye(4)
    residual = Closure(loop).residuals(theta[None])[0]
    # sqrt(1e-16) next to a half turn would not show here: the norm of q_v is exact to
    # rounding everywhere
    rotation = np.linalg.norm(gap[:3, :3]) / np.sqrt(2)
    translation = gap[:3, 3] / loop.characteristic_length
    assert np.linalg.norm(residual[:3]) == pytest.approx(rotation, abs=1e-13)
    assert residual[3:] == pytest.approx(translation, abs=1e-13)


def test_a_half_turn_is_no_closed_configuration():
    # all axes along z through one point: the loop product is the rotation by the sum of
    # the angles
    loop = Loop((0.0,) * 4, (0.0,) * 4, (0.0,) * 4)
    problem = Closure(loop)
    half, whole = np.array([np.pi, 0.0, 0.0, 0.0]), np.array([np.pi, np.pi, 0.0, 0.0])
    # the skew part, used in the sources, does not see it
    rotation = loop.frames(half)[-1][:3, :3]
    assert np.abs(rotation - rotation.T).max() < 1e-15
    assert np.linalg.norm(problem.residuals(half[None])[0]) == pytest.approx(2.0)
    assert np.linalg.norm(problem.residuals(whole[None])[0]) < 1e-15


@pytest.mark.parametrize(
    "name",
    [
        "bennett",
        "bricard-line-symmetric",
        "special-double-subtractive-goldberg",
        "goldberg-5r",
    ],
)
def test_projection_ends_in_closed_configurations_or_says_the_gap(name):
    loop = entry(name).build()
    problem = Closure(loop)
    starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (400, loop.n))
    points, gaps = problem.project(starts)
    residuals = np.linalg.norm(problem.residuals(points), axis=1)
    assert np.allclose(gaps, residuals, rtol=0, atol=1e-14)
    closed = gaps < 1e-12
    assert closed.sum() > 50
    matrices = loop.frames(points[closed])[:, -1]
    matrices[:, :3, 3] /= loop.characteristic_length
    assert np.abs(matrices - np.eye(4)).max() < 1e-11


@settings(max_examples=50, derandomize=True, deadline=None)
@given(loops(), st.sampled_from([1e-6, 1e-3, 1e3, 1e9]))
def test_nothing_depends_on_the_unit_of_length(case, factor):
    loop, theta = case
    one, other = Closure(loop), Closure(loop.scaled(factor))
    # the characteristic length is scaled, too: only its rounding and that of the
    # lengths is left
    residuals, jacobians = one.residuals(theta[None]), one.jacobians(theta[None])
    assert other.residuals(theta[None]) == pytest.approx(residuals, abs=1e-13)
    assert other.jacobians(theta[None]) == pytest.approx(jacobians, abs=1e-13)


def test_the_jacobian_is_the_joint_screws_where_the_loop_is_closed():
    loop = entry("bricard-line-symmetric").build()
    problem = Closure(loop)
    theta = problem.seeds(np.random.default_rng(0), 5).points[0]
    screws = loop.joint_screws(theta)
    screws[3:] /= loop.characteristic_length
    assert problem.jacobians(theta[None])[0] == pytest.approx(screws, abs=1e-13)


def test_solutions_on_a_sphere_are_closed_and_at_the_radius():
    problem = Closure(entry("bricard-line-symmetric").build())
    center = problem.seeds(np.random.default_rng(0), 5).points[0]
    tangent = np.linalg.svd(problem.jacobians(center[None])[0])[2][-1]
    starts = center + 0.05 * np.array([tangent, -tangent])
    points, gaps, last = problem.project_to_sphere(starts, center, 0.05)
    assert gaps.max() < 1e-14
    assert last.max() < 1e-10
    assert np.linalg.norm(points - center, axis=1) == pytest.approx(0.05, abs=1e-14)


@pytest.mark.parametrize("joints", [8, 9, 12])
def test_solutions_on_a_sphere_of_a_loop_with_more_unknowns_than_equations_are_closed(
    joints,
):
    rng = np.random.default_rng(joints)
    lengths, offsets = rng.uniform(0.5, 1.0, joints), rng.uniform(-0.3, 0.3, joints)
    problem = Closure(Loop(lengths, rng.uniform(-3, 3, joints), offsets))
    points, gaps = problem.project(rng.uniform(-np.pi, np.pi, (20, joints)))
    center = points[np.argmin(gaps)]
    null_space = np.linalg.svd(problem.jacobians(center[None])[0])[2][6:]
    found, left, _ = problem.project_to_sphere(center + 1e-2 * null_space, center, 1e-2)
    assert left.max() < 1e-14
    assert np.linalg.norm(found - center, axis=1) == pytest.approx(1e-2, abs=1e-14)


def test_seeds_of_a_short_loop_are_closed_and_come_from_complete_slices_and_random_starts():
    problem = Closure(entry("special-double-subtractive-goldberg").build())
    seeds = problem.seeds(np.random.default_rng(4), 30)
    # the slices hold configurations, and there are no motions yet
    assert seeds.audit([], 0.0).level == "estimated"
    assert 0 < seeds.random.sum() <= 30 < len(seeds.points)
    assert np.linalg.norm(problem.residuals(seeds.points), axis=1).max() < 1e-12


def random_loop(joints):
    rng = np.random.default_rng(5)
    lengths = rng.uniform(0.5, 1, joints)
    twists = rng.uniform(-3, 3, joints)
    return Loop(lengths, twists, rng.uniform(-0.5, 0.5, joints))


def test_seeds_of_a_long_loop_are_random_and_claim_nothing_complete():
    problem = Closure(random_loop(8))
    seeds = problem.seeds(np.random.default_rng(0), 40)
    assert seeds.random.all()
    assert seeds.audit is None
    assert len(seeds.points) + len(seeds.gaps) == 40


def test_a_loop_of_seven_joints_is_sliced_by_the_rings_of_six_that_are_left():
    problem = Closure(random_loop(7))
    seeds = problem.seeds(np.random.default_rng(0), 40)
    assert seeds.audit.counts == (16,)
    assert np.linalg.norm(problem.residuals(seeds.points), axis=1).max() < 1e-10
    (driver,) = seeds.audit.drivers
    sliced = seeds.points[~seeds.random][:, driver]
    gaps = np.diff(np.unique(np.round(np.mod(sliced, 2 * np.pi), 9)))
    assert np.allclose(gaps / np.radians(10), np.round(gaps / np.radians(10)))


def test_seeds_of_a_surface_do_not_claim_completeness():
    planar = Loop((1.0, 1.2, 0.9, 1.1, 0.8), (0.0,) * 5, (0.0,) * 5)
    seeds = Closure(planar).seeds(np.random.default_rng(0), 10)
    audit = seeds.audit([], 1.0)
    assert audit.level == "estimated"
    assert LinkageClaim.SLICES_INCOMPLETE.is_kind_of(audit.claims[0])
