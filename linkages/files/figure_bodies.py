"""Bodies of figures of points and pieces between them: bars in a plane, arcs on a
sphere."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from linkages.mechanisms.joint import Joint
from linkages.values import GeometryError, quoted

FRAME = "frame"


class Piece(NamedTuple):
    """The points at the ends of a bar or an arc."""

    start: str
    end: str


def read_fixed(content: Mapping[str, object], known: Sequence[str]) -> tuple[str, ...]:
    """The fixed points of a file; raises `GeometryError`."""
    fixed = content.get("fixed", [])
    if not isinstance(fixed, list):
        raise GeometryError("fixed", quoted(fixed), "a list of names of points")
    for name in fixed:
        check_point("fixed", name, known)
        if fixed.count(name) > 1:
            raise GeometryError("fixed", quoted(name), "named once")
    return tuple(fixed)


def check_held(fixed: Sequence[str], joints: Sequence[Joint]) -> None:
    """Raise `GeometryError` where no points are ``fixed`` and a body hangs on one joint
    for want of a frame."""
    if fixed:
        return
    counts = Counter(body for joint in joints for body in joint.bodies)
    for body, count in counts.items():
        if count < 2:
            allowed = (
                "given, the names of the points that hold the frame; without a frame "
                f"{body} hangs on one joint only"
            )
            raise GeometryError("fixed", "a missing key or an empty list", allowed)


def check_point(what: str, name: object, known: Sequence[str]) -> None:
    """Raise `GeometryError` for what is none of the ``known`` points."""
    if name not in known:
        allowed = f"one of the points {', '.join(known)}"
        raise GeometryError(what, quoted(name), allowed)


def bodies_of_figure(
    fixed: Sequence[str],
    pieces: Mapping[str, Piece],
    on_pieces: Mapping[str, Piece],
    are_apart: Callable[[Sequence[str]], bool],
) -> dict[str, list[str]]:
    """The points on every body, the frame, which holds the ``fixed`` ones, first.

    ``pieces`` are bodies by name; ``on_pieces`` are points that are rigid with the body
    that holds two others. A piece between two points of one body is rigid with it, and
    no body of its own, wherever it stands; ``are_apart`` says whether points hold two
    bodies together.
    """
    bodies: dict[str, list[str]] = {}
    if fixed:
        bodies[FRAME] = list(fixed)
    _add_points_on(bodies, on_pieces)
    bodies |= {name: list(piece) for name, piece in pieces.items()}
    _add_points_on(bodies, on_pieces)
    return _without_parts(bodies, on_pieces, are_apart)


def _without_parts(
    bodies: dict[str, list[str]],
    on_pieces: Mapping[str, Piece],
    are_apart: Callable[[Sequence[str]], bool],
) -> dict[str, list[str]]:
    """The bodies, those that points hold together as one.

    That is called as the frame is, or as the one with the most points, so that it does
    not depend on the order of the pieces.
    """
    ranked = sorted(bodies, key=lambda name: (name != FRAME, -len(bodies[name])))
    for first, second in combinations(ranked, 2):
        common = [point for point in bodies[first] if point in bodies[second]]
        if not are_apart(common):
            continue
        joined = dict(bodies)
        others = joined.pop(second)
        new = [point for point in others if point not in joined[first]]
        joined[first] = joined[first] + new
        _add_points_on(joined, on_pieces)
        return _without_parts(joined, on_pieces, are_apart)
    return bodies


def _add_points_on(
    bodies: dict[str, list[str]], on_pieces: Mapping[str, Piece]
) -> None:
    """Add the points on pieces to the body that holds both ends of their piece."""
    for name, piece in on_pieces.items():
        for points in bodies.values():
            if set(piece) <= set(points) and name not in points:
                points.append(name)
