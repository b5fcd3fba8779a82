"""The picture of the singular values against one unknown."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from bifurc.atlas import Atlas
from bifurc.errors import ProblemError
from bifurc.figures.drawing import note_emptiness
from bifurc.figures.planes import Scale, place_in_frame, scale_of
from bifurc.figures.style import RC, form_style

LOWEST = 1e-16  # of the largest value: what is drawn of a zero
DECADES = 5  # at least, on the vertical axis
PLAIN = Scale(1.0, np.inf, "")


def plot_singular_values_against(
    atlas: Atlas, unknown: int, figure: Figure | None = None
) -> Figure:
    """The regular singular values of each form against one unknown, numbered from 1, on
    a logarithmic scale, in one panel a form.

    The smallest is drawn strongly; bifurcations are dashed lines with their names, near
    misses triangles. Raises `ProblemError` where there is no such unknown.
    """
    n = len(atlas.names)
    if not 1 <= unknown <= n:
        allowed = f"one of the unknowns, numbered from 1 to {n}"
        raise ProblemError("unknown", unknown, allowed)
    count = max(len(atlas.forms), 1)
    columns = 1 if count == 1 else 2 if count <= 8 else 3
    rows = -(-count // columns)
    scale = scale_of(atlas, unknown - 1)
    with rc_context(RC):
        size = (4.6 * columns if count > 1 else 6.4, 2.5 * rows + 0.4)
        figure = figure or Figure(figsize=size, layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False, sharey=True).flat
        for axes in panels[count:]:
            axes.set_visible(False)
        for i in range(len(atlas.forms)):
            _draw_form(panels[i], atlas, i, unknown - 1, scale)
        figure.supxlabel(scale.label, fontsize=9)
        figure.supylabel("singular value", fontsize=9)
        note_emptiness(panels[0], atlas)
    return figure


def _draw_form(
    axes: Axes, atlas: Atlas, index: int, unknown: int, scale: Scale
) -> None:
    form = atlas.forms[index]
    style = form_style(index)
    s, values = _with_zeros(atlas, index)
    top = float(values.max())
    shown = _shown(form.branch(s)[:, unknown], scale)
    jumps = np.flatnonzero(np.abs(np.diff(shown)) > scale.half) + 1
    x = np.insert(shown, jumps, np.nan)
    y = np.insert(np.maximum(values, LOWEST * top), jumps, np.nan, axis=0)
    axes.plot(x, y[:, :-1], color="0.75", linewidth=0.8, zorder=1)
    axes.plot(x, y[:, -1], color=style.color, linewidth=1.6, zorder=2)
    _name_points(axes, atlas, index, unknown, scale)
    least = _draw_near_misses(axes, atlas, index, unknown, scale)
    axes.set(yscale="log", ylim=(min(least / 10, top * 10.0**-DECADES), 2 * top))
    if scale.is_periodic:
        axes.set_xlim(-scale.half, scale.half)
    if scale.half == 180.0:
        axes.xaxis.set_major_locator(MultipleLocator(90))
    axes.set_title(form.name, color=style.color, fontsize=9, loc="left", pad=14)
    axes.grid(True)


def _name_points(
    axes: Axes, atlas: Atlas, index: int, unknown: int, scale: Scale
) -> None:
    """Dashed lines at the singular points of a form, their names above the panel."""
    for point in atlas.points:
        if not any(number == index for number, _ in point.passes):
            continue
        x = _shown(point.point.u[[unknown]], scale)[0]
        axes.axvline(x, color="0.35", linewidth=0.8, linestyle=(0, (3, 2)))
        axes.annotate(
            point.name,
            (x, 1.0),
            (0, 2),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="center",
            fontsize=8,
        )


def _draw_near_misses(
    axes: Axes, atlas: Atlas, index: int, unknown: int, scale: Scale
) -> float:
    """The least value of the near misses of a form, which are drawn as triangles; inf
    where there is none."""
    least = np.inf
    for event in atlas.near_misses:
        if event.form == index:
            x = _shown(event.u[[unknown]], scale)[0]
            axes.plot(x, event.value, "v", color="black", markersize=4, zorder=4)
            least = min(least, event.value)
    return float(least)


def _with_zeros(atlas: Atlas, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Arclengths (k,) along a form and its regular singular values (k, rank), with the
    singular points, where the smallest is 0."""
    form = atlas.forms[index]
    s = form.profile.arclength.ravel()
    values = form.profile.values.reshape(len(s), -1)[:, : form.rank]
    zeros = [
        place
        for point in atlas.points
        for number, place in point.passes
        if number == index
    ]
    places = np.concatenate([s, zeros])
    columns = [np.interp(places, s, column) for column in values.T]
    columns[-1][len(s) :] = 0.0
    order = np.argsort(places, kind="stable")
    return places[order], np.stack(columns, axis=1)[order]


def _shown(values: np.ndarray, scale: Scale) -> np.ndarray:
    """Values (k,) of an unknown as they are shown, periodic ones within the frame."""
    pairs = np.stack([values, np.zeros_like(values)], axis=1)
    return np.asarray(place_in_frame(pairs, (scale, PLAIN))[:, 0])
