"""What `bifurc verify` shows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TypeAlias

from bifurc.tables import count_of
from linkages.app.reports.verify import (
    ClosedFormCheck,
    ErratumCheck,
    MemberCheck,
    NetworkVerification,
    Verification,
)

Json: TypeAlias = (
    "bool | int | float | str | Sequence[Json] | Mapping[str, Json] | None"
)


def make_verification_document(
    verification: Verification | NetworkVerification,
) -> dict[str, Json]:
    """The verification as plain values for JSON, where nan becomes None."""
    values = asdict(verification)
    values["failures"] = list(verification.failures)
    return {key: _without_nan(value) for key, value in values.items()}


def _without_nan(value: Json) -> Json:
    if isinstance(value, Mapping):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def describe_verification(verification: Verification) -> str:
    """The verification as a paragraph for the screen."""
    lines = [verification.name]
    lines += [_line("condition", text) for text in verification.conditions]
    lines += [_line("closed form", _proof(form)) for form in verification.closed_forms]
    if not verification.closed_forms:
        lines.append(_line("closed form", "none in the sources"))
    lines.append(_line("members", _count_members(verification.members)))
    real = [member for member in verification.members if member.real]
    if real:
        closure = max(member.closure for member in real)
        lines.append(_line("mobility", _mobility(real)))
        lines.append(_line("closure", f"{closure:.1e} at most along the curves"))
    if real and verification.closed_forms:
        lines.append(_line("distance", _distance(real)))
    lines += [_line("erratum", _erratum(erratum)) for erratum in verification.errata]
    lines += [_line("FAILED", text) for text in verification.failures]
    return "\n".join(lines)


def describe_network_verification(verification: NetworkVerification) -> str:
    """The verification of a network as a paragraph for the screen."""
    lines = [verification.name]
    lines += [_line("condition", text) for text in verification.conditions]
    real = [member for member in verification.members if not member.refused]
    refused = len(verification.members) - len(real)
    lines.append(_line("members", f"{len(real)} checked, {refused} refused"))
    if real:
        by_rank = _alternatives({member.mobility for member in real})
        by_form = _alternatives({member.by_closed_form for member in real})
        mobility = f"{by_rank} by rank, {by_form} by closed form"
        lines.append(_line("mobility", mobility))
        closure = max(member.closure for member in real)
        count = sum(member.configurations for member in real)
        places = count_of(count, "configuration")
        text = f"{closure:.1e} at most in space, at {places} of the closed form"
        lines.append(_line("closure", text))
    lines += [_line("FAILED", text) for text in verification.failures]
    return "\n".join(lines)


def _line(head: str, text: str) -> str:
    return f"  {head:<13} {text}"


def _proof(form: ClosedFormCheck) -> str:
    proved = "NOT PROVED"
    if form.proved:
        proved = f"proved exactly at {count_of(form.points, 'point')}"
    return f"{form.form}: {proved} (doubt {form.doubt:.0e}); {form.source}"


def _count_members(members: Sequence[MemberCheck]) -> str:
    traced = sum(member.real for member in members)
    refused = sum(bool(member.refused) for member in members)
    unreal = len(members) - refused - traced
    return f"{traced} traced, {refused} refused, {unreal} without real configuration"


def _mobility(members: Sequence[MemberCheck]) -> str:
    by_rank = _alternatives({member.corank for member in members})
    by_tracing = _alternatives({member.mobility for member in members})
    curves = sum(len(member.outcomes) for member in members)
    return f"{by_rank} by rank, {by_tracing} by tracing ({count_of(curves, 'curve')})"


def _alternatives(values: set[int]) -> str:
    return " or ".join(str(value) for value in sorted(values))


def _distance(members: Sequence[MemberCheck]) -> str:
    everywhere = max(member.distance for member in members)
    certain = max(member.certain for member in members)
    return (
        f"{everywhere:.1e} rad at most from the closed form, "
        f"{certain:.1e} off singular points"
    )


def _erratum(erratum: ErratumCheck) -> str:
    return (
        f"{erratum.equation}: printed fails by {erratum.printed:.1e}, "
        f"corrected by {erratum.corrected:.1e}"
    )
