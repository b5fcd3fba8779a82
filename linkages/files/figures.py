"""Figures of points and pieces between them: bars in a plane or in space, arcs on a
sphere.

Every piece is a body, and so is the frame, which holds the fixed points. A point is a
joint of all bodies that it lies on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Generic, TypeVar

import numpy as np

from bifurc.equations.expression import ExpressionError, parse_expression
from bifurc.equations.program import Program
from linkages.mechanisms.joint import Joint
from linkages.values import (
    SOME,
    GeometryError,
    checked_list,
    checked_table,
    quoted,
    require,
)

FRAME = "frame"
Place = TypeVar("Place")  # of a point: coordinates, or a direction (3,)
Numbers = TypeVar("Numbers")  # of a point on a piece


@dataclass(frozen=True)
class Piece:
    """A bar or an arc between two points, with the length or the angle (rad) that is
    given for it."""

    start: str
    end: str
    measure: float | None = None

    @property
    def name(self) -> str:
        """What the body is called."""
        return joined_name(self.start, self.end)

    @property
    def ends(self) -> tuple[str, str]:
        """The points at its ends."""
        return self.start, self.end


@dataclass(frozen=True)
class PointOnPiece(Generic[Numbers]):
    """A point that is rigid with the body that holds two others, at ``numbers`` that
    say where."""

    start: str
    end: str
    numbers: Numbers


@dataclass(frozen=True)
class FigureKind(Generic[Numbers]):
    """The words of a kind of figure, as files and errors have them, and its numbers.

    ``read_measure`` and ``read_numbers`` take what an error calls a number, and what
    the file says.
    """

    noun: str
    article: str
    measure: str
    numbers: str
    read_measure: Callable[[str, Any], float]
    read_numbers: Callable[[str, object], Numbers]

    @property
    def piece(self) -> str:
        """The noun with its article."""
        return f"{self.article} {self.noun}"


@dataclass(frozen=True)
class Figure(Generic[Place, Numbers]):
    """What a file says: the places of ``points``, which of them are ``fixed``,
    ``pieces``, and the points ``on_pieces``, in an order in which each follows the
    points that it lies between."""

    kind: FigureKind[Numbers]
    points: dict[str, Place]
    fixed: tuple[str, ...]
    pieces: tuple[Piece, ...]
    on_pieces: dict[str, PointOnPiece[Numbers]]

    @property
    def free(self) -> list[str]:
        """The points that may be moved."""
        return [name for name in self.points if name not in self.fixed]


# --- keys -----------------------------------------------------------------------------


def table_of_points(content: Mapping[str, Any], row: str) -> Mapping[str, object]:
    """The table ``[points]`` of a file, whose rows look like ``row``, with texts of
    numbers as these; raises `GeometryError`."""
    given = content.get("points")
    table = checked_table("points", given, f"a table of points {row}")
    require(bool(table), "points", quoted(given), f"a table of points {row}")
    return {name: _numbers(f"point {name}", row) for name, row in table.items()}


def _numbers(what: str, given: Any) -> Any:
    """What is given for a number, or for a list of numbers, with constant expressions, such
    as "sqrt(3)/2", as the numbers that they are; raises `GeometryError`."""
    if isinstance(given, list):
        return [_numbers(what, one) for one in given]
    if not isinstance(given, str):
        return given
    try:
        value = parse_expression(given, {}, Program()).value
    except ExpressionError as error:
        allowed = f'a number, or a text such as "sqrt(3)/2"; {error}'
        raise GeometryError(what, quoted(given), allowed) from None
    assert value is not None  # without symbols everything is constant
    return value


def read_figure(
    content: Mapping[str, Any], kind: FigureKind[Numbers], points: dict[str, Place]
) -> Figure[Place, Numbers]:
    """The figure of these ``points`` that a file describes; raises `GeometryError`."""
    on_pieces = _read_points_on(content, kind, points)
    known = [*points, *on_pieces]
    given = content.get("fixed", [])
    fixed = checked_list("fixed", given, "a list of names of points")
    for name in fixed:
        _check_point("fixed", name, known)
        require(fixed.count(name) == 1, "fixed", quoted(name), "named once")
    pieces = _read_pieces(content, kind, known)
    return Figure(kind, points, tuple(fixed), pieces, on_pieces)


def _read_points_on(
    content: Mapping[str, Any], kind: FigureKind[Numbers], points: Mapping[str, object]
) -> dict[str, PointOnPiece[Numbers]]:
    key = f"points_on_{kind.noun}s"
    shape = f'["A", "B", {kind.numbers}]'
    table = checked_table(key, content.get(key, {}), f"a table of points {shape}")
    on_pieces: dict[str, PointOnPiece[Numbers]] = {}
    for name, row in table.items():
        what = f"{key} {name}"
        is_new = name not in points
        require(is_new, what, quoted(name), "no name of a point in [points]")
        checked_list(what, row, f"a list {shape}", (3,))
        for end in row[:2]:
            is_known = end in points or end in on_pieces
            require(is_known, what, quoted(end), "a point that stands before it")
        numbers = kind.read_numbers(what, _numbers(what, row[2]))
        on_pieces[name] = PointOnPiece(row[0], row[1], numbers)
    return on_pieces


def _read_pieces(
    content: Mapping[str, Any], kind: FigureKind[Any], known: Sequence[str]
) -> tuple[Piece, ...]:
    key = f"{kind.noun}s"
    rows = checked_list(key, content.get(key), f'a list of {key} ["A", "B"]', SOME)
    pieces: list[Piece] = []
    for number, row in enumerate(rows, start=1):
        what = f"{key}[{number}]"
        checked_list(what, row, f'["A", "B"] or ["A", "B", {kind.measure}]', (2, 3))
        for name in row[:2]:
            _check_point(what, name, known)
        allowed = f"{kind.piece} between two points"
        require(row[0] != row[1], what, row[:2], allowed)
        is_new = all(set(piece.ends) != set(row[:2]) for piece in pieces)
        require(is_new, what, row[:2], f"{kind.piece} that stands there once")
        measure = None
        if len(row) == 3:
            of_piece = f"{kind.measure} of {what}"
            measure = kind.read_measure(of_piece, _numbers(of_piece, row[2]))
        pieces.append(Piece(row[0], row[1], measure))
    check_joined_names(kind.noun, [piece.ends for piece in pieces])
    return tuple(pieces)


def _check_point(what: str, name: object, known: Sequence[str]) -> None:
    """Raise `GeometryError` for what is none of the ``known`` points."""
    allowed = f"one of the points {', '.join(known)}"
    require(name in known, what, quoted(name), allowed)


# --- assembly -------------------------------------------------------------------------

RANK = 1e-9  # singular value, over the largest, of a motion: no step along it


def polished(
    gaps: Callable[[np.ndarray], np.ndarray],
    derivatives: Callable[[np.ndarray], np.ndarray],
    values: np.ndarray,
    steps: int,
) -> np.ndarray:
    """The ``values`` (n,) after so many steps of Newton's method at most, as long as
    they make ``gaps`` (m,) with these ``derivatives`` (m, n) smaller."""
    for _ in range(steps):
        now = gaps(values)
        trial = values - np.linalg.lstsq(derivatives(values), now, rcond=RANK)[0]
        if not np.linalg.norm(gaps(trial)) < np.linalg.norm(now):
            break
        values = trial
    return values


# --- names ----------------------------------------------------------------------------


def joined_name(first: str, second: str) -> str:
    """What a body between two points or joints is called: "A-B"."""
    return f"{first}-{second}"


def check_joined_names(noun: str, ends: Iterable[tuple[str, str]]) -> None:
    """Raise `GeometryError` where bodies, each a ``noun``, between different ``ends``
    have one name: "A-B" and "C" make the name of "A" and "B-C"."""
    owners: dict[str, tuple[str, str]] = {}
    for pair in ends:
        name = joined_name(*pair)
        other = owners.setdefault(name, pair)
        ends_of_both = [f'"{first}" to "{second}"' for first, second in (other, pair)]
        what = f"names of {noun}s {' and '.join(ends_of_both)}"
        allowed = "different; call their ends otherwise"
        require(other == pair, what, f'"{name}"', allowed)


# --- joints and bodies ----------------------------------------------------------------


def joints_of_figure(
    figure: Figure[Place, Any],
    places: Mapping[str, Place],
    hold_together: Callable[[Sequence[str], Sequence[str]], bool],
    joint_at: Callable[[str, tuple[str, ...], Place], Joint],
) -> tuple[Joint, ...]:
    """A joint at every point on two bodies or more.

    ``hold_together`` says whether the points of two bodies make these one, ``joint_at``
    gives the joint of a name between bodies at a place. Raises `GeometryError` for a point
    on no body, and where no points are fixed and a body hangs on one joint.
    """
    bodies = bodies_of_figure(figure, hold_together)
    kind = figure.kind
    on_body = {point for points in bodies.values() for point in points}
    for name, one in figure.on_pieces.items():
        ends = f"{one.start} and {one.end}"
        allowed = f"on {kind.piece}; there is none between {ends}"
        what = f"points_on_{kind.noun}s {name}"
        require(name in on_body, what, ends, allowed)
    joints = []
    for name, place in places.items():
        value, allowed = f"on no {kind.noun}", f"the end of {kind.piece}"
        require(name in on_body, f"point {name}", value, allowed)
        here = tuple(body for body, points in bodies.items() if name in points)
        if len(here) > 1:
            joints.append(joint_at(name, here, place))
    counts = Counter(body for joint in joints for body in joint.bodies)
    for body, count in counts.items():
        allowed = (
            "given, the names of the points that hold the frame; without a frame "
            f"{body} hangs on one joint only"
        )
        is_held = bool(figure.fixed) or count > 1
        require(is_held, "fixed", "a missing key or an empty list", allowed)
    return tuple(joints)


def bodies_of_figure(
    figure: Figure[Any, Any],
    hold_together: Callable[[Sequence[str], Sequence[str]], bool],
) -> dict[str, list[str]]:
    """The points on every body, the frame first.

    A piece between two points of one body is rigid with it, and no body of its own,
    wherever it stands.
    """
    bodies: dict[str, list[str]] = {}
    if figure.fixed:
        bodies[FRAME] = list(figure.fixed)
    _add_points_on(bodies, figure)
    bodies |= {piece.name: list(piece.ends) for piece in figure.pieces}
    _add_points_on(bodies, figure)
    while (pair := _held_together(bodies, hold_together)) is not None:
        first, second = pair
        others = bodies.pop(second)
        bodies[first] += [point for point in others if point not in bodies[first]]
        _add_points_on(bodies, figure)
    return bodies


def _held_together(
    bodies: dict[str, list[str]],
    hold_together: Callable[[Sequence[str], Sequence[str]], bool],
) -> tuple[str, str] | None:
    """Two bodies that points hold together; None where there are none.

    The one that gives both its name is the frame, or the one with the most points, so
    that it does not depend on the order of the pieces.
    """
    ranked = sorted(bodies, key=lambda name: (name != FRAME, -len(bodies[name])))
    for first, second in combinations(ranked, 2):
        if hold_together(bodies[first], bodies[second]):
            return first, second
    return None


def _add_points_on(bodies: dict[str, list[str]], figure: Figure[Any, Any]) -> None:
    """Add the points on pieces to the body that holds both ends of their piece."""
    for name, one in figure.on_pieces.items():
        for points in bodies.values():
            if {one.start, one.end} <= set(points) and name not in points:
                points.append(name)
