"""What moves, as lines on bodies that joints let move: the links of a loop, or the bodies
of a mechanism. Distances, models and pages are made of them alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from bifurc.atlas import Form
from bifurc.branch import Branch
from bifurc.isometry import Isometry
from linkages.decisions import is_parallel_axis
from linkages.geometry_table import link_name
from linkages.links.distances import MARGIN, largest_rates, places_along
from linkages.links.mechanism_drawing import (
    Drawing,
    best_view_of_mechanism,
    breadths_of_mechanism,
    draw_bodies,
    draw_symbols,
    held_body,
)
from linkages.links.motion_document import describe_motion, has_tape
from linkages.links.rods import link_corners, seat_heights
from linkages.loop import Loop
from linkages.mechanisms.joint import JointKind, Shape
from linkages.readout.poses import Poses
from linkages.scene import View, best_view, breadth, make_scene, view_of_plane
from linkages.structure.plane import normal_of_plane
from linkages.structure.structure import Structure

STEP = 1e-5  # rad, along a branch: of the differences that are taken for speeds
UPWARD = np.array([0.0, 0.0, 1.0])
UPRIGHT = np.eye(3)
OF_EXTENT, OF_BODY = 0.03, 0.09  # the radius of a joint, in what it is drawn in
FLAT = 1e-9  # sine of a twist of a planar loop

Pair: TypeAlias = tuple[int, int]  # of bodies, by their numbers


class Symbol(NamedTuple):
    """A joint on a body: its ``place`` (3,), and its ``direction`` (3,), a unit
    vector; ``bodies`` are those that it joins, the one that has the symbol first, of a
    slide the one that has the rail second."""

    name: str
    shape: Shape
    place: np.ndarray
    direction: np.ndarray
    bodies: tuple[int, ...]

    def is_on(self, body: int) -> bool:
        """Whether it joins this body."""
        return body in self.bodies


class Parts(ABC):
    """Bodies by their ``names``, of a characteristic length, their ``size``; the body
    number ``frame`` is at rest. ``word`` is what all are called, ``whole`` what they make
    together, ``full_names`` what each is where it stands alone. Lengths are in the
    user's unit, and every body has its own frame."""

    word: str
    whole: str
    names: Sequence[str]
    full_names: Sequence[str]
    size: float
    frame: int

    @property
    def held(self) -> int:
        """The body that is drawn at rest."""
        return self.frame

    @property
    @abstractmethod
    def normal(self) -> np.ndarray | None:
        """The unit normal (3,) of the plane in which all move, where there is one, in
        the frame of the body that is drawn at rest."""

    def panels(self, body: int) -> list[np.ndarray]:
        """The panels of a body by their corners (k, 3)."""
        return []

    @abstractmethod
    def breadths(self, points: np.ndarray) -> np.ndarray:
        """The lesser extents (k,) of where joints are at configurations (k, n): small
        where they are nearly on one line."""

    @abstractmethod
    def lines(self, points: np.ndarray) -> list[np.ndarray]:
        """The lines (m, 2, 3) of every body, rails as long as slides are used at
        configurations (k, n)."""

    @abstractmethod
    def poses(self, points: np.ndarray) -> np.ndarray:
        """The transforms (k, b, 4, 4) of all bodies at configurations (k, n)."""

    @abstractmethod
    def symbols_on(self, body: int) -> list[Symbol]:
        """The symbols of joints that a body carries."""

    def symbols_at(self, point: np.ndarray) -> list[Symbol]:
        """The symbols of all joints, where they are at a configuration (n,), the held
        body at rest."""
        poses = self.poses(point[None])[0]
        symbols = []
        for body, pose in enumerate(np.linalg.inv(poses[self.held]) @ poses):
            for symbol in self.symbols_on(body):
                place = pose[:3, :3] @ symbol.place + pose[:3, 3]
                direction = pose[:3, :3] @ symbol.direction
                symbols.append(symbol._replace(place=place, direction=direction))
        return symbols

    def extent(self, point: np.ndarray, lines: list[np.ndarray]) -> float:
        """How far what is drawn at a configuration (n,) reaches from the first joint:
        the others, and the ends of the ``lines`` of every body."""
        places = [symbol.place for symbol in self.symbols_at(point)]
        poses = self.poses(point[None])[0]
        for pose, own in zip(
            np.linalg.inv(poses[self.held]) @ poses, lines, strict=True
        ):
            places.extend(own.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3])
        distances = np.linalg.norm(np.array(places) - places[0], axis=1)
        return float(distances.max(initial=0.0)) or self.size

    def joint_radius(self, point: np.ndarray, extent: float) -> float:
        """How large a joint is drawn at a configuration (n,): in the ``extent`` of all,
        and smaller where bodies, from joint to joint, are small beside that, as panels
        of a sheet are."""
        symbols = self.symbols_at(point)
        on_body: dict[int, list[np.ndarray]] = {}
        for symbol in symbols:
            for body in symbol.bodies:
                on_body.setdefault(body, []).append(symbol.place)
        sizes = [
            np.linalg.norm(np.ptp(places, axis=0))
            for places in on_body.values()
            if len(places) > 1
        ]
        usual = float(np.median(sizes)) if sizes else np.inf
        return min(OF_EXTENT * extent, OF_BODY * usual)

    @abstractmethod
    def are_joined(self, pair: Pair) -> bool:
        """Whether two bodies share a joint."""

    @abstractmethod
    def closing_speeds(
        self, pairs: Sequence[Pair], lines: list[np.ndarray], branch: Branch
    ) -> list[float]:
        """How fast the lines of each two bodies can near each other for each unit of
        arclength of a branch."""

    @abstractmethod
    def best_view(self, point: np.ndarray) -> View:
        """From where the joints of a configuration (n,) are seen farthest apart."""

    @abstractmethod
    def page(self, points: np.ndarray) -> dict[str, Any]:
        """What a page has to know of them, ``points`` (k, n) being on the map."""

    def form_on_page(self, form: Form, start: float) -> dict[str, Any]:
        """What it has to know of a form besides, which is first shown at a place."""
        return {}

    def pairs_apart(self, lines: list[np.ndarray]) -> list[Pair]:
        """Every two bodies that have lines and share no joint."""
        drawn = [body for body, of_body in enumerate(lines) if len(of_body)]
        pairs = combinations(drawn, 2)
        return [pair for pair in pairs if not self.are_joined(pair)]


class Links(Parts):
    """The links of a ``loop``, to whose joint angles an isometry leads from the unknowns;
    these have ``unknowns`` as names where they are others. Each is given by the joint
    (from 0) that it follows."""

    word = "links"
    whole = "linkage"

    def __init__(
        self,
        loop: Loop,
        to_angles: Isometry,
        unknowns: Sequence[str] = (),
        orientation: np.ndarray = UPRIGHT,
    ) -> None:
        self.orientation = orientation
        self.loop = loop
        self.to_angles = to_angles
        self.unknowns = unknowns
        self.names = [link_name(link, loop.n) for link in range(loop.n)]
        self.full_names = [f"link {name}" for name in self.names]
        self.size = loop.characteristic_length
        self.frame = loop.n - 1

    def lines(self, points: np.ndarray) -> list[np.ndarray]:
        """The rods of every link."""
        corners = link_corners(self.loop)
        return list(np.stack([corners[:, :-1], corners[:, 1:]], axis=2))

    def poses(self, points: np.ndarray) -> np.ndarray:
        """The frames that move with the links."""
        return self.loop.frames(self.to_angles.points(points))[:, 1:]

    def symbols_on(self, body: int) -> list[Symbol]:
        """The joint behind a link, whose axis is the z axis of the link."""
        joint = (body + 1) % self.loop.n
        seat = float(seat_heights(self.loop)[joint]) * UPWARD
        name = f"joint {joint + 1}"
        return [Symbol(name, Shape.CYLINDER, seat, UPWARD, (body, joint))]

    @property
    def normal(self) -> np.ndarray | None:
        """That of parallel axes."""
        sines = np.abs(np.sin(self.loop.arrays.twists))
        return UPWARD if all(map(is_parallel_axis, sines.tolist())) else None

    def breadths(self, points: np.ndarray) -> np.ndarray:
        """Those of the joints in the middle of their offsets."""
        angles = self.to_angles.points(points)
        scenes = [make_scene(self.loop, theta) for theta in angles]
        return np.array([breadth(scene.joints) for scene in scenes])

    def are_joined(self, pair: Pair) -> bool:
        """Whether one follows the other."""
        return pair[1] - pair[0] in (1, self.loop.n - 1)

    def closing_speeds(
        self, pairs: Sequence[Pair], lines: list[np.ndarray], branch: Branch
    ) -> list[float]:
        """Bounds that the geometry gives.

        Only the joints between them move them, either way round; of these a point of a
        closed loop is no farther away than half the way round.
        """
        lengths, _, offsets = self.loop.arrays
        half_way = float(np.abs(lengths).sum() + np.abs(offsets).sum()) / 2
        # joints that were moved aside stand that far out at both ends
        farthest = half_way + 2 * self.size
        largest = largest_rates(branch)[self.to_angles.columns]
        speeds = []
        for first, second in pairs:
            between = largest[first + 1 : second + 1].sum()
            around = largest.sum() - between
            speeds.append(farthest * float(min(between, around)))
        return speeds

    def best_view(self, point: np.ndarray) -> View:
        """The view of the scene of axes and common normals; of a planar loop that from
        straight above."""
        if np.all(np.abs(np.sin(self.loop.arrays[1])) < FLAT):
            return view_of_plane(UPWARD, self.orientation)
        return best_view(make_scene(self.loop, self.to_angles.points(point)))

    def page(self, points: np.ndarray) -> dict[str, Any]:
        """The table, and the joints where the unknowns are not its angles."""
        lengths, twists, offsets = self.loop.arrays
        loop = {
            "lengths": lengths.tolist(),
            "twists": twists.tolist(),
            "offsets": offsets.tolist(),
            "size": self.size,
        }
        if self.unknowns:
            loop["joints"] = self._joints()
        return {"loop": loop}

    def _joints(self) -> list[dict[str, Any]]:
        """The joints in loop order: each angle is an offset, and a sign times the
        unknown of a column."""
        back = self.to_angles.inverse
        joints = []
        for joint in range(self.loop.n):
            column = back.index(joint)
            joints.append(
                {
                    "name": self.unknowns[column],
                    "column": column,
                    "sign": int(back.signs[column]),
                    "offset": float(back.origin[column]),
                }
            )
        return joints


class Bodies(Parts):
    """The bodies of the mechanism of a ``structure``; their frames are that of the
    reference configuration. Of a planar one they may lie at ``heights`` (b,) over the
    plane, with pins from the lowest to the highest of a joint."""

    word = "bodies"
    whole = "mechanism"

    def __init__(self, structure: Structure, heights: np.ndarray | None = None):
        self._heights = heights
        mechanism = structure.mechanism
        self.structure = structure
        self.names = self.full_names = mechanism.bodies
        self.size = structure.unit
        self.frame = mechanism.bodies.index(mechanism.frame)
        self._placing = Poses(structure)

    def lines(self, points: np.ndarray) -> list[np.ndarray]:
        """Those from joint to joint, and pins."""
        drawings = draw_bodies(self.structure, points)
        lines = [np.array(one["lines"]).reshape(-1, 2, 3) for one in drawings]
        flat = [self.size * one for one in lines]
        if self._heights is None:
            return flat
        return [
            np.concatenate([own + self._up(height), *self._pins_on(body)])
            for body, (own, height) in enumerate(zip(flat, self._heights, strict=True))
        ]

    def _up(self, height: float) -> np.ndarray:
        """So much over the plane (3,)."""
        assert self.normal is not None  # heights are over a plane
        return height * self.normal

    def _pins_on(self, body: int) -> list[np.ndarray]:
        """The pins (1, 2, 3) of joints whose symbols a body carries."""
        pins = []
        for symbol in self.symbols_on(body):
            low, high = self._reach_of(symbol.bodies)
            half = self._up((high - low) / 2)
            pins.append(np.array([[symbol.place - half, symbol.place + half]]))
        return pins

    def _reach_of(self, bodies: Sequence[int]) -> tuple[float, float]:
        """The heights of the lowest and the highest of some bodies."""
        if self._heights is None:
            return 0.0, 0.0
        own = self._heights[list(bodies)]
        return float(own.min()), float(own.max())

    def poses(self, points: np.ndarray) -> np.ndarray:
        """The displacements from the reference configuration."""
        return self._placing.at(points)

    def symbols_on(self, body: int) -> list[Symbol]:
        """Those of its joints, in the middle of their pins; the second axis of a universal joint is on its other
        body, and a rigid joint has no symbol."""
        return self._symbols.get(body, [])

    @cached_property
    def _symbols(self) -> dict[int, list[Symbol]]:
        symbols: dict[int, list[Symbol]] = {}
        for drawing in draw_symbols(self.structure):
            kind = JointKind(drawing["kind"])
            if kind is JointKind.RIGID:
                continue
            name = f"joint {drawing['label']}".strip()
            place = self.size * np.array(drawing["place"])
            directions = drawing["directions"] or [UPWARD.tolist()]
            holders = (drawing["holder"], drawing["other"])
            for body, direction in zip(holders, directions, strict=False):
                joined = self._joined(drawing, body)
                seat = place + self._middle_of(joined)
                symbol = Symbol(
                    name, kind.facets.shape, seat, np.array(direction), joined
                )
                symbols.setdefault(body, []).append(symbol)
        return symbols

    def _middle_of(self, bodies: Sequence[int]) -> np.ndarray:
        """Over the plane (3,) in the middle of some bodies."""
        if self._heights is None:
            return np.zeros(3)
        return self._up(sum(self._reach_of(bodies)) / 2)

    def _joined(self, drawing: Drawing, body: int) -> tuple[int, ...]:
        """The bodies that a joint joins, one of which has its symbol."""
        bodies = [drawing["holder"], drawing["other"]]
        if JointKind(drawing["kind"]).facets.is_shared:
            joint = self.structure.mechanism.joint(drawing["label"])
            bodies = [self.names.index(name) for name in joint.bodies]
        return (body, *(one for one in bodies if one != body))

    @property
    def held(self) -> int:
        """The frame, or the middle one of a sheet of panels."""
        return self.names.index(held_body(self.structure.mechanism))

    @property
    def normal(self) -> np.ndarray | None:
        return normal_of_plane(self.structure.mechanism)

    def panels(self, body: int) -> list[np.ndarray]:
        return self._panels.get(self.names[body], [])

    @cached_property
    def _panels(self) -> dict[str, list[np.ndarray]]:
        panels: dict[str, list[np.ndarray]] = {}
        for panel in self.structure.mechanism.panels:
            panels.setdefault(panel.body, []).append(np.array(panel.corners))
        return panels

    def breadths(self, points: np.ndarray) -> np.ndarray:
        return breadths_of_mechanism(self.structure, points)

    def are_joined(self, pair: Pair) -> bool:
        """Whether a joint is of both."""
        names = {self.names[body] for body in pair}
        return any(names <= {*one.bodies} for one in self.structure.mechanism.joints)

    def closing_speeds(
        self, pairs: Sequence[Pair], lines: list[np.ndarray], branch: Branch
    ) -> list[float]:
        """No faster than the fastest end of a line of one, seen from the other, either
        way round."""
        points, rates = places_along(branch)
        steps = [self.poses(points + step * rates) for step in (-STEP, STEP)]

        def largest(seen_from: int, body: int) -> float:
            before, after = (
                moved_lines(
                    lines[body], np.linalg.inv(poses[:, seen_from]) @ poses[:, body]
                )
                for poses in steps
            )
            ways = np.linalg.norm(after - before, axis=-1)
            return float(ways.max()) / (2 * STEP)

        return [MARGIN * min(largest(a, b), largest(b, a)) for a, b in pairs]

    def best_view(self, point: np.ndarray) -> View:
        """The same, the body at rest that is drawn so; of a planar mechanism that from
        straight above, but where it is a sheet that folds along parallel lines."""
        normal = normal_of_plane(self.structure.mechanism)
        if normal is not None and not self.structure.mechanism.panels:
            return view_of_plane(normal, UPRIGHT)
        return best_view_of_mechanism(self.structure, point)

    def page(self, points: np.ndarray) -> dict[str, Any]:
        """How bodies move, and what is drawn of them."""
        return {"mechanism": describe_motion(self.structure, points)}

    def form_on_page(self, form: Form, start: float) -> dict[str, Any]:
        """Where it is first shown, and the smallest regular singular value where the
        page has no equations."""
        on_page: dict[str, Any] = {"start": start}
        if not has_tape(self.structure):
            on_page["smallest"] = _smallest(form)
        return on_page


def _smallest(form: Form) -> list[list[float]]:
    """The smallest regular singular value along a form, as [s, value] in order."""
    profile = form.profile
    rows = np.stack([profile.arclength.ravel(), profile.smallest.ravel()], axis=1)
    ordered = rows[np.argsort(rows[:, 0], kind="stable")]
    values: list[list[float]] = ordered.tolist()
    return values


def moved_lines(lines: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Lines (k, m, 2, 3) that transforms (k, 4, 4) make of lines (m, 2, 3)."""
    turned = lines.reshape(-1, 3) @ np.swapaxes(poses[:, :3, :3], 1, 2)
    moved: np.ndarray = turned + poses[:, None, :3, 3]
    return moved.reshape(len(poses), -1, 2, 3)
