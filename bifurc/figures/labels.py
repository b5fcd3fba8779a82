"""Names beside the singular points, where curves and other names leave room."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.figures.planes import Plane, copies_in_frame

REACH = 11.0  # from a mark to its name
REACH_FACTORS = (1.0, 1.5, 2.2)
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
SAME_MARK = 2.0  # pixels: marks that are closer share a name
SAME_SPOT = 0.01  # of the frame: points that are closer share a name

# What a name costs in a place, over one point of a curve that it covers.
OVERLAP_COST = 100  # for each other name or mark
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


@dataclass
class _Page:
    """What is drawn already: ``corners`` (2, 2) of the frame, points (k, 2) on the
    ``curves``, and the ``boxes`` of marks and names, all in points on the page."""

    corners: np.ndarray
    curves: np.ndarray
    boxes: list[_Box] = field(default_factory=list)

    def place(self, mark: np.ndarray, half: np.ndarray) -> _Box:
        """The best box for a name beside a mark (2,), which is then occupied."""
        candidates = []
        for factor in REACH_FACTORS:
            for direction in DIRECTIONS:
                step = REACH * factor - 4 + half * np.abs(direction)
                candidates.append(_Box(mark + step * direction, half))
        costs = [
            self._cost(box) + ORDER_COST * order for order, box in enumerate(candidates)
        ]
        best = candidates[int(np.argmin(costs))]
        self.boxes.append(best)
        return best

    def _cost(self, box: _Box) -> float:
        """What a name covers there, and how far it sticks out of the frame."""
        covers = np.all(np.abs(self.curves - box.middle) < box.half, axis=1)
        overlaps = sum(box.overlaps(other) for other in self.boxes)
        low_overhang = np.maximum(self.corners[0] - (box.middle - box.half), 0).sum()
        high_overhang = np.maximum(box.middle + box.half - self.corners[1], 0).sum()
        return float(
            np.count_nonzero(covers)
            + OVERLAP_COST * overlaps
            + OUTSIDE_COST * (low_overhang + high_overhang)
        )


class _Label(NamedTuple):
    """The names of the singular points on one ``spot`` (2,) of the plane."""

    text: str
    spot: np.ndarray


def label_points(axes: Axes, atlas: Atlas, plane: Plane) -> None:
    """Names beside the singular points, one label for those on one spot, where curves
    and other names leave room."""
    periods = np.array([2 * scale.half for scale in plane.scales])
    tolerance = SAME_SPOT * _extent(atlas, plane, periods)

    def are_same(spot: np.ndarray, other: np.ndarray) -> bool:
        return bool(np.all(np.abs(torus.difference(spot, other, periods)) < tolerance))

    names = [point.name for point in atlas.points]
    spots = [plane.spot(point.point.u) for point in atlas.points]
    labels = _joined(names, spots, are_same)
    copies = [copies_in_frame(label.spot, plane.scales) for label in labels]
    _draw_labels(axes, labels, [copy for places in copies for copy in places])


def label_spots(axes: Axes, names: Sequence[str], spots: Sequence[np.ndarray]) -> None:
    """Names beside marks on ``spots`` (2,), where curves and other names leave room;
    marks on one spot share a name."""

    def are_same(spot: np.ndarray, other: np.ndarray) -> bool:
        gap = _on_page(axes, spot, 1.0) - _on_page(axes, other, 1.0)
        return bool(np.abs(gap).max() < SAME_MARK)

    _draw_labels(axes, _joined(names, spots, are_same), spots)


def _joined(
    names: Sequence[str],
    spots: Sequence[np.ndarray],
    are_same: Callable[[np.ndarray, np.ndarray], bool],
) -> list[_Label]:
    """Names on their spots (2,); those on spots that are the same are one label."""
    labels: list[_Label] = []
    for name, spot in zip(names, spots, strict=True):
        for k, label in enumerate(labels):
            if are_same(spot, label.spot):
                labels[k] = _Label(f"{label.text}, {name}", label.spot)
                break
        else:
            labels.append(_Label(name, spot))
    return labels


def _draw_labels(
    axes: Axes, labels: Sequence[_Label], marks: Sequence[np.ndarray]
) -> None:
    """Names beside the marks on spots (2,) of the plane."""
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    axes.apply_aspect()  # its place and its limits are now what they will be
    axes.autoscale_view()
    scale = 72.0 / figure.dpi
    page = _page(axes, scale)
    for spot in marks:
        page.boxes.append(_Box(_on_page(axes, spot, scale), MARK_HALF))
    for label in labels:
        mark = _on_page(axes, label.spot, scale)
        half = np.array([2.8 * len(label.text) + 1, 4.5])
        box = page.place(mark, half)
        axes.annotate(
            label.text,
            tuple(label.spot.tolist()),
            tuple((box.middle - mark).tolist()),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=9,
            fontweight="bold",
            zorder=6,
            bbox=BACKGROUND,
        )


def _page(axes: Axes, scale: float) -> _Page:
    """The frame and the curves that are drawn."""
    frame = axes.get_window_extent()
    corners = np.array([[frame.x0, frame.y0], [frame.x1, frame.y1]]) * scale
    curves = [np.empty((0, 2))]
    for line in axes.lines:
        rows = np.asarray(line.get_xydata())
        curves.append(_filled(_on_page(axes, rows, scale)))
    return _Page(corners, np.concatenate(curves))


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
