"""Narrow limits keep the forms that pass through them."""

from dataclasses import replace

import numpy as np
import pytest

import linkages
from bifurc import SearchSettings
from linkages.closure import within_limits
from linkages.closure.closure import Closure
from linkages.closure.within_limits import brought_within_limits
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.readout import Readout
from tests.maps import map_of

FEW = SearchSettings(starts=60, count=False, certify=False, near_motions=False)
# a 6R loop whose opposite axes are images in a half turn about the z axis (Bricard
# 1897): points and directions of the first three
POINTS = np.array([[1.0, 0.2, 0.3], [0.4, 0.9, -0.5], [-0.6, 0.8, 0.7]])
DIRECTIONS = np.array([[0.3, 1.0, 0.5], [1.0, -0.4, 0.8], [0.2, 0.5, 1.0]])
HALF_TURN = np.array([-1.0, -1.0, 1.0])


def line_symmetric_loop(**limits):
    """The loop with limits of some joints, rad."""
    points = np.concatenate([POINTS, POINTS * HALF_TURN])
    directions = np.concatenate([DIRECTIONS, DIRECTIONS * HALF_TURN])
    bodies = "fabcde"
    joints = []
    for k in range(6):
        name = f"R{k}"
        ends = (bodies[k], bodies[(k + 1) % 6])
        place, axis = tuple(points[k]), tuple(directions[k])
        joint = Joint(name, "revolute", ends, place, axis)
        joints.append(replace(joint, limits=(limits.get(name),)))
    return Mechanism(tuple(joints))


def rccc(limits):
    """A loop of a revolute joint with limits, rad, and three cylindrical ones."""
    joints = (
        Joint(
            "C0",
            "revolute",
            ("g", "a"),
            (-0.52, -0.22, 0.22),
            (0.37, 1.8, 1.08),
            limits=(limits,),
        ),
        Joint(
            "C1", "cylindrical", ("a", "b"), (-0.56, -0.41, -1.74), (1.2, -1.69, 0.78)
        ),
        Joint("C2", "cylindrical", ("b", "c"), (1.12, 0.73, -0.4), (-0.7, -0.64, 0.0)),
        Joint(
            "C3", "cylindrical", ("c", "g"), (-1.95, 0.13, 1.97), (-0.35, 1.16, 0.42)
        ),
    )
    return Mechanism(joints)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("low", [-2.5, 1.0])
def test_both_forms_of_a_loop_are_found_within_narrow_limits(low, seed):
    mechanism = line_symmetric_loop(R0=(low, low + 0.05))
    atlas = map_of(mechanism, settings=FEW, seed=seed)
    assert len(atlas.forms) == 2


@pytest.mark.parametrize("seed", range(3))
def test_both_forms_of_a_loop_with_slides_are_found_within_narrow_limits(seed):
    mechanism = rccc((-2.2365, -2.2165))
    atlas = map_of(mechanism, settings=FEW, seed=seed)
    assert len(atlas.forms) == 2


def test_a_form_is_found_within_narrow_limits_of_three_joints():
    free = line_symmetric_loop()
    branch = map_of(free, settings=FEW).forms[0].branch
    (place,) = Readout(free).values(branch(0.3 * branch.length)[None])
    limits = {f"R{k}": (place[k] - 0.02, place[k] + 0.03) for k in (0, 2, 4)}
    mechanism = line_symmetric_loop(**limits)
    atlas = map_of(mechanism, settings=FEW)
    assert len(atlas.forms) == 1


def test_what_is_held_stays_and_the_rest_closes():
    problem = Closure(line_symmetric_loop(R0=(1.0, 1.05)))
    starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (40, 6))
    starts[:, 0] = 1.02
    points, gaps = problem.compiled.project(starts, np.arange(6) == 0)
    assert np.abs(points[:, 0] - 1.02).max() < 1e-12
    assert np.count_nonzero(gaps < 1e-12) > 10


def test_what_is_brought_within_limits_is_closed_there():
    problem = Closure(line_symmetric_loop(R0=(1.0, 1.05)))
    rng = np.random.default_rng(0)
    starts = rng.uniform(-np.pi, np.pi, (40, 6))
    points, gaps = problem.project(starts)
    beyond = points[gaps < 1e-12]
    inside = brought_within_limits(problem, problem.compiled.project, beyond, rng)
    assert len(inside) > 10
    assert np.all(problem.domain.are_inside(inside))
    assert np.abs(problem.residuals(inside)).max() < 1e-9


def test_nothing_is_brought_from_nowhere():
    problem = Closure(line_symmetric_loop(R0=(1.0, 1.05)))
    rng = np.random.default_rng(0)
    assert brought_within_limits(
        problem, problem.compiled.project, np.empty((0, 6)), rng
    ).shape == (0, 6)


def test_the_way_along_solutions_leads_within_many_limits(monkeypatch):
    monkeypatch.setattr(within_limits, "TIMES_BACK", 0)  # nothing is held
    free = line_symmetric_loop()
    branch = linkages.map_linkage(free, settings=FEW).forms[0].branch
    (place,) = Readout(free).values(branch(0.3 * branch.length)[None])
    limits = {f"R{k}": (place[k] - 0.02, place[k] + 0.03) for k in range(5)}
    problem = Closure(line_symmetric_loop(**limits))
    rng = np.random.default_rng(0)
    starts = np.column_stack([rng.uniform(*pair, 40) for pair in limits.values()])
    starts = np.column_stack([starts, rng.uniform(-np.pi, np.pi, 40)])
    points, gaps = problem.project(starts)
    beyond = points[(gaps < 1e-12) & ~problem.domain.are_inside(points)]
    inside = within_limits.brought_within_limits(
        problem, problem.compiled.project, beyond, rng
    )
    assert len(inside) > 0.2 * len(beyond) > 2
    assert np.all(problem.domain.are_inside(inside))
    assert np.abs(problem.residuals(inside)).max() < 1e-9


@pytest.mark.parametrize("width", [1e-3, 0.1])
def test_the_form_through_the_reference_is_listed_whatever_the_limits_are(width):
    rng = np.random.default_rng(1)
    for _ in range(3):
        sides = rng.uniform(0.001, 1.0, (6, 2)) * width
        limits = {f"R{k}": (-a, b) for k, (a, b) in enumerate(sides)}
        mechanism = line_symmetric_loop(**limits)
        atlas = map_of(mechanism, settings=FEW)
        distances = [form.branch.nearest(np.zeros(6))[0][0] for form in atlas.forms]
        assert min(distances) < 1e-9
