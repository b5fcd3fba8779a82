"""Joints of a mechanism that a command line locks or drives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from linkages.app.choice import (
    choose_linkage,
    read_number,
    require_kind,
    split_parameter,
)
from linkages.app.exit_codes import CommandError
from linkages.app.options import HoldOptions
from linkages.linkage import Linkage
from linkages.values import GeometryError, check_angle, told_apart

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.networks.mechanism import NetworkMechanism

# why something has no centre to be left without
NO_NETWORK = "--without-centre: it takes a network, and {} is none"


@dataclass(frozen=True)
class Inputs:
    """A mechanism with joints held for a command, and ``notes`` on those that nobody
    asked for."""

    mechanism: Linkage | Mechanism
    notes: tuple[str, ...] = ()


def choose_held(
    text: str, parameters: Sequence[str], hold: HoldOptions
) -> Linkage | Mechanism:
    """What `choose_linkage` finds, with joints held; what nobody asked for is said on
    standard error. Raises as `choose_linkage` and `hold_joints`."""
    inputs = hold_joints(text, choose_linkage(text, parameters), hold)
    for note in inputs.notes:
        click.echo(note, err=True)
    return inputs.mechanism


def hold_joints(text: str, linkage: Linkage | Mechanism, hold: HoldOptions) -> Inputs:
    """The mechanism called ``text`` with the locks, each "J=40", angles in degrees, and
    slides in the file's unit of length, and what else has to be held for one joint to
    drive it; of a network, where that is asked for, the loop without its centre.

    Raises `CommandError` for a linkage that takes none, `GeometryError` for a joint
    that it does not have.
    """
    if hold == HoldOptions():
        return Inputs(linkage)
    if hold.is_without_centre:
        _require_network(text, linkage)
    from linkages.mechanisms.mechanism import Mechanism

    refusal = (
        f"{hold.names}: it takes a mechanism with joints by name, and {text} is a "
        "single loop, a table or axes"
    )
    locked = _with_locks(require_kind(linkage, Mechanism, refusal), hold.locks)
    inputs = Inputs(locked) if hold.driver is None else _driven(locked, hold.driver)
    if not hold.is_without_centre:
        return inputs
    loop = _without_centre(_require_network(text, inputs.mechanism))
    return Inputs(loop.mechanism, inputs.notes + loop.notes)


def _driven(mechanism: Mechanism, driver: str) -> Inputs:
    """The mechanism with what has to be held for one joint to drive it."""
    from linkages.closure.driving import joints_to_hold

    held = joints_to_hold(mechanism, driver)
    notes: tuple[str, ...] = ()
    if held:
        names = ", ".join(held)
        notes = (
            f"--drive {driver}: so that it drives all, also held where they are in the "
            f"reference configuration: {names}",
        )
    return Inputs(mechanism.with_locks(held), notes)


def _with_locks(mechanism: Mechanism, texts: Sequence[str]) -> Mechanism:
    """The mechanism with the locks: those of a network are D-H angles of its outer
    joints."""
    from linkages.networks.mechanism import NetworkMechanism

    if isinstance(mechanism, NetworkMechanism):
        return mechanism.with_kinks(read_kinks(texts))
    return mechanism.with_locks(_read_locks(mechanism, texts))


def read_kinks(texts: Sequence[str], option: str = "--lock") -> dict[str, float]:
    """The D-H angles, rad, by the names of joints, of "2=40", in degrees; raises
    `CommandError` and `GeometryError`."""
    kinks: dict[str, float] = {}
    for text in texts:
        joint, value = split_parameter(text, option)
        if joint in kinks:
            raise CommandError(f"{option} {joint}: it is given twice")
        number = read_number(joint, value, option)
        check_angle(f"{option} {joint}", number, in_degrees=True)
        kinks[joint] = math.radians(number)
    return kinks


def _require_network(text: str, linkage: Linkage | Mechanism) -> NetworkMechanism:
    from linkages.networks.mechanism import NetworkMechanism

    return require_kind(linkage, NetworkMechanism, NO_NETWORK.format(text))


def _without_centre(network: NetworkMechanism) -> Inputs:
    """The single loop that is left of a network without the bars inside."""
    loop = network.without_centre()
    note = (
        "--without-centre: every motion of the network is one of this loop, and the "
        "loop may have more: taking the middle away adds forms and bifurcations"
    )
    followers = [joint for joint in network.still if joint not in network.kinks]
    notes: tuple[str, ...] = (note,)
    if followers:
        names = ", ".join(followers)
        notes += (f"--without-centre: replaced as well, for it does not move: {names}",)
    return Inputs(Linkage(loop), notes)


def _read_locks(mechanism: Mechanism, texts: Sequence[str]) -> dict[str, float]:
    """The values of "J=40", in rad where the variable is an angle."""
    is_turn = {one.label: one.motion.is_turn for one in mechanism.variables}
    values: dict[str, float] = {}
    for text in texts:
        label, value = split_parameter(text, "--lock")
        if label in values:
            raise CommandError(f"--lock {label}: it is given twice")
        number = read_number(label, value, "--lock")
        if is_turn.get(label):
            check_angle(f"--lock {label}", number, in_degrees=True)
            number = math.radians(number)
        values[label] = number
    check_limits(mechanism, values)
    return values


def check_limits(mechanism: Mechanism, values: Mapping[str, float]) -> None:
    """Raise `GeometryError`, in degrees, for a lock, by the label of its variable,
    outside the limits of a file."""
    for one in mechanism.variables:
        value = values.get(one.label)
        if value is None or one.limits is None:
            continue
        low, high = one.limits
        if low <= value <= high:
            continue
        unit = math.radians(1.0) if one.motion.is_turn else 1.0
        word = " deg" if one.motion.is_turn else ""
        shown, least, most = told_apart(value / unit, low / unit, high / unit)
        allowed = f"within its limits {least} to {most}{word}"
        raise GeometryError(f"--lock {one.label}", f"{shown}{word}", allowed)
