"""The files of `bifurc chart`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy.ndimage import distance_transform_edt

from linkages.app.reports.follow_files import in_unit, label_of, write_report
from linkages.app.reports.tolerance_figure import COLOURS
from linkages.parameters.chart import Chart, RegionMap, line_of

Colour: TypeAlias = tuple[float, float, float]

PALE = 0.65  # of white in the colour of a region
LINE = "#222222"
SAMPLES = 600  # of a boundary


def write_chart(
    chart: Chart,
    words: Mapping[RegionMap, str],
    text: str,
    document: Mapping[str, object],
    folder: Path,
) -> None:
    """Write chart.txt, chart.json and chart.png; ``words`` are those of its maps."""
    write_report("chart", text, document, draw_chart(chart, words), folder)


def draw_chart(chart: Chart, words: Mapping[RegionMap, str]) -> Figure:
    """The regions in the colours of their maps, boundaries, points of codimension two and
    the random members; those that disagree are crossed."""
    figure = Figure(figsize=(8.6, 5.2), layout="constrained")
    axes = figure.subplots()
    colours = [_pale(COLOURS[k % len(COLOURS)]) for k in range(len(chart.maps))]
    _draw_regions(axes, chart, colours)
    _name_maps(axes, [words[found] for found in chart.maps], colours)
    for curve in chart.boundaries:
        axes.plot(*_shown(chart, line_of(curve, SAMPLES)), color=LINE, lw=1.3)
    if len(chart.checked):
        axes.plot(*_shown(chart, chart.checked), ".", color="#777777", ms=2)
    if chart.points:
        at = np.array([point.p for point in chart.points])
        axes.plot(*_shown(chart, at), "o", color=LINE, ms=5)
    if len(chart.disagreements):
        axes.plot(*_shown(chart, chart.disagreements), "x", color="#cc0000", ms=7)
    first, second = chart.members.free
    axes.set(xlabel=label_of(first), ylabel=label_of(second))
    return figure


def _draw_regions(axes: Axes, chart: Chart, colours: Sequence[Colour]) -> None:
    """The cells in the colours of their maps."""
    classes = chart.maps
    numbers = np.array([classes.index(region.map) for region in chart.regions] + [-1])
    labels = np.where(chart.labels < len(chart.regions), chart.labels, -1)
    # a cell under a boundary has the colour of the nearest one that is not
    _, nearest = distance_transform_edt(labels < 0, return_indices=True)
    cells = numbers[labels[tuple(nearest)]]
    ends = np.array(list(chart.members.ranges.values())).T
    (left, right), (low, high) = _shown(chart, ends)
    image = np.ma.masked_less(cells.T, 0)
    axes.imshow(
        image,
        origin="lower",
        extent=(left, right, low, high),
        aspect="auto",
        cmap=ListedColormap(colours or ["white"]),
        vmin=-0.5,
        vmax=max(len(colours), 1) - 0.5,
        interpolation="nearest",
    )


def _name_maps(axes: Axes, words: Sequence[str], colours: Sequence[Colour]) -> None:
    """What the maps of colours are, beside the plane."""
    handles = [
        Patch(color=colour, label=text.replace(", ", ",\n"))
        for colour, text in zip(colours, words, strict=True)
    ]
    if handles:
        axes.legend(
            handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False
        )


def _pale(colour: str) -> Colour:
    red, green, blue = (PALE + (1.0 - PALE) * part for part in to_rgb(colour))
    return red, green, blue


def _shown(chart: Chart, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (k, 2) as they are drawn."""
    first, second = chart.members.free
    return in_unit(first, p[:, 0]), in_unit(second, p[:, 1])
