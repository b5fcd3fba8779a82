"""Dyads close in every way in which they can."""

import cmath
from itertools import product

import numpy as np
import pytest

from linkages.dyads.geometry import (
    DegenerateDyadError,
    Pivot,
    PlaneGeometry,
    PlanePose,
    Rail,
)

KINDS = [kinds for kinds in product("RP", repeat=3) if "R" in kinds]
PLANE = PlaneGeometry(np.array([0.0, 0.0, 1.0]), 1.0)


def random_place(rng):
    return complex(*rng.normal(size=2))


def random_pose(rng):
    return PlanePose(cmath.exp(1j * rng.uniform(-np.pi, np.pi)), random_place(rng))


def random_direction(rng):
    return cmath.exp(1j * rng.uniform(-np.pi, np.pi))


def end_at(kind, pose, rng):
    """An end at which a body with this pose closes."""
    if kind == "R":
        local = random_place(rng)
        return Pivot(pose(local), local)
    along = random_direction(rng)
    start = PlanePose(pose.turn, pose.shift - rng.normal() * along)
    return Rail(start, along)


def middle_at(kind, first, second, rng):
    if kind == "R":
        local = random_place(rng)
        return Pivot(local, second.inverse()(first(local)))
    relative = first.inverse().after(second)
    along = random_direction(rng)
    start = PlanePose(relative.turn, relative.shift - rng.normal() * along)
    return Rail(start, along)


def misfit_at_end(end, pose):
    if isinstance(end, Pivot):
        return abs(pose(end.second) - end.first)
    beside = ((pose.shift - end.start.shift) / end.along).imag
    return abs(pose.turn - end.start.turn) + abs(beside)


def misfit_between(middle, first, second):
    if isinstance(middle, Pivot):
        return abs(first(middle.first) - second(middle.second))
    relative = first.inverse().after(second)
    return misfit_at_end(Rail(middle.start, middle.along), relative)


def is_among(poses, found):
    gaps = [
        max(
            max(abs(one.turn - other.turn), abs(one.shift - other.shift))
            for one, other in zip(poses, candidate, strict=True)
        )
        for candidate in found
    ]
    return min(gaps) < 1e-9


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kinds", KINDS, ids="".join)
def test_a_dyad_closes_where_it_was_taken_from_and_wherever_else(kinds, seed):
    rng = np.random.default_rng(seed)
    first, second = random_pose(rng), random_pose(rng)
    one, other = end_at(kinds[0], first, rng), end_at(kinds[2], second, rng)
    middle = middle_at(kinds[1], first, second, rng)
    found = PLANE.close_dyad(one, middle, other)
    lines_only = kinds.count("P") == 2
    assert len(found) == (1 if lines_only else 2)
    assert is_among((first, second), found)
    for poses in found:
        assert misfit_at_end(one, poses[0]) < 1e-11
        assert misfit_between(middle, *poses) < 1e-11
        assert misfit_at_end(other, poses[1]) < 1e-11


@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_a_body_on_two_joints_is_placed_by_them(kinds):
    rng = np.random.default_rng(3)
    pose = random_pose(rng)
    one, other = (end_at(kind, pose, rng) for kind in kinds)
    (found,) = PLANE.close_monad(one, other)
    assert is_among((pose,), [(found,)])


def test_a_body_between_two_pivots_that_do_not_fit_is_nowhere():
    one, other = Pivot(0j, 0j), Pivot(1 + 0j, 1.1 + 0j)
    assert PLANE.close_monad(one, other) == []


def test_circles_that_are_apart_do_not_meet():
    one, other = Pivot(0j, 0j), Pivot(3 + 0j, 0j)
    assert PLANE.close_dyad(one, Pivot(1 + 0j, 1 + 0j), other) == []


def test_equal_circles_about_one_point_meet_all_along():
    one, other, pin = Pivot(0j, 0j), Pivot(0j, 0j), Pivot(1 + 0j, -1 + 0j)
    assert PLANE.may_be_degenerate(one, pin, other)
    with pytest.raises(DegenerateDyadError):
        PLANE.close_dyad(one, pin, other)
    unequal = Pivot(1 + 0j, -1.2 + 0j)
    assert not PLANE.may_be_degenerate(one, unequal, other)
    assert PLANE.close_dyad(one, unequal, other) == []


def test_a_body_with_both_joints_on_one_axis_turns_freely():
    """In a dyad, on a slide, and alone, wherever the axis is."""
    one, other = Pivot(0j, 0j), Pivot(0.7 + 0.1j, 0j)
    coaxial = Pivot(1e-17 + 0j, 0.5 + 0j)
    assert PLANE.may_be_degenerate(one, coaxial, other)
    assert PLANE.may_be_degenerate(one, coaxial, Rail(PlanePose(1j, 0.3 + 0j), 1j))
    with pytest.raises(DegenerateDyadError):
        PLANE.close_dyad(one, coaxial, other)
    with pytest.raises(DegenerateDyadError):
        PLANE.close_monad(one, Pivot(2.0 + 0j, 0j))
