"""Figures of an atlas: the transition map, unknowns against the input, singular values,
and the graph of forms.

Each function draws into the figure given, or makes one, and returns it; nothing depends
on the state of pyplot or on the user's settings. Forms are told apart by colour (safe
for the colour-blind) and by line style (safe in print).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullLocator

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.errors import ProblemError
from bifurc.figures.drawing import (
    SETTINGS,
    draw_curve,
    draw_legend,
    draw_marks,
    form_style,
    label_groups,
    legend_size,
    note_emptiness,
)
from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.planes import (
    Scale,
    choose_plane,
    curve_points,
    cut_to_frame,
    scale_of,
)

__all__ = [
    "plot_form_graph",
    "plot_joint_angles",
    "plot_singular_values",
    "plot_transition_map",
    "save_figures",
]


def plot_transition_map(
    atlas: Atlas, figure: Figure | None = None, joints: Sequence[int] | None = None
) -> Figure:
    """The forms in the plane of two unknowns, with the singular points marked and
    named.

    ``joints`` are two numbers of unknowns, from 1; left out, the plane is chosen that
    tells the forms apart best. Angles are drawn in degrees on the torus. Raises
    `ProblemError` for numbers that are not two of the unknowns.
    """
    plane = choose_plane(atlas) if joints is None else _checked(atlas, joints)
    width, height = legend_size(atlas)
    with rc_context(SETTINGS):
        figure = figure or Figure(
            figsize=(4.9 + width, max(4.9, height)), layout="constrained"
        )
        axes = figure.subplots()
        _draw_plane(axes, atlas, plane)
        draw_marks(axes, atlas, plane)
        draw_legend(figure, atlas)
        note_emptiness(axes, atlas)
        label_groups(axes, atlas, plane)
    return figure


def plot_joint_angles(
    atlas: Atlas, figure: Figure | None = None, input_joint: int = 1
) -> Figure:
    """Every unknown against the input one, in panels of their own.

    ``input_joint`` is counted from 1. Raises `ProblemError` where there is no such
    unknown.
    """
    n = len(atlas.names)
    (first,) = _checked(atlas, [input_joint], count=1)
    others = [i for i in range(n) if i != first] or [first]
    columns = min(len(others), 3 if len(others) <= 9 else 4)
    rows = -(-len(others) // columns)
    width, height = legend_size(atlas)
    size = (2.3 * columns + width, max(2.2 * rows + 0.4, height))
    with rc_context(SETTINGS):
        figure = figure or Figure(figsize=size, layout="compressed")
        panels = figure.subplots(rows, columns, squeeze=False)
        for axes in panels.flat[len(others) :]:
            axes.set_visible(False)
        for k, (axes, i) in enumerate(zip(panels.flat, others, strict=False)):
            _draw_plane(axes, atlas, (first, i), width=1.4)
            draw_marks(axes, atlas, (first, i), size=3.5)
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_minor_locator(NullLocator())
            if k + columns < len(others):
                axes.set_xlabel("")
                axes.tick_params(labelbottom=False)
        draw_legend(figure, atlas)
        note_emptiness(panels.flat[0], atlas)
    return figure


def plot_singular_values(atlas: Atlas, figure: Figure | None = None) -> Figure:
    """The regular singular values along each form on a logarithmic scale, in one panel
    a form.

    The smallest is drawn strongly. It vanishes at singular points (dashed, named); near
    misses carry their value.
    """
    count = max(len(atlas.forms), 1)
    columns = 1 if count == 1 else 2 if count <= 8 else 3
    rows = -(-count // columns)
    low, high = _range_of_singular_values(atlas)
    with rc_context(SETTINGS):
        size = (4.6 * columns if count > 1 else 6.4, 2.3 * rows + 0.4)
        figure = figure or Figure(figsize=size)
        panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
        width, height = (
            figure.get_size_inches()
        )  # margins in inches: no layout engine need measure the text
        figure.subplots_adjust(
            left=0.85 / width,
            right=1 - 0.2 / width,
            bottom=0.6 / height,
            top=1 - 0.45 / height,
            wspace=0.3 / (width / columns - 0.3),
            hspace=0.75 / (height / rows - 0.75),
        )
        for axes in panels.flat[count:]:
            axes.set_visible(False)
        for i, axes in enumerate(panels.flat[: len(atlas.forms)]):
            _draw_singular_values(axes, atlas, i, low, high)
        unit = (
            f" ({atlas.units[0]})"
            if len(set(atlas.units)) == 1 and atlas.units[0]
            else ""
        )
        figure.supxlabel(f"arclength{unit}", fontsize=9)
        figure.supylabel("singular value", fontsize=9)
        note_emptiness(panels.flat[0], atlas)
    return figure


def save_figures(atlas: Atlas, folder: str | os.PathLike[str]) -> list[Path]:
    """Paths of the four figures just written into an existing ``folder``, as PNG and
    SVG each.

    The same atlas gives the same bytes. Each file is written beside its place and
    renamed when it is whole.
    """
    figures: dict[str, Callable[[Atlas], Figure]] = {
        "transition_map": plot_transition_map,
        "joint_angles": plot_joint_angles,
        "singular_values": plot_singular_values,
        "form_graph": plot_form_graph,
    }
    paths = []
    for name, plot in figures.items():
        figure = plot(atlas)
        endings: dict[str, dict[str, Any]] = {
            "png": {
                "metadata": {"Software": None},
                "pil_kwargs": {"compress_level": 2},
            },
            "svg": {"metadata": {"Date": None, "Creator": None}},
        }
        for ending, options in endings.items():
            path = Path(folder) / f"{name}.{ending}"
            part = path.with_name(f".{path.name}.part")
            try:
                with rc_context(SETTINGS):
                    figure.savefig(part, format=ending, dpi=140, **options)
                os.replace(part, path)
            finally:
                part.unlink(missing_ok=True)
            figure.set_layout_engine("none")  # the layout of the first drawing stays
            paths.append(path)
    return paths


# --- planes of two unknowns ---------------------------------------------------------------------------


def _checked(atlas: Atlas, joints: Sequence[int], count: int = 2) -> tuple[int, ...]:
    n = len(atlas.names)
    if (
        len(joints) != count
        or len(set(joints)) != count
        or not all(1 <= j <= n for j in joints)
    ):
        raise ProblemError(
            "joints", list(joints), f"{count} of the unknowns, numbered from 1 to {n}"
        )
    return tuple(j - 1 for j in joints)


def _draw_plane(
    axes: Axes, atlas: Atlas, plane: tuple[int, ...], width: float = 1.8
) -> None:
    """All forms in a plane, with axes to match."""
    scales = (scale_of(atlas, plane[0]), scale_of(atlas, plane[-1]))
    for i, form in enumerate(atlas.forms):
        points = curve_points(form.branch)[:, [plane[0], plane[-1]]]
        if len(points):
            draw_curve(axes, cut_to_frame(points, scales), form_style(i), width)
    _set_axis(axes, "x", scales[0])
    _set_axis(axes, "y", scales[1])
    if all(np.isfinite(scale.half) for scale in scales):
        axes.set_box_aspect(1)
    axes.grid(True)
    for spine in axes.spines.values():
        spine.set_zorder(1)  # forms that lie on the edge of the frame are drawn over it


def _set_axis(axes: Axes, which: str, scale: Scale) -> None:
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_label_text(scale.label)
    if not np.isfinite(scale.half):
        return
    (axes.set_xlim if which == "x" else axes.set_ylim)(-scale.half, scale.half)
    if scale.half == 180.0:
        axis.set_major_locator(MultipleLocator(90))
        axis.set_minor_locator(MultipleLocator(30))


# --- singular values ----------------------------------------------------------------------------------


def _range_of_singular_values(atlas: Atlas) -> tuple[float, float]:
    """Limits of the logarithmic axis: a decade below everything that is not zero, and
    five decades at least."""
    if not atlas.forms:
        return 1e-5, 1.0
    high = max(float(form.profile.values.max()) for form in atlas.forms)
    small = [e.value for e in atlas.near_misses] + [
        float(form.profile.smallest.min()) for form in atlas.forms
    ]
    low = max(min(small) / 10, 1e-16 * high)
    if atlas.points:
        low = min(low, 1e-5 * high)
    return 10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(2 * high))


def _draw_singular_values(
    axes: Axes, atlas: Atlas, index: int, low: float, high: float
) -> None:
    form = atlas.forms[index]
    style = form_style(index)
    s = form.profile.arclength.ravel()
    values = form.profile.values.reshape(len(s), -1)[:, : form.rank]
    stops = [
        (at, point) for point in atlas.points for i, at in point.passes if i == index
    ]
    misses = [event for event in atlas.near_misses if event.form == index]
    axes.plot(s, values[:, :-1], color="0.75", linewidth=0.8, zorder=1)
    turns = (
        (-form.branch.length, 0.0, form.branch.length) if form.branch.closed else (0.0,)
    )
    zeros = [at + turn for at, _ in stops for turn in turns]
    x = np.concatenate([s, [event.s for event in misses]])
    y = np.concatenate([values[:, -1], [event.value for event in misses]])
    x, y = _with_zeros(x, y, zeros)
    draw_curve(
        axes, np.stack([x, np.maximum(y, 1e-3 * low)], axis=1), style, 1.6, cut=True
    )
    for event in misses:
        axes.plot([event.s], [event.value], "v", color="black", markersize=4, zorder=4)
        left = event.s > 0.85 * form.branch.length
        axes.annotate(
            f"{event.value:.1e}",
            (event.s, event.value),
            (-5 if left else 5, -3),
            textcoords="offset points",
            ha="right" if left else "left",
            va="top",
            fontsize=7,
        )
    _name_stops(axes, stops, form.branch.length)
    axes.set(yscale="log", ylim=(low, high), xlim=(0.0, form.branch.length))
    axes.yaxis.set_major_formatter(FuncFormatter(_power_of_ten))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_title(
        form.name, color=style.color, fontsize=9, loc="left", pad=14 if stops else 6
    )
    axes.grid(True)


def _power_of_ten(value: float, _: int) -> str:
    """A tick's label in plain characters: matplotlib's own needs a parser of formulas,
    a fifth of a second to load."""
    return "10" + str(round(np.log10(value))).translate(
        str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    )


def _with_zeros(
    s: np.ndarray, values: np.ndarray, zeros: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Samples and zeros, with steep stretches filled in linearly: drawn straight in
    logarithms they would mislead."""
    x, y = np.concatenate([s, zeros]), np.concatenate([values, np.zeros(len(zeros))])
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    small, large = np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])
    steep = np.flatnonzero(large > 1.3 * small)
    near = 10.0 ** np.concatenate(
        [np.arange(-8.0, -1.5, 0.25), np.arange(-1.5, -0.25, 0.1)]
    )
    fraction = np.concatenate([near, 1.0 - near])
    inner = (x[steep, None] + fraction * np.diff(x)[steep, None]).ravel()
    filled = np.union1d(x, inner)
    return filled, np.interp(filled, x, y)


def _name_stops(
    axes: Axes, stops: list[tuple[float, MeetingPoint]], length: float
) -> None:
    """Dashed lines at singular points, their names above the panel, those close
    together in one label."""
    groups: list[list[tuple[float, MeetingPoint]]] = []
    for at, point in sorted(stops, key=lambda stop: stop[0]):
        axes.axvline(at, color="0.35", linewidth=0.8, linestyle=(0, (3, 2)), zorder=0)
        if groups and at - groups[-1][-1][0] < 0.05 * length:
            groups[-1].append((at, point))
        else:
            groups.append([(at, point)])
    for group in groups:
        axes.annotate(
            ", ".join(point.name for _, point in group),
            (float(np.mean([at for at, _ in group])), 1.0),
            (0, 2),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8,
        )
