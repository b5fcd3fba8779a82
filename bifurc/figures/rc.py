"""Settings of matplotlib: those of this project, over which the user's go.

A setting is the user's where it differs from what matplotlib comes with: by a style, a
file matplotlibrc, or in the program.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from cycler import cycler
from matplotlib import rc_context, rcParams, rcParamsDefault
from matplotlib.font_manager import FontProperties

from bifurc.figures.style import COLORS, DASHES, Style

SALT = "svg.hashsalt"  # by which it is seen that these settings are set
# Their values are of the types that each of them takes.
RC: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": "medium",
    "figure.labelsize": "medium",
    "xtick.labelsize": "small",
    "ytick.labelsize": "small",
    "axes.prop_cycle": cycler(color=COLORS),
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.edgecolor": "0.4",
    "legend.frameon": False,
    SALT: "bifurc",
    "pdf.fonttype": 42,  # letters that journals can search and edit
    "text.parse_math": False,  # names of the user's may hold a dollar sign
    "lines.dash_capstyle": "butt",
    "lines.solid_capstyle": "butt",
}
SIZE = "figure.figsize"
# by names that are not known beforehand
CURRENT: Any = rcParams
DEFAULT: Any = rcParamsDefault


@contextmanager
def drawing_style() -> Iterator[None]:
    """A block in which figures are drawn: settings are those of this project, but for
    what the user has set. Inside of such a block they stay as they are."""
    if CURRENT[SALT] == RC[SALT]:
        yield
        return
    own = {key: value for key, value in RC.items() if not is_of_user(key)}
    with rc_context(own):
        yield


def is_of_user(key: str) -> bool:
    """Whether the user has set this."""
    return bool(CURRENT[key] != DEFAULT[key])


def size_of_user() -> tuple[float, float] | None:
    """Width and height of figures, in inches, where the user has set them."""
    if not is_of_user(SIZE):
        return None
    width, height = CURRENT[SIZE]
    return float(width), float(height)


def letter_size(key: str = "font.size") -> float:
    """The size of letters of a setting, in inches."""
    return float(FontProperties(size=CURRENT[key]).get_size_in_points()) / 72


def line_style(index: int) -> Style:
    """Colour and dashes of form number ``index`` in a figure: those of
    `bifurc.figures.style.form_style`, or of the user's cycle."""
    cycle = rcParams["axes.prop_cycle"].by_key()
    colors = cycle.get("color", COLORS)
    dashes = cycle.get("linestyle", DASHES)
    return Style(colors[index % len(colors)], dashes[index % len(dashes)])
