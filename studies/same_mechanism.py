"""The same map of a mechanism from every start and however it is given.

    python -m studies.same_mechanism [NAME ...] [--seeds 10] [--budget 60] [--out DIR]

Every mechanism of data/mechanisms.json is mapped with several seeds of the random starts;
with its joints in another order and turned round; with another body at rest; in another
frame of coordinates; in the mirror; and a thousand times as small and as large
(`studies.known_mechanisms`). Each map is held against the one with seed 0: forms, how many
of them close, singular points by kind, dimensions of surfaces, rigid assemblies, level, and
lengths of forms to 1e-6. Maps that the budget ends are counted, not compared. The reference
configuration has to be closed to rounding, and solutions about it have the dimension that
is known. A name may be a part of one.
"""

from __future__ import annotations

import csv
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TextIO

import click
import numpy as np

from bifurc import Atlas, SearchSettings
from bifurc.singular.dimension import local_dimensions
from bifurc.system import relative_gaps
from bifurc.tables import count_of, section
from linkages import Closure, Mechanism, map_linkage
from linkages.app.options import FOLDER
from studies.known_mechanisms import WAYS, KnownMechanism, known_mechanisms
from studies.study import Study

CLOSE = 1e-6  # of lengths of forms, over 1 or their size
CLOSED = 1e-14  # relative residual of the reference configuration
REFERENCE = "seed 0"
# Beside a cusp doubles see a form end earlier or later, by so much of its length.
STALLED_CLOSE = 1e-3


@dataclass(frozen=True)
class Answer:
    """What a map says: how many ``forms`` there are, and how many ``closed`` ones;
    the singular ``points`` by kind, the dimensions of ``surfaces``, how many ``rigid``
    assemblies, the ``level``, whether it is ``in_doubt``, whether it came to an end
    (``is_finished``), and the ``lengths`` of the forms in order."""

    forms: int
    closed: int
    points: Mapping[str, int]
    surfaces: tuple[int, ...]
    rigid: int
    level: str
    in_doubt: bool
    is_finished: bool
    lengths: tuple[float, ...]

    @property
    def text(self) -> str:
        """The counts in a few words."""
        words = [count_of(self.forms, "form")]
        words += [f"{kind}: {count}" for kind, count in self.points.items()]
        words += [f"surface of dimension {dimension}" for dimension in self.surfaces]
        if self.rigid:
            words.append(count_of(self.rigid, "isolated assembly"))
        return "; ".join(words)


@dataclass(frozen=True)
class Run:
    """One map of a ``mechanism``, given in a ``way``: how it comes out, and in which
    ``lines`` it differs from the map that it is held against."""

    mechanism: str
    way: str
    seconds: float
    answer: str
    level: str
    is_finished: bool
    lines: tuple[str, ...]


def answer_of(atlas: Atlas) -> Answer:
    """What an atlas says, in numbers that do not hang on how it was made."""
    points = Counter(point.kind.value for point in atlas.points)
    return Answer(
        forms=len(atlas.forms),
        closed=sum(form.branch.closed for form in atlas.forms),
        points=dict(sorted(points.items())),
        surfaces=tuple(sorted(surface.dimension for surface in atlas.surfaces)),
        rigid=len(atlas.rigid),
        level=atlas.completeness.level.value,
        in_doubt=atlas.completeness.is_in_doubt,
        is_finished=not atlas.provenance.out_of_time,
        lengths=tuple(sorted(form.branch.length for form in atlas.forms)),
    )


def differences(one: Answer, other: Answer, *, same_measure: bool) -> tuple[str, ...]:
    """Where two answers differ; lengths count where they are of the ``same_measure``."""
    lines = []
    for key in ("forms", "closed", "points", "surfaces", "rigid", "level", "in_doubt"):
        left, right = getattr(one, key), getattr(other, key)
        if left != right:
            lines.append(f"{key}: {left} and {right}")
    if same_measure and one.forms == other.forms:
        closeness = CLOSE if one.closed == one.forms else STALLED_CLOSE
        if not np.allclose(one.lengths, other.lengths, rtol=closeness, atol=closeness):
            lines.append(f"lengths: {one.lengths} and {other.lengths}")
    return tuple(lines)


def fact_misses(known: KnownMechanism) -> tuple[str, ...]:
    """Where the configuration in which a mechanism is given is not what is known."""
    problem = Closure(known.mechanism)
    reference = problem.reference[None]
    gap = float(relative_gaps(problem, reference)[0])
    about = local_dimensions(problem, reference)
    lines = []
    if gap > CLOSED:
        lines.append(f"closure: {gap:.1e}")
    if about.dimension[0] != known.mobility:
        lines.append(f"mobility: {about.dimension[0]} and {known.mobility} known")
    if about.nullity[0] != known.nullity:
        lines.append(f"nullity: {about.nullity[0]} and {known.nullity} known")
    return tuple(lines)


# --- runs -----------------------------------------------------------------------------


def compare_ways(
    name: str, mechanism: Mechanism, seeds: int, settings: SearchSettings
) -> Iterator[Run]:
    """The maps of a mechanism from so many seeds and in all ways, the first with seed
    0, against which the others are held."""
    reference, run = _first_run(name, mechanism, settings)
    yield run
    for seed in range(1, seeds):
        way = f"seed {seed}"
        yield _run(name, way, mechanism, settings, seed, reference)
    for way, change in WAYS.items():
        yield _run(name, way, change(mechanism), settings, 0, reference)


def _first_run(
    name: str, mechanism: Mechanism, settings: SearchSettings
) -> tuple[Answer, Run]:
    began = time.perf_counter()
    reference = answer_of(map_linkage(mechanism, settings=settings, seed=0))
    seconds = time.perf_counter() - began
    return reference, _row(name, REFERENCE, seconds, reference, ())


def _run(
    name: str,
    way: str,
    mechanism: Mechanism,
    settings: SearchSettings,
    seed: int,
    reference: Answer,
) -> Run:
    began = time.perf_counter()
    answer = answer_of(map_linkage(mechanism, settings=settings, seed=seed))
    seconds = time.perf_counter() - began
    # angles of a joint of several bodies are measured from another one there
    several = any(len(joint.bodies) > 2 for joint in mechanism.joints)
    same_measure = not (way == "re-based" and several)
    lines: tuple[str, ...] = ()
    if reference.is_finished and answer.is_finished:
        lines = differences(reference, answer, same_measure=same_measure)
    return _row(name, way, seconds, answer, lines)


def _row(
    name: str, way: str, seconds: float, answer: Answer, lines: tuple[str, ...]
) -> Run:
    level = f"{answer.level}{', in doubt' if answer.in_doubt else ''}"
    return Run(name, way, seconds, answer.text, level, answer.is_finished, lines)


def describe(runs: Sequence[Run], misses: Mapping[str, tuple[str, ...]]) -> str:
    """A row a mechanism, and what differs in each map that does."""
    rows = []
    notes = [f"{name}: {line}" for name, lines in misses.items() for line in lines]
    for name in dict.fromkeys(run.mechanism for run in runs):
        of_name = [run for run in runs if run.mechanism == name]
        unlike = [run for run in of_name if run.lines]
        unfinished = sum(not run.is_finished for run in of_name)
        first = of_name[0]
        counts = (str(len(of_name)), str(len(unlike)), str(unfinished))
        median = f"{np.median([run.seconds for run in of_name]):.1f}"
        rows.append((name, first.answer, first.level, *counts, median))
        for run in unlike:
            notes += [f"{name}, {run.way}: {line}" for line in run.lines]
    heads = ("mechanism", "map", "level", "maps", "that differ", "unfinished", "s")
    return "\n".join([section("Mechanisms given in other ways", heads, rows), *notes])


def _write(runs: Iterator[Run], file: TextIO) -> list[Run]:
    """The runs, each a row of a file as soon as it is made."""
    writer = csv.DictWriter(file, [field.name for field in fields(Run)])
    writer.writeheader()
    kept = []
    for run in runs:
        lines = " | ".join(run.lines)
        writer.writerow({**asdict(run), "lines": lines})
        file.flush()
        kept.append(run)
    return kept


def _named(names: Sequence[str]) -> dict[str, KnownMechanism]:
    """The cases whose names hold one of ``names``; all without."""
    cases = known_mechanisms()
    if not names:
        return cases
    chosen = {
        name: case
        for name, case in cases.items()
        if any(part in name for part in names)
    }
    if not chosen:
        parts = ", ".join(map(repr, names))
        raise click.BadParameter(f"{parts}: no name of a mechanism holds it")
    return chosen


@click.command(cls=Study, help=__doc__)
@click.argument("names", nargs=-1)
@click.option("--seeds", type=click.IntRange(1), default=10, show_default=True)
@click.option(
    "--budget", type=click.FloatRange(min=1.0), default=60.0, show_default=True
)
@click.option("--starts", type=click.IntRange(1), default=200, show_default=True)
@click.option("--charts", type=click.IntRange(0), default=0, show_default=True)
@click.option("--out", type=FOLDER, default=Path("out/same_mechanism"))
def main(
    names: tuple[str, ...],
    seeds: int,
    budget: float,
    starts: int,
    charts: int,
    out: Path,
) -> None:
    """Run the study; write maps.csv and summary.txt. The exit code is 1 where a map
    differs."""
    chosen = _named(names)
    settings = SearchSettings(starts=starts, budget=budget, charts=charts)
    out.mkdir(parents=True, exist_ok=True)
    misses = {name: fact_misses(known) for name, known in chosen.items()}
    maps = (
        run
        for name, known in chosen.items()
        for run in compare_ways(name, known.mechanism, seeds, settings)
    )
    with (out / "maps.csv").open("w", newline="", encoding="utf-8") as file:
        runs = _write(maps, file)
    text = describe(runs, misses)
    click.echo(text)
    (out / "summary.txt").write_text(text + "\n", encoding="utf-8")
    if any(run.lines for run in runs) or any(misses.values()):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
