"""What a network becomes when outer joints are locked, two or three at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from linkages.catalogue import distinct_entries
from linkages.identification.identify import identify
from linkages.loop import MIN_JOINTS
from linkages.networks.assembly import motion_at
from linkages.networks.mechanism import NetworkMechanism, lock_network, replaced_ring
from linkages.networks.network import Network
from linkages.networks.placement import PlacedNetwork
from linkages.values import GeometryError, require


@dataclass(frozen=True)
class LockedState:
    """A network with the joints of ``kinks`` locked at these D-H angles (rad).

    ``mobility`` is None where it cannot be assembled there. Outer joints are ``left``
    to move, or stand ``still`` besides the locked ones. ``linkages`` are the names of
    the catalogue that the single loop of the joints left is a case of, the most special
    one first.
    """

    kinks: Mapping[str, float]
    mobility: int | None
    left: tuple[str, ...] = ()
    still: tuple[str, ...] = ()
    linkages: tuple[str, ...] = ()

    @property
    def becomes(self) -> str:
        """What is left of the outer loop, in a word."""
        if self.mobility is None:
            return "no configuration"
        if not self.mobility:
            return "rigid"
        return f"{len(self.left)}R"


def locked_states(
    network: Network, count: int, kinks: tuple[float, ...] = ()
) -> Iterator[LockedState]:
    """What becomes of a network for every choice of ``count`` outer joints.

    They are locked at ``kinks`` (rad), in the order of the ring, or, where none are
    given, where they stand in the reference configuration. Raises `GeometryError` for
    another number of kinks.
    """
    is_whole = len(kinks) in (0, count)
    require(is_whole, "number of kinks", len(kinks), f"{count}, one for each")
    reference = lock_network(network, {}).placed.reference
    for axes in combinations(network.plan.ring, count):
        if not kinks:
            standing = PlacedNetwork(network, reference).turns
            values = {axis: standing[axis] for axis in axes}
            yield _state_at(PlacedNetwork(network, reference, values))
            continue
        values = dict(zip(axes, kinks, strict=True))
        try:
            mechanism = lock_network(network, values)
        except GeometryError:
            yield LockedState(values, None)
            continue
        yield locked_state(mechanism)


def locked_state(mechanism: NetworkMechanism) -> LockedState:
    """What a network with locked joints is, in its reference configuration."""
    return _state_at(mechanism.placed)


def _state_at(placed: PlacedNetwork) -> LockedState:
    network = placed.network
    ring = network.plan.ring
    motion = motion_at(network, placed.locks, placed.reference)
    at_rest = motion.still(ring)
    left = tuple(axis for axis in ring if axis not in at_rest)
    still = tuple(axis for axis in at_rest if axis not in placed.kinks)
    names: tuple[str, ...] = ()
    if motion.mobility == 1 and len(left) >= MIN_JOINTS:
        loop = replaced_ring(placed, at_rest)
        names = identify(loop, entries=distinct_entries(), locking=False).names
    return LockedState(placed.kinks, motion.mobility, left, still, names)
