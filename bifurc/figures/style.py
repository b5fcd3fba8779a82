"""How curves and marks look in every figure."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, TypeAlias

from bifurc.singular.point import Mark

Properties: TypeAlias = dict[str, Any]  # of what matplotlib draws, as it calls them
Dashes: TypeAlias = Literal["-"] | tuple[float, tuple[float, ...]]

# Okabe and Ito (2008), without the yellow that is too light on white
COLORS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
    "#E69F00",
    "#000000",
    "#7F3C8D",
)
# what stands for the colours that cannot be seen on a dark page
ON_DARK = {"#000000": "#FFFFFF", "#7F3C8D": "#B98BC9"}
DASHES: tuple[Dashes, ...] = (
    "-",
    (0, (6, 2)),
    (0, (6, 2, 1.2, 2)),
    (0, (1.2, 1.2)),
    (0, (9, 2, 3, 2)),
    (0, (3, 1.5)),
)


DOTS: Dashes = (0, (1.0, 1.0))


class Style(NamedTuple):
    """Colour and dashes of a form."""

    color: str
    dashes: Dashes

    @property
    def line(self) -> Properties:
        """How a line of it is drawn."""
        return {"color": self.color, "linestyle": self.dashes}


def form_style(index: int) -> Style:
    """Style of form number ``index``: colours and dashes repeat, but not together
    before 24 forms."""
    return Style(COLORS[index % len(COLORS)], DASHES[index % len(DASHES)])


def near_motion_style(index: int) -> Style:
    """Style of a near motion with ``index`` forms and near motions before it: dotted,
    for it is no motion."""
    return Style(COLORS[index % len(COLORS)], DOTS)


def color_on_dark(color: str) -> str:
    """The colour that stands for ``color`` on a dark page: the same where it can be
    seen there."""
    return ON_DARK.get(color, color)


def hollow(mark: Mark) -> Properties:
    """How a mark is drawn, white inside."""
    return {
        "marker": mark.symbol,
        "markersize": mark.size,
        "markerfacecolor": "white",
        "markeredgecolor": "black",
    }
