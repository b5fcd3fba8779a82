"""Where the time of one map goes.

    python -m studies.map_budget [NAME] [--out DIR]

The steps of the method are functions that do not call each other; a profiler adds up
their time over some maps. What is in none of them is the rest. Another table has the
time of `bifurc map NAME --json` as a process: to start Python, to import what the map
needs, to make it. The last one sets the Taylor series of the forms against what the
processor can do: the operations that their recurrences take, over the rate at which a
product of matrices runs.
"""

from __future__ import annotations

import cProfile
import pstats
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import click
import numpy as np

from bifurc import MarchSettings, trace_branch
from bifurc.curves.continuation import DEFAULT_SETTINGS
from linkages import Closure, Linkage, load_linkage, map_linkage
from linkages.app.options import FOLDER
from studies.study import Study

LINKAGE = "special-double-subtractive-goldberg"
MAPS = 20
RUNS = 7  # of a process, of which the least counts
SIZE = 300  # of the matrices whose product gives the rate of the processor

# The step of the method that a function is: module, function, name of the step.
STEPS = (
    ("slices.elimination", "slice_configurations", "complete slices"),
    ("closure.loop_parts", "project", "projections"),
    ("search.components", "components_of_seeds", "components of seeds"),
    ("curves.continuation", "trace_branch", "tracing"),
    ("curves.misclosure", "largest_misclosure", "misclosure of forms"),
    ("search.branches.canonical_course", "canonical_course", "starts of forms"),
    ("numerics.blur", "blur_along", "how well forms are known"),
    ("curves.monitor", "profile_branch", "singular values"),
    ("curves.minima", "singular_value_minima", "minima of singular values"),
    ("search.branches.certification", "certificate_of", "certificates"),
    ("singular.locate", "locate_singular_point", "locating singular points"),
    ("singular.sphere", "is_on_surface", "surfaces through singular points"),
    ("singular.classify", "classify_singular_point", "classifying singular points"),
    ("search.findings", "branch_through", "matching starts to forms"),
    ("search.findings", "branch_along", "matching forms to forms"),
    ("search.findings", "match_seeds", "matching seeds to forms"),
    ("slices.completeness", "__call__", "audit by slices"),
    ("slices.assemblies", "isolated_assemblies", "isolated assemblies"),
    ("search.answer.assemble", "assemble_atlas", "the atlas"),
    ("labelling", "name_atlas", "names of forms"),
)


class Share(NamedTuple):
    """The ``seconds`` that a ``step`` takes of one map, and what ``share`` of it."""

    step: str
    seconds: float
    share: float


def budget(linkage: Linkage, maps: int = MAPS) -> list[Share]:
    """The steps of the map of a linkage, the longest first, and the rest."""
    map_linkage(linkage)
    profiler = cProfile.Profile(time.process_time, builtins=False)
    profiler.enable()
    for _ in range(maps):
        map_linkage(linkage)
    profiler.disable()
    times: Times = vars(pstats.Stats(profiler))["stats"]
    whole = _seconds_of(times, "mapping", "map_linkage")
    seconds = {
        name: _seconds_of(times, module, function) for module, function, name in STEPS
    }
    # the audit asks for the isolated assemblies
    seconds["audit by slices"] -= seconds["isolated assemblies"]
    shares = [
        Share(name, total / maps, total / whole) for name, total in seconds.items()
    ]
    shares.sort(key=lambda share: -share.seconds)
    rest = whole - sum(seconds.values())
    return [*shares, Share("the rest", rest / maps, rest / whole)]


Times: TypeAlias = dict[
    tuple[str, int, str], tuple[int, int, float, float, dict[Any, Any]]
]
"""What a profiler knows of a function (file, line, name): calls without and with those
to itself, seconds without and with what it calls, its callers."""


def _seconds_of(times: Times, module: str, name: str) -> float:
    """Seconds spent in a function, and in what it calls, in all calls from outside."""
    ending = "/" + module.replace(".", "/") + ".py"
    return sum(
        cumulative
        for (path, _, function), (_, _, _, cumulative, _) in times.items()
        if function == name and path.endswith(ending)
    )


# --- the process ----------------------------------------------------------------------


def process_times(name: str) -> dict[str, float]:
    """Seconds on the clock of a process that does less and less of a map, the least of
    a few runs."""
    commands = {
        f"bifurc map {name} --json": (
            "from linkages.app.cli import main; main()",
            ("map", name, "--json"),
        ),
        "the imports of a map": ("import linkages.app.atlas_source", ()),
        "import numpy": ("import numpy", ()),
        "python alone": ("pass", ()),
    }
    return {what: _least_time(*command) for what, command in commands.items()}


def _least_time(program: str, arguments: Sequence[str]) -> float:
    """Seconds on the clock of a Python program, the least of some runs."""
    command = [sys.executable, "-c", program, *arguments]
    times = []
    for _ in range(RUNS):
        began = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        times.append(time.perf_counter() - began)
    return min(times)


# --- the Taylor series ----------------------------------------------------------------


def series_operations(joints: int, order: int) -> int:
    """Additions and multiplications of numbers for one series of the motion of a loop.

    For every pair of orders a product of a rate and a screw for the twists, one for
    what is known of the next rates, and a bracket (three cross products and a sum); a
    cross product takes 9. Solving for the rates takes 4 x 7 n.
    """
    pairs = order * (order + 1) // 2
    rate_and_screw = 12
    bracket = 3 * 9 + 3 + 6
    return pairs * joints * (2 * rate_and_screw + bracket) + order * 4 * 7 * joints


def seconds_of_series(linkage: Linkage) -> tuple[float, int]:
    """Seconds that a march takes for a piece of the first form, the least of some runs,
    and the operations of its series."""
    problem = Closure(linkage.loop)
    form = map_linkage(linkage).forms[0].branch
    start, tangent = form(0.0), form(0.0, 1)
    pieces = len(trace_branch(problem, start, tangent).pieces)
    settings = MarchSettings(
        order=DEFAULT_SETTINGS.order,
        tolerance=DEFAULT_SETTINGS.tolerance,
        shortest=DEFAULT_SETTINGS.shortest,
        longest=DEFAULT_SETTINGS.longest,
        count=pieces,
    )
    seconds = _least_seconds(lambda: problem.march(start, tangent, settings))
    return seconds / pieces, series_operations(problem.n, settings.order)


def operations_per_second() -> float:
    """The rate at which this processor multiplies and adds, in a product of matrices
    with one thread."""
    matrix = np.random.default_rng(0).standard_normal((SIZE, SIZE))
    seconds = _least_seconds(lambda: matrix @ matrix)
    return 2 * SIZE**3 / seconds


def _least_seconds(work: Callable[[], object]) -> float:
    """Processor time of ``work``, the least of some runs."""
    times = []
    for _ in range(30):
        began = time.process_time()
        work()
        times.append(time.process_time() - began)
    return min(times)


# --- the study ------------------------------------------------------------------------


@click.command(cls=Study, help=__doc__)
@click.argument("name", default=LINKAGE)
@click.option("--out", type=FOLDER)
def main(name: str, out: Path | None) -> None:
    """Print the tables; write them to ``out``/budget.txt where that is given."""
    linkage = load_linkage(name)
    shares = budget(linkage)
    whole = sum(share.seconds for share in shares)
    lines = [f"{name}: {1e3 * whole:.1f} ms a map under the profiler", ""]
    for step, seconds, share in shares:
        lines.append(f"  {step:30} {1e3 * seconds:7.2f} ms {100 * share:5.1f} %")
    lines += ["", "as a process"]
    for what, seconds in process_times(name).items():
        lines.append(f"  {what:50} {seconds:6.2f} s")
    seconds, operations = seconds_of_series(linkage)
    rate = operations_per_second()
    lines += [
        "",
        f"a piece takes {1e6 * seconds:.1f} us; its series {operations} operations, "
        f"{1e6 * operations / rate:.1f} us at {rate / 1e9:.1f} thousand million a "
        "second, the rate of a product of matrices",
    ]
    text = "\n".join(lines)
    click.echo(text)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "budget.txt").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
