"""The pictures of the singular values: along the forms, and against one unknown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from bifurc.atlas import Atlas, Event, Form
from bifurc.checks import UnknownName
from bifurc.figures.drawing import (
    DegreeLocator,
    columns_of,
    name_above,
    note_emptiness,
)
from bifurc.figures.layout import (
    Canvas,
    Margins,
    PanelPlan,
    Sheet,
    figure_of,
    fix_names_of_axes,
    lay_out,
)
from bifurc.figures.planes import Scale, indices_of, place_in_frame, scale_of
from bifurc.figures.quantities import shown_unit
from bifurc.figures.rc import drawing_style, letter_size, line_style
from bifurc.figures.selection import EVERYTHING, Selection
from bifurc.figures.style import Properties, Style

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MARGINS = Margins(0.7, 0.2, 0.5, 0.42, between_columns=0.3, between_rows=0.65)
LEAST_WIDTH = 2.0  # of a panel, in inches, above which its name stands
STEEP = 1.3  # values of neighbours over each other, above which points are put between
LOWEST = 1e-16  # of the largest value: what is drawn of a zero
PLAIN = Scale(1.0, np.inf, "")
AT_POINT: Properties = {"color": "0.35", "linewidth": 0.8, "linestyle": (0, (3, 2))}
LETTER_WIDTH = 0.7  # of a name, over the size of its letters


class _Range(NamedTuple):
    """Limits of the logarithmic axis."""

    low: float
    high: float


class _Stop(NamedTuple):
    """A form passes a singular point: the arclength and the name of the point."""

    s: float
    name: str


def plot_singular_values(
    atlas: Atlas, figure: Canvas | None = None, *, selection: Selection = EVERYTHING
) -> Figure:
    """The regular singular values along each form on a logarithmic scale, in one panel
    a form, in a ``figure`` or a part of one, or in a new one.

    The smallest is drawn strongly. It vanishes at singular points (dashed, named); near
    misses carry their value. Bars on the axis show where a form is not certified.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> figure = bifurc.plot_singular_values(atlas)
    >>> len(figure.axes) == len(atlas.forms)
    True
    """
    forms = selection.indices(atlas)
    limits = _limits(atlas)
    with drawing_style():
        sheet = _lay_out(figure, len(forms))
        for axes, i in zip(sheet.panels, forms, strict=False):
            _draw_form(axes, atlas, i, limits)
        sheet.canvas.supxlabel(f"arclength{_unit(atlas)}")
        sheet.canvas.supylabel("singular value")
        note_emptiness(sheet.panels[0], atlas)
    return figure_of(sheet.canvas)


def _lay_out(figure: Canvas | None, forms: int) -> Sheet:
    """A figure with an empty panel for each form, and one where there is none."""
    count = max(forms, 1)
    width = 4.2 if count > 1 else 5.4
    plan = PanelPlan(
        count,
        columns_of(count),
        width,
        1.6,
        MARGINS,
        has_common_ordinate=True,
        least_width=LEAST_WIDTH,
    )
    return lay_out(figure, plan)


def _unit(atlas: Atlas) -> str:
    """The units of the unknowns, in brackets, if all have one."""
    if not all(atlas.units):
        return ""
    names = []
    for index, unit in enumerate(atlas.units):
        factor, shown = shown_unit(atlas, index)
        names.append(unit if shown == unit else f"{shown} over {factor:.4g}")
    return f" ({', '.join(sorted(set(names), reverse=True))})"


def _limits(atlas: Atlas) -> _Range:
    """A decade below everything that is not zero, and five decades at least."""
    if not atlas.forms:
        return _Range(1e-5, 1.0)
    high = max(float(np.nanmax(form.profile.values)) for form in atlas.forms)
    if high == 0.0:
        return _Range(1e-5, 1.0)
    small = [event.value for event in atlas.near_misses]
    small += [float(form.profile.smallest.min()) for form in atlas.forms]
    low = max(min(small) / 10, 1e-16 * high)
    if atlas.points:
        low = min(low, 1e-5 * high)
    return _Range(10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(2 * high)))


# --- one form -------------------------------------------------------------------------


def _draw_form(axes: Axes, atlas: Atlas, index: int, limits: _Range) -> None:
    form = atlas.forms[index]
    style = line_style(index)
    stops = _stops(atlas, index)
    misses = [event for event in atlas.near_misses if event.form == index]
    zeros = [stop.s for stop in stops]
    _draw_values(axes, form, zeros, misses, style, limits)
    for event in misses:
        _draw_near_miss(axes, event, form.branch.length)
    axes.set(yscale="log", ylim=limits, xlim=(0.0, form.branch.length))
    _name_stops(axes, stops)
    _mark_refusals(axes, form)
    axes.yaxis.set_major_formatter(FuncFormatter(_power_of_ten))
    axes.yaxis.set_minor_locator(NullLocator())
    fix_names_of_axes(axes)
    _name_form(axes, form, style, stops)
    axes.grid(True)


def _name_form(axes: Axes, form: Form, style: Style, stops: Sequence[_Stop]) -> None:
    """The name of a form above its panel, and above the names of its ``stops``."""
    lines = 2.0 if stops else 0.8
    pad = 72 * letter_size() * (lines - 0.4)
    axes.set_title(form.name, color=style.color, loc="left", pad=pad, y=1.0)


def _stops(atlas: Atlas, index: int) -> list[_Stop]:
    """The singular points on a form."""
    stops = []
    for point in atlas.points:
        for form, s in point.passes:
            if form == index:
                stops.append(_Stop(s, point.name))
    return stops


def _regular_values(form: Form) -> tuple[np.ndarray, np.ndarray]:
    """Arclengths (k,) along a form and its regular singular values (k, rank)."""
    s = form.profile.arclength.ravel()
    values = form.profile.values.reshape(len(s), -1)[:, : form.rank]
    return s, values[:, ~np.isnan(values).all(axis=0)]  # of many only some are known


def _draw_values(
    axes: Axes,
    form: Form,
    zeros: Sequence[float],
    misses: Sequence[Event],
    style: Style,
    limits: _Range,
) -> None:
    """All regular singular values along a form, the smallest strongly."""
    s, values = _regular_values(form)
    if not values.shape[1]:
        return  # nothing holds the only unknown
    axes.plot(s, values[:, :-1], color="0.75", linewidth=0.8, zorder=1)
    length = form.branch.length
    turns = (-length, 0.0, length) if form.branch.closed else (0.0,)
    repeated = [zero + turn for zero in zeros for turn in turns]
    x = np.concatenate([s, [event.s for event in misses]])
    y = np.concatenate([values[:, -1], [event.value for event in misses]])
    x, y = _with_zeros(x, y, repeated)
    rows = np.stack([x, np.maximum(y, 1e-3 * limits.low)], axis=1)
    axes.plot(*rows.T, linewidth=1.6, zorder=2, **style.line)


def _with_zeros(
    s: np.ndarray, values: np.ndarray, zeros: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Samples and zeros, with steep stretches filled in linearly: drawn straight in
    logarithms they would mislead."""
    x = np.concatenate([s, zeros])
    y = np.concatenate([values, np.zeros(len(zeros))])
    order = np.argsort(x, kind="stable")
    x = x[order]
    y = y[order]
    lower = np.minimum(y[:-1], y[1:])
    upper = np.maximum(y[:-1], y[1:])
    steep = np.flatnonzero(upper > STEEP * lower)
    exponents = [np.arange(-8.0, -1.5, 0.25), np.arange(-1.5, -0.25, 0.1)]
    small = 10.0 ** np.concatenate(exponents)
    fractions = np.concatenate([small, 1.0 - small])
    inner = x[steep, None] + fractions * np.diff(x)[steep, None]
    dense = np.union1d(x, inner.ravel())
    return dense, np.interp(dense, x, y)


def _draw_near_miss(axes: Axes, event: Event, length: float) -> None:
    """A mark with the value, on the side where there is room on a form of that
    length."""
    axes.plot([event.s], [event.value], "v", color="black", markersize=4, zorder=4)
    on_the_left = event.s > 0.85 * length
    axes.annotate(
        f"{event.value:.1e}",
        (event.s, event.value),
        (-5 if on_the_left else 5, -3),
        textcoords="offset points",
        ha="right" if on_the_left else "left",
        va="top",
        fontsize="x-small",
    )


def _mark_refusals(axes: Axes, form: Form) -> None:
    """Bars on the axis of arclength where nothing is certified."""
    if form.certificate is None:
        return
    for low, high in form.certificate.gaps:
        axes.plot(
            np.array([low, 0.5 * (low + high), high]),
            np.zeros(3),
            transform=axes.get_xaxis_transform(),
            marker="x",
            markevery=[1],
            markersize=5,
            color="tab:red",
            linewidth=4,
            solid_capstyle="butt",
            clip_on=False,
            label="not certified",
            zorder=5,
        )


def _name_stops(axes: Axes, stops: Sequence[_Stop]) -> None:
    """Dashed lines at singular points, their names above the panel, those that have no
    room beside each other in one label."""
    figure = figure_of(axes)
    low, high = axes.get_xlim()
    letter = LETTER_WIDTH * letter_size("xtick.labelsize")
    letter *= (high - low) * figure.dpi / axes.bbox.width  # along the axis
    groups: list[tuple[str, float]] = []
    for stop in sorted(stops, key=lambda stop: stop.s):
        axes.axvline(stop.s, zorder=0, **AT_POINT)
        name, place = stop.name, stop.s
        while groups:
            before, middle = groups[-1]
            if place - middle > 0.5 * letter * (len(before) + len(name) + 2):
                break
            groups.pop()
            share = len(name) / (len(before) + len(name))
            name, place = f"{before}, {name}", middle + share * (place - middle)
        groups.append((name, place))
    for name, place in groups:
        half = 0.5 * letter * len(name)
        inside = min(max(place, low + half), high - half)
        name_above(axes, inside, name, va="bottom")


def _power_of_ten(value: float, _: int) -> str:
    """A tick's label in plain characters: matplotlib's own needs a parser of formulas,
    a fifth of a second to load."""
    return "10" + str(round(np.log10(value))).translate(SUPERSCRIPTS)


# --- against one unknown --------------------------------------------------------------


def plot_singular_values_against(
    atlas: Atlas,
    unknown: UnknownName | int,
    figure: Canvas | None = None,
    *,
    selection: Selection = EVERYTHING,
) -> Figure:
    """The regular singular values of each form against one unknown, by its name or its
    number from 1, on a logarithmic scale, in one panel a form, in a ``figure`` or a
    part of one, or in a new one.

    The smallest is drawn strongly; bifurcations are dashed lines with their names, near
    misses triangles. Raises `ProblemError` where there is no such unknown.
    """
    (index,) = indices_of(atlas, "unknown", [unknown], 1)
    forms = selection.indices(atlas)
    scale = scale_of(atlas, index, selection.window)
    limits = _limits(atlas)
    with drawing_style():
        sheet = _lay_out(figure, len(forms))
        for axes, i in zip(sheet.panels, forms, strict=False):
            _draw_form_against(axes, atlas, i, index, scale, limits)
        sheet.canvas.supxlabel(scale.label)
        sheet.canvas.supylabel("singular value")
        note_emptiness(sheet.panels[0], atlas)
    return figure_of(sheet.canvas)


def _draw_form_against(
    axes: Axes, atlas: Atlas, index: int, unknown: int, scale: Scale, limits: _Range
) -> None:
    form = atlas.forms[index]
    style = line_style(index)
    stops = _stops(atlas, index)
    s, values = _values_at_stops(form, [stop.s for stop in stops])
    shown = _shown(form.branch(s)[:, unknown], scale)
    jumps = np.flatnonzero(np.abs(np.diff(shown)) > scale.half) + 1
    x = np.insert(shown, jumps, np.nan)
    y = np.insert(np.maximum(values, LOWEST * limits.high), jumps, np.nan, axis=0)
    axes.plot(x, y[:, :-1], color="0.75", linewidth=0.8, zorder=1)
    axes.plot(x, y[:, -1], color=style.color, linewidth=1.6, zorder=2)
    for event in atlas.near_misses:
        if event.form == index:
            place = _shown(event.u[[unknown]], scale)[0]
            axes.plot(place, event.value, "v", color="black", markersize=4, zorder=4)
    axes.set(yscale="log", ylim=limits)
    axes.yaxis.set_major_formatter(FuncFormatter(_power_of_ten))
    axes.yaxis.set_minor_locator(NullLocator())
    if scale.is_periodic:
        axes.set_xlim(scale.limits)
    if scale.is_degrees:
        axes.xaxis.set_major_locator(DegreeLocator())
    places: list[_Stop] = []
    for point in atlas.points:
        if any(number == index for number, _ in point.passes):
            place = float(_shown(point.point.u[[unknown]], scale)[0])
            places.append(_Stop(place, point.name))
    low, high = axes.get_xlim()
    _name_stops(axes, [stop for stop in places if low <= stop.s <= high])
    _name_form(axes, form, style, places)
    axes.grid(True)


def _values_at_stops(
    form: Form, zeros: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Arclengths (k,) along a form and its regular singular values (k, rank), with the
    singular points, where the smallest is 0."""
    s, values = _regular_values(form)
    places = np.concatenate([s, zeros])
    columns = [np.interp(places, s, column) for column in values.T]
    columns[-1][len(s) :] = 0.0
    order = np.argsort(places, kind="stable")
    return places[order], np.stack(columns, axis=1)[order]


def _shown(values: np.ndarray, scale: Scale) -> np.ndarray:
    """Values (k,) of an unknown as they are shown, periodic ones within the frame."""
    pairs = np.stack([values, np.zeros_like(values)], axis=1)
    return np.asarray(place_in_frame(pairs, (scale, PLAIN))[:, 0])
