"""Names beside the singular points, where curves and other names leave room."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.text import Annotation

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.figures.layout import figure_of
from bifurc.figures.planes import Plane, copies_in_frame
from bifurc.figures.selection import EVERYTHING, Selection

REACH = 11.0  # from a mark to its name
REACH_FACTORS = (1.0, 1.5, 2.2, 3.2)
DIRECTIONS = [
    np.array([np.cos(a), np.sin(a)])
    for a in np.deg2rad([45, 135, 315, 225, 0, 180, 90, 270])
]
MARK_HALF = np.full(2, 3.5)  # half the sides of what a mark covers
SPACING = 3.0  # of points on a line by which it is seen what a name covers
BACKGROUND = {
    "boxstyle": "square,pad=0.1",
    "facecolor": "white",
    "alpha": 0.75,
    "linewidth": 0,
}
SAME_MARK = 0.005  # of the frame: marks that are closer share a name
MOST_PLACED = 150  # names; more of them have no room anyway
ROOM = 1.0  # around a name, in points
SAME_SPOT = 0.01  # of the frame: points that are closer share a name

# What a name costs in a place, over one point of a curve that it covers.
OVERLAP_COST = 100  # for each other name or mark
MISLEADING_COST = 30  # for each other mark that is as near to it as its own
OUTSIDE_COST = 20  # for each point of length that it sticks out of the frame
ORDER_COST = 0.1  # for each place that is tried before


class _Box(NamedTuple):
    """What a name or a mark covers, by its ``middle`` (2,) and ``half`` its sides (2,),
    in points on the page."""

    middle: np.ndarray
    half: np.ndarray

    def overlaps(self, other: _Box) -> bool:
        """Whether two boxes cover some of the same."""
        gap = np.abs(other.middle - self.middle)
        return bool(np.all(gap < self.half + other.half))

    def distances(self, marks: np.ndarray) -> np.ndarray:
        """How far (m,) marks (m, 2) are from it."""
        gaps = np.maximum(np.abs(marks - self.middle) - self.half, 0.0)
        return np.asarray(np.linalg.norm(gaps, axis=1))


@dataclass
class _Page:
    """What is drawn already: ``corners`` (2, 2) of the frame, points (k, 2) on the
    ``curves``, ``marks`` (m, 2), and the ``boxes`` of marks and names, all in points on
    the page."""

    corners: np.ndarray
    curves: np.ndarray
    marks: np.ndarray
    boxes: list[_Box] = field(init=False)

    def __post_init__(self) -> None:
        self.boxes = [_Box(mark, MARK_HALF) for mark in self.marks]

    def place(self, mark: np.ndarray, half: np.ndarray) -> _Box:
        """The best box for a name beside a mark (2,), which is then occupied."""
        candidates = []
        for factor in REACH_FACTORS:
            for direction in DIRECTIONS:
                # the near side or corner of the name is so far from the mark
                side = np.sign(np.round(direction, 9))
                offset = (REACH * factor - 4) * direction + half * side
                candidates.append(_Box(mark + offset, half))
        costs = [
            self._cost(box, mark) + ORDER_COST * order
            for order, box in enumerate(candidates)
        ]
        best = candidates[int(np.argmin(costs))]
        self.boxes.append(best)
        return best

    def _cost(self, box: _Box, mark: np.ndarray) -> float:
        """What the name of a mark (2,) covers there, how far it sticks out of the frame,
        and whether it seems to be that of another mark."""
        covers = np.all(np.abs(self.curves - box.middle) < box.half, axis=1)
        overlaps = sum(box.overlaps(other) for other in self.boxes)
        is_other = np.any(np.abs(self.marks - mark) > MARK_HALF, axis=1)
        own = box.distances(mark[None])
        misleads = is_other & (box.distances(self.marks) <= own)
        low_overhang = np.maximum(self.corners[0] - (box.middle - box.half), 0).sum()
        high_overhang = np.maximum(box.middle + box.half - self.corners[1], 0).sum()
        return float(
            np.count_nonzero(covers)
            + OVERLAP_COST * overlaps
            + MISLEADING_COST * np.count_nonzero(misleads)
            + OUTSIDE_COST * (low_overhang + high_overhang)
        )


class Label(NamedTuple):
    """The names of the singular points on one ``spot`` (2,) of the plane."""

    text: str
    spot: np.ndarray


def label_points(
    axes: Axes, atlas: Atlas, plane: Plane, selection: Selection = EVERYTHING
) -> None:
    """Names beside the singular points that are drawn, one label for those on one spot,
    where curves and other names leave room."""
    periods = np.array([2 * scale.half for scale in plane.scales])
    tolerance = SAME_SPOT * _extent(atlas, plane, periods)

    def are_same(spot: np.ndarray, other: np.ndarray) -> bool:
        return bool(np.all(np.abs(torus.difference(spot, other, periods)) < tolerance))

    points = selection.points(atlas)
    names = [point.name for point in points]
    spots = [plane.spot(point.point.u) for point in points]
    labels = joined(names, spots, are_same)
    copies = [copies_in_frame(label.spot, plane.scales) for label in labels]
    _draw_labels(axes, labels, [copy for places in copies for copy in places])


def label_spots(axes: Axes, names: Sequence[str], spots: Sequence[np.ndarray]) -> None:
    """Names beside marks on ``spots`` (2,), where curves and other names leave room;
    marks on one spot share a name."""
    tolerance = SAME_MARK * np.ptp([axes.get_xlim(), axes.get_ylim()], axis=1)

    def are_same(spot: np.ndarray, other: np.ndarray) -> bool:
        return bool(np.all(np.abs(spot - other) < tolerance))

    _draw_labels(axes, joined(names, spots, are_same), spots)


def joined(
    names: Sequence[str],
    spots: Sequence[np.ndarray],
    are_same: Callable[[np.ndarray, np.ndarray], bool],
) -> list[Label]:
    """Names on their spots (2,); those on spots that are the same are one label."""
    labels: list[Label] = []
    for name, spot in zip(names, spots, strict=True):
        for k, label in enumerate(labels):
            if are_same(spot, label.spot):
                labels[k] = Label(f"{label.text}, {name}", label.spot)
                break
        else:
            labels.append(Label(name, spot))
    return labels


def _draw_labels(
    axes: Axes, labels: Sequence[Label], marks: Sequence[np.ndarray]
) -> None:
    """Names beside the marks on spots (2,) of the plane, as far as these are shown."""
    texts = []
    for label in labels:
        text = axes.annotate(
            label.text,
            tuple(label.spot.tolist()),
            (0.0, 0.0),
            textcoords="offset points",
            annotation_clip=True,
            ha="center",
            va="center",
            fontweight="bold",
            zorder=6,
            bbox=BACKGROUND,
        )
        text.set_in_layout(False)  # where it stands follows from the layout
        texts.append(text)
    if texts:
        axes.add_artist(_Placement(axes, texts, marks))


class _Placement(Artist):
    """Puts names in their places when a figure is drawn, below all else that is drawn:
    only then it is known how large the frame is."""

    def __init__(
        self, axes: Axes, texts: Sequence[Annotation], marks: Sequence[np.ndarray]
    ):
        super().__init__()
        self._axes = axes
        self._texts = texts
        self._marks = marks
        self.set_zorder(-1)
        self.set_in_layout(False)

    def draw(self, renderer: RendererBase) -> None:
        """Place the names; nothing is drawn."""
        if len(self._texts) > MOST_PLACED:
            return
        axes = self._axes
        figure = figure_of(axes)
        scale = 72.0 / figure.dpi
        page = _page(axes, self._marks, scale)
        for text in self._texts:
            spot = np.array(text.xy, dtype=float)
            mark = _on_page(axes, spot, scale)
            extent = text.get_window_extent(renderer)
            half = 0.5 * scale * np.array([extent.width, extent.height]) + ROOM
            box = page.place(mark, half)
            text.set_position(tuple((box.middle - mark).tolist()))


def _page(axes: Axes, spots: Sequence[np.ndarray], scale: float) -> _Page:
    """The frame and the curves that are drawn, and marks on spots of the plane."""
    frame = axes.get_window_extent()
    corners = np.array([[frame.x0, frame.y0], [frame.x1, frame.y1]]) * scale
    curves = [np.empty((0, 2))]
    for line in axes.lines:
        rows = _on_page(axes, np.asarray(line.get_xydata()), scale)
        is_drawn = (
            line.get_linestyle() != "None"
        )  # else it is marks, with nothing between
        curves.append(_filled(rows) if is_drawn else rows)
    marks = _on_page(axes, np.reshape(spots, (-1, 2)), scale)
    return _Page(corners, np.concatenate(curves), marks)


def _on_page(axes: Axes, spots: np.ndarray, scale: float) -> np.ndarray:
    """Where spots (..., 2) of the plane lie on the page, in points; ``scale`` is the
    size of a pixel."""
    return np.asarray(axes.transData.transform(spots)) * scale


def _filled(rows: np.ndarray) -> np.ndarray:
    """A polyline with points added so that none are more than about `SPACING` apart."""
    parts = [rows]
    lengths = np.linalg.norm(np.diff(rows, axis=0), axis=1)
    for i in np.flatnonzero(lengths > SPACING):
        count = int(lengths[i] / SPACING) + 2
        parts.append(np.linspace(rows[i], rows[i + 1], count))
    points = np.concatenate(parts)
    return points[np.all(np.isfinite(points), axis=1)]


def _extent(atlas: Atlas, plane: Plane, periods: np.ndarray) -> np.ndarray:
    """Extent (2,) of the frame: the period, or what the forms take."""
    samples = [np.zeros((1, 2))]
    if atlas.forms:
        samples = [plane.project(form.branch.sample(50)) for form in atlas.forms]
    ranges = np.ptp(np.concatenate(samples), axis=0)
    return np.where(np.isfinite(periods), periods, np.maximum(ranges, 1e-6))
