"""A short, fixed set of benchmarks, with versions and machine, as JSON.

    python -m studies.bench [--out bench.json] [--against OLD.json]

Work inside the process is given in processor time, medians of warm runs; commands in
wall time, as a user sees them.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import TypedDict

import click
import numpy as np

from bifurc import (
    Branch,
    MarchSettings,
    SearchSettings,
    TraceSettings,
    explore,
    trace_branch,
)
from bifurc.curves.continuation import DEFAULT_SETTINGS
from linkages import Closure, load_linkage, map_linkage
from linkages.app.options import FILE
from linkages.catalogue import entry
from linkages.slices.elimination import slice_configurations
from studies.methods.cases import bratu
from studies.study import Study

LINKAGE = "special-double-subtractive-goldberg"
UNCOUNTED = SearchSettings(count=False, certify=False)
CPU_INFO = Path("/proc/cpuinfo")
IMPORTS = "import linkages.mapping, linkages.app.cli"
COMMAND = "from linkages.app.cli import main; main()"
PACKAGES = ("bifurc", "numpy", "scipy", "networkx", "xarray")


def median_time(
    work: Callable[[], object],
    budget: float = 0.5,
    clock: Callable[[], float] = time.process_time,
) -> float:
    """Median time of ``work`` over as many runs as fit into the budget, at least 3,
    after one that warms up."""
    work()
    times: list[float] = []
    while len(times) < 3 or (sum(times) < budget and len(times) < 200):
        began = clock()
        work()
        times.append(clock() - began)
    return statistics.median(times)


def benchmarks() -> dict[str, float]:
    """Seconds of each benchmark by name."""
    return {
        **_tracing_benchmarks(),
        **_search_benchmarks(),
        "Bratu, 50 unknowns, tolerance 1e-9": _bratu_benchmark(),
        "import numpy, wall": command_time("-c", "import numpy"),
        "import all that a map needs, wall": command_time("-c", IMPORTS),
        f"bifurc map {LINKAGE} --json, wall": command_time(
            "-c", COMMAND, "map", LINKAGE, "--json"
        ),
    }


def _tracing_benchmarks() -> dict[str, float]:
    """One form of the linkage, traced again and again."""
    problem = Closure(entry(LINKAGE).build())
    form = explore(problem, settings=UNCOUNTED).forms[0].branch
    point, tangent = form(0.3), form(0.3, 1)

    settings = MarchSettings(
        order=DEFAULT_SETTINGS.order,
        tolerance=DEFAULT_SETTINGS.tolerance,
        shortest=DEFAULT_SETTINGS.shortest,
        longest=DEFAULT_SETTINGS.longest,
        count=len(form.pieces),
    )

    def trace() -> Branch:
        return trace_branch(problem, point, tangent)

    def march() -> object:
        return problem.march(point, tangent, settings)

    return {
        "one closed 6R form, public interface": median_time(trace),
        "one closed 6R form, kernel": median_time(march),
    }


def _search_benchmarks() -> dict[str, float]:
    """The steps of a search for all forms of the linkage, and the whole of it."""
    linkage = load_linkage(LINKAGE)
    loop = linkage.loop
    problem = Closure(loop)
    starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, loop.n))
    angles = np.linspace(0, 6, 24)
    work: dict[str, Callable[[], object]] = {
        "200 random starts of a 6R, projected": lambda: problem.project(starts),
        "24 complete slices of a 6R": lambda: slice_configurations(loop, 1, angles),
        "explore, four forms of a 6R": lambda: explore(problem, settings=UNCOUNTED),
        "complete map of a 6R, named": lambda: map_linkage(linkage),
    }
    return {name: median_time(task) for name, task in work.items()}


def _bratu_benchmark() -> float:
    """A square system of 51 unknowns."""
    chain = bratu(50)
    settings = TraceSettings(tolerance=1e-9)

    def trace() -> Branch:
        return trace_branch(chain.problem, chain.start, chain.tangent, settings)

    return median_time(trace)


def command_time(*arguments: str) -> float:
    """Median wall time of a Python process."""

    def run() -> None:
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)

    return median_time(run, budget=3.0, clock=time.perf_counter)


class Machine(TypedDict):
    """What the benchmarks ran on; ``packages`` are versions by name."""

    system: str
    architecture: str
    processor: str
    cores: int | None
    python: str
    packages: dict[str, str]


def machine() -> Machine:
    """What the benchmarks run on."""
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
    }


def _processor() -> str:
    """The name of the processor."""
    if CPU_INFO.exists():
        for line in CPU_INFO.read_text(encoding="utf-8").splitlines():
            key, _, value = line.partition(":")
            if key.strip() == "model name":
                return value.strip()
    return platform.processor()


@click.command(cls=Study)
@click.option(
    "--out",
    default="bench.json",
    show_default=True,
    type=FILE,
)
@click.option(
    "--against",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="An older result.",
)
def main(out: Path, against: Path | None) -> None:
    """Run the benchmarks and write them; with --against also say how many times faster
    or slower each is."""
    seconds = benchmarks()
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    result = {"machine": machine(), "load": busy, "seconds": seconds}
    out.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    before: dict[str, float] = {}
    if against is not None:
        before = json.loads(against.read_text(encoding="utf-8"))["seconds"]
    for name, value in seconds.items():
        line = f"{1e3 * value:10.3f} ms   {name}"
        if name in before:
            line += f"   {value / before[name]:.2f} of the time before"
        click.echo(line)


if __name__ == "__main__":
    main()
