"""Crease patterns in SVG files, by the colours of their lines as Origami Simulator reads
them (Ghassaei, Demaine and Gershenfeld 2018)."""

from __future__ import annotations

import logging
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from linkages.files.crease_lines import CreaseLine, Place, fold_content
from linkages.files.fold import ANGLES, SIDES, STRAIGHT, mechanism_of_fold
from linkages.formats.xml_tree import Element
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError, quoted, require

Style: TypeAlias = Mapping[str, str]
Points: TypeAlias = Sequence[Sequence[float] | np.ndarray] | np.ndarray

log = logging.getLogger(__name__)

COLORS = {
    "B": ("#000000", "#000", "black", "rgb(0,0,0)"),
    "M": ("#ff0000", "#f00", "red", "rgb(255,0,0)"),
    "V": ("#0000ff", "#00f", "blue", "rgb(0,0,255)"),
    "C": ("#00ff00", "#0f0", "green", "lime", "rgb(0,255,0)"),
    "F": ("#ffff00", "#ff0", "yellow", "rgb(255,255,0)"),
    "U": ("#ff00ff", "#f0f", "magenta", "fuchsia", "rgb(255,0,255)"),
}
LETTER_OF = {color: letter for letter, colors in COLORS.items() for color in colors}
GROUPS = ("svg", "g", "a", "switch")
CURVES = ("circle", "ellipse", "use")
UNSEEN = ("hidden", "collapse")
OPACITIES = ("opacity", "stroke-opacity")
INHERITED = ("stroke", "stroke-opacity", "visibility")
LINES = "a straight line: line, polyline, polygon, rect, or path with M, L, H, V and Z"
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
TOKEN = re.compile(rf"[A-Za-z]|{NUMBER}|[^\s,]")
RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
TRANSFORM = re.compile(r"(\w+)\s*\(([^()]*)\)")


class _Pen(NamedTuple):
    """How elements are drawn: the ``style`` that they inherit, the ``frame`` (3, 3) of
    their coordinates, and the ``rules`` of the file, by selector."""

    style: Style
    frame: np.ndarray
    rules: Mapping[str, Style]


def read_svg(root: Element, name: str, triangulated: bool = False) -> Mechanism:
    """The mechanism of a crease pattern, called by ``name``, its panels ``triangulated``
    or not.

    Where lines are not all opaque, their opacity is their fold angle over 180 degrees;
    angles that do not close are left out, with a warning, and so are lines of other
    colours. Raises `GeometryError` with the line.
    """
    others: Counter[str] = Counter()
    frame = np.diag([1.0, -1.0, 1.0])  # y is downwards
    lines = list(_lines(root, _Pen({}, frame, _rules(root)), others))
    if others:
        shown = ", ".join(f"{count} of {color}" for color, count in others.items())
        log.warning("lines of other colours are no creases: %s", shown)
    if all(line.angle in (None, STRAIGHT, -STRAIGHT) for line in lines):
        lines = [line._replace(angle=None) for line in lines]
    content = fold_content(lines)
    try:
        return mechanism_of_fold(content, name, triangulated)
    except GeometryError as error:
        if error.name != ANGLES:
            raise
        log.warning("the flat state is the reference: %s", error)
    del content[ANGLES]
    return mechanism_of_fold(content, name, triangulated)


def _lines(element: Element, pen: _Pen, others: Counter[str]) -> Iterator[CreaseLine]:
    """The lines of an element and of those in it; ``others`` are counted by colour."""
    style = _style(element, pen)
    if style.get("display") == "none":
        return
    pen = _Pen(style, pen.frame @ _transform(element), pen.rules)
    tag = element.tag.removeprefix("svg:")
    if tag in GROUPS:
        for child in element.children:
            yield from _lines(child, pen, others)
    if tag not in (*SHAPES, *CURVES) or style.get("visibility") in UNSEEN:
        return
    color = style.get("stroke", "none").lower().replace(" ", "")
    letter = LETTER_OF.get(color)
    if letter is None:
        others.update([color] if color != "none" else [])
        return
    require(tag in SHAPES, element.place, color, LINES)
    angle = _angle(element, style, letter)
    for chain in SHAPES[tag](element):
        for start, end in pairwise(_placed(chain, pen.frame)):
            yield CreaseLine(start, end, letter, element.place, angle)


def _placed(chain: Points, frame: np.ndarray) -> list[Place]:
    """The points of a chain in the pattern."""
    points = np.reshape(np.array(chain, dtype=float), (-1, 2))
    return [(x, y) for x, y in (points @ frame[:2, :2].T + frame[:2, 2]).tolist()]


def _style(element: Element, pen: _Pen) -> Style:
    """How an element is drawn: by what it inherits, its attributes, and style sheets."""
    style = {key: pen.style[key] for key in INHERITED if key in pen.style}
    style |= element.attributes
    classes = element.attributes.get("class", "").split()
    for selector in (element.tag.removeprefix("svg:"), *(f".{one}" for one in classes)):
        style |= pen.rules.get(selector, {})
    return style | _declarations(element.attributes.get("style", ""))


def _angle(element: Element, style: Style, letter: str) -> float | None:
    """The fold angle (degrees) that the opacity of a mountain or a valley says."""
    if letter not in SIDES:
        return None
    given = next((style[key] for key in OPACITIES if key in style), "1")
    (opacity,) = element.parsed_numbers("opacity", given, (1,))
    element.require(0.0 <= opacity <= 1.0, "opacity", opacity, "from 0 to 1")
    return math.copysign(opacity * STRAIGHT, SIDES[letter])


# --- style and frames -----------------------------------------------------------------


def _rules(root: Element) -> dict[str, dict[str, str]]:
    """What the style sheets of a file say, by selector."""
    rules: dict[str, dict[str, str]] = {}
    waiting = [root]
    while waiting:
        element = waiting.pop()
        waiting += element.children
        if element.tag.removeprefix("svg:") != "style":
            continue
        for selectors, declarations in RULE.findall(element.text):
            for one in selectors.split(","):
                known = rules.setdefault(one.strip(), {})
                known |= _declarations(declarations)
    return rules


def _declarations(text: str) -> dict[str, str]:
    """What a style declares, by property."""
    parts = (one.partition(":") for one in text.split(";"))
    return {key.strip(): value.strip() for key, colon, value in parts if colon}


def _transform(element: Element) -> np.ndarray:
    """The frame (3, 3) of an element in the one around it."""
    frame = np.eye(3)
    for kind, text in TRANSFORM.findall(element.attributes.get("transform", "")):
        what = "transform"
        element.require(
            kind in COUNTS, what, quoted(kind), "one of " + ", ".join(COUNTS)
        )
        numbers = element.parsed_numbers(what, text.replace(",", " "), COUNTS[kind])
        frame = frame @ _frame(kind, numbers)
    return frame


COUNTS = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3)}


def _frame(kind: str, numbers: Sequence[float]) -> np.ndarray:
    first, *rest = numbers
    if kind == "matrix":
        return np.vstack([np.reshape(numbers, (3, 2)).T, [0.0, 0.0, 1.0]])
    if kind == "scale":
        return np.diag([first, *(rest or [first]), 1.0])
    frame = np.eye(3)
    if kind == "translate":
        frame[:2, 2] = [first, *(rest or [0.0])]
        return frame
    cosine, sine = math.cos(math.radians(first)), math.sin(math.radians(first))
    frame[:2, :2] = [[cosine, -sine], [sine, cosine]]
    center = np.array(rest or [0.0, 0.0])
    frame[:2, 2] = center - frame[:2, :2] @ center
    return frame


# --- shapes, as chains of points ------------------------------------------------------


def _number(element: Element, key: str) -> float:
    given = element.attributes.get(key, "0").removesuffix("px")
    return element.parsed_numbers(key, given, (1,))[0]


def _of_line(element: Element) -> Iterator[Points]:
    yield [[_number(element, f"{axis}{end}") for axis in "xy"] for end in "12"]


def _of_rect(element: Element) -> Iterator[Points]:
    x, y, width, height = (_number(element, k) for k in ("x", "y", "width", "height"))
    right, bottom = x + width, y + height
    yield [[x, y], [right, y], [right, bottom], [x, bottom], [x, y]]


def _of_polyline(element: Element) -> Iterator[Points]:
    text = " ".join(TOKEN.findall(element.attributes.get("points", "")))
    count = len(text.split())
    element.require(count % 2 == 0, "points", quoted(text), "pairs of numbers")
    points = np.reshape(element.parsed_numbers("points", text, (count,)), (-1, 2))
    is_closed = element.tag.endswith("polygon")
    yield [*points, *points[:1]] if is_closed else points


def _of_path(element: Element) -> Iterator[Points]:
    """The chains of a path, one for each move."""
    tokens = TOKEN.findall(element.attributes.get("d", ""))
    tokens.reverse()
    here, command = [0.0, 0.0], ""
    chain: list[list[float]] = []
    while tokens:
        if tokens[-1].isalpha():
            command = tokens.pop()
        kind, is_relative = command.upper(), command.islower()
        element.require(kind in AXES, "d", quoted(command), LINES)
        if kind == "M":
            yield chain
            chain = []
        base = here if is_relative else [0.0, 0.0]
        here = list(here)
        for axis in AXES[kind]:
            given = tokens.pop() if tokens else ""
            here[axis] = base[axis] + element.parsed_numbers("d", given, (1,))[0]
        if kind == "Z":
            here = list(chain[0]) if chain else here
        chain = [*chain, here]
        command = FOLLOWING.get(command, command)
    yield chain


AXES = {"M": (0, 1), "L": (0, 1), "H": (0,), "V": (1,), "Z": ()}
# what numbers after the first of a command stand for, where that is another one
FOLLOWING = {"M": "L", "m": "l", "Z": "", "z": ""}
SHAPES = {
    "line": _of_line,
    "rect": _of_rect,
    "polyline": _of_polyline,
    "polygon": _of_polyline,
    "path": _of_path,
}
