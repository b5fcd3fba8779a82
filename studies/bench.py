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
from typing import Any

import click
import numpy as np

from bifurc.curves.continuation import DEFAULT_SETTINGS, TraceSettings, trace_branch
from bifurc.search.explore import explore
from linkages.catalogue import entry
from linkages.closure import kernels
from linkages.closure.loop_closure import LoopClosure
from linkages.linkage import Linkage
from linkages.mapping import map_linkage
from linkages.slices.elimination import slice_configurations
from studies.methods.cases import bratu

__all__ = ["benchmarks", "machine"]

LINKAGE = "special-double-subtractive-goldberg"
COMMAND = "from linkages.app.cli import main; main()"
PACKAGES = ("bifurc", "numpy", "scipy", "numba", "networkx", "xarray")


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
    found = entry(LINKAGE)
    loop = found.build()
    problem = LoopClosure(loop)
    form = explore(problem).forms[0].branch
    point, tangent = form(0.3), form(0.3, 1)
    starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, 6))
    limits = (
        DEFAULT_SETTINGS.order,
        DEFAULT_SETTINGS.tolerance,
        DEFAULT_SETTINGS.shortest,
        DEFAULT_SETTINGS.longest,
    )
    patterns = found.patterns(**found.defaults) if found.patterns is not None else ()
    chain = bratu(50)
    loose = TraceSettings(tolerance=1e-9)
    return {
        "one closed 6R form, public interface": median_time(
            lambda: trace_branch(problem, point, tangent)
        ),
        "one closed 6R form, kernel": median_time(
            lambda: kernels.march(
                point, tangent, problem._geometry, *limits, len(form.pieces)
            )
        ),
        "200 random starts of a 6R, projected": median_time(
            lambda: problem.project(starts)
        ),
        "24 complete slices of a 6R": median_time(
            lambda: slice_configurations(loop, 1, np.linspace(0, 6, 24))
        ),
        "explore, four forms of a 6R": median_time(lambda: explore(problem)),
        "complete map of a 6R, named": median_time(
            lambda: map_linkage(Linkage(loop, patterns))
        ),
        "Bratu, 50 unknowns, tolerance 1e-9": median_time(
            lambda: trace_branch(chain.problem, chain.start, chain.tangent, loose)
        ),
        "import numpy, wall": command_time("-c", "import numpy"),
        "import all that a map needs, wall": command_time(
            "-c", "import linkages.mapping, linkages.app.cli"
        ),
        f"bifurc map {LINKAGE} --json, wall": command_time(
            "-c", COMMAND, "map", LINKAGE, "--json"
        ),
    }


def command_time(*arguments: str) -> float:
    """Median wall time of a Python process."""

    def run() -> None:
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)

    return median_time(run, budget=3.0, clock=time.perf_counter)


def machine() -> dict[str, Any]:
    """What the benchmarks ran on."""
    model = platform.processor()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next(
            (
                line.partition(":")[2].strip()
                for line in lines
                if line.startswith("model name")
            ),
            model,
        )
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": model,
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
    }


@click.command()
@click.option(
    "--out",
    default="bench.json",
    show_default=True,
    type=click.Path(path_type=Path, dir_okay=False),
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
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    result = {"machine": machine(), "load": load, "seconds": seconds}
    out.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    before = (
        json.loads(against.read_text(encoding="utf-8"))["seconds"] if against else {}
    )
    for name, value in seconds.items():
        ratio = (
            f"   {value / before[name]:.2f} of the time before"
            if name in before
            else ""
        )
        click.echo(f"{1e3 * value:10.3f} ms   {name}{ratio}")


if __name__ == "__main__":
    main()
