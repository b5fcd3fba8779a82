"""What is drawn of a mechanism: the lines of its bodies and the symbols of its joints,
in the reference configuration, in characteristic lengths."""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.mechanisms.joint import Joint, JointKind, Place
from linkages.mechanisms.mechanism import Mechanism, Pair
from linkages.readout.poses import Poses
from linkages.scene import View, breadth, clearest_view
from linkages.structure.structure import Structure

SAME = 1e-6  # characteristic lengths: places that are closer are drawn as one
ASIDE = 0.7  # how far along its axis a joint is drawn that would cover another one
RAIL_END = 0.15  # how far a rail goes on beyond the places that the slide comes to
ENOUGH_OF_AN_AXIS = 0.35  # of its length: showing more of it makes no view better
MOST_SPOTS = 60  # joints that are looked at for the best view
OVER_A_SHEET = View(elevation=60.0, azimuth=-90.0)  # x is to the right
TRIANGLE = 3  # joints of a body that is drawn as a polygon; one of more is a star

Segment: TypeAlias = list[list[float]]
Drawing: TypeAlias = dict[str, Any]  # values that JSON can hold


class _Sides(NamedTuple):
    """The bodies of a slide: the one that has the rail and the one that moves along
    it; the sign says whether the latter is the moved body of the pair."""

    rail: str
    box: str
    sign: int


# --- bodies ---------------------------------------------------------------------------


def draw_bodies(structure: Structure, points: np.ndarray) -> list[Drawing]:
    """The ``name`` of every body, its ``lines`` (from, to), and the ``panels``, each a
    polygon by its corners. Lines go straight from joint to joint, as triangles, as stars
    where joints are more, and as rails that are as long as slides are used at ``points``
    (k, n)."""
    mechanism = structure.mechanism
    places = _places(structure)
    rails = _rails(structure, points, places)
    panels: dict[str, list[Segment]] = {body: [] for body in mechanism.bodies}
    for panel in mechanism.panels:
        corners = np.array(panel.corners) / structure.unit
        panels[panel.body].append(corners.tolist())
    drawings: list[Drawing] = []
    for body, numbers in joints_of_bodies(mechanism).items():
        lines = _lines(places[numbers]) + rails.get(body, [])
        drawings.append({"name": body, "lines": lines, "panels": panels[body]})
    return drawings


def joints_of_bodies(mechanism: Mechanism) -> dict[str, list[int]]:
    """The numbers of the joints of every body."""
    numbers = {joint.name: number for number, joint in enumerate(mechanism.joints)}
    return {
        body: [numbers[joint.name] for joint in mechanism.joints_of[body]]
        for body in mechanism.bodies
    }


def _lines(places: np.ndarray) -> list[Segment]:
    """The lines between the places (k, 3) of the joints of a body."""
    corners: list[np.ndarray] = []
    for place in places:
        if all(np.linalg.norm(place - one) > SAME for one in corners):
            corners.append(place)
    if len(corners) <= 1:
        return []
    if len(corners) <= TRIANGLE:
        around = pairwise([*corners, corners[0]])
        sides = list(around)[: len(corners) if len(corners) == TRIANGLE else 1]
        return [_segment(start, end) for start, end in sides]
    middle = np.mean(corners, axis=0)
    return [
        _segment(middle, corner)
        for corner in corners
        if np.linalg.norm(corner - middle) > SAME
    ]


def _segment(start: np.ndarray, end: np.ndarray) -> Segment:
    return [start.tolist(), end.tolist()]


def _rails(
    structure: Structure, points: np.ndarray, places: np.ndarray
) -> dict[str, list[Segment]]:
    """The rails on every body that has any."""
    mechanism = structure.mechanism
    numbers = {joint.name: k for k, joint in enumerate(mechanism.joints)}
    rails: dict[str, list[Segment]] = {}
    for pair in mechanism.pairs:
        number = numbers[pair.joint]
        joint = mechanism.joints[number]
        if not joint.kind.facets.has_rail:
            continue
        sides = _sides(mechanism, pair)
        shifts = sides.sign * _shifts(structure, pair, points)
        along = joint.motions[0].direction
        low = places[number] + (min(0.0, shifts.min()) - RAIL_END) * along
        high = places[number] + (max(0.0, shifts.max()) + RAIL_END) * along
        rails.setdefault(sides.rail, []).append(_segment(low, high))
    return rails


def _shifts(structure: Structure, pair: Pair, points: np.ndarray) -> np.ndarray:
    """How far a pair has slid at ``points`` (k, n), in characteristic lengths."""
    total = np.zeros(len(points))
    for number in pair.variables:
        advance = structure.mechanism.variables[number].motion.advance
        total += advance * structure.values(points, number) / structure.unit
    return total


def _sides(mechanism: Mechanism, pair: Pair) -> _Sides:
    """The frame has the rail; elsewhere the base of the pair has it."""
    if pair.moved == mechanism.frame:
        return _Sides(pair.moved, pair.base, -1)
    return _Sides(pair.base, pair.moved, 1)


# --- joints ---------------------------------------------------------------------------


def draw_symbols(structure: Structure) -> list[Drawing]:
    """The symbols of all joints but creases that are held flat: one for every pair of
    bodies, but for joints whose bodies share one.

    Each has the ``kind`` of its joint and its ``place`` on its body, the ``holder``;
    ``directions`` holds that of the axis, the slide or the normal, with the second one
    of a universal joint, which is on the ``other`` body, and none where a joint has
    none. ``columns`` are the unknowns of the joint; None where what it does is not
    among them. A joint between several bodies has its ``label`` once, on the first
    symbol.
    """
    mechanism = structure.mechanism
    places = _places(structure)
    symbols: list[Drawing] = []
    first = 0
    for number, joint in enumerate(mechanism.joints):
        pairs = range(first, first + len(joint.bodies) - 1)
        first += len(pairs)
        if structure.creases_held_flat.intersection(joint.labels):
            continue
        groups = [pairs] if joint.kind.facets.is_shared else [[pair] for pair in pairs]
        for k, group in enumerate(groups):
            label = joint.name if k == 0 else ""
            symbols.append(_symbol(structure, label, list(group), places[number]))
    return symbols


def _symbol(
    structure: Structure, label: str, pairs: list[int], place: np.ndarray
) -> Drawing:
    mechanism = structure.mechanism
    pair = mechanism.pairs[pairs[0]]
    joint = mechanism.joint(pair.joint)
    holder, other = pair.base, pair.moved
    if joint.kind.facets.has_rail:
        sides = _sides(mechanism, pair)
        holder, other = sides.box, sides.rail
    elif joint.kind is JointKind.PLANAR:
        holder, other = pair.moved, pair.base
    return {
        "label": label,
        "kind": joint.kind.value,
        "place": place.tolist(),
        "directions": _directions(joint),
        "holder": mechanism.bodies.index(holder),
        "other": mechanism.bodies.index(other),
        "columns": _columns(structure, pairs),
    }


def _directions(joint: Joint) -> list[list[float]]:
    if joint.kind is JointKind.PLANAR:
        return [joint.motions[-1].direction.tolist()]
    turns = (
        joint.motions[:2] if joint.kind is JointKind.UNIVERSAL else joint.motions[:1]
    )
    return [motion.direction.tolist() for motion in turns]


def _columns(structure: Structure, pairs: list[int]) -> list[int] | None:
    """The unknowns of some pairs; None for a spherical joint that is cut."""
    columns: list[int] = []
    for number in pairs:
        pair = structure.mechanism.pairs[number]
        if pair.center is not None:
            if number not in structure.embedded:
                return None
            columns += structure.embedded[number]
        free = [k for k in pair.variables if k in structure.column_of]
        columns += [structure.column_of[k] for k in free]
    return columns


# --- places ---------------------------------------------------------------------------


def _places(structure: Structure) -> np.ndarray:
    """Where each of the k joints is drawn (k, 3): on its axis, so that bodies are
    short, and apart from the others of its bodies; between panels, in the middle of
    their hinge."""
    mechanism = structure.mechanism
    places = _shortest_places(structure)
    sheets = _sheets(mechanism)
    for number, joint in enumerate(mechanism.joints):
        if joint.kind.facets.place is Place.ALONG and sheets.keys() >= {*joint.bodies}:
            joined = [sheets[body] for body in joint.bodies]
            places[number] = _middle_of_hinge(joint, joined) / structure.unit
        if joint.kind.facets.place is not Place.ANYWHERE:
            continue
        if joint.point is not None:
            places[number] = joint.place / structure.unit
        elif mechanism.frame in joint.bodies:
            # the middle of the other joints of the body that slides in the frame
            slider = next(body for body in joint.bodies if body != mechanism.frame)
            own = joints_of_bodies(mechanism)[slider]
            others = [k for k in own if k != number]
            places[number] = places[others].mean(axis=0)
    apart: np.ndarray = places + _steps_aside(mechanism, places)
    return apart


def _shortest_places(structure: Structure) -> np.ndarray:
    """The points (k, 3) of joints between which bodies are short; a turn and a slide that
    are one cylindrical joint have one."""
    joints = structure.mechanism.joints
    numbers = {joint.name: number for number, joint in enumerate(joints)}
    size = structure.size
    places = np.zeros((len(joints), 3))
    for place, point in zip(size.places, size.points, strict=True):
        places[[numbers[name] for name in place.joints]] = point / structure.unit
    return places


def _sheets(mechanism: Mechanism) -> dict[str, np.ndarray]:
    """The corners (m, 3) of all panels of every body that has any."""
    corners: dict[str, list[np.ndarray]] = {}
    for panel in mechanism.panels:
        corners.setdefault(panel.body, []).append(np.array(panel.corners))
    return {body: np.concatenate(parts) for body, parts in corners.items()}


def _middle_of_hinge(joint: Joint, sheets: list[np.ndarray]) -> np.ndarray:
    """The middle (3,) of the stretch of an axis along which all ``sheets``, by their
    corners (m, 3), have an edge: the corners that are nearest to it, as hinges of thick
    panels lie beside the paper."""
    direction = joint.motions[0].direction
    ends = []
    for corners in sheets:
        offsets = corners - joint.place
        along = offsets @ direction
        away = np.linalg.norm(offsets - np.outer(along, direction), axis=1)
        edge = along[away < away.min() + SAME * np.ptp(along)]
        ends.append((edge.min(), edge.max()))
    low, high = np.array(ends).T
    middle: np.ndarray = joint.place + (low.max() + high.min()) / 2 * direction
    return middle


def _steps_aside(mechanism: Mechanism, places: np.ndarray) -> np.ndarray:
    """By how much (k, 3) joints are drawn farther out on their axes, where two axes of
    a body meet and their joints would be in one place (k, 3)."""
    steps = np.zeros_like(places)
    joined: set[tuple[int, int]] = set()
    for numbers in joints_of_bodies(mechanism).values():
        joined.update(combinations(numbers, 2))
    for first, second in sorted(joined):
        if np.linalg.norm(places[first] - places[second]) > SAME:
            continue
        joints = mechanism.joints[first], mechanism.joints[second]
        if any(joint.kind.facets.place is Place.ANYWHERE for joint in joints):
            continue
        for number, joint in zip((first, second), joints, strict=True):
            if joint.kind.facets.place is Place.ALONG:
                steps[number] = ASIDE * joint.motions[0].direction
    return steps


# --- where to look from ---------------------------------------------------------------


def held_body(mechanism: Mechanism) -> str:
    """The body that is drawn at rest: the frame, or, of a sheet of panels, the one with
    the panel nearest to their middle, so that the others do not swing far."""
    if not mechanism.panels:
        return mechanism.frame
    middles = np.array([np.mean(one.corners, axis=0) for one in mechanism.panels])
    away = np.linalg.norm(middles - middles.mean(axis=0), axis=1)
    nearest = int(np.argmax(away < (1 + SAME) * away.min() + SAME))
    return mechanism.panels[nearest].body


def breadths_of_mechanism(structure: Structure, points: np.ndarray) -> np.ndarray:
    """The lesser extents (k,) of where joints are at configurations (k, n), in
    characteristic lengths: small where they are nearly on one line."""
    seats = _Seats(structure)
    poses = Poses(structure).at(points)
    return np.array([breadth(seats.at(pose)) for pose in poses])


def best_view_of_mechanism(structure: Structure, point: np.ndarray) -> View:
    """From where the joints of a configuration (n,) are seen farthest apart, the held
    body at rest; some of them where they are many. A sheet that lies flat is seen as it is
    drawn, from above and in front."""
    mechanism = structure.mechanism
    poses = Poses(structure).at(point[None])[0]
    held = mechanism.bodies.index(held_body(mechanism))
    poses = np.linalg.inv(poses[held]) @ poses
    seats = _Seats(structure)
    spots = seats.at(poses)
    if mechanism.panels and np.ptp(spots[:, 2]) < SAME:
        return OVER_A_SHEET
    axes = []
    for joint, holder in zip(mechanism.joints, seats.holders, strict=True):
        if joint.kind.facets.place is Place.ALONG:
            axes.append(poses[holder, :3, :3] @ joint.motions[0].direction)
    every = -(-len(spots) // MOST_SPOTS)
    clarity = _Clarity(spots[::every], np.array(axes[::every]).reshape(-1, 3))
    return clearest_view(clarity)


class _Seats:
    """Where joints are drawn, each on the first of its bodies, of these numbers, the
    ``holders``."""

    def __init__(self, structure: Structure) -> None:
        self._places = _places(structure)
        self._unit = structure.unit
        numbers = {body: k for k, body in enumerate(structure.mechanism.bodies)}
        self.holders = [numbers[one.bodies[0]] for one in structure.mechanism.joints]

    def at(self, poses: np.ndarray) -> np.ndarray:
        """The places (k, 3) with bodies in these poses (b, 4, 4)."""
        own = poses[self.holders]
        turned = np.einsum("kij,kj->ki", own[:, :3, :3], self._places)
        return np.asarray(turned + own[:, :3, 3] / self._unit)


class _Clarity:
    """How well joints at ``spots`` (k, 3) are told apart, and how much is seen of every
    one of their ``axes`` (m, 3), unit vectors, along a look (3,)."""

    def __init__(self, spots: np.ndarray, axes: np.ndarray) -> None:
        self._spots, self._axes = spots, axes
        self._first, self._second = np.triu_indices(len(spots), 1)
        real = self._distances(spots)
        self._is_apart = real > SAME
        self._size = float(real.max(initial=SAME))

    def __call__(self, look: np.ndarray) -> float:
        seen = self._spots - np.outer(self._spots @ look, look)
        shown = self._distances(seen)[self._is_apart]
        closest = float(shown.min(initial=self._size)) / self._size
        end_on = float(np.abs(self._axes @ look).max(initial=0.0))
        visible = float(np.sqrt(max(1.0 - end_on**2, 0.0)))
        spread = 4 * closest + 4 * breadth(seen) / self._size
        return spread + min(visible, ENOUGH_OF_AN_AXIS)

    def _distances(self, places: np.ndarray) -> np.ndarray:
        gaps = places[self._first] - places[self._second]
        return np.asarray(np.linalg.norm(gaps, axis=1))
