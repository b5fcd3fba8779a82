"""Joints of a mechanism that a command line locks or drives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkages.app.choice import read_number, split_parameter
from linkages.app.exit_codes import CommandError
from linkages.linkage import Linkage

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

__all__ = ["Inputs", "with_inputs"]


@dataclass(frozen=True)
class Inputs:
    """A mechanism with joints held for a command, and ``notes`` on those that nobody
    asked for."""

    mechanism: Linkage | Mechanism
    notes: tuple[str, ...] = ()


def with_inputs(
    text: str, linkage: Linkage | Mechanism, locks: Sequence[str], driver: str | None
) -> Inputs:
    """The mechanism called ``text`` with the ``locks``, each "J=40", in degrees or in
    the unit of the file, and what else has to be held for one joint to drive it.

    Raises `CommandError` for a linkage that takes none, `GeometryError` for a joint
    that it does not have.
    """
    if not locks and driver is None:
        return Inputs(linkage)
    option = "--lock" if locks else "--drive"
    if isinstance(linkage, Linkage):
        raise CommandError(
            f"{option}: it takes a mechanism with joints by name, and {text} is a "
            "single loop, a table or axes"
        )
    mechanism = linkage.with_locks(_read_locks(linkage, locks))
    if driver is None:
        return Inputs(mechanism)
    from linkages.mechanisms.driving import joints_to_hold

    held = joints_to_hold(mechanism, driver)
    notes: tuple[str, ...] = ()
    if held:
        names = ", ".join(held)
        notes = (
            f"--drive {driver}: so that it drives all, also held where they are in the "
            f"reference configuration: {names}",
        )
    return Inputs(mechanism.with_locks(held), notes)


def _read_locks(mechanism: Mechanism, texts: Sequence[str]) -> dict[str, float]:
    """The values of "J=40", in rad where the variable is an angle."""
    is_turn = {one.label: one.motion.is_turn for one in mechanism.variables}
    values: dict[str, float] = {}
    for text in texts:
        label, value = split_parameter(text, "--lock")
        if label in values:
            raise CommandError(f"--lock {label}: it is given twice")
        number = read_number(label, value, "--lock")
        values[label] = math.radians(number) if is_turn.get(label) else number
    return values
