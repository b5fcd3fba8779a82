"""That limits leave no configuration, in words."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from linkages.app.subject import subject_at
from linkages.app.texts.numbers import in_degrees, in_lengths

if TYPE_CHECKING:
    from linkages.app.reports.beyond_limits import LimitedRange
    from linkages.mechanisms.joint import Limits


@lru_cache(maxsize=2)
def kept_out_by_limits(atlas: Atlas) -> str:
    """The sentence on a mechanism that closes nowhere within its limits, as far as is
    seen, but does without them; empty for any other.

    Where every variable alone is within its limits in some configurations, all that is
    known is that none was found.
    """
    limited = subject_at(atlas).ranges_beyond_limits()
    if not limited:
        return ""
    unit = subject_at(atlas).size
    words = [_where(variable, unit) for variable in limited]
    start = "The linkage has no real configuration within its limits."
    if all(variable.meets_limits for variable in limited):
        start = (
            "No configuration of the linkage was found within its limits (estimated)."
        )
    return f"{start} Without them it closes with {', '.join(words)}."


def _where(variable: LimitedRange, unit: float) -> str:
    """What a variable is without its limits, and these."""
    ranges = []
    for one in variable.ranges:
        low, high = _ends((one.low, one.high), variable.is_turn, unit)
        text = f"at {low}" if low == high else f"from {low} to {high}"
        ranges.append("at all angles" if one.turns else text)
    low, high = _ends(variable.limits, variable.is_turn, unit)
    places = " or ".join(dict.fromkeys(ranges))
    return f"{variable.label} {places} (limits: {low} to {high})"


def _ends(pair: Limits, is_turn: bool, unit: float) -> list[str]:
    """The ends of a range as they are shown: degrees, or the user's unit."""
    if is_turn:
        return [in_degrees(end, 2) for end in pair]
    return [in_lengths(end, unit, 5) for end in pair]
