"""Figures of all singular values of the Jacobian against the angle of one joint, as Gan
and Pellegrino (2006) chart them: linear, in the source's unit of length."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from bifurc.atlas import Atlas, Form
from bifurc.figures.planes import curve_points
from bifurc.torus import wrap
from linkages.loop import Loop
from linkages.source_figures.configurations import (
    atlas_of,
    form_named,
    loop_of_content,
)
from linkages.source_figures.table import SourceFigure

DEGREES = 180.0 / np.pi
REGULAR = "#0072B2"
SMALLEST = "#D55E00"


def singular_values(loop: Loop, theta: np.ndarray) -> np.ndarray:
    """Singular values (k, 6), the largest first, of the 6 x n joint screws in the frame
    of joint 1, lengths in the unit of the loop, at joint angles (k, n), rad."""
    values: np.ndarray = np.linalg.svd(loop.joint_screws(theta), compute_uv=False)
    return values


def draw(source: SourceFigure) -> Figure:
    """One panel a form: the singular values, the bifurcations as dashed lines, and near
    misses as triangles."""
    content = source.content
    atlas = atlas_of(content)
    loop = loop_of_content(content)
    names = content["forms"]
    figure = Figure(figsize=(4.8 * len(names) + 1.1, 3.7), layout="constrained")
    panels = figure.subplots(1, len(names), squeeze=False)[0]
    for axes, name in zip(panels, names, strict=True):
        form = form_named(atlas, name)
        _draw_values(axes, loop, form)
        _draw_true_list(axes, atlas, loop, form)
        axes.set_title(form.name, fontsize=9, pad=14)
    panels[-1].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    panels[0].set_ylabel("singular value")
    return figure


def _draw_values(axes: Axes, loop: Loop, form: Form) -> None:
    theta = curve_points(form.branch)
    values = singular_values(loop, theta)
    input_angle = DEGREES * wrap(theta, form.branch.periods)[:, 0]
    jumps = np.flatnonzero(np.abs(np.diff(input_angle)) > 180.0) + 1
    x = np.insert(input_angle, jumps, np.nan)
    count = values.shape[1]
    for k in range(count):
        y = np.insert(values[:, k], jumps, np.nan)
        is_last = k >= count - 2
        color = SMALLEST if k == count - 2 else REGULAR if not is_last else "0.4"
        axes.plot(
            x,
            y,
            color=color,
            linestyle=(0, (4, 2)) if k == count - 1 else "-",
            linewidth=1.8 if k == count - 2 else 1.1,
            label=_label(k, count),
        )
    axes.set(xlim=(-180, 180), ylim=(-0.02 * values.max(), 1.04 * values.max()))
    axes.xaxis.set_major_locator(MultipleLocator(90))
    axes.set_xlabel("θ₁ (deg)")
    axes.grid(True)


def _label(k: int, count: int) -> str:
    """What a curve is called in the legend: the first regular one names all of them."""
    if k == 0:
        return f"σ₁ to σ{chr(0x2080 + count - 2)}"
    if k == count - 2:
        return f"σ{chr(0x2080 + count - 1)}"
    if k == count - 1:
        return f"σ{chr(0x2080 + count)}, always 0"
    return "_"


def _draw_true_list(axes: Axes, atlas: Atlas, loop: Loop, form: Form) -> None:
    """The bifurcations and near misses of the map, as against small values."""
    index = atlas.forms.index(form)
    for point in atlas.points:
        if any(passing == index for passing, _ in point.passes):
            angle = _shown(point.point.u)
            axes.axvline(angle, color="0.4", linestyle=(0, (3, 2)), linewidth=0.9)
            axes.annotate(
                point.name,
                (angle, 1.0),
                (0, 2),
                xycoords=("data", "axes fraction"),
                textcoords="offset points",
                ha="center",
                fontsize=8,
            )
    for event in atlas.near_misses:
        if event.form == index:
            value = singular_values(loop, event.u[None])[0, -2]
            axes.plot(_shown(event.u), value, "v", color="black", markersize=5)


def _shown(theta: np.ndarray) -> float:
    """The angle of joint 1 in degrees, within half a turn."""
    return DEGREES * float(wrap(theta[:1], np.array([2 * np.pi]))[0])
