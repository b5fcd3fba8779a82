"""What `bifurc follow` and `bifurc special` say, as text and as plain values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from bifurc.branch import Outcome
from bifurc.following.follow import FollowedPoint
from bifurc.following.places import FollowedPlace, PlaceKind
from bifurc.tables import count_of
from bifurc.torus import wrap
from linkages.app.texts.numbers import in_degrees
from linkages.entry import Parameter, ParameterKind
from linkages.parameters.followed import Followed, MemberComparison
from linkages.parameters.member_search import MapShape
from linkages.parameters.members import FreeParameters, Members
from linkages.parameters.relations import PreciseChange
from linkages.parameters.special import MapChange, SpecialValues

SAMPLES = 200  # of a curve in JSON
MOST_DIGITS = 15
LEAST = 1e-12  # of the scale: what is less of an unknown is shown as 0


# --- follow ---------------------------------------------------------------------------


def describe_followed(
    members: FreeParameters, refusals: Mapping[str, str], points: Sequence[Followed]
) -> str:
    """What became of each point; ``refusals``: why there are no members beyond the range
    of a parameter."""
    lines = [headline(members)]
    lines += [
        f"beyond the range of {name} there are no members: {reason}"
        for name, reason in refusals.items()
        if reason
    ]
    for point in points:
        lines += ["", f"{point.point.name} ({point.point.kind.value})"]
        lines += [f"  {line}" for line in _lines(members, point)]
    return "\n".join(lines)


def headline(members: FreeParameters) -> str:
    """What has free parameters, and their ranges."""
    spans = [
        f"{one.name} from {shown(one, members.ranges[one.name][0])} to "
        f"{shown(one, members.ranges[one.name][1])}"
        for one in members.free
    ]
    return f"{members.title}: {' and '.join(spans)}"


def _lines(members: FreeParameters, point: Followed) -> list[str]:
    curve, comparison = point.curve, point.comparison
    if curve is None or comparison is None:
        return [f"not followed: {point.reason}"]
    lines = [_course(members, curve)]
    lines += [_place_line(members, place) for place in curve.places]
    if not curve.places and len(members.free) == 1:
        lines.append("none of its kind meets it on the way")
    return [*lines, *_comparison_lines(comparison, curve.problem.nullity)]


def _comparison_lines(comparison: MemberComparison, nullity: int) -> list[str]:
    lines = [
        f"{count_of(comparison.members, 'member')} built anew: they close there to "
        f"{comparison.gap:.1e}, {count_of(nullity, 'singular value')} at most "
        f"{comparison.singular_value:.1e}"
    ]
    if comparison.refusal:
        lines.append(f"others of the curve are none: {comparison.refusal}")
    return lines


def _course(members: FreeParameters, curve: FollowedPoint) -> str:
    """From where to where a curve goes."""
    if curve.branch.closed:
        return "a closed curve"
    ends = [
        ", ".join(
            f"{one.name} {shown(one, value)}"
            for one, value in zip(members.free, curve.parameters(s), strict=True)
        )
        for s in (0.0, curve.branch.length)
    ]
    course = f"from {ends[0]} to {ends[1]}"
    if curve.branch.outcome is Outcome.LEFT_REGION:
        return course
    return f"{course}; it ended, {curve.branch.outcome.value}"


def _place_line(members: FreeParameters, place: FollowedPlace) -> str:
    values = ", ".join(
        f"{one.name} = {_known(one, value, place.error)}"
        for one, value in zip(members.free, place.p, strict=True)
    )
    what = place.kind.value
    if place.kind is PlaceKind.BIRTH:
        side = "above" if place.is_minimum else "below"
        what = f"it meets another one, and both are there {side} only"
    elif place.parameter is not None:
        extreme = "least" if place.is_minimum else "largest"
        what = f"{members.free[place.parameter].name} is {extreme}"
    return f"{values}: {what}, at {_place(members, place.u)}"


def _place(members: FreeParameters, u: np.ndarray) -> str:
    """The unknowns (n,), of joints without their names."""
    domain = members.problem.domain
    if all(period < np.inf for period in domain.periods):
        return _angles(u)
    least = LEAST * domain.scale
    return ", ".join(
        f"{name} = {0.0 if abs(x) < least else x:.10g}"
        for name, x in zip(domain.names, u.tolist(), strict=True)
    )


def _angles(u: np.ndarray) -> str:
    centred = wrap(u, np.full(len(u), 2 * np.pi))
    return "(" + " ".join(in_degrees(angle) for angle in centred) + ") deg"


def typed(parameter: Parameter, value: float) -> str:
    """A value of a parameter as it is given to a command, with all digits."""
    return shown(parameter, value, MOST_DIGITS).removesuffix(" deg")


def shown(parameter: Parameter, value: float, digits: int = 6) -> str:
    """A value of a parameter, angles in degrees."""
    if parameter.kind is ParameterKind.ANGLE:
        return f"{math.degrees(value):.{digits}g} deg"
    return f"{value:.{digits}g}"


def _known(parameter: Parameter, value: float, error: float) -> str:
    """A value with the digits that are known, 0 where that is all there is to it."""
    if abs(value) <= error:
        return shown(parameter, 0.0)
    size = abs(value)
    digits = int(-math.log10(max(error / size, 10.0**-MOST_DIGITS)))
    return shown(parameter, value, max(digits, 1))


def followed_document(
    members: FreeParameters, points: Sequence[Followed]
) -> dict[str, Any]:
    """The same as plain values, angles in rad: ``curves`` by samples, and the ``points``
    at which something happens on them."""
    names = members.problem.domain.names
    curves: list[dict[str, Any]] = []
    places: list[dict[str, Any]] = []
    for point in points:
        curve, comparison = point.curve, point.comparison
        if curve is None or comparison is None:
            curves.append({"point": point.point.name, "reason": point.reason})
            continue
        s = curve.branch.arclengths(SAMPLES)
        curves.append(
            {
                "point": point.point.name,
                "kind": point.point.kind.value,
                "outcome": curve.branch.outcome.name.lower(),
                "parameters": _columns(members.ranges, curve.parameters(s)),
                "unknowns": _columns(names, curve.unknowns(s)),
                "members": comparison.members,
                "closure_gap": comparison.gap,
                "singular_value": comparison.singular_value,
            }
        )
        places += [
            {
                "point": point.point.name,
                "kind": place.kind.value,
                "parameters": row_of(members.ranges, place.p),
                "unknowns": row_of(names, place.u),
                "error": place.error,
            }
            for place in curve.places
        ]
    return {"curves": curves, "points": places}


def _columns(
    names: Sequence[str] | Mapping[str, object], values: np.ndarray
) -> dict[str, list[float]]:
    return {name: values[:, k].tolist() for k, name in enumerate(names)}


def row_of(
    names: Sequence[str] | Mapping[str, object], values: np.ndarray
) -> dict[str, float]:
    """Values (k,) by their names."""
    return dict(zip(names, values.tolist(), strict=True))


# --- special --------------------------------------------------------------------------


def describe_changes(
    members: Members,
    refusal: str,
    special: SpecialValues,
    precise: Sequence[PreciseChange | None] | None = None,
) -> str:
    """The values at which the map changes, and where they were looked for what is known
    of these more exactly."""
    (parameter,) = members.free
    lines = [headline(members)]
    if refusal:
        lines.append(f"beyond that there are no members: {refusal}")
    if not special.is_whole:
        lines.append("The search was ended early: there may be more than is listed.")
    if not special.changes:
        lines.append("No value was found at which the map changes.")
    for k, change in enumerate(special.changes):
        value = _known(parameter, change.value, change.error)
        lines += ["", f"{parameter.name} = {value}: {change.what}"]
        if precise is not None:
            lines.append(f"  {_relation_text(precise[k : k + 1])}")
        if change.u is not None:
            lines.append(f"  at {_place(members, change.u)}")
        for where, shape in (
            ("below", change.before),
            ("there", change.at),
            ("above", change.after),
        ):
            lines.append(f"  {where}: {shape_text(shape)}")
    apart = shown(parameter, special.apart)
    lines += [
        "",
        f"Maps were made at most {apart} apart: a change that is undone within that may be "
        "missing.",
    ]
    return "\n".join(lines)


def _relation_text(precise: Sequence[PreciseChange | None]) -> str:
    """Of one change, or of none where the time was over before it."""
    if not precise:
        return "no relation was looked for: the time was over"
    (change,) = precise
    if change is None:
        return "no relation was looked for: it was not found to more digits"
    relation = change.relation
    if relation is None:
        return "no simple relation of the parameters was found that it follows"
    return (
        f"{relation.text}; holds for {relation.held} of "
        f"{count_of(relation.members, 'random member')} to {relation.digits} digits"
    )


def shape_text(shape: MapShape | None) -> str:
    """A map in words."""
    if shape is None:
        return "no member"
    text = (
        f"{count_of(shape.forms, 'form')} in {count_of(shape.components, 'component')}, "
        f"{count_of(shape.bifurcations, 'bifurcation')}"
    )
    if shape.other_points:
        text += f", {count_of(shape.other_points, 'other singular point')}"
    if shape.surfaces:
        text += f", {count_of(shape.surfaces, 'surface')}"
    at_rest = [", ".join(joints) for joints in shape.at_rest if joints]
    if at_rest:
        text += f"; at rest in a form: {' and in another '.join(at_rest)}"
    return text


def changes_document(
    members: Members,
    special: SpecialValues,
    precise: Sequence[PreciseChange | None] | None = None,
) -> dict[str, Any]:
    """The same as plain values, angles in rad; ``precise`` ones in decimals, as text."""
    (parameter,) = members.free
    names = members.problem.domain.names
    return {
        "parameter": parameter.name,
        "is_whole": special.is_whole,
        "apart": special.apart,
        "changes": [
            {
                "value": change.value,
                "kind": change.kind.value,
                "text": change.what,
                "digits": _digits(change),
                "error": change.error,
                "unknowns": None if change.u is None else row_of(names, change.u),
                "before": _shape_row(change.before),
                "at": _shape_row(change.at),
                "after": _shape_row(change.after),
                **({} if precise is None else _precise_row(precise[k : k + 1])),
            }
            for k, change in enumerate(special.changes)
        ],
    }


def _precise_row(precise: Sequence[PreciseChange | None]) -> dict[str, Any]:
    if not precise or precise[0] is None:
        return {"precise": None, "relation": None}
    relation = precise[0].relation
    row = None if relation is None else asdict(relation)
    return {"precise": precise[0].value, "relation": row}


def _digits(change: MapChange) -> int:
    share = change.error / (abs(change.value) or 1.0)
    return int(-math.log10(max(share, 10.0**-MOST_DIGITS)))


def _shape_row(shape: MapShape | None) -> dict[str, Any] | None:
    return None if shape is None else shape._asdict()
