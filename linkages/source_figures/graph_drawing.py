"""Assemblies as graphs: the loop on a circle, joints on links where they stand there,
all others in the middle of their neighbours (Tutte 1963), links with their names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import networkx as nx
import numpy as np
from matplotlib.axes import Axes
from matplotlib.textpath import TextPath

from linkages.source_figures.assembly import Assembly, Bar, Role, Seat
from linkages.source_figures.drawing import LINK_COLORS, LINK_DASHES, write_at

SHORTEST = 0.2  # of a drawn link: the least distance of a joint on it from its ends
SEPARATION = 0.55  # joints inside the ring, at least, where the ring has radius 1
PUSHES = 20
# of a link, where its name may stand
FRACTIONS = np.array([0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18])
LETTER = 0.07  # the width of a letter of a name, where the ring has radius 1
BESIDE = 0.13  # from a link of the ring to its name
ENOUGH = 0.35  # room for a name, where the ring has radius 1
FURTHEST = 1.45  # of a drawn link: how far beyond it a joint is drawn
NAME_SIZE = 7.5  # points
ROOM_AT_EDGE = 4  # points, between a name and the edge of the panel
LETTER_ROOM = 0.3  # that a letter needs, where the ring has radius 1
LETTER_STEP = 0.16  # how far a letter may move aside, where the ring has radius 1
LETTER_PLACES = 8  # around where it belongs


def places_of(assembly: Assembly, ring: Sequence[str]) -> dict[str, np.ndarray]:
    """Where each joint stands (2,): those of the ``ring`` on a circle, those with a seat
    on their link, every other one in the middle of its neighbours."""
    start = np.pi / 2 + np.pi / len(ring)
    angles = start - 2 * np.pi * np.arange(len(ring)) / len(ring)
    places = {}
    for name, angle in zip(ring, angles, strict=True):
        places[name] = np.array([np.cos(angle), np.sin(angle)])
    for name, seat in assembly.seats.items():
        if name in places:
            continue
        begin = places[seat.first]
        places[name] = begin + _drawn_fraction(seat) * (places[seat.last] - begin)
    inner = [name for name in assembly.axes if name not in places]
    if inner:
        middles = _in_the_middle(assembly, inner, places)
        places.update(_separated(middles))
    return places


def _drawn_fraction(seat: Seat) -> float:
    """Where on a link a joint is drawn: beside the ends, not on them."""
    if seat.fraction > 1:
        return float(np.clip(seat.fraction, 1 + SHORTEST, FURTHEST))
    return float(np.clip(seat.fraction, SHORTEST, 1 - SHORTEST))


def _in_the_middle(
    assembly: Assembly, inner: list[str], places: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """The places of the ``inner`` joints, each in the middle of its neighbours, the
    others standing where they are."""
    graph = nx.Graph()
    graph.add_nodes_from(assembly.axes)
    graph.add_edges_from((bar.first, bar.last) for bar in assembly.bars)
    outer = list(places)
    laplacian = nx.laplacian_matrix(graph, nodelist=[*inner, *outer]).toarray()
    count = len(inner)
    pull = -laplacian[:count, count:] @ np.array([places[name] for name in outer])
    solved = np.linalg.solve(laplacian[:count, :count], pull)
    return dict(zip(inner, solved, strict=True))


def _separated(places: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The places with those that are too close moved away from each other; those that
    are one move up and down."""
    out = {name: place.copy() for name, place in places.items()}
    names = list(out)
    for _ in range(PUSHES):
        for i, first in enumerate(names):
            for second in names[i + 1 :]:
                gap = out[first] - out[second]
                distance = float(np.linalg.norm(gap))
                if distance >= SEPARATION:
                    continue
                is_one = distance < 1e-6
                direction = np.array([0.0, 1.0]) if is_one else gap / distance
                push = 0.5 * (SEPARATION - distance) * direction
                out[first] += push
                out[second] -= push
    return out


def draw_graph(
    axes: Axes,
    assembly: Assembly,
    ring: Sequence[str],
    letters: Mapping[str, str],
    *,
    filled: Sequence[str] = (),
    unnumbered: Sequence[str] = (),
) -> None:
    """Draw the graph of an assembly; ``letters`` name parts of it, each in the middle
    of its joints, as "1 2 X"."""
    places = places_of(assembly, ring)
    taken = list(places.values())  # joints, and names that stand already
    inner: list[tuple[np.ndarray, str]] = []  # links whose names stand on them
    half = max(1.5, float(np.abs(taken).max()) + 0.2)
    for bar in assembly.bars:
        ends = np.array([places[bar.first], places[bar.last]])
        axes.plot(
            *ends.T,
            color=LINK_COLORS[bar.role],
            linestyle=LINK_DASHES[bar.role],
            linewidth=1.4 if bar.role is Role.REMOVED else 2.2,
            zorder=1,
        )
        if not bar.label:
            continue
        if bar.role is not Role.REMOVED and _are_neighbours(ring, bar):
            name = _name_outside(axes, ends, bar.label, half)
            half = max(half, name.half)
            taken += _letters_at(name.place, bar.label, name.side)
        else:
            inner.append((ends, bar.label))
    for ends, label in inner:
        taken += _name_link(axes, ends, label, np.array(taken))
    for joint, place in places.items():
        text = "" if joint in unnumbered else joint
        _draw_joint(axes, place, text, joint in filled)
    for letter, joints in letters.items():
        middle = np.mean([places[name] for name in joints.split()], axis=0)
        place = _place_of_letter(middle, np.array(taken))
        write_at(axes, place, letter, fontsize=11, zorder=4)
    axes.set_aspect("equal")
    axes.set(xlim=(-half, half), ylim=(-half, half))
    axes.set_axis_off()


def _are_neighbours(ring: Sequence[str], bar: Bar) -> bool:
    """Whether a bar is a side of the ring."""
    sides = zip(ring, [*ring[1:], ring[0]], strict=True)
    return {bar.first, bar.last} in [set(side) for side in sides]


def _draw_joint(axes: Axes, place: np.ndarray, text: str, is_filled: bool) -> None:
    """A joint as a circle with its name in it, a small one without a name."""
    axes.plot(
        *place,
        "o",
        markersize=14 if text else 5,
        markerfacecolor="black" if is_filled else "white",
        markeredgecolor="black",
        markeredgewidth=1.0,
        zorder=3,
    )
    color = "white" if is_filled else "black"
    write_at(axes, place, text, fontsize=NAME_SIZE, color=color, zorder=4)


def _place_of_letter(middle: np.ndarray, taken: np.ndarray) -> np.ndarray:
    """Where a letter stands (2,): in the middle of its joints, or beside that where it
    would cover what is ``taken`` (k, 2)."""
    angles = 2 * np.pi * np.arange(LETTER_PLACES) / LETTER_PLACES
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    places = np.vstack([middle, middle + LETTER_STEP * ring])
    room = np.linalg.norm(places[:, None] - taken, axis=2).min(axis=1)
    best = int(np.argmax(np.round(np.minimum(room, LETTER_ROOM), 6)))
    return np.asarray(places[best])


class _Name(NamedTuple):
    """Where a name stands (2,), to which ``side`` of the place, and half the width that
    its panel must have for it, where the ring has radius 1."""

    place: np.ndarray
    side: str
    half: float


def _letters_at(place: np.ndarray, label: str, side: str) -> list[np.ndarray]:
    """Where the letters of a name are, each (2,)."""
    width = LETTER * len(label)
    begin = {"left": 0.0, "center": -0.5 * width, "right": -width}[side]
    steps = np.linspace(begin, begin + width, len(label))
    return [place + np.array([step, 0.0]) for step in steps]


def _name_outside(axes: Axes, ends: np.ndarray, label: str, half: float) -> _Name:
    """The name of a link of the ring, just written beside it: in two lines where it
    would not fit into a panel of ``half`` the width."""
    middle = ends.mean(axis=0)
    away = middle / max(float(np.linalg.norm(middle)), 1e-9)
    sides = {-1: "right", 0: "center", 1: "left"}
    side = sides[int(np.sign(away[0]) * (abs(away[0]) > 0.3))]
    place = middle + BESIDE * away
    text = label
    if _half_width(axes, place, [label], side) > half:
        text = label.replace("/", "/\n", 1)
    write_at(axes, place, text, ha=side, fontsize=NAME_SIZE)
    return _Name(place, side, _half_width(axes, place, text.split("\n"), side))


def _half_width(axes: Axes, place: np.ndarray, lines: list[str], side: str) -> float:
    """Half the width of a panel that has room for some lines to one side of a place
    (2,)."""
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    panel = 72 * figure.get_figwidth() * axes.get_position(original=True).width
    paths = [TextPath((0, 0), line, size=NAME_SIZE) for line in lines]
    width = max(path.get_extents().width for path in paths) + ROOM_AT_EDGE
    share = 0.5 if side == "center" else 1.0
    return float(abs(place[0]) / (1 - 2 * share * width / panel))


def _name_link(
    axes: Axes, ends: np.ndarray, label: str, taken: np.ndarray
) -> list[np.ndarray]:
    """Where the letters (2,) are of the name of a link that has just been written on its
    line: where it is furthest from what is ``taken`` (k, 2)."""
    places = ends[0] + FRACTIONS[:, None] * (ends[1] - ends[0])
    names = [np.array(_letters_at(place, label, "center")) for place in places]
    rooms = [np.linalg.norm(name[:, None] - taken, axis=2).min() for name in names]
    best = int(np.argmax(np.round(np.minimum(rooms, ENOUGH), 6)))
    box = {"boxstyle": "square,pad=0.12", "facecolor": "white", "linewidth": 0}
    write_at(axes, places[best], label, fontsize=NAME_SIZE, zorder=2, bbox=box)
    return list(names[best])
