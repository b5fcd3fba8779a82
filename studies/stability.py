"""Where methods fail: near misses of any width, and singular points of every kind, for
this project and the usual ways.

    python -m studies.stability [--out DIR] [--quick]

Part one: an arc that passes another because of an imperfection from 1e-1 to 1e-12. A
method is right when it follows the true arc to its end, has failed when it says so, and
has jumped when it goes over to the other arc without a word. Fine, medium and coarse
are steps of at most 0.02, 0.1 and 0.5. This project says that it failed where it
stalls, and where its certificate refuses a wrong arc. Every curve of this project is
certified; the cost of that is listed apart.

Part two: how many bifurcations every method reports on a curve where their number is
known. Test functions see sign changes of a determinant or small singular values; this
project locates and classifies.

Cost is counted in evaluations of F and F' at a point (a compiled Taylor piece of this
project counts ten), and in processor time. The tests of right and wrong are exact: a
sign that cannot change on the true arc.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from bifurc.tables import section
from linkages.app.options import FOLDER
from studies.hard_cases import crossings, ladders
from studies.stability_arcs import STEPS, follow_ladder, followers
from studies.stability_figure import draw_stability
from studies.stability_points import report_points, reporters
from studies.stability_runs import Run, Verdict
from studies.study import Study

IMPERFECTIONS = 10.0 ** -np.arange(1.0, 13.0)
NOTE_LENGTH = 60  # characters of a note that are shown


def describe(runs: Sequence[Run]) -> str:
    """Three tables: how often each method was right on the near misses, what this
    project's answers cost, and what each method reported on the curves with
    bifurcations."""
    near_misses = [run for run in runs if run.step]
    curves = [run for run in runs if not run.step]
    parts = [
        _near_miss_table(near_misses),
        _cost_table([run for run in near_misses if run.certificate]),
        _bifurcation_table(curves),
    ]
    return "\n\n".join(part for part in parts if part)


def _near_miss_table(runs: Sequence[Run]) -> str:
    groups: dict[tuple[str, str, str], list[Run]] = {}
    for run in runs:
        groups.setdefault((run.case, run.method, run.step), []).append(run)
    rows = []
    for (case, method, step), group in groups.items():
        verdicts = [run.verdict for run in group]
        evaluations = np.median([run.evaluations for run in group])
        seconds = np.median([run.seconds for run in group])
        rows.append(
            (
                case,
                method,
                step,
                f"{verdicts.count(Verdict.RIGHT)} of {len(group)}",
                str(verdicts.count(Verdict.FAILED)),
                str(verdicts.count(Verdict.JUMPED)),
                f"{evaluations:.0f}",
                f"{1e3 * seconds:.1f}",
            )
        )
    heads = (
        "near miss",
        "method",
        "step",
        "right",
        "says it failed",
        "jumps",
        "evaluations",
        "ms",
    )
    return section("Following an arc past another", heads, rows)


def _cost_table(runs: Sequence[Run]) -> str:
    rows = []
    for run in runs:
        rows.append(
            (
                run.case,
                f"{run.difficulty:.0e}",
                f"{run.width:.1e}",
                run.step,
                run.verdict,
                str(run.pieces),
                str(run.evaluations),
                f"{1e3 * run.seconds:.1f}",
                run.certificate,
                str(run.certificate_points),
                f"{1e3 * run.certificate_seconds:.1f}",
            )
        )
    heads = (
        "near miss",
        "imperfection",
        "width",
        "step",
        "verdict",
        "pieces",
        "evaluations",
        "ms",
        "certificate",
        "points",
        "ms",
    )
    return section("What this project's answers cost", heads, rows)


def _bifurcation_table(runs: Sequence[Run]) -> str:
    rows = []
    for run in runs:
        reported = "-" if run.verdict is Verdict.FAILED else str(run.found)
        rows.append(
            (
                run.case,
                f"{run.difficulty:.0f}",
                run.method,
                reported,
                run.verdict,
                str(run.evaluations),
                f"{1e3 * run.seconds:.1f}",
                run.note[:NOTE_LENGTH],
            )
        )
    heads = (
        "curve",
        "bifurcations",
        "method",
        "reported",
        "verdict",
        "evaluations",
        "ms",
        "note",
    )
    return section("Bifurcations on a curve", heads, rows)


def run_all(imperfections: NDArray[np.float64]) -> list[Run]:
    """Every method on every case."""
    runs = []
    for ladder in ladders(imperfections):
        for name, follower in followers().items():
            runs += [follow_ladder(ladder, name, follower, step) for step in STEPS]
    for crossing in crossings():
        for name, reporter in reporters().items():
            runs.append(report_points(crossing, name, reporter))
    return runs


def _warm_up() -> None:
    """Compile what is not yet compiled."""
    follower = followers()["this project"]
    for ladder in ladders(IMPERFECTIONS[:1]):
        follow_ladder(ladder, "this project", follower, "coarse")


def _write_runs(path: Path, runs: Sequence[Run]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Run)])
        writer.writeheader()
        writer.writerows(asdict(run) for run in runs)


@click.command(cls=Study, help=__doc__)
@click.option(
    "--out",
    type=FOLDER,
    default=Path("out/stability"),
)
@click.option("--quick", is_flag=True, help="Every third imperfection.")
def main(out: Path, quick: bool) -> None:
    """Run the study; write runs.csv, summary.txt and stability.png."""
    out.mkdir(parents=True, exist_ok=True)
    _warm_up()
    runs = run_all(IMPERFECTIONS[::3] if quick else IMPERFECTIONS)
    text = describe(runs)
    click.echo(text)
    (out / "summary.txt").write_text(text + "\n", encoding="utf-8")
    _write_runs(out / "runs.csv", runs)
    draw_stability(runs).savefig(out / "stability.png", dpi=150)


if __name__ == "__main__":
    main()
