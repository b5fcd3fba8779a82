"""The links of a CUIK world: of their shapes only the points that joints refer to."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from linkages.formats.assembly import translation
from linkages.formats.cuik_tokens import Cursor
from linkages.mechanisms.joint import Vector
from linkages.values import GeometryError, quoted, require

COLORS = (
    *("red", "green", "blue", "black", "grey", "gray", "white", "yellow", "purple"),
    "cyan",
)
SHAPES = ("body", "box", "prism", "sphere", "cylinder", "line", "segments")
TURNS = {"rx": (1.0, 0.0, 0.0), "ry": (0.0, 1.0, 0.0), "rz": (0.0, 0.0, 1.0)}
SLIDES = {"tx": (1.0, 0.0, 0.0), "ty": (0.0, 1.0, 0.0), "tz": (0.0, 0.0, 1.0)}
INERTIAS = ("rod", "cylinder", "sphere", "box", "ellipsoid")
MOST_POINTS = 100_000  # of a body in a file of its own


@dataclass
class Link:
    """A link: its ``name``, and the points (3,) that define each of its ``shapes``; for
    a shape in a file of its own the ``path`` of that file."""

    name: str
    shapes: list[list[Vector] | Path] = field(default_factory=list)

    def point(self, shape: int, number: int, what: str) -> Vector:
        """A point (3,) of a shape, by number from 0; raises `GeometryError`."""
        allowed = f"below {len(self.shapes)}, the number of shapes of {self.name}"
        is_shape = 0 <= shape < len(self.shapes)
        require(is_shape, f"shape of {what}", shape, allowed)
        points = self.shapes[shape]
        if isinstance(points, Path):
            points = self.shapes[shape] = _points_of_off(points)
        allowed = f"below {len(points)}, the number of points of {self.name}"
        is_point = 0 <= number < len(points)
        require(is_point, f"point of {what}", number, allowed)
        return points[number]


def read_links(cursor: Cursor, folder: Path, links: dict[str, Link]) -> None:
    """Read links up to the next section into ``links``, by name; bodies in files of
    their own are next to ``folder``."""
    while not cursor.is_at_section:
        line = cursor.token.line
        name = cursor.name("the name of a link")
        require(name not in links, f"line {line}", quoted(name), "given once")
        links[name] = Link(name)
        has_parts = cursor.take(":") or cursor.take("-")
        while has_parts and not cursor.is_at_section:
            if cursor.is_word(*SHAPES) and cursor.ahead(1) not in (":", "-"):
                links[name].shapes.append(_read_shape(cursor, folder))
            elif not skip_details(cursor):
                break


def _read_shape(cursor: Cursor, folder: Path) -> list[Vector] | Path:
    """The points of a shape, or the path of its file."""
    shape = cursor.next().text.lower()
    match shape:
        case "body":
            if cursor.token.kind != "text":
                cursor.refuse("the name of a file in quotes")
            return folder / cursor.next().text.strip('"')
        case "sphere":
            cursor.number()
            return [read_point(cursor)]
        case "cylinder":
            cursor.number()
            return _read_points(cursor)
        case "prism":
            points = [read_point(cursor) for _ in range(3)]
            cursor.number()
            return points
        case "segments":
            cursor.expect("(")
            rows = [cursor.numbers(3)]
            while cursor.take(";"):
                rows.append(cursor.numbers(3))
            cursor.expect(")")
            return [(x, y, z) for x, y, z in rows]
        case _:
            return _read_points(cursor)


def skip_details(cursor: Cursor) -> bool:
    """Whether a word on how a shape looks, on mass or on inertia stands here; the
    cursor goes on behind it."""
    following = cursor.ahead(1).lower()
    is_name = following in (":", "-")
    if cursor.token.kind == "number" and following == "*":
        cursor.place += 2
    elif cursor.is_word("color") and following == "(":
        cursor.next()
        read_point(cursor)
    elif cursor.is_word("granularity") or (cursor.is_word("mass") and not is_name):
        cursor.next()
        cursor.number()
    elif cursor.is_word(*COLORS, "hidden", "decoration") and not is_name:
        cursor.next()
    elif cursor.is_word("inertial") and following == "frame":
        cursor.place += 2
        read_transforms(cursor)
    elif cursor.is_word("inertia") and following == "matrix":
        cursor.place += 2
        cursor.take("solid")
        if cursor.token.text.lower().split("_")[0] in INERTIAS:
            cursor.next()
        cursor.number()
        while cursor.take(","):
            cursor.number()
    else:
        return cursor.take("+")
    return True


# --- points ---------------------------------------------------------------------------


def read_point(cursor: Cursor) -> Vector:
    """The point (x, y, z) that stands here."""
    x, y, z = cursor.row("()", 3)
    return (x, y, z)


def _read_points(cursor: Cursor) -> list[Vector]:
    """Two points, the second one as such or as a vector from the first one."""
    first = read_point(cursor)
    return [first, read_end(cursor, first)]


def read_end(cursor: Cursor, start: Vector) -> Vector:
    """A point, or "+" and the vector to it from ``start``."""
    is_vector = cursor.take("+")
    x, y, z = read_point(cursor)
    if not is_vector:
        return (x, y, z)
    return (start[0] + x, start[1] + y, start[2] + z)


def _points_of_off(path: Path) -> list[Vector]:
    """The vertices of a body in an OFF file; raises `GeometryError`."""
    try:
        text = path.read_text(encoding="utf-8")
        lines = [line.split("#")[0] for line in text.splitlines()]
        words = " ".join(lines).split()
        start = 1 if words[0].upper().endswith("OFF") else 0
        count = int(words[start])
        numbers = [float(word) for word in words[start + 3 : start + 3 + 3 * count]]
        is_whole = len(numbers) == 3 * count and bool(np.all(np.isfinite(numbers)))
        if not (0 <= count <= MOST_POINTS and is_whole):
            raise ValueError
    except OSError as error:
        allowed = f"a file that can be read ({error.strerror})"
        raise GeometryError("body", quoted(path), allowed) from None
    except (ValueError, IndexError):  # of text that is not UTF-8, among others
        raise GeometryError("body", quoted(path), "an OFF file of text") from None
    rows = [numbers[k : k + 3] for k in range(0, 3 * count, 3)]
    return [(x, y, z) for x, y, z in rows]


# --- transforms -----------------------------------------------------------------------


def read_transforms(cursor: Cursor) -> np.ndarray:
    """The product (4, 4) of the transforms that stand here; identity without any."""
    result = np.eye(4)
    while cursor.is_word("id", "txyz", "tr", *TURNS, *SLIDES):
        result = result @ _read_transform(cursor)
        if not cursor.take("*"):
            break
    return result


def _read_transform(cursor: Cursor) -> np.ndarray:
    word = cursor.next().text.lower()
    if word == "id":
        return np.eye(4)
    if word == "txyz":
        return translation(read_point(cursor))
    if word == "tr":
        cursor.place -= 1
        cursor.refuse("one of Id, Tx, Ty, Tz, Txyz, Rx, Ry, Rz")
    (value,) = cursor.row("()", 1)
    result = (
        translation(value * np.array(SLIDES[word]))
        if word in SLIDES
        else rotation(TURNS[word], value)
    )
    if cursor.token.text == "^" and cursor.ahead(1) == "-" and cursor.ahead(2) == "1":
        cursor.place += 3
        return np.linalg.inv(result)
    return result


def rotation(direction: Vector, angle: float) -> np.ndarray:
    """The turn (4, 4) about a unit vector (3,) through the origin."""
    from linkages.mechanisms.joint import turns

    result = np.eye(4)
    result[:3, :3] = turns(np.array(direction), np.array([angle]))[0]
    return result
