"""What `bifurc identify` shows: the linkages of the catalogue that a table is a case
of, and with which parameters."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bifurc.tables import count_of
from linkages.app.reports.corrections import (
    correction_documents,
    describe_corrections,
)
from linkages.app.reports.entry_parameters import parameters_text
from linkages.app.texts.numbers import known_to
from linkages.geometry_table import link_name
from linkages.identification.corrections import Corrections
from linkages.identification.fitting import NEAR
from linkages.identification.identify import Identification, LockedJoint
from linkages.identification.match import Match

NEAREST = 3  # linkages that are shown where none fits
WORST = 4  # numbers of the table that are shown of each of them
NO_CORRECTIONS = Corrections(())
LENGTH_ROW, TWIST_ROW, OFFSET_ROW = range(3)  # of a table (3, n)


# --- text -----------------------------------------------------------------------------


def describe_identification(
    identification: Identification, corrections: Corrections = NO_CORRECTIONS
) -> str:
    """The answer as text, with what a table may be meant to be that is none: lengths in
    the unit of the table, degrees, joints numbered from 1."""
    loop = identification.loop
    matches = identification.matches
    if matches:
        linkages = count_of(len(matches), "linkage")
        sentence = f"A case of {linkages} of the catalogue, the most special first."
        parts = [_match(match) for match in matches]
    else:
        tolerance = f"{identification.tolerance:.1g}"
        sentence = f"No linkage of the catalogue has this geometry, to {tolerance}."
        parts = [_near(match) for match in identification.nearest[:NEAREST]]
        words = describe_corrections(corrections, loop.n)
        if corrections.found:
            parts = [words]
        elif not parts:
            parts = [f"None misses by less than {NEAR:g}. {words}"]
    parts += [_locked(joint) for joint in identification.locked]
    if loop.rounding:
        parts.append(known_to(loop.rounding, loop.characteristic_length))
    return "\n\n".join([f"{loop.name}\n{sentence}", *parts])


def _match(match: Match) -> str:
    """A linkage that the table is a case of."""
    lengths, twists, offsets = np.abs(match.residuals).max(axis=1)
    return (
        f"{_head(match)}\n"
        f"  {parameters_text(match)}\n"
        f"  read {match.reading}\n"
        f"  off by at most {lengths:.1e} in lengths, {twists:.1e} rad in twists, "
        f"{offsets:.1e} in offsets, of:\n"
        f"{_conditions(match)}"
    )


def _near(match: Match) -> str:
    """A linkage that the table is not, and the numbers that are off most."""
    worst = np.argsort(-np.abs(match.residuals), axis=None)[:WORST]
    rows, columns = np.unravel_index(worst, match.residuals.shape)
    lines = [
        f"Near: {_head(match)}",
        f"  {parameters_text(match)}",
        f"  off by {match.distance:.2g}:",
    ]
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        lines.append(f"    {_deviation(match, row, column)}")
    lines.append(_conditions(match))
    return "\n".join(lines)


def _deviation(match: Match, row: int, column: int) -> str:
    """One number of the table: what it would be, and by how much it is off."""
    value = match.member[row, column]
    residual = match.residuals[row, column]
    link = link_name(column, match.residuals.shape[1])
    if row == TWIST_ROW:
        degrees = math.degrees(value)
        return f"alpha{link} would be {degrees:.6f} deg (off by {residual:.2g} rad)"
    name = f"R{column + 1}" if row == OFFSET_ROW else f"a{link}"
    return f"{name} would be {value:.8g} (off by {residual:.2g})"


def _conditions(match: Match) -> str:
    """The conditions of the entry, each with how far the table is from it where it is
    an equation in its numbers."""
    lines = []
    for text, residual in match.conditions:
        remark = "" if residual is None else f"  [off by {residual:.1e}]"
        lines.append(f"    {text}{remark}")
    return "\n".join(lines)


def _head(match: Match) -> str:
    head = f"{match.entry.name}: {match.entry.title}"
    if not match.freedom:
        return head
    return f"{head}, {count_of(match.freedom, 'free parameter')}"


def _locked(locked: LockedJoint) -> str:
    best = locked.matches[0]
    names = ", ".join(match.entry.name for match in locked.matches)
    angle = math.degrees(locked.angle)
    return (
        f"With joint {locked.joint} locked at {angle:.0f} deg: {names}\n"
        f"  {best.entry.name}: {parameters_text(best)}"
    )


# --- JSON -----------------------------------------------------------------------------


def make_identification_document(
    identification: Identification, corrections: Corrections = NO_CORRECTIONS
) -> dict[str, Any]:
    """The same as a JSON document, angles in radians. ``member`` and ``residuals``, which
    are given less member, have rows a, alpha, R."""
    return {
        "linkage": identification.loop.name,
        "tolerance": identification.tolerance,
        "matches": [_match_document(m) for m in identification.matches],
        "nearest": [_match_document(m) for m in identification.nearest[:NEAREST]],
        "locked": [_locked_document(joint) for joint in identification.locked],
        "corrections": correction_documents(corrections.found, identification.loop.n),
        "two_numbers_not_looked_for": list(corrections.left),
    }


def _locked_document(locked: LockedJoint) -> dict[str, Any]:
    return {
        "joint": locked.joint,
        "angle": locked.angle,
        "matches": [_match_document(match) for match in locked.matches],
    }


def _match_document(match: Match) -> dict[str, Any]:
    return {
        "name": match.entry.name,
        "parameters": match.parameters,
        "distance": match.distance,
        "freedom": match.freedom,
        "conditions": [
            {"text": text, "residual": residual} for text, residual in match.conditions
        ],
        "member": match.member.tolist(),
        "residuals": match.residuals.tolist(),
    }
