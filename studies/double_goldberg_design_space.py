"""Where in the design space do the forms make one cycle, and where do they fall into
two components?

The sources state that all four forms of the double-Goldberg linkages reach each other,
and likewise those of the zero-offset line-symmetric Bricard linkage (Song 2013,
sections 5.2 and 4.4.3). Here every member of a plane through the design space is
mapped, and members drawn from the whole of it are counted. Lengths follow from the
twists but for a common scale in the double-Goldberg linkages.

    python -m studies.double_goldberg_design_space [--out DIR] [--count 36] [--random 400] [--workers N]
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from linkages.app.options import FOLDER
from linkages.app.sweep.member import Status
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import run_sweep
from linkages.app.sweep.store import open_sweep
from linkages.catalogue import entry
from linkages.entry import ParameterKind
from studies.study import Study

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Plane:
    """Two twists of a family, and their range in degrees; the other parameters at their
    defaults."""

    family: str
    x: str
    y: str
    low: float = 5.0
    high: float = 175.0


PLANES = (
    Plane("wohlhart-double-goldberg", "beta", "delta"),
    Plane("double-subtractive-goldberg", "beta", "delta"),
    Plane("bricard-line-symmetric-zero-offset", "alpha12", "alpha34"),
)
CLASSES = {
    "one cycle": "#4477aa",
    "one component, no cycle": "#66ccee",
    "two components": "#ee6677",
    "more components": "#aa3377",
    "no form": "#bbbbbb",
    "refused": "#ffffff",
}
REFUSED = list(CLASSES).index("refused")
STARTS = 100  # random starts of every member


def classes(data: xr.Dataset) -> np.ndarray:
    """For every member the number of its class, in the order of `CLASSES`."""
    components, status = data["components"].values, data["status"].values
    cases = [
        status != Status.MAPPED,
        components == 0,
        data["one_cycle"].values == 1,
        components == 1,
        components == 2,
    ]
    return np.select(cases, [5, 4, 0, 1, 2], 3)


def shares(data: xr.Dataset) -> dict[str, float]:
    """Share of each class that occurs among the members that exist."""
    numbers = classes(data).ravel()
    members = numbers[numbers != REFUSED]
    counts = np.bincount(members, minlength=len(CLASSES))
    pairs = zip(CLASSES, counts.tolist(), strict=True)
    return {name: count / len(members) for name, count in pairs if count}


def describe(data: xr.Dataset) -> str:
    """The share of each class, and how fast the members were mapped."""
    parts = [f"{name} {share:.1%}" for name, share in shares(data).items()]
    rate = 1.0 / float(np.nanmean(data["seconds"].values))
    return f"{', '.join(parts)}; {rate:.1f} members per second per core"


def plane_plan(plane: Plane, count: int) -> Plan:
    """The grid over a plane, its points off the symmetry lines where possible."""
    span = f"{plane.low}:{plane.high}:{count}"
    texts = [f"{plane.x}={span}", f"{plane.y}={span}"]
    return read_plan(plane.family, texts, starts=STARTS)


def draw_plane(axes: Axes, plane: Plane, data: xr.Dataset) -> None:
    """The classes of a plane as coloured cells."""
    x = np.degrees(data[plane.x].values)
    y = np.degrees(data[plane.y].values)
    values = classes(data.transpose(plane.y, plane.x, ...))
    axes.pcolormesh(
        x,
        y,
        values,
        cmap=ListedColormap(list(CLASSES.values())),
        vmin=-0.5,
        vmax=len(CLASSES) - 0.5,
    )
    axes.set(xlabel=f"{plane.x} (deg)", ylabel=f"{plane.y} (deg)", aspect="equal")
    fixed = []
    for parameter in entry(plane.family).parameters:
        if parameter.name in (plane.x, plane.y, "a"):
            continue
        value = parameter.default
        if parameter.kind is ParameterKind.ANGLE:
            value = np.degrees(value)
        fixed.append(f"{parameter.name} = {value:.4g}")
    title = plane.family.replace("-", " ")
    axes.set_title(f"{title}\n{', '.join(fixed)}", fontsize=8)


def draw(datasets: dict[Plane, xr.Dataset], path: Path) -> None:
    """All planes side by side."""
    count = len(datasets)
    figure = Figure(figsize=(4.6 * count, 5.2), layout="constrained")
    panels = figure.subplots(1, count, squeeze=False)[0]
    occurring: set[int] = set()
    for axes, (plane, data) in zip(panels, datasets.items(), strict=True):
        draw_plane(axes, plane, data)
        occurring.update(np.unique(classes(data)).tolist())
    names = list(CLASSES)
    handles = []
    for number in sorted(occurring):
        colour = CLASSES[names[number]]
        handles.append(Patch(facecolor=colour, edgecolor="0.4", label=names[number]))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False
    )
    figure.savefig(path, dpi=160)


@click.command(cls=Study)
@click.option(
    "--out",
    default="design_space",
    show_default=True,
    type=FOLDER,
)
@click.option(
    "--count", default=36, show_default=True, help="Members along each side of a plane."
)
@click.option(
    "--random",
    "number",
    default=400,
    show_default=True,
    help="Members drawn from the whole design space.",
)
@click.option(
    "--workers",
    type=click.IntRange(1),
    help="Number of processes (all cores by default).",
)
def main(out: Path, count: int, number: int, workers: int | None) -> None:
    """Map planes through the design space, and count the classes over the whole of
    it."""
    out.mkdir(parents=True, exist_ok=True)
    datasets = {}
    for plane in PLANES:
        store = out / f"{plane.family}_{count}.zarr"
        run_sweep(plane_plan(plane, count), store, workers=workers)
        datasets[plane] = open_sweep(store)
        click.echo(f"{plane.family}, plane: {describe(datasets[plane])}")
        whole = out / f"{plane.family}_random_{number}.zarr"
        plan = read_plan(plane.family, [], random=number, starts=STARTS)
        run_sweep(plan, whole, workers=workers)
        click.echo(f"{plane.family}, whole design space: {describe(open_sweep(whole))}")
    draw(datasets, out / "design_space.png")
    click.echo(f"wrote {out / 'design_space.png'}")


if __name__ == "__main__":
    main()
