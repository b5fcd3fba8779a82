"""Do the printed parts of planar mechanisms in layers keep apart over a whole form?

    python -m studies.printed_layers [--only NAME] [--places 30] [--out out/printed_layers]

Ten planar mechanisms, seven of data/mechanisms.json and three of the catalogue, are laid
in layers along their first form as `bifurc export --to x.stl` does, and their solids are
made: rods of 6 mm at a mean length of a link of 100 mm. At configurations evenly along
the form every two solids, pins and caps among them, are intersected by the kernel that
made them. The study prints the layers, the volume that any two share, and whether the STL
file, opened by another program, has closed parts of positive volume only. With --out the
STEP and STL files are written there. Needs build123d and trimesh; about ten minutes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np

from bifurc.tables import table
from linkages import Mechanism, load, loop_of, map_linkage
from linkages.app.options import FOLDER, PrintOptions
from linkages.app.reports.stacking import stack_of
from linkages.mechanisms.of_loop import mechanism_of_loop
from linkages.printing.stack import Stack
from studies.known_mechanisms import cases, mechanism_of_case
from studies.study import Study, require_known

if TYPE_CHECKING:
    from build123d import Solid

    from linkages.printing.solids import StackedParts

FROM_DATA = (
    "planar RPRP",
    "planar slider-crank RRRP",
    "Dixon I, K(3,3)",
    "K(2,3)",
    "three equal parallel cranks, pivots on a line",
    "Peaucellier-Lipkin inversor",
    "double Watt mechanism with slanted couplers (cusp 3/2)",
)
FROM_CATALOGUE = ("four-bar", "parallelogram", "kite")
BEGIN = 0.3  # arclength, rad, at which a loop of the catalogue becomes a mechanism
PLACES = 30  # of a form, at which solids are intersected
NOTHING = 1e-9  # mm^3


class PrintedLayers(NamedTuple):
    """What is seen of the parts of a mechanism: its layers and solids, the largest volume
    (mm^3) that two share, which two, and how many parts of the STL file there are, how
    many of them closed, and the least volume."""

    name: str
    layers: int
    solids: int
    shared: float
    worst: str
    parts: int
    closed: int
    least: float

    @property
    def holds(self) -> bool:
        """Whether no two share anything, and all that is printed is closed."""
        is_apart = self.shared <= NOTHING
        is_closed = self.parts == self.closed == self.solids
        return is_apart and is_closed and self.least > 0


def mechanisms() -> dict[str, Callable[[], Mechanism]]:
    """What makes each of the ten, by name."""
    made: dict[str, Callable[[], Mechanism]] = {}
    for name in FROM_DATA:
        made[name] = partial(_of_data, name)
    for name in FROM_CATALOGUE:
        made[name] = partial(_of_catalogue, name)
    return made


def _of_data(name: str) -> Mechanism:
    return mechanism_of_case(cases()[name])


def _of_catalogue(name: str) -> Mechanism:
    atlas = map_linkage(load(name))
    return mechanism_of_loop(loop_of(atlas), atlas.forms[0].branch(BEGIN))


def measure(
    names: Iterable[str], places: int, out: Path | None = None
) -> Iterator[PrintedLayers]:
    """What is seen of some of the ten at so many ``places``; files go to ``out``."""
    from linkages.printing.solids import make_stack

    made = mechanisms()
    for name in names:
        atlas = map_linkage(made[name]())
        stack = stack_of(atlas, atlas.forms[:1], PrintOptions())
        yield measure_parts(name, stack, make_stack(stack), places, out)


def measure_parts(
    name: str, stack: Stack, parts: StackedParts, places: int, out: Path | None = None
) -> PrintedLayers:
    """What is seen of some ``parts`` along the form for which they are made."""
    from linkages.printing.solids import place_stack, write_stack_step, write_stl

    form = stack.plan.forms[0]
    shared, worst = 0.0, ""
    for s in np.linspace(0.0, form.branch.length, places, endpoint=False):
        volume, pair = most_shared(place_stack(stack, parts, form.branch(s)))
        if volume > shared:
            shared, worst = volume, f"{pair} at {s:.4f}"
    with TemporaryDirectory() as folder:
        stem = name.split(",")[0].split("(")[0].strip().replace(" ", "-")
        file = (out or Path(folder)) / f"{stem}.stl"
        write_stl(parts, file)
        volumes = volumes_of_file(file)
        if out is not None:
            point = form.branch(0.0)
            write_stack_step(stack, parts, point, name, file.with_suffix(".step"))
    closed = [volume for volume in volumes if volume is not None]
    return PrintedLayers(
        name,
        stack.layers.count,
        len(parts.solids),
        shared,
        worst,
        len(volumes),
        len(closed),
        min(closed, default=0.0),
    )


def most_shared(solids: Sequence[tuple[str, Solid]]) -> tuple[float, str]:
    """The largest volume that two of some solids share, mm^3, and which two these are."""
    boxes = [solid.bounding_box(optimal=False) for _, solid in solids]
    low = np.array([tuple(box.min) for box in boxes])
    high = np.array([tuple(box.max) for box in boxes])
    most, worst = 0.0, ""
    for i, j in combinations(range(len(solids)), 2):
        if np.any(low[i] > high[j]) or np.any(low[j] > high[i]):
            continue
        common = solids[i][1].intersect(solids[j][1])
        volume = sum(solid.volume for solid in common or [])
        if volume > most:
            most, worst = volume, f"{solids[i][0]} and {solids[j][0]}"
    return most, worst


def volumes_of_file(path: Path) -> list[float | None]:
    """The volume of every part of an STL file, mm^3; None of one that is not closed."""
    import trimesh

    mesh = trimesh.load_mesh(path)
    return [
        float(part.volume) if part.is_watertight else None
        for part in mesh.split(only_watertight=False)
    ]


def describe(rows: Sequence[PrintedLayers]) -> str:
    """A line for each mechanism."""
    heads = (
        "mechanism",
        "layers",
        "solids",
        "shared (mm^3)",
        "parts",
        "closed",
        "holds",
    )
    lines = [
        (
            row.name,
            f"{row.layers}",
            f"{row.solids}",
            f"{row.shared:.3g} {row.worst}".strip(),
            f"{row.parts}",
            f"{row.closed}",
            "yes" if row.holds else "no",
        )
        for row in rows
    ]
    return table(heads, lines)


@click.command(cls=Study)
@click.option("--only", multiple=True, help="One of the mechanisms, by name.")
@click.option(
    "--places", type=click.IntRange(1), default=PLACES, help="Configurations of a form."
)
@click.option("--out", type=FOLDER, help="Where STL and STEP files are written.")
def main(only: tuple[str, ...], places: int, out: Path | None) -> None:
    """Intersect the printed parts of ten planar mechanisms along a form."""
    require_known("--only", only, mechanisms())
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    rows = list(measure(only or mechanisms(), places, out))
    click.echo(describe(rows))
    if not all(row.holds for row in rows):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
