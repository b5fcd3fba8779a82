"""What `bifurc identify` shows: the linkages of the catalogue that a table is a case
of, and with which parameters."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from linkages.identification.identify import (
    NEAR,
    Identification,
    LockedJoint,
    Match,
)

__all__ = ["NOT_KNOWN", "describe_identification", "make_identification_document"]

NOT_KNOWN = 5  # exit code: no linkage of the catalogue has this geometry
NEAREST, WORST = (
    3,
    4,
)  # linkages, and numbers of the table, that are shown where none fits


def describe_identification(found: Identification) -> str:
    """The answer as text: lengths in the unit of the table, degrees, joints numbered
    from 1."""
    if found.matches:
        count = f"{len(found.matches)} linkage{'s' if len(found.matches) > 1 else ''}"
        parts = [
            f"{found.loop.name}\nA case of {count} of the catalogue, the most special first."
        ]
        parts += [_match(match) for match in found.matches]
    else:
        parts = [
            f"{found.loop.name}\nNo linkage of the catalogue has this geometry, to {found.tolerance:.1g}."
        ]
        parts += [_near(match) for match in found.nearest[:NEAREST]]
        if not found.nearest:
            parts.append(f"None misses by less than {NEAR:g}, so that none is near.")
    return "\n\n".join(parts + [_locked(joint) for joint in found.locked])


def _match(match: Match) -> str:
    lengths, twists, offsets = np.abs(match.residuals).max(axis=1)
    return (
        f"{_head(match)}\n  {_parameters(match)}\n  read {match.reading}\n"
        f"  off by at most {lengths:.1e} in lengths, {twists:.1e} rad in twists, {offsets:.1e} in offsets, of:\n"
        + _conditions(match)
    )


def _conditions(match: Match) -> str:
    """The conditions of the entry, each with how far the table is from it where it is
    an equation in its numbers."""
    shown = (
        f"    {text}" + ("" if size is None else f"  [off by {size:.1e}]")
        for text, size in match.conditions
    )
    return "\n".join(shown)


def _near(match: Match) -> str:
    order = np.argsort(-np.abs(match.residuals), axis=None)[:WORST]
    lines = [
        _number(match, *(int(i) for i in np.unravel_index(k, match.residuals.shape)))
        for k in order
    ]
    head = (
        f"Near: {_head(match)}\n  {_parameters(match)}\n  off by {match.distance:.2g}:"
    )
    return "\n".join([head, *lines, _conditions(match)])


def _number(match: Match, row: int, column: int) -> str:
    n = match.residuals.shape[1]
    link = f"{column + 1}{'-' if n > 9 else ''}{(column + 1) % n + 1}"
    name = f"R{column + 1}" if row == 2 else f"{('a', 'alpha')[row]}{link}"
    wanted = match.member[row, column]
    shown = f"{math.degrees(wanted):.6f} deg" if row == 1 else f"{wanted:.8g}"
    return f"    {name} would be {shown} (off by {match.residuals[row, column]:.2g}{' rad' if row == 1 else ''})"


def _head(match: Match) -> str:
    free = f", {match.freedom} free parameters" if match.freedom else ""
    return f"{match.entry.name}: {match.entry.title}{free}"


def _parameters(match: Match) -> str:
    kinds = {p.name: p.kind for p in match.entry.parameters}
    return ", ".join(
        f"{name} = {math.degrees(value):.8g} deg"
        if kinds[name] == "angle"
        else f"{name} = {value:.8g}"
        for name, value in match.parameters.items()
    )


def _locked(found: LockedJoint) -> str:
    best = found.matches[0]
    names = ", ".join(match.entry.name for match in found.matches)
    return (
        f"With joint {found.joint} locked at {math.degrees(found.angle):.0f} deg: {names}\n  "
        f"{best.entry.name}: {_parameters(best)}"
    )


def make_identification_document(found: Identification) -> dict[str, Any]:
    """The same as a JSON document, angles in radians; ``residuals`` are given less
    member, rows a, alpha, R."""
    return {
        "linkage": found.loop.name,
        "tolerance": found.tolerance,
        "matches": [_document(match) for match in found.matches],
        "nearest": [_document(match) for match in found.nearest[:NEAREST]],
        "locked": [
            {
                "joint": joint.joint,
                "angle": joint.angle,
                "matches": [_document(match) for match in joint.matches],
            }
            for joint in found.locked
        ],
    }


def _document(match: Match) -> dict[str, Any]:
    return {
        "name": match.entry.name,
        "parameters": match.parameters,
        "distance": match.distance,
        "freedom": match.freedom,
        "conditions": [
            {"text": text, "residual": size} for text, size in match.conditions
        ],
        "member": match.member.tolist(),
        "residuals": match.residuals.tolist(),
    }
