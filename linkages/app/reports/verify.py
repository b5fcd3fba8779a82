"""Verification of linkages: conditions, exact closure, mobility, closed form against
traced curve, misprints; of networks: closed form against the closure in space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Surface
from bifurc.branch import Branch
from bifurc.curves.continuation import trace_branch
from bifurc.numerics.singular_values import singular_values
from bifurc.tables import count_of
from linkages.catalogue import entry
from linkages.closed_forms.closed_form import ClosedForm
from linkages.closed_forms.comparison import compare
from linkages.closed_forms.proof import prove
from linkages.closure.closure import Closure
from linkages.entry import Entry
from linkages.errata.erratum import HOLDS
from linkages.errata.misprints import errata_of
from linkages.loop import Loop
from linkages.mobility import survey
from linkages.networks.entries import NETWORKS, NetworkEntry
from linkages.values import GeometryError

Floats = NDArray[np.float64]

CLOSURE = 1e-12  # largest residual allowed along a traced form
DISTANCE = 1e-10  # rad, largest distance of a closed form from the traced curve
MISPRINT = 1e-4  # smallest amount by which a misprint fails
SAMPLES = 2000  # of a traced form
INPUTS = 40  # angles at which a closed form is tried for a start
SINGULAR = 1e-9  # below it a singular value counts as zero
TRACED = 0.1  # rad: a curve as long as that is a motion
NAN = float("nan")


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
    the traced forms and at samples of surfaces, ``distance`` that of the closed form
    (rad; nan without one), ``certain`` the same away from singular points.
    """

    parameters: Mapping[str, float]
    refused: str = ""
    corank: int = 0
    mobility: int = 0
    outcomes: tuple[str, ...] = ()
    closure: float = NAN
    distance: float = NAN
    certain: float = NAN

    @property
    def real(self) -> bool:
        """Whether the member has real configurations."""
        return not self.refused and bool(self.outcomes or self.mobility)


@dataclass(frozen=True)
class ErratumCheck:
    """By how much the printed equation fails, and the corrected one."""

    equation: str
    printed: float
    corrected: float

    @property
    def reproduced(self) -> bool:
        """Whether the print fails and the correction holds."""
        return self.printed > MISPRINT and self.corrected < HOLDS


def _of_members(faults: Sequence[Sequence[str]], missing: str) -> list[str]:
    """The faults of each member, numbered from 1; what is ``missing`` where there is no
    member."""
    if not faults:
        return [missing]
    sentences = []
    for number, texts in enumerate(faults, start=1):
        sentences += [f"member {number}: {text}" for text in texts]
    return sentences


@dataclass(frozen=True)
class Verification:
    """Everything checked about one linkage; ``expected`` is the mobility that is
    published."""

    name: str
    conditions: tuple[str, ...]
    closed_forms: tuple[ClosedFormCheck, ...]
    members: tuple[MemberCheck, ...]
    errata: tuple[ErratumCheck, ...]
    expected: int = 1

    @property
    def failures(self) -> tuple[str, ...]:
        """What does not hold, in words; empty when all is well."""
        sentences = []
        for form in self.closed_forms:
            if not form.proved:
                sentences.append(f"{form.form}: not proved")
        for erratum in self.errata:
            if not erratum.reproduced:
                sentences.append(f"erratum {erratum.equation}: not reproduced")
        faults = [self._faults(one) for one in self.members if one.real]
        sentences += _of_members(faults, "no member with a real configuration")
        return tuple(sentences)

    def _faults(self, member: MemberCheck) -> list[str]:
        """What is wrong with one member."""
        faults = []
        if member.mobility != self.expected:
            faults.append(f"mobility {member.mobility}, not {self.expected}")
        if member.closure > CLOSURE:
            faults.append(f"closure {member.closure:.1e} along the curve")
        if member.certain > DISTANCE:
            faults.append(f"closed form {member.certain:.1e} rad away from the curve")
        return faults


def verify(name: str, members: int = 1, points: int = 6, seed: int = 0) -> Verification:
    """Verify the default member and ``members`` - 1 random ones; raises
    `UnknownLinkageError`."""
    family = entry(name)
    rng = np.random.default_rng(seed)
    proofs = []
    for form in family.closed_forms:
        proof = prove(form, family, points, seed)
        proofs.append(
            ClosedFormCheck(
                form.form, form.source, proof.proved, proof.points, proof.doubt
            )
        )
    parameters = [family.defaults]
    parameters += [family.draw(rng) for _ in range(members - 1)]
    errata = [ErratumCheck(e.equation, *e.measure()) for e in errata_of(name)]
    checks = [check_member(family, values, seed) for values in parameters]
    return Verification(
        name=name,
        conditions=tuple(condition.text for condition in family.conditions),
        closed_forms=tuple(proofs),
        members=tuple(checks),
        errata=tuple(errata),
        expected=family.facts.get("mobility", 1),
    )


def check_member(family: Entry, values: Mapping[str, float], seed: int) -> MemberCheck:
    """Build a member, trace its forms from the closed form or from a survey, and
    compare."""
    try:
        loop = family.build(**values)
    except GeometryError as refusal:
        return MemberCheck(values, refused=str(refusal))
    return _check_loop(loop, family.closed_forms, values, seed)


def _check_loop(
    loop: Loop, forms: Sequence[ClosedForm], values: Mapping[str, float], seed: int
) -> MemberCheck:
    """What tracing finds of the member with these ``values``, and the closed ``forms``
    of its family beside it."""
    problem = Closure(loop)
    starts = _starts_on(forms, values, seed)
    branches = [trace_branch(problem, start) for start in starts]
    surfaces: Sequence[Surface] = ()
    if not branches:
        atlas = survey(loop, seed=seed).atlas
        branches = [form.branch for form in atlas.forms]
        surfaces = atlas.surfaces
    seen = [branch.sample(SAMPLES) for branch in branches]
    seen += [surface.samples for surface in surfaces]
    if not seen:
        return MemberCheck(values)
    compared = branches if forms else []
    distances = [compare(forms, values, problem, branch) for branch in compared]
    corank = _corank(problem, np.array([points[0] for points in seen]))
    return MemberCheck(
        values,
        corank=corank,
        mobility=_mobility(branches, surfaces, corank),
        outcomes=tuple(branch.outcome.name for branch in branches),
        closure=_closure_error(problem, np.concatenate(seen)),
        distance=max((d.everywhere for d in distances), default=NAN),
        certain=max((d.certain for d in distances), default=NAN),
    )


def _starts_on(
    forms: Sequence[ClosedForm], values: Mapping[str, float], seed: int
) -> Floats:
    """A configuration (k, n) of each closed form and root, where it is real."""
    inputs = np.random.default_rng(seed).uniform(-3.0, 3.0, INPUTS)
    starts = []
    for form in forms:
        for root in form.roots:
            theta = form.configurations(inputs, values, root)
            real = np.isfinite(theta).all(axis=1)
            starts.append(theta[real][:1])
    return np.concatenate(starts) if starts else np.empty((0, 0))


def _corank(problem: Closure, points: Floats) -> int:
    """How many singular values vanish at least at points (k, n)."""
    is_zero = singular_values(problem, points) < SINGULAR
    return int(is_zero.sum(axis=1).min())


def _mobility(
    branches: Sequence[Branch], surfaces: Sequence[Surface], corank: int
) -> int:
    """The largest dimension of the surfaces; without any, 1 where every branch is a
    motion and the rank allows for one."""
    if surfaces:
        return max(surface.dimension for surface in surfaces)
    shortest = min(branch.length for branch in branches)
    return min(corank, 1) if shortest > TRACED else 0


def _closure_error(problem: Closure, points: Floats) -> float:
    """The largest residual at points (k, n)."""
    residuals = problem.residuals(points)
    return float(np.linalg.norm(residuals, axis=1).max())


CONFIGURATIONS = 200  # of the closed form, at which closure in space is looked at


@dataclass(frozen=True)
class NetworkMember:
    """One member of a network: its parameters, or why the constructor ``refused`` them.

    ``closure`` is the largest residual in space over so many ``configurations`` of the
    closed form, relative to the characteristic length; ``mobility`` is the number of
    unknowns less the largest rank there, and that ``by_closed_form``.
    """

    parameters: Mapping[str, float]
    refused: str = ""
    configurations: int = 0
    closure: float = NAN
    mobility: int = 0
    by_closed_form: int = 0


@dataclass(frozen=True)
class NetworkVerification:
    """Everything checked about one network; ``expected`` is the mobility that is
    published."""

    name: str
    conditions: tuple[str, ...]
    members: tuple[NetworkMember, ...]
    expected: int

    @property
    def failures(self) -> tuple[str, ...]:
        """What does not hold, in words; empty when all is well."""
        faults = [self._faults(one) for one in self.members if not one.refused]
        return tuple(_of_members(faults, "no member that is not refused"))

    def _faults(self, member: NetworkMember) -> list[str]:
        """What is wrong with one member."""
        faults = []
        if member.mobility != self.expected:
            faults.append(f"mobility {member.mobility} by rank, not {self.expected}")
        if member.by_closed_form != self.expected:
            mobility = member.by_closed_form
            faults.append(f"mobility {mobility} by closed form, not {self.expected}")
        if not member.closure <= CLOSURE:
            faults.append(f"closed form misses closure by {member.closure:.1e}")
        return faults


def verify_network(name: str, members: int = 1, seed: int = 0) -> NetworkVerification:
    """Verify the default member of the network called ``name`` and ``members`` - 1
    random ones."""
    source = NETWORKS[name]
    rng = np.random.default_rng(seed)
    parameters = [source.defaults]
    parameters += [source.draw(rng) for _ in range(members - 1)]
    return NetworkVerification(
        name=name,
        conditions=tuple(condition.text for condition in source.conditions),
        members=tuple(_check_network(source, values, rng) for values in parameters),
        expected=source.mobility,
    )


def _check_network(
    source: NetworkEntry, values: Mapping[str, float], rng: np.random.Generator
) -> NetworkMember:
    """Build a member, and look at configurations of its closed form in space."""
    # they import networkx, which a loop does not need
    from linkages.decisions import is_dependent_constraint
    from linkages.networks.assembly import assemble, motion_at
    from linkages.networks.mechanism import lock_network

    try:
        network = source.build(**values)
        mechanism = lock_network(network, {})
    except GeometryError as refusal:
        return NetworkMember(values, refused=str(refusal))
    placed = mechanism.placed
    problem = Closure(mechanism)
    states = rng.permutation(assemble(network, {}))[:CONFIGURATIONS]
    states = np.concatenate([placed.reference[None], states])
    free = list(problem.structure.column_of)
    points = placed.variables(states)[:, free]
    residuals = np.linalg.norm(problem.residuals(points), axis=1)
    singular_values = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    ranks = np.count_nonzero(~is_dependent_constraint(singular_values), axis=1)
    return NetworkMember(
        values,
        configurations=len(points),
        closure=float(residuals.max()),
        mobility=problem.n - int(ranks.max()),
        by_closed_form=motion_at(network, (), placed.reference).mobility,
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
        lines.append(_line("mobility", _mobility_by_both(real)))
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


def _mobility_by_both(members: Sequence[MemberCheck]) -> str:
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
