"""The same answer on every processor, from every start and through rounding noise.

    python -m studies.same_answer [NAME ...] [--seeds 10] [--draws 20] [--out DIR]

Every linkage of the catalogue is mapped with kernels of OpenBLAS made for other
processors, which round otherwise, each with several seeds of the random starts; and
with noise in the last places of everything that the problem computes
(`bifurc.noisy_problem`), inside the compiled kernels too. The JSON documents of all
these maps are held against one: forms with lengths, winding numbers and places,
bifurcations with tangents, rank drops, near misses, dead points, rigid assemblies,
levels and statements. Numbers agree to 1e-9, near misses to 1e-6
(`studies.document_differences`).
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import click

from bifurc.tables import section
from linkages.app.options import FOLDER
from linkages.catalogue import catalogue
from studies.same_answer_maps import Comparison
from studies.study import Study, require_known

KERNELS = ("Prescott", "Nehalem", "Haswell", "Zen", "SkylakeX")
HEADS = ("kernel", "linkage", "seed", "draw", "seconds", "differences")
OWN = ""  # the kernels that OpenBLAS picks by itself


@dataclass(frozen=True)
class Batch:
    """Maps of one process: with the ``kernel`` of OpenBLAS, so many ``seeds`` of the
    random starts and ``draws`` of rounding noise."""

    kernel: str
    seeds: int
    draws: int

    @property
    def name(self) -> str:
        """What is varied, for a table."""
        if self.draws:
            return f"rounding noise, {self.draws} draws"
        return f"{self.kernel or 'own kernels'}, {self.seeds} seeds"


def write_reference(reference: Path, names: Sequence[str]) -> None:
    """Write the maps with seed 0 and the kernels of this processor."""
    subprocess.run(
        [*_command(reference, names), "--write"], env=_environment(OWN), check=True
    )


def compare(
    reference: Path, names: Sequence[str], batch: Batch
) -> Iterator[Comparison]:
    """The maps of a batch against the reference, as they come."""
    counts = ["--seeds", str(batch.seeds), "--draws", str(batch.draws)]
    command = [*_command(reference, names), *counts]
    environment = _environment(batch.kernel)
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            yield Comparison(**json.loads(line))
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)


def _command(reference: Path, names: Sequence[str]) -> list[str]:
    module = "studies.same_answer_maps"
    return [sys.executable, "-m", module, str(reference), *names]


def _environment(kernel: str) -> dict[str, str]:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    if kernel:
        environment["OPENBLAS_CORETYPE"] = kernel
    return environment


def describe(results: Sequence[tuple[Batch, Sequence[Comparison]]]) -> str:
    """How many maps of every batch differ, and what differs in each of these."""
    rows = []
    differing = []
    for batch, comparisons in results:
        unlike = [comparison for comparison in comparisons if comparison.lines]
        seconds = sum(comparison.seconds for comparison in comparisons)
        counts = (str(len(comparisons)), str(len(unlike)), f"{seconds:.0f}")
        rows.append((batch.name, *counts))
        for comparison in unlike:
            run = f"{comparison.linkage}, {batch.name}, seed {comparison.seed}"
            differing += [f"{run}: {line}" for line in comparison.lines]
    heads = ("with", "maps", "that differ", "s")
    table = section("Maps held against one of every linkage", heads, rows)
    return "\n".join([table, *differing])


def _run(
    reference: Path, names: Sequence[str], batch: Batch, file: TextIO
) -> list[Comparison]:
    """The comparisons of a batch, each a row of a file as soon as it is made."""
    writer = csv.writer(file)
    comparisons = []
    for one in compare(reference, names, batch):
        run = [batch.kernel, one.linkage, one.seed, one.draw, f"{one.seconds:.3f}"]
        writer.writerow([*run, " | ".join(one.lines)])
        file.flush()
        comparisons.append(one)
    return comparisons


@click.command(cls=Study, help=__doc__)
@click.argument("names", nargs=-1)
@click.option("--seeds", type=click.IntRange(0), default=10, show_default=True)
@click.option("--draws", type=click.IntRange(0), default=20, show_default=True)
@click.option("--kernel", "kernels", multiple=True, default=KERNELS, show_default=True)
@click.option(
    "--out",
    type=FOLDER,
    default=Path("out/same_answer"),
)
def main(
    names: tuple[str, ...], seeds: int, draws: int, kernels: tuple[str, ...], out: Path
) -> None:
    """Run the study; write maps.csv and summary.txt. The exit code is 1 where a map
    differs."""
    require_known("NAME", names, catalogue())
    out.mkdir(parents=True, exist_ok=True)
    reference = out / "reference.json"
    write_reference(reference, names)
    batches = [Batch(kernel, seeds, 0) for kernel in kernels if seeds]
    batches += [Batch(OWN, 0, draws)] if draws else []
    results = []
    with (out / "maps.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerow(HEADS)
        for batch in batches:
            results.append((batch, _run(reference, names, batch, file)))
            click.echo(f"{batch.name}: {len(results[-1][1])} maps", err=True)
    text = describe(results)
    click.echo(text)
    (out / "summary.txt").write_text(text + "\n", encoding="utf-8")
    if any(comparison.lines for _, all_of in results for comparison in all_of):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
