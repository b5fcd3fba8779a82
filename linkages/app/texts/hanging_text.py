"""What hangs on a mechanism, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bifurc.tables import count_of
from linkages.mechanisms.mechanism import Mechanism

if TYPE_CHECKING:
    # they import networkx, which a loop does not need
    from linkages.structure.hanging import HangingJoint
    from linkages.structure.structure import Structure

SHOWN = 12  # joints beyond this number are only counted
NAMED = 4  # bodies that one of them carries beyond this number are only counted


def describe_hanging(structure: Structure) -> str:
    """What is held as it lies in no closed loop, a line for every joint; that nothing
    does, where no joint does; else empty."""
    hanging = structure.hanging
    if not structure.mechanism.independent_loops:
        return "No joint lies in a closed loop: each moves by itself, as far as it can."
    if not hanging.joints or not structure.holds_flaps:
        return ""
    lines = ["Held where it is drawn:"]
    lines += [_line(joint, hanging.mechanism) for joint in hanging.joints[:SHOWN]]
    more = hanging.joints[SHOWN:]
    if more:
        freedoms = sum(joint.freedoms for joint in more)
        lines.append(
            f"{count_of(len(more), 'more joint')} in no closed loop: mobility + "
            f"{freedoms}; listed with --json."
        )
    return "\n".join(lines)


def _line(joint: HangingJoint, mechanism: Mechanism) -> str:
    body, *others = joint.bodies
    sheets = {panel.body for panel in mechanism.panels}
    noun = "flap" if body in sheets else "body"
    along = {"turns": "about", "slides": "along"}.get(joint.verb, "by")
    how = "within its limits" if joint.limited else "freely"
    carried = ""
    if others:
        shown = ", ".join(others[:NAMED])
        more = f" and {len(others) - NAMED} more" if len(others) > NAMED else ""
        carried = f", with {shown}{more} on it,"
    return (
        f"{noun} {body}{carried} {joint.verb} {how} {along} {joint.joint}: mobility + "
        f"{joint.freedoms}; each form times {' and '.join(joint.spaces)}."
    )


def mobility_with_flaps(mobility: int, structure: Structure) -> str:
    """The mobility of what is mapped, and of all together where something is held."""
    if not structure.hanging.joints or not structure.holds_flaps:
        return f"Mobility {mobility}"
    return (
        f"Mobility {mobility}, {mobility + structure.hanging.freedoms} with what hangs"
    )
