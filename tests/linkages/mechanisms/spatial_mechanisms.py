"""Mechanisms in space with spherical joints, rods and legs."""

import numpy as np

from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism


def one_of_each():
    """A loop with a helical, a universal, a planar and a spherical joint."""
    return Mechanism(
        (
            Joint("H", "helical", ("a", "b"), (0, 0, 0), (0, 0, 1), pitch=0.7),
            Joint("U", "universal", ("b", "c"), (1, 0, 0.3), (0, 1, 0), (1, 0, 1)),
            Joint("E", "planar", ("c", "d"), (1, 1, 0), (0, 0.6, 0.8)),
            Joint("S", "spherical", ("d", "a"), (0, 1.3, 0)),
        )
    )


def rods():
    """A plate on a hinge, and a rod from it to a slider."""
    return Mechanism(
        (
            Joint("R", "revolute", ("base", "plate"), (0, 0, 0), (1, 0, 0.2)),
            Joint("S1", "spherical", ("plate", "rod"), (0.3, 1, 0)),
            Joint("S2", "spherical", ("rod", "slider"), (0.4, 1.2, 1.5)),
            Joint("P", "prismatic", ("slider", "base"), direction=(0.1, 0, 1)),
        )
    )


def rods_and_a_leg():
    """Two rods of a plate to a point, which a leg carries."""
    return Mechanism(
        (
            Joint("A", "spherical", ("base", "a"), (0, 0, 0)),
            Joint("B", "spherical", ("base", "b"), (1, 0.2, 0)),
            Joint("C", "spherical", ("base", "c"), (0.3, 1, 0.1)),
            Joint("P", "prismatic", ("c", "d"), direction=(0.2, -0.6, 0.9)),
            Joint("D", "spherical", ("a", "b", "d"), (0.5, 0.4, 1)),
        )
    )


def carried_by_legs():
    """A point that three legs carry from a slider, which moves on the base."""
    joints = [Joint("P", "prismatic", ("base", "slider"), direction=(1, 0.2, 0))]
    feet = [(0, 0, 0), (1, 0.2, 0), (0.3, 1, 0.1)]
    top = np.array([0.5, 0.4, 1.0])
    for k, foot in enumerate(feet):
        body = "slider" if k else "base"
        along = tuple(top - foot)
        joints.append(Joint(f"A{k}", "spherical", (body, f"low{k}"), foot))
        joints.append(
            Joint(f"L{k}", "prismatic", (f"low{k}", f"up{k}"), direction=along)
        )
    joints.append(Joint("T", "spherical", ("up0", "up1", "up2"), tuple(top)))
    return Mechanism(tuple(joints))


def platform_on_a_platform():
    """Six rods from the base to a plate, one from there to another plate, and five from
    plate to plate: chains with two free bodies, one of them the other way."""
    rng = np.random.default_rng(11)
    joints = []
    for k in range(12):
        below = "base" if k < 7 else "middle"
        above = "middle" if k < 6 else "top"
        foot, head = rng.normal(size=(2, 3))
        foot[2] += 0 if below == "base" else 2
        head[2] += 2 if above == "middle" else 4
        joints.append(Joint(f"A{k}", "spherical", (below, f"rod{k}"), tuple(foot)))
        joints.append(Joint(f"B{k}", "spherical", (f"rod{k}", above), tuple(head)))
    return Mechanism(tuple(joints))


def platform(locked=(0.0,) * 6):
    """A platform on six legs, each between two spherical joints."""
    rng = np.random.default_rng(3)
    feet = 2.0 * rng.normal(size=(6, 3)) * (1, 1, 0.15)
    tops = 1.2 * rng.normal(size=(6, 3)) * (1, 1, 0.25) + (0, 0, 1.7)
    joints = []
    for i, (foot, top) in enumerate(zip(feet, tops, strict=True)):
        low, up = f"low{i}", f"up{i}"
        lock = () if locked[i] is None else (locked[i],)
        joints += [
            Joint(f"A{i}", "spherical", ("base", low), foot),
            Joint(f"P{i}", "prismatic", (low, up), direction=top - foot, locked=lock),
            Joint(f"B{i}", "spherical", (up, "plate"), top),
        ]
    return Mechanism(tuple(joints), "platform")


def rsrs():
    """A loop with two spherical joints and no rod: one of them is embedded."""
    return Mechanism(
        (
            Joint("R1", "revolute", ("base", "a"), (0, 0, 0), (0, 0, 1)),
            Joint("S1", "spherical", ("a", "b"), (1, 0, 0)),
            Joint("R2", "revolute", ("b", "c"), (2, 1.2, 0.4), (1, 0.3, 0)),
            Joint("S2", "spherical", ("c", "base"), (2.5, 0, 0.3)),
        )
    )


def ring_with_rods(rng):
    """A ring of bodies with joints of many kinds at few points, and rods across it."""
    count = int(rng.integers(3, 7))
    points = rng.normal(size=(int(rng.integers(4, 8)), 3))
    joints = []
    for k in range(count):
        bodies = (f"b{k}", f"b{(k + 1) % count}")
        here, there = points[rng.choice(len(points), 2, replace=False)]
        kind = rng.choice(["spherical", "spherical", "revolute", "cylindrical"])
        # axes run through the points of other joints: some turns are idle
        axis = None if kind == "spherical" else tuple(there - here)
        joints.append(Joint(f"J{k}", str(kind), bodies, tuple(here), axis))
    for k in range(int(rng.integers(1, 5))):
        ends = points[rng.choice(len(points), 2, replace=False)]
        bodies = rng.choice(count, 2, replace=False)
        for letter, body, place in zip("ab", bodies, ends, strict=True):
            name, pair = f"R{k}{letter}", (f"b{body}", f"rod{k}")
            joints.append(Joint(name, "spherical", pair, tuple(place)))
    return Mechanism(tuple(joints))


def samples(problem, rng, count):
    """Random points within the limits."""
    low, high = problem.domain.bounds.T
    low = np.where(np.isfinite(low), low, -np.pi)
    high = np.where(np.isfinite(high), high, np.pi)
    return rng.uniform(low, high, (count, problem.n))
