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

from linkages.app.sweep.member import Status
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import run_sweep
from linkages.app.sweep.store import open_sweep
from linkages.catalogue import entry

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["PLANES", "Plane", "classes", "shares"]


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
    found = classes(data).ravel()
    found = found[found != 5]
    counts = np.bincount(found, minlength=len(CLASSES)) / max(len(found), 1)
    return {
        name: float(share)
        for name, share in zip(CLASSES, counts, strict=True)
        if share > 0
    }


def plane_plan(plane: Plane, count: int) -> Plan:
    """The grid over a plane, its points off the symmetry lines where possible."""
    span = f"{plane.low}:{plane.high}:{count}"
    return read_plan(
        plane.family, [f"{plane.x}={span}", f"{plane.y}={span}"], starts=100
    )


def draw_plane(axes: Axes, plane: Plane, data: xr.Dataset) -> None:
    """The classes of a plane as coloured cells."""
    from matplotlib.colors import ListedColormap

    x, y = (np.degrees(data[name].values) for name in (plane.x, plane.y))
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
    fixed = ", ".join(
        f"{p.name} = {np.degrees(p.default) if p.kind == 'angle' else p.default:.4g}"
        for p in entry(plane.family).parameters
        if p.name not in (plane.x, plane.y, "a")
    )
    axes.set_title(f"{plane.family.replace('-', ' ')}\n{fixed}", fontsize=8)


def draw(datasets: dict[Plane, xr.Dataset], path: Path) -> None:
    """All planes side by side."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.patches import Patch

    figure, axes = plt.subplots(
        1, len(datasets), figsize=(4.6 * len(datasets), 5.2), layout="constrained"
    )
    for where, (plane, data) in zip(np.atleast_1d(axes), datasets.items(), strict=True):
        draw_plane(where, plane, data)
    seen = sorted(
        set(
            np.concatenate(
                [np.unique(classes(data)) for data in datasets.values()]
            ).tolist()
        )
    )
    names = list(CLASSES)
    handles = [
        Patch(facecolor=CLASSES[names[i]], edgecolor="0.4", label=names[i])
        for i in seen
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False
    )
    figure.savefig(path, dpi=160)
    plt.close(figure)


@click.command()
@click.option(
    "--out",
    default="design_space",
    show_default=True,
    type=click.Path(path_type=Path, file_okay=False),
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
        whole = out / f"{plane.family}_random_{number}.zarr"
        run_sweep(
            read_plan(plane.family, [], random=number, starts=100),
            whole,
            workers=workers,
        )
        for where, data in (
            ("plane", datasets[plane]),
            ("whole design space", open_sweep(whole)),
        ):
            said = ", ".join(
                f"{name} {share:.1%}" for name, share in shares(data).items()
            )
            rate = 1.0 / float(np.nanmean(data["seconds"].values))
            click.echo(
                f"{plane.family}, {where}: {said}; {rate:.1f} members per second per core"
            )
    draw(datasets, out / "design_space.png")
    click.echo(f"wrote {out / 'design_space.png'}")


if __name__ == "__main__":
    main()
