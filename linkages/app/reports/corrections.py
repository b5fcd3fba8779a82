"""What a table is meant to be that is rounded or has a misprint: as text, as a JSON
document, and as a file with the exact table."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from linkages.app.reports.entry_parameters import parameters_text
from linkages.app.texts.numbers import in_degrees
from linkages.identification.corrections import (
    PATIENCE,
    ROUNDED,
    Change,
    Correction,
    Corrections,
)
from linkages.identification.recovery import Row
from linkages.loop import Loop

SAME = 1e-9  # a number of the exact table and the printed one, relative, rad
DIGITS = 15  # of the numbers in the file
NO_CORRECTION = (
    "None has all its numbers but one either, or but two that are not both twists, nor all "
    "of them with two rows, two numbers of a column, or a column in another place."
)
TITLES = {Row.LENGTHS: "lengths", Row.TWISTS: "twists", Row.OFFSETS: "offsets"}


# --- text -----------------------------------------------------------------------------


def describe_corrections(corrections: Corrections, n: int) -> str:
    """What a table of n joints is meant to be: every way to mend it by the simplest
    mistake, each with the most special of its linkages; and what was not looked for."""
    if not corrections.found:
        return " ".join([NO_CORRECTION, *_not_looked_for(corrections)])
    best = best_corrections(corrections.found)
    if not best[0].changes:
        match = best[0].match
        word = "a rounding of" if best[0].is_rounding else "near"
        lines = [
            f"It is {word} {match.entry.name}: {match.entry.title}",
            f"  {parameters_text(match)}",
            f"  off by {match.distance:.1e}, all numbers together.",
        ]
        return "\n".join([*lines, *_not_looked_for(corrections)])
    wrong = {change.name(n): None for one in best for change in one.changes}
    head = f"A misprint, probably; suspicious: {', '.join(wrong)}."
    if not all(one.is_rounding for one in best):
        head = f"A misprint, but in doubt which; suspicious: {', '.join(wrong)}."
    elif len(best) > 1:
        head += f" {len(best)} ways to mend the table; it cannot tell which is right."
    ways = [_correction(one, n) for one in best]
    return "\n".join([head, *ways, *_not_looked_for(corrections)])


def best_corrections(corrections: Sequence[Correction]) -> list[Correction]:
    """Those than which none is simpler and as near, nor nearer and as simple, one for
    each way to mend the table."""
    ways: list[Correction] = []
    for one in corrections:
        is_beaten = any(_beats(other, one) for other in corrections)
        if not is_beaten and not any(_is_same_way(one, other) for other in ways):
            ways.append(one)
    return ways


def _beats(one: Correction, other: Correction) -> bool:
    """Whether a mistake is simpler than another one and leaves no more, or is as simple
    and leaves nothing but rounding where the other leaves more."""
    own, others = one.is_rounding, other.is_rounding
    is_simpler, is_nearer = one.depth < other.depth, own and not others
    return (is_simpler and own >= others) or (is_nearer and one.depth <= other.depth)


def _is_same_way(one: Correction, other: Correction) -> bool:
    """Whether two corrections mend the same numbers alike."""
    if one.mistake != other.mistake or len(one.changes) != len(other.changes):
        return False
    pairs = zip(one.changes, other.changes, strict=True)
    return all(
        (a.row, a.column) == (b.row, b.column) and _is_near(a.meant, b.meant)
        for a, b in pairs
    )


def _not_looked_for(corrections: Corrections) -> list[str]:
    """The families that were left out of the search for two numbers, in a sentence."""
    if not corrections.left:
        return []
    names = ", ".join(corrections.left)
    return [f"Two wrong numbers not looked for ({PATIENCE:g} s at most): {names}."]


def _correction(correction: Correction, n: int) -> str:
    match = correction.match
    lines = [
        f"  {match.entry.name}: {match.entry.title}",
        f"    {parameters_text(match)}",
    ]
    if correction.mistake:
        lines.append(f"    {correction.mistake}")
    else:
        lines += [f"    {_change(change, n)}" for change in correction.changes]
    remark = "" if correction.is_rounding else ", more than rounding makes: in doubt"
    lines.append(f"    off by {match.distance:.1e} then{remark}")
    return "\n".join(lines)


def _change(change: Change, n: int) -> str:
    unit = " deg" if change.row is Row.TWISTS else ""
    name, right = change.name(n), _shown(change.row, change.meant)
    printed = _shown(change.row, change.printed)
    return f"{name} would be {right}{unit}, not {printed}{unit}{_reason(change)}"


def _shown(row: Row, value: float) -> str:
    return in_degrees(value) if row is Row.TWISTS else f"{value:.6g}"


def _reason(change: Change) -> str:
    """How a wrong number may have come about."""
    printed, meant = change.printed, change.meant
    if _is_near(meant, -printed):
        return " (the sign)"
    if change.row is Row.TWISTS:
        if _is_near(math.cos(meant), -math.cos(printed)) and _is_near(
            math.sin(meant), math.sin(printed)
        ):
            return " (the supplement)"
        if _is_near(math.cos(meant - printed), -1.0):
            return " (half a turn)"
    return ""


def _is_near(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=ROUNDED, abs_tol=1e-6)


# --- JSON -----------------------------------------------------------------------------


def correction_documents(
    corrections: Iterable[Correction], n: int
) -> list[dict[str, Any]]:
    """The same as JSON, angles in rad; ``table`` has rows a, alpha, R."""
    return [
        {
            "name": one.match.entry.name,
            "parameters": one.match.parameters,
            "mistake": one.mistake,
            "changes": [
                {"number": c.name(n), "printed": c.printed, "meant": c.meant}
                for c in one.changes
            ],
            "table": one.match.member.tolist(),
            "distance": one.match.distance,
            "is_rounding": one.is_rounding,
        }
        for one in corrections
    ]


# --- the file -------------------------------------------------------------------------


def exact_toml(printed: Loop, correction: Correction) -> str:
    """The text of a file with the exact table that a ``printed`` one is meant to be, a
    comment at each number that is another one there."""
    match = correction.match
    words = [f"# {match.entry.name}: {parameters_text(match)}"]
    if correction.mistake:
        words.append(f"# {correction.mistake} in {printed.name}")
    lines = [*words, f"name = {json.dumps(printed.name, ensure_ascii=False)}"]
    lines.append('angles = "deg"')
    rows = (printed.lengths, printed.twists, printed.offsets)
    wrong = {(change.row, change.column) for change in correction.changes}
    for row, values in zip(Row, rows, strict=True):
        lines.append(f"{TITLES[row]} = [")
        right = match.member[row.value]
        for column in range(printed.n):
            change = Change(row, column, float(values[column]), float(right[column]))
            is_wrong = (row, column) in wrong
            lines.append(f"    {_line(change, printed, is_wrong)}")
        lines.append("]")
    return "\n".join(lines) + "\n"


def _line(change: Change, printed: Loop, is_wrong: bool) -> str:
    """One number of the file, and what it is in the printed table."""
    factor = 180 / math.pi if change.row is Row.TWISTS else 1.0
    unit = 1.0 if change.row is Row.TWISTS else printed.characteristic_length
    text = f"{_number(factor * change.meant)},"
    gap = abs(change.meant - change.printed) / unit
    if gap <= SAME:
        return text
    name = change.name(printed.n)
    word = "misprint" if is_wrong else "rounded"
    shown = _number(factor * change.printed)
    return f"{text}  # {name}: {shown} is printed ({word})"


def _number(value: float) -> str:
    return repr(
        float(np.format_float_positional(value, DIGITS, fractional=False)) + 0.0
    )
