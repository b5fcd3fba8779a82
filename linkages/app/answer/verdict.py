"""What a linkage is, by its atlas: mobile, rigid, or without any real configuration;
and the exit code for it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NoReturn

import click

from bifurc.atlas import Atlas, NearMotion
from bifurc.completeness import Completeness, Level
from bifurc.decisions import closes_to_rounding
from bifurc.singular.point import Kind
from bifurc.systems.verdict import (
    has_only_open_points,
    remark_on_charts,
    words_of_components,
)
from bifurc.tables import count_of
from linkages.app.exit_codes import ExitCode
from linkages.app.reports.entry_parameters import member_text
from linkages.app.texts.configurations import ArclengthUnit, arclength_unit
from linkages.app.texts.numbers import in_degrees, in_lengths
from linkages.identification.corrections import roundings_of
from linkages.identification.identify import identify
from linkages.statements import has_all_assemblies
from linkages.subject import subject_at
from linkages.turns.translates import translates_of
from linkages.values import GeometryError

if TYPE_CHECKING:
    from linkages.mechanisms.joint import Limits
    from linkages.readout.beyond_limits import LimitedRange


@dataclass(frozen=True)
class Verdict:
    """One sentence on what the linkage is, and the exit code."""

    sentence: str
    code: ExitCode


def judge(atlas: Atlas) -> Verdict:
    """What the linkage of an atlas is.

    An interrupted search is said to be one, whatever it found. A search that ran out of
    time before it found a motion says nothing of the linkage.
    """
    if atlas.provenance.interrupted:
        return Verdict(_interrupted(atlas), ExitCode.INTERRUPTED)
    if atlas.forms or atlas.surfaces:
        return Verdict(_mobile(atlas) + _flaps(atlas) + _remark(atlas), ExitCode.DONE)
    if atlas.completeness.level is Level.OUT_OF_TIME:
        return Verdict(_nothing_known(atlas), ExitCode.NOTHING_KNOWN)
    if has_only_open_points(atlas):
        return Verdict(_closed_at_points(atlas), ExitCode.NOTHING_KNOWN)
    return Verdict(_immobile(atlas) + _flaps(atlas), ExitCode.DOES_NOT_MOVE)


def exit_by(verdict: Verdict) -> NoReturn:
    """End a command that has written what there is, with the exit code of the verdict;
    one that is not "done" is said on standard error."""
    if verdict.code is not ExitCode.DONE:
        click.echo(verdict.sentence, err=True)
    click.get_current_context().exit(verdict.code)


def is_without_gaps(completeness: Completeness) -> bool:
    """Whether every slice was complete, and nothing rests on random starts alone."""
    return completeness.level in (Level.COUNTED, Level.CERTIFIED)


def _interrupted(atlas: Atlas) -> str:
    forms = count_of(len(atlas.forms), "form")
    bifurcations = count_of(len(atlas.bifurcations), "bifurcation")
    return f"The search was interrupted; {forms} and {bifurcations} were found by then."


def _remark(atlas: Atlas) -> str:
    """What to add where the answer is in doubt."""
    if not atlas.completeness.is_in_doubt:
        return ""
    return " Some of it is in doubt: see its completeness."


def _flaps(atlas: Atlas) -> str:
    """What hangs on the linkage, where that is held."""
    freedoms = subject_at(atlas).held_freedoms
    return f" What hangs on it has mobility {freedoms} besides." if freedoms else ""


def _mobile(atlas: Atlas) -> str:
    forms = count_of(len(atlas.forms), "form")
    translates = translates_of(atlas)
    if atlas.forms and translates is not None:
        distinct = translates.distinct_forms
        fewer = f"{distinct} " if distinct < len(atlas.forms) else ""
        forms += f" ({fewer}up to whole turns)"
    if not atlas.surfaces:
        components = count_of(atlas.components, "component")
        bifurcations = count_of(len(atlas.bifurcations), "bifurcation")
        sentence = (
            f"The linkage moves with mobility {_at_least(atlas, 1)}: {forms} in "
            f"{components}, {bifurcations}."
        )
        return sentence + _within_tolerance(atlas)
    dimension = max(surface.dimension for surface in atlas.surfaces)
    mobility = _at_least(atlas, dimension)
    sentence = f"The linkage moves with mobility {mobility}{_components(atlas)}"
    if atlas.forms:
        sentence += f", and has {forms} of mobility 1"
    return f"{sentence}.{_within_tolerance(atlas)}{remark_on_charts(atlas)}"


def _at_least(atlas: Atlas, mobility: int) -> str:
    """The mobility, and that it may be larger where creases are at rest that may fold."""
    readout = subject_at(atlas).readout
    is_part = readout is not None and bool(readout.mechanism.at_rest)
    return f"{mobility} at least" if is_part else str(mobility)


def _components(atlas: Atlas) -> str:
    """How many components of the largest mobility there are, where all of them are known
    to be products or covered by charts."""
    largest = [one for one in atlas.surfaces if one.dimension == atlas.mobility]
    words = words_of_components(largest)
    return words and f" in {count_of(len(largest), 'component')}, {words}"


def _within_tolerance(atlas: Atlas) -> str:
    """By how much forms miss closure, where that is more than rounding."""
    largest = max((form.misclosure for form in atlas.forms), default=0.0)
    if closes_to_rounding(largest):
        return ""
    return (
        " It moves within the closing tolerance: along the way its loop misses closure "
        f"by {largest:.2g} of the characteristic length at most."
    )


def _nothing_known(atlas: Atlas) -> str:
    assemblies = count_of(len(atlas.rigid), "isolated assembly")
    seconds = atlas.provenance.settings.budget
    return (
        f"The search ended after {seconds:.4g} s, before it found a motion: whether "
        f"the linkage moves is not known ({assemblies} so far)."
    )


def _closed_at_points(atlas: Atlas) -> str:
    points = count_of(len(atlas.points), "singular point")
    return (
        f"The linkage closes at {points}; whether it moves from there within its "
        "limits is not known."
    )


def _immobile(atlas: Atlas) -> str:
    shaky = sum(1 for point in atlas.points if point.kind is Kind.ISOLATED)
    assemblies = len(atlas.rigid) + shaky
    if atlas.near_motions:
        unit = arclength_unit(atlas)
        sentence = (
            f"The linkage nearly moves{_near_motion(atlas.near_motions[0], unit)}."
        )
        rounded = rounding_of(atlas)
        if rounded:
            sentence += f" It is a rounding of {rounded}."
    elif assemblies:
        sentence = "The linkage is rigid."
    else:
        return kept_out_by_limits(atlas) or _nowhere_closed(atlas)
    if not assemblies:
        return sentence
    return f"{sentence} {_assemblies(atlas, assemblies, shaky)}"


@lru_cache(maxsize=2)
def rounding_of(atlas: Atlas) -> str:
    """The linkage of the catalogue, with its parameters, that the table of an atlas is
    to rounding; empty where it is none, or no single loop."""
    try:
        loop = subject_at(atlas).as_loop()
    except GeometryError:
        return ""
    rounded = roundings_of(identify(loop, locking=False))
    return member_text(rounded[0].match) if rounded else ""


def _nowhere_closed(atlas: Atlas) -> str:
    start = "The linkage has no real configuration"
    if closes_to_rounding(atlas.closure_gap):
        return f"{start} within the limits in which slides are followed."
    gap = f"{atlas.closure_gap:.3g} of the characteristic length"
    return f"{start}: its loop stays open by {gap}."


def _near_motion(motion: NearMotion, unit: ArclengthUnit) -> str:
    """How far a near motion goes, and by how much it is none."""
    length = f"joint-space length {unit.factor * motion.length:.4g} ({unit.name})"
    if unit.name == "deg":
        length = f"{math.degrees(motion.length):.4g} degrees of joint-space length"
    stretch = f": all along a closed path of {length}"
    if motion.mobility > 1:
        stretch = f" with mobility {motion.mobility}: all over a surface"
    elif not motion.is_closed:
        stretch = f": along {length}"
    return (
        f"{stretch} its loop misses closure by {motion.misclosure:.3g} of the "
        "characteristic length at most"
    )


def _assemblies(atlas: Atlas, count: int, shaky: int) -> str:
    """In how many assemblies a linkage closes, at least where random starts alone led to
    them."""
    least = "" if has_all_assemblies(atlas.completeness) else "at least "
    remark = f", {shaky} of them shaky (of lower rank)" if shaky else ""
    if count == shaky == 1:
        remark = ", which is shaky (of lower rank)"
    translates = translates_of(atlas)
    if translates is not None:
        fewest = "" if translates.are_all else "at least "
        remark += f" (up to whole turns; with them {fewest}{translates.assemblies})"
    return (
        f"It closes in {least}{count_of(count, 'isolated assembly')}{remark}, and does "
        "not move from there."
    )


@lru_cache(maxsize=2)
def kept_out_by_limits(atlas: Atlas) -> str:
    """The sentence on a mechanism that closes nowhere within its limits, as far as is
    seen, but does without them; empty for any other.

    Where every variable alone is within its limits in some configurations, all that is
    known is that none was found.
    """
    from linkages.mapping import map_linkage  # it imports the search

    limited = subject_at(atlas).ranges_beyond_limits(map_linkage)
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
