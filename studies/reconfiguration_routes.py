"""How is a linkage taken from any of its forms to any other?

    python -m studies.reconfiguration_routes [NAME ...] [--out DIR]

For every two forms of a linkage the shortest way from the middle of the longest arc of one
to that of the other, beside the least number of bifurcations that lie between them. The
number is a question to the graph of forms alone; the shortest way weighs every arc by its
length in joint space, and may pass more. Without names the linkages are those of Song
2013, chapters 4 and 5, whose forms meet.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import click
import networkx as nx
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc import (
    Atlas,
    BifurcError,
    Route,
    RouteError,
    find_route,
    transition_graph,
)
from linkages import load, map_linkage
from linkages.app.options import FOLDER
from studies.study import Study

LINKAGES = (
    "special-double-subtractive-goldberg",
    "special-wohlhart-double-goldberg",
    "wohlhart-double-goldberg",
    "double-subtractive-goldberg",
    "bricard-line-symmetric-zero-offset",
    "reconfigurable-bricard-1",
)
COLUMNS = 3  # pictures side by side
SHORT_NAME = 10  # letters of a form's name in a picture


@dataclass(frozen=True)
class Way:
    """The shortest ``route`` between two forms of an atlas, by index, and the ``fewest``
    bifurcations that a way between them passes; neither where no way leads there."""

    start: int
    goal: int
    route: Route | None
    fewest: int | None

    @property
    def bifurcations(self) -> list[str]:
        """The bifurcations that the shortest route passes, in order."""
        return [] if self.route is None else [leg.at for leg in self.route.legs[:-1]]


def ways_of(atlas: Atlas) -> list[Way]:
    """The ways between every two forms of an atlas."""
    fewest = dict(nx.all_pairs_shortest_path_length(transition_graph(atlas)))
    ways = []
    for start, goal in combinations(by_name(atlas), 2):
        names = atlas.forms[start].name, atlas.forms[goal].name
        try:
            route = find_route(atlas, *names)
        except RouteError:
            route = None
        ways.append(Way(start, goal, route, fewest[names[0]].get(names[1])))
    return ways


def by_name(atlas: Atlas) -> list[int]:
    """The forms of an atlas, by index, in the order of their names."""
    return sorted(range(len(atlas.forms)), key=lambda form: atlas.forms[form].name)


def table(atlas: Atlas, ways: list[Way]) -> str:
    """The ways as text: lengths in degrees of joint space, the bifurcations passed, the
    fewest, and the joint that turns farthest."""
    lines = []
    for way in ways:
        ends = f"  {atlas.forms[way.start].name} -> {atlas.forms[way.goal].name}"
        if way.route is None:
            lines.append(f"{ends}: no way")
            continue
        travel = np.degrees(way.route.travel)
        farthest = int(travel.argmax())
        lines.append(
            f"{ends}: {np.degrees(way.route.length):.3f} deg through "
            f"{', '.join(way.bifurcations)} (fewest: {way.fewest}); "
            f"{atlas.names[farthest]} turns {travel[farthest]:.3f} deg"
        )
    return "\n".join(lines or ["  one form"])


def draw(axes: Axes, name: str, atlas: Atlas, ways: list[Way]) -> None:
    """Draw the lengths of the ways as a square of forms by forms, with the bifurcations
    that they pass."""
    forms = by_name(atlas)
    places = {form: place for place, form in enumerate(forms)}
    lengths = np.zeros((len(forms), len(forms)))
    texts = np.full(lengths.shape, "", dtype=object)
    for way in ways:
        pair = places[way.start], places[way.goal]
        if way.route is None:
            lengths[pair], texts[pair] = np.nan, "no way"
        else:
            lengths[pair] = np.degrees(way.route.length)
            texts[pair] = f"{lengths[pair]:.0f}\N{DEGREE SIGN}\n"
            texts[pair] += " ".join(way.bifurcations)
        lengths[pair[::-1]], texts[pair[::-1]] = lengths[pair], texts[pair]
    axes.imshow(lengths, cmap="Blues", vmin=0.0, vmax=2.0 * np.nanmax(lengths))
    for (y, x), text in np.ndenumerate(texts):
        axes.text(x, y, text, ha="center", va="center", fontsize=8)
    labels = [atlas.forms[form].name.partition(" (")[0][:SHORT_NAME] for form in forms]
    axes.set_xticks(range(len(labels)), labels, fontsize=8)
    axes.set_yticks(range(len(labels)), labels, fontsize=8)
    axes.set_title(name, fontsize=9)


@click.command(cls=Study, help=__doc__)
@click.argument("names", nargs=-1)
@click.option("--out", type=FOLDER, default=Path("out") / "reconfiguration_routes")
def main(names: tuple[str, ...], out: Path) -> None:
    """Map the linkages, print their ways, and write them with a picture."""
    names = names or LINKAGES
    rows = -(-len(names) // COLUMNS)
    columns = min(len(names), COLUMNS)
    figure = Figure(figsize=(4.4 * columns, 4.2 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    texts = []
    for name, axes in zip(names, grid.flat, strict=False):
        try:
            atlas = map_linkage(load(name))
        except BifurcError as error:
            raise click.ClickException(str(error)) from None
        ways = ways_of(atlas)
        texts.append(f"{name}\n{table(atlas, ways)}")
        click.echo(texts[-1])
        draw(axes, name, atlas, ways)
    for axes in grid.flat[len(names) :]:
        axes.remove()
    out.mkdir(parents=True, exist_ok=True)
    (out / "routes.txt").write_text("\n\n".join(texts) + "\n", encoding="utf-8")
    figure.savefig(out / "routes.png", dpi=150)
    click.echo(f"wrote routes.txt and routes.png to {out}", err=True)


if __name__ == "__main__":
    main()
