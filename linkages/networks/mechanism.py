"""A network with locked joints, as the mechanism that is mapped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import degrees
from typing import Any, NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from linkages.construction.constructions import lock, locked_angles
from linkages.loop import Loop
from linkages.mechanisms.mechanism import Lock, Mechanism, OuterJoint
from linkages.mechanisms.subject import mechanism_of
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.entries import NETWORKS
from linkages.networks.network import Network, wrap_angles
from linkages.networks.placement import PlacedNetwork
from linkages.values import GeometryError, require

# What every cell turns by at its second axis in the reference configuration, rad, where
# nothing is locked: in no special place.
PRESET = 0.9, -1.3, 2.1, -1.7
MOST_CONSTRUCTED = 48  # configurations from which a search of a network starts


class OuterLoop(NamedTuple):
    """The single ``loop`` that the outer bars of a network leave, and the outer joints
    that are ``still``, which were replaced."""

    loop: Loop
    still: tuple[str, ...]


@dataclass(frozen=True)
class NetworkMechanism(Mechanism):
    """The mechanism of a network with joints locked; all its variables are 0 in the
    configuration of ``placed``."""

    placed: PlacedNetwork = field(kw_only=True, compare=False, repr=False)
    way_to_loop = "; --without-centre takes the single loop that its outer bars leave under --lock"

    @property
    def kinks(self) -> dict[str, float]:
        """The D-H angles (rad) of the locked outer joints."""
        return self.placed.kinks

    def holds_angle(self, name: str) -> bool:
        """Always: locks hold outer joints."""
        return True

    def held(self, values: Mapping[str, float]) -> NetworkMechanism:
        """The network with outer joints, by name, locked at D-H angles (rad) besides
        those that are locked. Raises as `lock_network`."""
        kinks = self.kinks
        for axis in values:
            is_free = axis not in kinks
            require(is_free, "lock", axis, "a joint that is not locked yet")
        return lock_network(self.placed.network, {**kinks, **values})

    @property
    def locks(self) -> list[Lock]:
        """Those of outer joints, where there are any."""
        kinks = [Lock(axis, kink, True) for axis, kink in self.kinks.items()]
        return kinks or super().locks

    @property
    def outer_joints(self) -> tuple[OuterJoint, ...]:
        """Those of the ring."""
        placed = self.placed
        return tuple(
            OuterJoint(
                axis, placed.label(axis), placed.turns[axis], axis in placed.kinks
            )
            for axis in placed.network.plan.ring
        )

    @property
    def still(self) -> tuple[str, ...]:
        """The outer joints that do not move, locked ones among them."""
        return _still_joints(self.placed)

    def assemblies(self) -> np.ndarray:
        """Configurations (k, v) on every motion of one freedom, by the closed form; none
        where there are more freedoms."""
        states = assemble(self.placed.network, self.kinks)
        if len(states) > MOST_CONSTRUCTED:
            return super().assemblies()
        return self.placed.variables(states)

    def subject_values(self) -> dict[str, Any]:
        """The plan, the parameters and the locks of the network."""
        placed = self.placed
        network = {
            "name": placed.network.name,
            "parameters": dict(placed.network.parameters),
            "reference": placed.reference.tolist(),
            "kinks": dict(placed.kinks),
        }
        return {"network": network}

    def document_values(self) -> dict[str, Any]:
        """The same without the reference configuration."""
        values = self.subject_values()
        del values["network"]["reference"]
        return values

    def without_centre(self) -> OuterLoop:
        """The single loop that is left where the bars inside are taken away, and every
        joint that does not move is replaced together with its two links by one link.

        That is done in the reference configuration; where two of the links lie on each
        other there, in the next one in which they do not. Raises `GeometryError` where
        there is none, and where fewer than four joints are left.
        """
        failures = []
        for placed in (self.placed, *_placements(self.placed.network, self.kinks)):
            still = _still_joints(placed)
            try:
                return OuterLoop(replaced_ring(placed, still), still)
            except GeometryError as error:
                failures.append(error)
        raise failures[0]


def replaced_ring(placed: PlacedNetwork, joints: Sequence[str]) -> Loop:
    """The ring of a network, each of the ``joints`` replaced, where it stands, together
    with its two links by one link; raises `GeometryError` where fewer than four are
    left."""
    network = placed.network
    loop = network.ring_loop
    axes = list(network.plan.ring)
    theta = np.array([placed.turns[axis] for axis in axes])
    kinks = [placed.turns[joint] for joint in joints]
    for joint in joints:
        place = axes.index(joint)
        kink = float(theta[place])
        theta = locked_angles(loop, place + 1, kink, theta)
        loop = lock(loop, place + 1, kink)
        axes.remove(joint)
    pairs = zip(joints, kinks, strict=True)
    shown = [f"{joint}={degrees(kink):.6g}" for joint, kink in pairs]
    name = ", ".join([f"{network.name} without centre", *shown])
    return replace(loop, name=name)


def lock_network(network: Network, kinks: Mapping[str, float]) -> NetworkMechanism:
    """A network with outer joints locked at ``kinks``, D-H angles in rad by name.

    Its reference configuration is that nearest to the one without locks. Raises
    `GeometryError` for what is no outer joint, and where the network cannot be
    assembled.
    """
    placements = _placements(network, kinks)
    shown = ", ".join(f"{axis}={degrees(kink):g}" for axis, kink in kinks.items())
    allowed = "kinks at which the network can be assembled"
    require(len(placements) > 0, f"locks of {network.name}", shown, allowed)
    placed = placements[0]
    plain = placed.mechanism
    return NetworkMechanism(plain.joints, plain.name, placed=placed)


def _still_joints(placed: PlacedNetwork) -> tuple[str, ...]:
    """The outer joints that do not move from the reference configuration on."""
    motion = motion_at(placed.network, placed.locks, placed.reference)
    return motion.still(placed.network.plan.ring)


def _placements(network: Network, kinks: Mapping[str, float]) -> list[PlacedNetwork]:
    """The network in all its configurations that are known in closed form with joints
    locked, those nearest to the one without locks first."""
    states = assemble(network, kinks)
    gaps = wrap_angles(states - np.array(PRESET[: states.shape[1]]))
    # rounded, so that of those as near as each other the first one is taken
    distances = np.round(np.linalg.norm(gaps, axis=1), 9)
    order = np.argsort(distances, kind="stable")
    return [PlacedNetwork(network, states[k], kinks) for k in order]


# --- what an atlas keeps --------------------------------------------------------------


def mechanism_at(atlas: Atlas) -> Mechanism | None:
    """The mechanism that an atlas is of, a network as such; None where it is of a loop
    that was given as such. Raises `NoLinkageError` as `mechanism_of`."""
    mechanism = mechanism_of(atlas)
    values = atlas.subject.get("network")
    if mechanism is None or not isinstance(values, Mapping):
        return mechanism
    network = NETWORKS[str(values["name"])].build(**values["parameters"])
    reference = np.array(values["reference"])
    placed = PlacedNetwork(network, reference, values["kinks"])
    # its joints, of which more may be locked than the kinks of the network say
    return NetworkMechanism(mechanism.joints, mechanism.name, placed=placed)
