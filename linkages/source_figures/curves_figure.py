"""Figures against the angle of one joint: the kinematic paths and input-output curves of
the sources, and all singular values of the Jacobian as Gan and Pellegrino (2006) chart
them, linear, in the source's unit of length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from bifurc.atlas import Atlas, Form
from bifurc.figures.drawing import name_above
from bifurc.figures.planes import Scale, curve_points, cut_to_frame
from bifurc.figures.style import Properties, form_style
from bifurc.torus import wrap
from linkages.loop import Loop
from linkages.source_figures.configurations import (
    atlas_of,
    form_named,
    loop_of_content,
    places_at,
)
from linkages.source_figures.table import Content, SourceFigure

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
ALIKE = 1e-9  # rad: curves that are closer everywhere are drawn as one
DEGREES = 180.0 / np.pi
TURN = 2 * np.pi
REGULAR = "#0072B2"
SMALLEST = "#D55E00"
DASHED = (0, (4, 2))


@dataclass(frozen=True)
class Curve:
    """The ``joints`` (from 0) that share a curve, and its index for colour and dashes."""

    joints: tuple[int, ...]
    index: int


def _panels(
    atlas: Atlas, names: Sequence[str], size: tuple[float, float], legend: float
) -> tuple[Figure, list[Axes], list[Form]]:
    """A figure with a panel (``size`` in inches) for each of the forms called so, all
    where there are no names, and room for a ``legend``."""
    forms = [form_named(atlas, name) for name in names] or list(atlas.forms)
    width, height = size
    figure = Figure(figsize=(width * len(forms) + legend, height), layout="constrained")
    panels = figure.subplots(1, len(forms), squeeze=False)[0]
    return figure, list(panels), forms


def _shown(angles: np.ndarray) -> np.ndarray:
    """Angles (...,) in degrees, within half a turn."""
    return DEGREES * wrap(np.asarray(angles)[..., None], np.array([TURN]))[..., 0]


# --- joint angles ---------------------------------------------------------------------


def draw_paths(source: SourceFigure) -> Figure:
    """One panel a form: every other joint's angle against that of joint 1."""
    content = source.content
    names = content.get("forms", [])
    figure, panels, forms = _panels(atlas_of(content), names, (5.0, 4.4), 0.9)
    for axes, form in zip(panels, forms, strict=True):
        _draw_form(axes, form, content)
        if len(forms) > 1:
            axes.set_title(form.name, fontsize=9)
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    return figure


def _draw_form(axes: Axes, form: Form, content: Content) -> None:
    turns = content.get("turns", 1)
    scales = (
        Scale(DEGREES, 180.0 * turns, "θ₁ (deg)"),
        Scale(DEGREES, 180.0, "joint angle (deg)"),
    )
    points = curve_points(form.branch)
    groups = joints_alike(points)
    for curve in groups:
        rows = cut_to_frame(points[:, [0, curve.joints[0]]], scales)
        axes.plot(
            *rows.T,
            linewidth=1.7,
            label=_names(curve.joints),
            clip_on=False,
            **form_style(curve.index).line,
        )
    for degrees, filling in content.get("dots", ()):
        color = "black" if filling == "filled" else "white"
        _draw_dots(axes, form, groups, degrees, color, turns)
    if content.get("turning_points"):
        _draw_turning_points(axes, form, groups)
    title = "   " + content["dots_title"] if "dots" in content else ""
    axes.set_xlabel(f"{scales[0].label}{title}")
    axes.set_ylabel(scales[1].label)
    axes.set(xlim=(-180 * turns, 180 * turns), ylim=(-180, 180))
    axes.xaxis.set_major_locator(MultipleLocator(90 * turns))
    axes.yaxis.set_major_locator(MultipleLocator(90))
    axes.grid(True)


def joints_alike(points: np.ndarray) -> list[Curve]:
    """The joints other than the first, those with the same angle all along points (k,
    n) of a form together; those that follow joint 1 come with nobody."""
    groups: list[list[int]] = []
    for joint in range(1, points.shape[1]):
        for group in groups:
            gap = np.sin((points[:, joint] - points[:, group[0]]) / 2)
            if np.abs(gap).max() < ALIKE:
                group.append(joint)
                break
        else:
            groups.append([joint])
    return [Curve(tuple(group), index) for index, group in enumerate(groups)]


def _names(joints: Sequence[int]) -> str:
    """The names of joint angles, as θ₂ = θ₅."""
    return " = ".join(f"θ{joint + 1}".translate(SUBSCRIPTS) for joint in joints)


def _draw_dots(
    axes: Axes,
    form: Form,
    groups: Sequence[Curve],
    degrees: float,
    color: str,
    turns: int,
) -> None:
    """Dots on all curves where joint 1 stands at an angle of so many turns."""
    half = 180.0 * turns
    place = (degrees + half) % (2 * half) - half
    for s in places_at(form.branch, 1, np.radians(degrees)):
        theta = form.branch(s)
        first = DEGREES * float(theta[0])
        if abs((first - place + half) % (2 * half) - half) > 1e-6:
            continue
        style: Properties = {
            "markersize": 5,
            "markeredgecolor": "black",
            "markerfacecolor": color,
        }
        for curve in groups:
            angle = float(_shown(theta[curve.joints[0]]))
            axes.plot(place, angle, "o", zorder=4, **style)


def _draw_turning_points(axes: Axes, form: Form, groups: Sequence[Curve]) -> None:
    """Marks where joint 1 turns back."""
    for s in form.branch.turning_points(0):
        angles = _shown(form.branch(s))
        for curve in groups:
            spot = angles[[0, curve.joints[0]]]
            axes.plot(*spot, "s", markersize=4, color="black", zorder=4)


# --- singular values ------------------------------------------------------------------


def singular_values(loop: Loop, theta: np.ndarray) -> np.ndarray:
    """Singular values (k, 6), the largest first, of the 6 x n joint screws in the frame
    of joint 1, lengths in the unit of the loop, at joint angles (k, n), rad."""
    return np.linalg.svd(loop.joint_screws(theta), compute_uv=False)


def draw_singular_values(source: SourceFigure) -> Figure:
    """One panel a form: the singular values, the bifurcations as dashed lines, and near
    misses as triangles."""
    content = source.content
    atlas = atlas_of(content)
    loop = loop_of_content(content)
    figure, panels, forms = _panels(atlas, content["forms"], (4.8, 3.7), 1.1)
    for axes, form in zip(panels, forms, strict=True):
        _draw_values(axes, loop, form)
        _mark_events(axes, atlas, loop, form)
        axes.set_title(form.name, fontsize=9, pad=14)
    panels[-1].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    panels[0].set_ylabel("singular value")
    return figure


def _draw_values(axes: Axes, loop: Loop, form: Form) -> None:
    """The curves of all singular values: the regular ones, of which the first names all
    in the legend, the smallest regular one, and the one that is always 0."""
    theta = curve_points(form.branch)
    values = singular_values(loop, theta)
    input_angle = _shown(theta[:, 0])
    jumps = np.flatnonzero(np.abs(np.diff(input_angle)) > 180.0) + 1
    x = np.insert(input_angle, jumps, np.nan)
    rows = np.insert(values, jumps, np.nan, axis=0)
    last = values.shape[1]
    regular = f"σ₁ to σ{chr(0x2080 + last - 2)}"
    for k in range(last - 2):
        label = regular if k == 0 else "_"
        axes.plot(x, rows[:, k], color=REGULAR, linewidth=1.1, label=label)
    label = f"σ{chr(0x2080 + last - 1)}"
    axes.plot(x, rows[:, -2], color=SMALLEST, linewidth=1.8, label=label)
    style: Properties = {"color": "0.4", "linestyle": DASHED, "linewidth": 1.1}
    axes.plot(x, rows[:, -1], label=f"σ{chr(0x2080 + last)}, always 0", **style)
    axes.set(xlim=(-180, 180), ylim=(-0.02 * values.max(), 1.04 * values.max()))
    axes.xaxis.set_major_locator(MultipleLocator(90))
    axes.set_xlabel("θ₁ (deg)")
    axes.grid(True)


def _mark_events(axes: Axes, atlas: Atlas, loop: Loop, form: Form) -> None:
    """The bifurcations and near misses of the map, as against small values."""
    index = atlas.forms.index(form)
    for point in atlas.points:
        if any(passing == index for passing, _ in point.passes):
            place = float(_shown(point.point.u[0]))
            axes.axvline(place, color="0.4", linestyle=(0, (3, 2)), linewidth=0.9)
            name_above(axes, place, point.name)
    for event in atlas.near_misses:
        if event.form == index:
            value = singular_values(loop, event.u[None])[0, -2]
            style: Properties = {"color": "black", "markersize": 5}
            axes.plot(float(_shown(event.u[0])), value, "v", **style)
