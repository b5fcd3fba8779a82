"""Random linkages that nearly bifurcate: is the traced arc the true one?

    python -m studies.near_bifurcations [--count 1000] [--seed 0] [--certify]

Every linkage is off one that bifurcates by 1e-8 to 1e-2, and is traced twice, with
steps of at most 0.1 and 0.5. Exact relations of its motion (`studies.near_misses`)
decide whether the curve stayed on its arc. A trace is right when it did and came back
to its start; flagged when it is wrong or unfinished, and its outcome or its certificate
says so; all else is a jump without a word. With --certify every trace gets a
certificate; where that stops at places that are singular to within rounding, singular
points are located there. (Some are none: a form that crossed before the linkage was
changed is left as one that nearly solves the equations.)
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import click
import numpy as np

from bifurc import Branch, TraceSettings, trace_branch
from bifurc.curves.certificate import CertificateStatus, certify_branch
from bifurc.curves.monitor import profile_branch
from bifurc.singular.locate import locate_singular_point
from bifurc.tables import table
from studies.near_misses import NearMiss, near_misses
from studies.study import Study

STEPS = (0.1, 0.5)


@dataclass(frozen=True)
class Trace:
    """One trace of one linkage: ``verdict`` is right, flagged or jump; ``certificate``
    its status, empty where none was made, of ``points``. ``seconds`` are those of the
    trace, ``certifying`` those of the certificate."""

    family: str
    size: float
    step: float
    verdict: str
    outcome: str
    pieces: int
    seconds: float
    certificate: str = ""
    points: int = 0
    certifying: float = 0.0


def follow(case: NearMiss, step: float, certify: bool = False) -> Trace:
    """Trace one linkage and judge it; without ``certify`` only wrong curves are held
    against their certificates."""
    settings = TraceSettings(longest=step / case.problem.domain.scale)
    start = time.process_time()
    branch = trace_branch(case.problem, case.start, None, settings)
    seconds = time.process_time() - start
    right = is_right(case, branch)
    trace = Trace(
        family=case.family,
        size=case.size,
        step=step,
        verdict="right" if right else "flagged",
        outcome=branch.outcome.name,
        pieces=len(branch.pieces),
        seconds=seconds,
    )
    if not branch.closed or (right and not certify):
        return trace
    start = time.process_time()
    status, points = certify_trace(case, branch)
    certifying = time.process_time() - start
    trace = replace(trace, certificate=status, points=points, certifying=certifying)
    if not right and status == CertificateStatus.CERTIFIED:
        return replace(trace, verdict="jump")
    return trace


def is_right(case: NearMiss, branch: Branch) -> bool:
    """Whether a branch came back to its start on its own arc, in one line."""
    return branch.closed and _joins(branch) and case.stays(branch)


def certify_trace(case: NearMiss, branch: Branch) -> tuple[str, int]:
    """Status and number of points of a certificate; a singular point is looked for
    wherever rounding stops it."""
    problem = case.problem
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    status = certificate.status
    if status == CertificateStatus.UP_TO_ROUNDING:
        middles = branch(certificate.blurred.mean(axis=1))
        reach = 1e-3 * problem.domain.scale
        located = [locate_singular_point(problem, u, 2, reach) for u in middles]
        if all(point is not None for point in located):
            status = CertificateStatus.UP_TO_SINGULAR_POINTS
    return status, certificate.points


def _joins(branch: Branch) -> bool:
    """Whether neighbouring pieces meet, in the same direction."""
    inner = branch.breaks[1:-1]
    lengths = np.diff(branch.breaks)
    tiny = 1e-9 * np.minimum(lengths[:-1], lengths[1:])
    jumps = np.linalg.norm(branch(inner + tiny) - branch(inner - tiny), axis=1)
    cosines = np.sum(branch(inner - tiny, 1) * branch(inner + tiny, 1), axis=1)
    return bool(np.all(jumps < 1e-8) and np.all(cosines > 0.9))


def describe(traces: Sequence[Trace]) -> str:
    """A row for every family and step, and one for all."""
    rows = []
    for family in dict.fromkeys(trace.family for trace in traces):
        for step in STEPS:
            group = [t for t in traces if (t.family, t.step) == (family, step)]
            rows.append((family, f"{step:g}", *_counts(group)))
    rows.append(("all", "", *_counts(traces)))
    heads = (
        "family",
        "step",
        "traces",
        "right",
        "flagged",
        "jumps",
        "pieces",
        "most",
        "ms",
    )
    return table(heads, rows)


def _counts(traces: Sequence[Trace]) -> tuple[str, ...]:
    """How many traces there are of every verdict, and what they took."""
    verdicts = [trace.verdict for trace in traces]
    pieces = [trace.pieces for trace in traces]
    seconds = [trace.seconds for trace in traces]
    return (
        str(len(traces)),
        str(verdicts.count("right")),
        str(verdicts.count("flagged")),
        str(verdicts.count("jump")),
        f"{np.median(pieces):.0f}",
        str(max(pieces)),
        f"{1e3 * np.median(seconds):.1f}",
    )


def describe_certificates(traces: Sequence[Trace]) -> str:
    """How many traces of every family and step are certified, and what it costs."""
    rows = []
    for family, step in dict.fromkeys((t.family, t.step) for t in traces):
        group = [t for t in traces if (t.family, t.step) == (family, step)]
        certificates = [trace.certificate for trace in group]
        points = [trace.points for trace in group]
        seconds = [trace.certifying for trace in group]
        rows.append(
            (
                family,
                f"{step:g}",
                *(str(certificates.count(status)) for status in CertificateStatus),
                f"{np.median(points):.0f}",
                str(max(points)),
                f"{1e3 * np.median(seconds):.0f}",
                f"{1e3 * max(seconds):.0f}",
            )
        )
    kinds = ("certified", "up to singular points", "up to rounding", "not")
    return table(("family", "step", *kinds, "points", "most", "ms", "most"), rows)


@click.command(cls=Study, help=__doc__)
@click.option(
    "--count",
    type=click.IntRange(1),
    default=1000,
    show_default=True,
    help="How many linkages.",
)
@click.option("--seed", type=int, default=0, show_default=True)
@click.option("--certify", is_flag=True, help="Certify the right curves, too.")
def main(count: int, seed: int, certify: bool) -> None:
    """Run the study and print its table, with a line for every trace that is not
    right."""
    traces = []
    for number, case in enumerate(near_misses(count, np.random.default_rng(seed))):
        for step in STEPS:
            trace = follow(case, step, certify)
            traces.append(trace)
            if trace.verdict != "right":
                click.echo(
                    f"{trace.verdict}: linkage {number}, {trace.family}, off by "
                    f"{trace.size:.1e}, step {step}, {trace.outcome}, "
                    f"{trace.pieces} pieces"
                )
    click.echo(describe(traces))
    if certify:
        click.echo(describe_certificates(traces))


if __name__ == "__main__":
    main()
