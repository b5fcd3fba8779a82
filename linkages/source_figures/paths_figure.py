"""Figures of joint angles against the angle of one joint: the kinematic paths and
input-output curves of the sources."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from bifurc.atlas import Atlas, Form
from bifurc.figures.planes import Scale, curve_points, cut_to_frame
from bifurc.figures.style import form_style
from bifurc.torus import wrap
from linkages.source_figures.configurations import atlas_of, form_named, places_at
from linkages.source_figures.table import Content, SourceFigure

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
ALIKE = 1e-9  # rad: curves that are closer everywhere are drawn as one
DEGREES = 180.0 / np.pi
TURN = 2 * np.pi


@dataclass(frozen=True)
class Curve:
    """The ``joints`` (from 0) that share a curve, and its index for colour and dashes."""

    joints: tuple[int, ...]
    index: int


def draw(source: SourceFigure) -> Figure:
    """One panel a form: every other joint's angle against that of joint 1."""
    content = source.content
    atlas = atlas_of(content)
    forms = _forms(atlas, content)
    figure = Figure(figsize=(5.0 * len(forms) + 0.9, 4.4), layout="constrained")
    panels = figure.subplots(1, len(forms), squeeze=False)[0]
    for axes, form in zip(panels, forms, strict=True):
        _draw_form(axes, form, content)
        if len(forms) > 1:
            axes.set_title(form.name, fontsize=9)
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    return figure


def _forms(atlas: Atlas, content: Content) -> Sequence[Form]:
    names = content.get("forms", [])
    if not names:
        return atlas.forms
    return [form_named(atlas, name) for name in names]


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
        style = form_style(curve.index)
        axes.plot(
            *rows.T,
            color=style.color,
            linestyle=style.dashes,
            linewidth=1.7,
            label=_names(curve.joints),
            clip_on=False,
        )
    for degrees, filling in content.get("dots", ()):
        _draw_dots(axes, form, groups, degrees, filling, turns)
    if "dots" in content:
        axes.set_xlabel("θ₁ (deg)   " + content["dots_title"])
    else:
        axes.set_xlabel("θ₁ (deg)")
    if content.get("turning_points"):
        _draw_turning_points(axes, form, groups)
    axes.set_ylabel("joint angle (deg)")
    axes.set(xlim=(-180 * turns, 180 * turns), ylim=(-180, 180))
    axes.xaxis.set_major_locator(MultipleLocator(90 * turns))
    axes.yaxis.set_major_locator(MultipleLocator(90))
    axes.grid(True)


def joints_alike(points: np.ndarray) -> list[Curve]:
    """The joints other than the first, those with the same angle all along points (k,
    n) of a form together; those that follow joint 1 come with nobody."""
    wrapped = wrap(points, np.full(points.shape[1], TURN))
    groups: list[list[int]] = []
    for joint in range(1, points.shape[1]):
        for group in groups:
            gap = np.sin((wrapped[:, joint] - wrapped[:, group[0]]) / 2)
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
    filling: str,
    turns: int,
) -> None:
    """Dots on all curves where joint 1 stands at an angle of so many turns."""
    half = 180.0 * turns
    shown = (degrees + half) % (2 * half) - half
    for s in places_at(form.branch, 1, np.radians(degrees)):
        theta = form.branch(s)
        first = DEGREES * float(theta[0])
        if abs((first - shown + half) % (2 * half) - half) > 1e-6:
            continue
        for curve in groups:
            angle = DEGREES * float(wrap(theta[[curve.joints[0]]], np.array([TURN]))[0])
            axes.plot(
                shown,
                angle,
                "o",
                markersize=5,
                markeredgecolor="black",
                markerfacecolor="black" if filling == "filled" else "white",
                zorder=4,
            )


def _draw_turning_points(axes: Axes, form: Form, groups: Sequence[Curve]) -> None:
    """Marks where joint 1 turns back."""
    s = np.linspace(0.0, form.branch.length, 721)
    speeds = form.branch(s, 1)[:, 0]
    for i in np.flatnonzero(np.diff(np.sign(speeds))):
        low, high = s[i], s[i + 1]
        for _ in range(60):
            middle = (low + high) / 2
            speed = float(form.branch(middle, 1)[0])
            if (speed > 0) == (speeds[i] > 0):
                low = middle
            else:
                high = middle
        theta = form.branch(low)
        for curve in groups:
            pair = theta[[0, curve.joints[0]]]
            spot = DEGREES * wrap(pair, np.full(2, TURN))
            axes.plot(*spot, "s", markersize=4, color="black", zorder=4)
