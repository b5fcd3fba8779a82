"""Square systems of the literature: complex and real solutions counted beside what is
published, and the time beside that of PHCpack.

    python -m studies.square_systems --only puma --only eco8

Times are those of the processor, in s. PHCpack's blackbox solver, `phc -b`, is run where
it is installed (the package `phcpack` of Debian).
"""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from bifurc.equations.polynomials import polynomial_system, simplest_ratio
from bifurc.limits import Deadline
from bifurc.search.isolated import isolated_solutions
from bifurc.systems.equation_file import EquationFile
from studies.study import Study, require_known

DATA = Path(__file__).parents[1] / "data" / "square_systems.json"
MOST = 2000  # paths
LIMIT = 3600.0  # s, for either program


@dataclass(frozen=True)
class SquareSystem:
    """A system by its ``name``, with the numbers of isolated solutions over the complex
    and the real numbers that are published, and texts of its ``equations``."""

    name: str
    origin: str
    complex: int
    real: int
    unknowns: tuple[str, ...]
    equations: tuple[str, ...]


def load_systems() -> list[SquareSystem]:
    """The systems of the table."""
    rows = json.loads(DATA.read_text(encoding="utf-8"))["systems"]
    return [
        SquareSystem(
            **{**row, "unknowns": tuple(row["unknowns"])},
        )
        for row in rows
    ]


@dataclass(frozen=True)
class Count:
    """How many solutions of full rank there are over the ``complex`` and the ``real``
    numbers, along how many ``paths``, and whether nothing was ``lost``; in ``seconds``."""

    complex: int
    real: int
    paths: int
    lost: int
    seconds: float


def count(system: SquareSystem, seed: int = 0) -> Count | None:
    """The solutions of a system, from generic ones of a ``seed``; None where there was no
    time."""
    content = {
        "name": system.name,
        "unknowns": {name: {} for name in system.unknowns},
        "equations": list(system.equations),
    }
    began = time.process_time()
    problem = EquationFile(DATA, content).system({}, {}).problem
    tape = problem.recording.tape
    polynomials = None if tape is None else polynomial_system(tape, simplest_ratio)
    if polynomials is None:
        raise click.ClickException(f"{system.name}: its equations are no polynomials")
    bounds = np.full((len(system.unknowns), 2), [-np.inf, np.inf])
    deadline = Deadline(LIMIT)
    found = isolated_solutions(polynomials, bounds, MOST, deadline, seed)
    if found is None:
        return None
    return Count(
        complex=found.complex,
        real=found.real,
        paths=len(found.paths.ends),
        lost=found.paths.lost,
        seconds=time.process_time() - began,
    )


def seconds_of_phcpack(system: SquareSystem) -> float | None:
    """How long PHCpack takes (s of the processor); None where it is not installed, or did
    not end in time."""
    program = shutil.which("phc")
    if program is None:
        return None
    text = f"{len(system.equations)}\n" + "".join(f"{e};\n" for e in system.equations)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "in").write_text(text, encoding="utf-8")
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        try:
            command = [program, "-b", "in", "out"]
            subprocess.run(command, cwd=folder, timeout=LIMIT, check=True)
        except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
            return None
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    return after - before


def row_of(system: SquareSystem, seed: int) -> str:
    """What is found of a system, beside what is published."""
    found = count(system, seed)
    other = seconds_of_phcpack(system) if seed == 0 else None
    shown = "-" if other is None else f"{other:.2f}"
    published = f"{system.real} of {system.complex}"
    if found is None:
        return (
            f"{system.name:<10} {published:>10} {'-':>10} {'-':>6} {'-':>8} {shown:>8}"
        )
    own = f"{found.real} of {found.complex}"
    lost = f" ({found.lost} lost)" if found.lost else ""
    return (
        f"{system.name:<10} {published:>10} {own:>10} {found.paths:>6} "
        f"{found.seconds:>8.2f} {shown:>8}{lost}"
    )


@click.command(cls=Study)
@click.option("--only", multiple=True, help="The name of a system.")
@click.option("--seeds", default=1, show_default=True, help="Random seeds from 0 on.")
def main(only: Sequence[str], seeds: int) -> None:
    """Count the real and complex solutions of square systems of the literature."""
    systems = load_systems()
    require_known("--only", only, [system.name for system in systems])
    heads = ("system", "published", "counted", "paths", "s", "PHCpack")
    click.echo("{:<10} {:>10} {:>10} {:>6} {:>8} {:>8}".format(*heads))
    for system in systems:
        if not only or system.name in only:
            for seed in range(seeds):
                click.echo(row_of(system, seed))


if __name__ == "__main__":
    main()
