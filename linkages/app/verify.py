"""Verification of linkages: conditions, exact closure, mobility, closed form against
traced curve, misprints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from bifurc.curves.continuation import trace_branch
from bifurc.curves.monitor import singular_values
from linkages.catalogue import catalogue, entry
from linkages.closure.loop_closure import LoopClosure
from linkages.entry import Entry
from linkages.errata.misprints import HOLDS, errata_of
from linkages.loop import GeometryError
from linkages.mobility import survey

__all__ = [
    "ClosedFormCheck",
    "ErratumCheck",
    "MemberCheck",
    "Verification",
    "describe",
    "verify",
    "verify_all",
]

CLOSURE = 1e-12  # largest residual allowed along a traced form
DISTANCE = 1e-10  # rad, largest distance of a closed form from the traced curve
SAMPLES = 2000


@dataclass(frozen=True)
class ClosedFormCheck:
    """Exact closure of one closed form: proved at ``points`` points; ``doubt`` as in
    `linkages.closed_forms.proof.Proof`."""

    form: str
    source: str
    proved: bool
    points: int
    doubt: float


@dataclass(frozen=True)
class MemberCheck:
    """One member of a family: its parameters, or why the constructor ``refused`` them;
    what tracing found.

    ``corank`` is n less the rank at the start, ``closure`` the largest residual along
    the traced forms, ``distance`` that of the closed form (rad; nan without one),
    ``certain`` the same away from singular points.
    """

    parameters: Mapping[str, float]
    refused: str = ""
    corank: int = 0
    mobility: int = 0
    outcomes: tuple[str, ...] = ()
    closure: float = float("nan")
    distance: float = float("nan")
    certain: float = float("nan")

    @property
    def real(self) -> bool:
        """Whether the member has real configurations."""
        return not self.refused and bool(self.outcomes)


@dataclass(frozen=True)
class ErratumCheck:
    """By how much the printed equation fails, and the corrected one."""

    equation: str
    printed: float
    corrected: float

    @property
    def reproduced(self) -> bool:
        """Whether the print fails and the correction holds."""
        return self.printed > 1e-4 and self.corrected < HOLDS


@dataclass(frozen=True)
class Verification:
    """Everything checked about one linkage."""

    name: str
    conditions: tuple[str, ...]
    closed_forms: tuple[ClosedFormCheck, ...]
    members: tuple[MemberCheck, ...]
    errata: tuple[ErratumCheck, ...]
    expected: int = field(default=1)

    @property
    def failures(self) -> tuple[str, ...]:
        """What does not hold, in words; empty when all is well."""
        out = [
            f"{check.form}: not proved"
            for check in self.closed_forms
            if not check.proved
        ]
        out += [
            f"erratum {check.equation}: not reproduced"
            for check in self.errata
            if not check.reproduced
        ]
        for i, member in enumerate(m for m in self.members if m.real):
            if member.mobility != self.expected:
                out.append(
                    f"member {i + 1}: mobility {member.mobility}, not {self.expected}"
                )
            if member.closure > CLOSURE:
                out.append(
                    f"member {i + 1}: closure {member.closure:.1e} along the curve"
                )
            if member.certain > DISTANCE:
                out.append(
                    f"member {i + 1}: closed form {member.certain:.1e} rad away from the curve"
                )
        if not any(member.real for member in self.members):
            out.append("no member with a real configuration")
        return tuple(out)

    def document(self) -> dict[str, Any]:
        """The verification as plain data."""
        return _plain({**asdict(self), "failures": list(self.failures)})


def _plain(value: Any) -> Any:
    """``value`` for JSON, where nan becomes None."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def verify(name: str, members: int = 1, points: int = 6, seed: int = 0) -> Verification:
    """Verify the default member and ``members`` - 1 random ones; raises
    `UnknownLinkageError`."""
    from linkages.closed_forms.proof import prove

    found, rng = entry(name), np.random.default_rng(seed)
    proofs = [(form, prove(form, found, points, seed)) for form in found.closed_forms]
    checks = tuple(
        ClosedFormCheck(f.form, f.source, p.proved, p.points, p.doubt)
        for f, p in proofs
    )
    drawn = [found.defaults, *(found.draw(rng) for _ in range(members - 1))]
    errata = tuple(ErratumCheck(e.equation, *e.measure()) for e in errata_of(name))
    verified = tuple(check_member(found, values, seed) for values in drawn)
    conditions = tuple(condition.text for condition in found.conditions)
    return Verification(
        name, conditions, checks, verified, errata, found.facts.get("mobility", 1)
    )


def verify_all(
    members: int = 1, points: int = 6, seed: int = 0
) -> Iterator[Verification]:
    """Verify every linkage of the catalogue, one after the other."""
    for name in catalogue():
        yield verify(name, members, points, seed)


def check_member(found: Entry, values: Mapping[str, float], seed: int) -> MemberCheck:
    """Build a member, trace its forms from the closed form or from a survey, and
    compare."""
    from linkages.closed_forms.comparison import compare

    try:
        loop = found.build(**values)
    except GeometryError as refusal:
        return MemberCheck(values, refused=str(refusal))
    problem, forms = LoopClosure(loop), found.closed_forms
    starts = _starts(forms, values, np.random.default_rng(seed))
    surfaces = False
    if not len(starts):
        seen = survey(loop, seed=seed)
        surfaces = bool(seen.atlas.surfaces)
        starts = np.array([form.branch(0.0) for form in seen.atlas.forms]).reshape(
            -1, loop.n
        )
    if not len(starts):
        return MemberCheck(values, mobility=2 if surfaces else 0)
    branches = [trace_branch(problem, start) for start in starts]
    closure = max(
        float(np.linalg.norm(problem.residuals(b.sample(SAMPLES)), axis=1).max())
        for b in branches
    )
    compared = [compare(forms, values, problem, b) for b in branches] if forms else []
    corank = min(
        int(np.count_nonzero(row < 1e-9)) for row in singular_values(problem, starts)
    )
    return MemberCheck(
        values,
        "",
        corank,
        2
        if surfaces
        else min(corank, 1)
        if min(b.length for b in branches) > 0.1
        else 0,
        tuple(b.outcome.name for b in branches),
        closure,
        max((c.everywhere for c in compared), default=float("nan")),
        max((c.certain for c in compared), default=float("nan")),
    )


def _starts(
    forms: Sequence[Any], values: Mapping[str, float], rng: np.random.Generator
) -> np.ndarray:
    """A configuration of each closed form and root, where it is real."""
    inputs, out = rng.uniform(-3.0, 3.0, 40), []
    for form in forms:
        for root in form.roots:
            theta = form.configurations(inputs, values, root)
            out.append(theta[np.isfinite(theta).all(axis=1)][:1])
    return np.concatenate(out) if out else np.empty((0, 0))


def describe(checked: Verification) -> str:
    """The verification as a paragraph for the screen."""
    lines = [checked.name, *(f"  condition     {text}" for text in checked.conditions)]
    for form in checked.closed_forms:
        proved = (
            f"proved exactly at {form.points} points" if form.proved else "NOT PROVED"
        )
        lines.append(
            f"  closed form   {form.form}: {proved} (doubt {form.doubt:.0e}); {form.source}"
        )
    if not checked.closed_forms:
        lines.append("  closed form   none in the sources")
    real = [member for member in checked.members if member.real]
    refused = sum(bool(member.refused) for member in checked.members)
    unreal = len(checked.members) - refused - len(real)
    lines.append(
        f"  members       {len(real)} traced, {refused} refused, {unreal} without real configuration"
    )
    if real:
        ranks = sorted({member.corank for member in real})
        kinds = sorted({member.mobility for member in real})
        curves = sum(len(member.outcomes) for member in real)
        lines.append(
            f"  mobility      {_list(ranks)} by rank, {_list(kinds)} by tracing ({curves} curves)"
        )
        lines.append(
            f"  closure       {max(member.closure for member in real):.1e} at most along the curves"
        )
    if checked.closed_forms and real:
        far = (
            max(member.distance for member in real),
            max(member.certain for member in real),
        )
        lines.append(
            f"  distance      {far[0]:.1e} rad at most from the closed form, {far[1]:.1e} off singular points"
        )
    for found in checked.errata:
        amounts = (
            f"printed fails by {found.printed:.1e}, corrected by {found.corrected:.1e}"
        )
        lines.append(f"  erratum       {found.equation}: {amounts}")
    lines += [f"  FAILED        {text}" for text in checked.failures]
    return "\n".join(lines)


def _list(values: Sequence[int]) -> str:
    return " or ".join(map(str, values))
