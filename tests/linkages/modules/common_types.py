"""Common types of modules, and of chains in single loops.

``python -m tests.linkages.modules.common_types`` makes their generic solutions anew, and
writes them where they are read, in ten minutes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from linkages.dyads.generic import (
    SHIPPED,
    RealFamily,
    find_generic,
    name_of,
    write_generic,
)
from linkages.dyads.group import Pattern, group_of
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.modules.assemblies import Module
from linkages.modules.loops import chains_of
from linkages.structure.structure import ClosureKind, Structure

PRISM = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)]
LEG = 3  # of the prism
K33 = [(i, j) for i in (0, 2, 4) for j in (1, 3, 5)]


class CommonType(NamedTuple):
    """The equations of a type that stands, and how many complex assemblies it has."""

    family: RealFamily
    count: int


def vector(numbers):
    x, y, z = map(float, numbers)
    return x, y, z


def platform(feet, heads):
    """A plate that legs hold at points (k, 3) from points (k, 3) of the frame."""
    joints = []
    for number, (foot, head) in enumerate(zip(feet, heads, strict=True)):
        leg = f"leg{number}"
        joints += [
            Joint(f"A{number}", JointKind.SPHERICAL, ("frame", leg), vector(foot)),
            Joint(f"B{number}", JointKind.SPHERICAL, (leg, "plate"), vector(head)),
        ]
    return Mechanism(tuple(joints))


def random_platform(seed):
    """One on six legs."""
    points = np.random.default_rng(seed).normal(size=(6, 2, 3))
    return platform(points[:, 0], points[:, 1])


def on_sphere(directions, arcs):
    """Points (k, 3) on a sphere, and arcs between them."""
    bodies = {point: [] for arc in arcs for point in arc}
    for start, end in arcs:
        bodies[start].append(f"{start}-{end}")
        bodies[end].append(f"{start}-{end}")
    return Mechanism(
        tuple(
            Joint(
                f"P{point}",
                JointKind.REVOLUTE,
                tuple(own),
                (0.0, 0.0, 0.0),
                vector(directions[point]),
            )
            for point, own in sorted(bodies.items())
        )
    )


def random_on_sphere(arcs, seed):
    return on_sphere(np.random.default_rng(seed).normal(size=(6, 3)), arcs)


def group_of_bars(arcs, *, is_spherical=False, first=0):
    """Bars between points, in a plane or on a sphere, of which one, the ``first``,
    stands."""
    arcs = [arcs[first], *arcs[:first], *arcs[first + 1 :]]
    order = list(dict.fromkeys(point for arc in arcs for point in arc))
    bodies = tuple(tuple(map(order.index, arc)) for arc in arcs[1:])
    return group_of(Pattern(bodies, len(arcs[0]), is_spherical))


def family_of(mechanism):
    """The equations of a mechanism that nothing moves."""
    return Module(Structure(mechanism)).family


# Ronga and Vust 1995; in a plane: Wunderlich 1976, Borcea and Streinu 2004; on a sphere,
# with reflections: Gallet, Grasegger, Legersky and Schicho 2021
TYPES = {
    "platform on six legs": CommonType(family_of(random_platform(0)), 40),
    "prism, a side of a triangle standing": CommonType(group_of_bars(PRISM), 24),
    "prism, a leg standing": CommonType(group_of_bars(PRISM, first=LEG), 24),
    "K(3,3)": CommonType(group_of_bars(K33), 16),
    "prism on a sphere": CommonType(group_of_bars(PRISM, is_spherical=True), 32),
    "prism on a sphere, a leg standing": CommonType(
        group_of_bars(PRISM, is_spherical=True, first=LEG), 32
    ),
    "K(3,3) on a sphere": CommonType(group_of_bars(K33, is_spherical=True), 16),
}


# Chains of single turns and slides. To a frame: Raghavan and Roth 1993; to a point: Pieper
# 1968 for three turns; to a distance: where a line or a circle meets a sphere.
CHAINS = {
    ClosureKind.ROD: {"P": 2, "R": 2},
    ClosureKind.POINT: {"PPP": 1, "PPR": 2, "PRP": 2, "PRR": 4, "RPR": 4, "RRR": 4},
    ClosureKind.CYCLE: {
        "PPPRRR": 2,
        "PPRPRR": 2,
        "PRPRPR": 2,
        "PPRRRR": 8,
        "PRPRRR": 8,
        "PRRPRR": 8,
        "PRRRRR": 16,
        "RRRRRR": 16,
    },
}
TYPES |= {
    letters: CommonType(chains_of(kind, letters), count)
    for kind, counts in CHAINS.items()
    for letters, count in counts.items()
}


def make() -> None:
    """Write the generic solutions of all types."""
    known = {}
    for name, one in TYPES.items():
        generic = find_generic(one.family, 2 * one.count)
        if generic.count != one.count:
            raise ArithmeticError(f"{name}: {generic.count} solutions are not all")
        known[name_of(one.family.family)] = generic
    write_generic(SHIPPED, known)


if __name__ == "__main__":
    make()
