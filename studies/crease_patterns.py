"""What `bifurc map` answers for a folder of crease patterns, and in what time.

    python -m studies.crease_patterns --from FOLDER [--budget 60] [--out TABLE.csv]

Every FOLD, CP and SVG file in the folder with so many faces is mapped by a process of
its own with the budget. A row for each says how many faces it has, the exit code and the
first line of the answer, or why there is none, the time on the clock, which the budget is
kept on, and that of the processor. The files stay where they are.
"""

from __future__ import annotations

import csv
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import click

from linkages import LinkageFileError, Mechanism, load
from linkages.app.exit_codes import ExitCode
from linkages.app.options import FILE, FOLDER, POSITIVE
from studies.study import Study

ENDINGS = (".fold", ".cp", ".svg")
ANSWERS = (ExitCode.DONE, ExitCode.DOES_NOT_MOVE)
PAST = 0.05  # of the budget, by which a map may end after it
PROGRAM = "from linkages.app.start import main; main()"
BETWEEN_PARTS = "\n\n\n"  # of what the command prints
PATIENCE = 10.0  # budgets after which a process is ended


class Answer(NamedTuple):
    """What became of a file: its number of ``faces``, the exit ``code`` of the command,
    None where it had to be ended, what it ``says``, and the time, s, on the ``clock`` and
    of the ``processor``."""

    file: str
    faces: int
    code: int | None
    says: str
    clock: float
    processor: float

    @property
    def is_answered(self) -> bool:
        """Whether it is said if the pattern moves."""
        return self.code in ANSWERS

    def is_late(self, budget: float) -> bool:
        """Whether it ended more than a twentieth of the budget after it."""
        return self.clock > (1 + PAST) * budget


def patterns(folder: Path, least: int, most: int) -> Iterator[tuple[Path, int]]:
    """The files of a folder that have from ``least`` to ``most`` faces, in the order of
    their names, with how many; those that cannot be read have 0."""
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() not in ENDINGS:
            continue
        try:
            mechanism = load(path)
        except LinkageFileError:
            yield path, 0
            continue
        assert isinstance(mechanism, Mechanism)
        faces = len(mechanism.panels)
        if least <= faces <= most:
            yield path, faces


def answer(path: Path, faces: int, budget: float) -> Answer:
    """What `bifurc map` says of a file within a budget, s."""
    command = [sys.executable, "-c", PROGRAM, "map", str(path)]
    before = _of_processor()
    began = time.perf_counter()
    code: int | None = None
    says = f"ended after {PATIENCE:g} budgets"
    try:
        run = subprocess.run(
            [*command, "--budget", str(budget)],
            capture_output=True,
            text=True,
            timeout=PATIENCE * budget,
            check=False,
        )
    except subprocess.TimeoutExpired:
        pass
    else:
        code, says = run.returncode, _said(run.stdout, run.stderr)
    clock = time.perf_counter() - began
    return Answer(path.name, faces, code, says, clock, _of_processor() - before)


def _of_processor() -> float:
    """The time of the processor, s, that all processes took that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _said(output: str, errors: str) -> str:
    """The sentence of the verdict on every part of a pattern, which is the line below its
    name, or the last line of the errors."""
    parts = [part.splitlines() for part in output.split(BETWEEN_PARTS)]
    verdicts = [lines[1] for lines in parts if len(lines) > 1]
    return " ".join(verdicts) or (errors.strip().splitlines() or ["nothing"])[-1]


def describe(answers: list[Answer], budget: float) -> str:
    """How many of the files are answered, how many end late, and the others by what is
    said of them."""
    answered = sum(one.is_answered for one in answers)
    late = sum(one.is_late(budget) for one in answers)
    lines = [
        f"{answered} of {len(answers)} files are answered, and {late} end more than "
        f"{PAST:.0%} after the budget of {budget:g} s"
    ]
    for one in answers:
        if not one.is_answered or one.is_late(budget):
            what = f"{one.file} ({one.faces} faces, {one.clock:.1f} s)"
            lines.append(f"{what}: {one.says}")
    return "\n".join(lines)


def write(answers: list[Answer], path: Path) -> None:
    """Write a table with a row for every file."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(Answer._fields)
        writer.writerows(answers)


@click.command(cls=Study, help=__doc__)
@click.option("--from", "folder", type=FOLDER, required=True, help="Where files are.")
@click.option("--budget", type=POSITIVE, default=60.0, show_default=True)
@click.option("--least", type=click.IntRange(min=1), default=4, show_default=True)
@click.option("--most", type=click.IntRange(min=1), default=100, show_default=True)
@click.option(
    "--every",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Take each file of this number in the order of their names.",
)
@click.option("--out", type=FILE, help="The table, as CSV.")
def main(
    folder: Path, budget: float, least: int, most: int, every: int, out: Path | None
) -> None:
    if not folder.is_dir():
        raise click.BadParameter(f"{folder} is no folder", param_hint="--from")
    answers: list[Answer] = []
    for number, (path, faces) in enumerate(patterns(folder, least, most)):
        if number % every:
            continue
        answers.append(answer(path, faces, budget))
        one = answers[-1]
        click.echo(f"{one.file}: {one.says} ({one.processor:.1f} s)", err=True)
        if out is not None:
            write(answers, out)
    click.echo(describe(answers, budget))


if __name__ == "__main__":
    main()
