"""How assemblies are held: infinitesimal flexes, stresses, and what second order says.

An isolated configuration and the closure equations go in; out come how many flexes and
stresses it has, the velocities of joints along each flex, the stresses of bars, and by
what it is known to be rigid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bifurc.numerics.singular_values import singular_values
from bifurc.singular.prestress import (
    SecondOrder,
    positive_combination,
    second_order_at,
)
from linkages.decisions import is_drawn_singular
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.readout import Readout
from linkages.structure.plane import is_on_sphere, normal_of_plane

SAME = 1e-6  # rad, and over the characteristic length: between assemblies that are one
CARRIES = 1e-6  # of a stress, over its largest: a bar that has less has none
STEP = 1e-5  # along a flex, in its unit, to either side: poses are entire functions


@dataclass(frozen=True, eq=False)
class Hold:
    """How a configuration ``point`` (n,) is held: so many ``stresses``, and what second
    ``order`` says of the closure equations, in whose unknowns flexes are."""

    point: np.ndarray
    stresses: int
    order: SecondOrder

    @property
    def flexes(self) -> int:
        """How many independent infinitesimal flexes there are."""
        return len(self.order.flexes)

    @property
    def words(self) -> str:
        """By what it is known to be rigid."""
        if not len(self.order.within):
            return "first order"
        if self.order.is_prestress_stable:
            return "prestress"
        return "second order" if self.order.is_rigid else "-"


def hold_at(readout: Readout, point: np.ndarray) -> Hold:
    """How the assembly at a configuration (n,) of the atlas is held.

    There are as many stresses as flexes, less Grübler's count (Maxwell 1864, Calladine
    1978), which is that of a plane or a sphere where all moves there; rods that turn
    about themselves, and what is held as it hangs in no loop, are in neither.
    """
    order = second_order_at(readout.closure, point)
    structure, mechanism = readout.structure, readout.mechanism
    is_flat = normal_of_plane(mechanism) is not None or is_on_sphere(mechanism)
    freedoms = mechanism.count_of_freedoms(3) if is_flat else mechanism.gruebler
    freedoms -= len(structure.idle_turns) + len(structure.rods)
    if structure.holds_flaps:
        freedoms -= structure.hanging.freedoms
    return Hold(point, max(len(order.flexes) - freedoms, 0), order)


def held_document(readout: Readout, point: np.ndarray) -> dict[str, Any]:
    """How the assembly at a configuration (n,) is held, in values that JSON can hold: of
    points in a plane also where they are, their velocities along flexes, and the stresses
    of bars."""
    hold = hold_at(readout, point)
    held: dict[str, Any] = {
        "flexes": hold.flexes,
        "stresses": hold.stresses,
        "is_prestress_stable": hold.order.is_prestress_stable,
        "is_rigid": hold.order.is_rigid,
    }
    mechanism = readout.mechanism
    size = dimension_of_points(mechanism)
    if not size:
        return held
    names = [joint.name for joint in mechanism.joints]
    (places,) = points_at(readout, point[None]) + np.array(mechanism.origin)
    held["points"] = _by_name(names, places[:, :size])
    held["velocities"] = [
        _by_name(names, rates[:, :size]) for rates in velocities(readout, hold)
    ]
    stresses = bar_stresses(readout, hold)
    if stresses is not None:
        bars, holding = stresses.bars, stresses.holding
        held["bar_stresses"] = [_by_name(bars, one) for one in stresses.densities]
        held["holding_stress"] = None if holding is None else _by_name(bars, holding)
    return held


def _by_name(names: Sequence[str], values: np.ndarray) -> dict[str, Any]:
    return dict(zip(names, values.tolist(), strict=True))


# --- points ---------------------------------------------------------------------------


def dimension_of_points(mechanism: Mechanism) -> int:
    """How many coordinates the joints have, where all are points of a plane or of space,
    as of bars; else 0."""
    kinds = {joint.kind for joint in mechanism.joints}
    if mechanism.is_planar and kinds == {JointKind.REVOLUTE}:
        return 2
    return 3 if kinds == {JointKind.SPHERICAL} else 0


def moving_points(mechanism: Mechanism) -> list[str]:
    """The names of the joints that are no points of the frame."""
    return [joint.name for joint in mechanism.joints if not _is_fixed(mechanism, joint)]


def points_at(readout: Readout, points: np.ndarray) -> np.ndarray:
    """Where all joints are in space, (k, j, 3), at configurations (k, n), in the user's
    unit."""
    mechanism = readout.mechanism
    bodies = [mechanism.bodies.index(one.bodies[0]) for one in mechanism.joints]
    poses = readout.poses(points)[:, bodies]
    places = np.array([[*joint.place, 1.0] for joint in mechanism.joints])
    placed: np.ndarray = np.einsum("kjab,jb->kja", poses, places)[..., :3]
    return placed


def velocities(readout: Readout, hold: Hold) -> np.ndarray:
    """The velocities (f, j, 3) of all joints along each flex, the largest of length 1."""
    steps = STEP * hold.order.flexes
    ahead = points_at(readout, hold.point + steps)
    behind = points_at(readout, hold.point - steps)
    rates = (ahead - behind) / (2.0 * STEP)
    sizes = np.linalg.norm(rates, axis=2).max(axis=1, initial=0.0)
    unit: np.ndarray = rates / np.where(sizes > 0.0, sizes, 1.0)[:, None, None]
    return unit


def _is_fixed(mechanism: Mechanism, joint: Joint) -> bool:
    return mechanism.frame in joint.bodies


# --- stresses of bars -----------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class BarStresses:
    """Force densities, force over length, of ``bars`` that are in balance at every point
    that moves: independent ones, ``densities`` (s, b), and ``holding`` (b,), which holds
    the flexes, where one does. The largest of each is 1 in size, and positive ones pull."""

    bars: tuple[str, ...]
    densities: np.ndarray
    holding: np.ndarray | None


def bar_stresses(readout: Readout, hold: Hold) -> BarStresses | None:
    """The stresses of a framework of bars between points; None of another
    mechanism."""
    ends = _ends_of_bars(readout.mechanism)
    if ends is None:
        return None
    first, last = np.array(list(ends.values())).T
    right = np.linalg.svd(_balance(readout, hold.point, first, last))[2]
    stresses = right[len(ends) - hold.stresses :]
    holding = None
    if hold.flexes and len(stresses):
        rates = velocities(readout, hold)
        apart = rates[:, first] - rates[:, last]
        forms = np.einsum("sb,abi,cbi->sac", stresses, apart, apart)
        weights, _ = positive_combination(forms)
        holding = None if weights is None else _of_size_one(weights @ stresses)
    densities = np.array([_of_size_one(stress) for stress in stresses])
    return BarStresses(tuple(ends), densities.reshape(-1, len(ends)), holding)


def is_as_drawn(readout: Readout, point: np.ndarray) -> bool:
    """Whether what is singular in the assembly at a configuration (n,) is as it is drawn:
    the assembly itself, or all points of bars in which the stress that holds it is."""
    drawn = readout.structure.reference
    smallest = singular_values(readout.closure, drawn)[-1]
    if not is_drawn_singular(float(smallest)):
        return False
    if _is_same(readout, point, drawn):
        return True
    hold = hold_at(readout, point)
    stresses = bar_stresses(readout, hold) if hold.flexes else None
    if stresses is None or stresses.holding is None:
        return False
    ends = _ends_of_bars(readout.mechanism) or {}
    carry = np.abs(stresses.holding) > CARRIES
    numbers = sorted(
        {end for bar in np.array(list(ends.values()))[carry] for end in bar}
    )
    places = points_at(readout, np.stack([point, drawn]))[:, numbers]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=3)
    gaps = np.abs(apart[0] - apart[1]).max(initial=0.0)
    return bool(gaps < SAME * readout.structure.unit)


def _is_same(readout: Readout, point: np.ndarray, other: np.ndarray) -> bool:
    gap = readout.closure.domain.difference(point, other)
    return bool(np.linalg.norm(gap) < SAME)


def _balance(
    readout: Readout, point: np.ndarray, first: np.ndarray, last: np.ndarray
) -> np.ndarray:
    """The forces (d p, b) on the p points that move of bars, between the joints numbered
    ``first`` and ``last`` (b,), with densities of 1, at a configuration (n,)."""
    size = dimension_of_points(readout.mechanism)
    places = points_at(readout, point[None])[0, :, :size]
    along = places[first] - places[last]
    joints = readout.mechanism.joints
    moves = np.array([not _is_fixed(readout.mechanism, joint) for joint in joints])
    balance = np.zeros((len(joints), size, len(first)))
    bars = np.arange(len(first))
    balance[first, :, bars] += along
    balance[last, :, bars] -= along
    on_points: np.ndarray = balance[moves].reshape(-1, len(first))
    return on_points


def _ends_of_bars(mechanism: Mechanism) -> dict[str, tuple[int, int]] | None:
    """The two joints, by number, of every bar; None where there is something else."""
    if not dimension_of_points(mechanism):
        return None
    ends: dict[str, list[int]] = {}
    for number, joint in enumerate(mechanism.joints):
        for body in joint.bodies:
            if body != mechanism.frame:
                ends.setdefault(body, []).append(number)
    if any(len(numbers) != 2 for numbers in ends.values()):
        return None
    return {body: (first, last) for body, (first, last) in ends.items()}


def _of_size_one(stress: np.ndarray) -> np.ndarray:
    """The stress (b,) with 1, or -1, for the bar that has most."""
    unit: np.ndarray = stress / np.abs(stress).max()
    return unit
