"""The head of a page: what the linkage is called, and where joints are locked."""

from __future__ import annotations

from math import degrees

from bifurc.atlas import Atlas
from linkages.labels import loop_of
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import mechanism_of

MOST_LOCKS = 6  # that a title lists


def title_of(atlas: Atlas) -> str:
    """The name of the linkage of an atlas, and its locks: those of a network are the
    D-H angles of its outer joints. Raises `NoLinkageError` where it is of none."""
    mechanism = mechanism_of(atlas)
    if mechanism is None:
        return loop_of(atlas).name or "linkage"
    name = mechanism.name or "mechanism"
    locks = _locks_of_network(atlas) or _locks(mechanism)
    if not locks:
        return name
    if len(locks) > MOST_LOCKS:
        return f"{name}, {len(locks)} variables locked"
    return f"{name}, locked: {', '.join(locks)}"


def _locks_of_network(atlas: Atlas) -> list[str]:
    """The locks of a network; none for anything else."""
    if "network" not in atlas.subject:
        return []
    # takes as long to import as all that a page of another mechanism needs
    from linkages.networks.mechanism import network_of

    network = network_of(atlas)
    assert network is not None
    return [_angle(joint, kink) for joint, kink in network.kinks.items()]


def _locks(mechanism: Mechanism) -> list[str]:
    """The variables that are locked by themselves, with their values."""
    motions = {one.label: one.motion for one in mechanism.variables}
    locks = []
    for joint in mechanism.joints:
        for label, value in zip(joint.labels, joint.locked, strict=True):
            if value is None:
                continue
            is_turn = motions[label].is_turn
            locks.append(_angle(label, value) if is_turn else f"{label}={value:.6g}")
    return locks


def _angle(label: str, value: float) -> str:
    # rounded first: 40 degrees in radians and back has other last digits
    return f"{label}={round(degrees(value), 6) + 0.0:.6g}°"
