"""A mechanism: bodies and the joints between them, in one closed configuration."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from bifurc.tables import count_of
from linkages.coordinates import are_near_origin, is_fine, rounding_of_doubles
from linkages.mechanisms.couplings import Coupling, Leader, leaders
from linkages.mechanisms.joint import (
    Joint,
    JointKind,
    Limits,
    Motion,
    Vector,
)
from linkages.values import GeometryError, check_number, quoted, require

if TYPE_CHECKING:
    # networkx takes long to import
    import networkx as nx

MOST_LAYERS = 99
MIRROR = np.array([1.0, 1.0, -1.0])  # a vector in the plane z = 0
FRAMES = ("frame", "ground", "base", "world")  # names of the body that is drawn at rest


class Variable(NamedTuple):
    """A joint variable: its ``label`` ("J1", or "C1.slide" in a joint of several), the
    name of its ``joint``, the ``motion``, what it may be, the value at which it is
    ``locked``, be it by the variable that it follows, and its ``leader``: itself where
    it follows none."""

    label: str
    joint: str
    motion: Motion
    limits: Limits | None
    locked: float | None
    leader: Leader


class Pair(NamedTuple):
    """Two bodies that a joint joins: ``moved`` moves with respect to ``base`` by the
    variables of these numbers, one after the other, or freely about ``center``."""

    joint: str
    base: str
    moved: str
    variables: tuple[int, ...]
    center: np.ndarray | None = None


class Lock(NamedTuple):
    """What is locked by its name, at which ``value`` (rad, the unit of length)."""

    name: str
    value: float
    is_angle: bool


class OuterJoint(NamedTuple):
    """A joint of the outer loop of a network: its ``name``, the ``label`` of its
    variable, its Denavit-Hartenberg angle (rad) in the ``reference`` configuration, and
    whether it is locked there."""

    name: str
    label: str
    reference: float
    is_locked: bool

    def angle(self, value: float) -> float:
        """The Denavit-Hartenberg angle at a value of the variable, rad."""
        turned = self.reference + value
        return float(np.remainder(turned + np.pi, 2 * np.pi) - np.pi)


class Panel(NamedTuple):
    """A flat polygon of a body, by its ``corners`` in order."""

    body: str
    corners: tuple[Vector, ...]


class Crease(NamedTuple):
    """A crease that is assigned: its ``joint``, "M" for a mountain or "V" for a valley,
    and the fold ``angle`` (rad, valleys positive) in the reference configuration."""

    joint: str
    letter: str
    angle: float

    @property
    def sign(self) -> int:
        """That of the fold angle where it is folded as assigned."""
        return 1 if self.letter == "V" else -1

    @property
    def limits(self) -> Limits:
        """The values of the variable at which it is folded as assigned."""
        ends = sorted((-self.angle, self.sign * math.pi - self.angle))
        return ends[0], ends[1]


@dataclass(frozen=True)
class Mechanism:
    """Bodies, joined by ``joints`` that are given in one closed configuration.

    ``is_planar``: it was given in a plane, so that a body has three freedoms for
    Grübler's count. ``origin`` is where a file that counts them from elsewhere has the
    origin of the points; nothing that is computed hangs on it. ``rounding``: how far off
    they may be, where that is more than they are as doubles. ``panels`` are drawn of
    bodies that are sheets, with ``creases`` that are assigned. What hangs on joints in no
    closed loop is held where it is given, but ``with_flaps``, and so are creases of a
    flat sheet that stay flat about this state, but ``with_flat_creases``, and creases
    ``at_rest``, which may fold. ``driver`` is the joint
    variable whose dead points matter: if none is named, those that ``motors`` drive, or
    else the first one that is free.
    ``layers`` are numbers from 1 of bodies that lie one above the other in a planar
    mechanism. ``moved``: how far vertices of a crease pattern are from where a file has them,
    that was a rounding of it. Bodies that do not hang together are mechanisms of their own, its `parts`.
    Raises `GeometryError` where a joint is named twice, joints are coupled in a
    circle, or something else than a body has a layer.
    """

    joints: tuple[Joint, ...]
    name: str = field(default="", compare=False)
    is_planar: bool = False
    origin: Vector = field(default=(0.0, 0.0, 0.0), compare=False)
    rounding: float = field(default=0.0, compare=False)
    panels: tuple[Panel, ...] = field(default=(), compare=False)
    with_flaps: bool = False
    with_flat_creases: bool = field(default=False, kw_only=True)
    at_rest: tuple[str, ...] = field(default=(), kw_only=True)
    creases: tuple[Crease, ...] = field(default=(), compare=False)
    driver: str = field(default="", compare=False)
    motors: tuple[str, ...] = field(default=(), compare=False)
    layers: tuple[tuple[str, int], ...] = field(default=(), compare=False)
    moved: float = field(default=0.0, compare=False)
    # what to do where a single loop is asked for, unless there is nothing to do
    way_to_loop: ClassVar[str] = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", _checked_joints(self.joints))
        _check_followers(self)
        _check_layers(self)

    # --- bodies -----------------------------------------------------------------------

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """The names of the bodies, in the order in which joints name them."""
        names = [body for joint in self.joints for body in joint.bodies]
        return tuple(dict.fromkeys(names))

    @property
    def frame(self) -> str:
        """The body that is drawn at rest: one called "frame", "ground", "base" or
        "world", else the first."""
        for name in FRAMES:
            if name in self.bodies:
                return name
        return self.bodies[0]

    def graph(self) -> nx.MultiGraph:
        """The bodies as nodes; an edge for every pair that a joint joins, its key the
        pair's number, with the ``joint`` and its ``kind``."""
        import networkx as nx

        kinds = {joint.name: joint.kind.value for joint in self.joints}
        graph = nx.MultiGraph(name=self.name)
        graph.add_nodes_from(self.bodies)
        for number, pair in enumerate(self.pairs):
            kind = kinds[pair.joint]
            graph.add_edge(
                pair.base, pair.moved, key=number, joint=pair.joint, kind=kind
            )
        return graph

    # --- joints -----------------------------------------------------------------------

    def joint(self, name: str) -> Joint:
        """The joint of this name; raises `GeometryError`."""
        if name in self._named:
            return self._named[name]
        names = ", ".join(self._named)
        raise GeometryError("joint", quoted(name), f"one of {names}")

    @cached_property
    def _named(self) -> dict[str, Joint]:
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def joints_of(self) -> dict[str, list[Joint]]:
        """The joints of every body, in their order."""
        joints: dict[str, list[Joint]] = {body: [] for body in self.bodies}
        for joint in self.joints:
            for body in joint.bodies:
                joints[body].append(joint)
        return joints

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """The variables of all joints but the spherical ones, in the order of the
        joints."""
        locks = [value for joint in self.joints for value in joint.locked]
        variables: list[Variable] = []
        for joint in self.joints:
            motions = joint.motions * (len(joint.bodies) - 1)
            rows = zip(joint.labels, motions, joint.limits, strict=True)
            for label, motion, limits in rows:
                leader = self._leaders[len(variables)]
                held = locks[leader.number]
                value = None if held is None else leader.value(held)
                variables.append(
                    Variable(label, joint.name, motion, limits, value, leader)
                )
        return tuple(variables)

    @cached_property
    def _leaders(self) -> tuple[Leader, ...]:
        """What every variable follows."""
        labels = [label for joint in self.joints for label in joint.labels]
        couplings = {
            label: coupling
            for joint in self.joints
            for label, coupling in zip(joint.labels, joint.coupled, strict=True)
            if coupling is not None
        }
        return leaders(labels, couplings)

    @property
    def is_coupled(self) -> bool:
        """Whether a variable follows another one."""
        return any(leader.number != k for k, leader in enumerate(self._leaders))

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """The pairs of bodies that joints join: k - 1 for a joint of k bodies."""
        pairs = []
        first = 0
        for joint in self.joints:
            count = len(joint.motions)
            is_spherical = joint.kind is JointKind.SPHERICAL
            center = joint.place if is_spherical else None
            for body in joint.bodies[1:]:
                numbers = tuple(range(first, first + count))
                pairs.append(Pair(joint.name, joint.bodies[0], body, numbers, center))
                first += count
        return tuple(pairs)

    @property
    def independent_loops(self) -> int:
        """How many closed loops are independent of each other."""
        return len(self.pairs) - len(self.bodies) + 1

    @property
    def gruebler(self) -> int:
        """Grübler's count: the freedoms of the joints that are neither locked nor coupled
        to others, less six for every independent loop, or three in a plane. Only the
        rank tells the true mobility."""
        return self.count_of_freedoms(3 if self.is_planar else 6)

    def count_of_freedoms(self, of_body: int) -> int:
        """The same count where a free body has so many freedoms, ``of_body``."""
        freedoms = sum(joint.freedoms for joint in self.joints)
        bound = sum(
            variable.locked is not None or variable.leader.number != number
            for number, variable in enumerate(self.variables)
        )
        return freedoms - bound - of_body * self.independent_loops

    @property
    def extent(self) -> float:
        """The largest distance of coordinates of joints; 1 where all are at one
        point."""
        return float(np.ptp(self._points, axis=0).max()) or 1.0

    @property
    def coordinate_rounding(self) -> float:
        """How far off coordinates of points may be, in the unit of length."""
        return max(rounding_of_doubles(self._points), self.rounding)

    @property
    def is_known_to_rounding(self) -> bool:
        """Whether coordinates of points are as exact as doubles of the size of the
        mechanism are."""
        points = self._points
        return are_near_origin(points) and is_fine(self.rounding, points)

    @cached_property
    def _points(self) -> np.ndarray:
        """The points (k, 3) at which axes are; the origin where there are none."""
        points = [
            joint.point
            for joint in self.joints
            if joint.point is not None and not joint.kind.facets.is_point_drawn_only
        ]
        return np.array(points or [(0.0, 0.0, 0.0)])

    # --- what a class of mechanisms knows ---------------------------------------------

    def assemblies(self) -> np.ndarray:
        """Closed configurations (k, v) that are known without a search, in all
        variables; none, unless a class has a closed form."""
        return np.empty((0, len(self.variables)))

    def subject_values(self) -> dict[str, Any]:
        """What the ``subject`` of an atlas says of it besides its joints, in values that
        JSON holds; nothing, unless a class is made of more."""
        return {}

    def document_values(self) -> dict[str, Any]:
        """The same for the JSON document of an atlas."""
        return {}

    @property
    def outer_joints(self) -> tuple[OuterJoint, ...]:
        """The joints of an outer loop, whose angles are shown as well; none, unless a
        class has one."""
        return ()

    def holds_angle(self, name: str) -> bool:
        """Whether a lock of this name holds an angle."""
        return any(one.label == name and one.motion.is_turn for one in self.variables)

    def held(self, values: Mapping[str, float]) -> Mechanism:
        """The mechanism with what locks hold, by name, at ``values``: variables, unless
        a class has other names for them."""
        return self.with_locks(values)

    @property
    def locks(self) -> list[Lock]:
        """What is locked by itself."""
        locks = []
        for joint in self.joints:
            for label, value in zip(joint.labels, joint.locked, strict=True):
                if value is not None:
                    locks.append(Lock(label, value, self.holds_angle(label)))
        return locks

    # --- other mechanisms -------------------------------------------------------------

    @property
    def parts(self) -> tuple[Mechanism, ...]:
        """The mechanisms that it consists of, each of bodies that hang together; itself
        where it is one. Raises `GeometryError` where a joint is coupled to one of another
        part."""
        import networkx as nx

        sets = list(nx.connected_components(self.graph()))
        if len(sets) == 1:
            return (self,)
        return tuple(
            self._part(number, sets[number - 1]) for number in range(1, len(sets) + 1)
        )

    def _part(self, number: int, bodies: Collection[str]) -> Mechanism:
        """What is left of it with some ``bodies`` only."""
        joints = tuple(joint for joint in self.joints if joint.bodies[0] in bodies)
        labels = {label for joint in joints for label in joint.labels}
        for joint in joints:
            for coupling in joint.coupled:
                is_inside = coupling is None or coupling.to in labels
                to = "" if coupling is None else coupling.to
                allowed = "coupled to what a chain of joints joins to it"
                require(is_inside, f"joint {joint.name}", f"coupled to {to}", allowed)
        panels = tuple(panel for panel in self.panels if panel.body in bodies)
        creases = tuple(one for one in self.creases if one.joint in labels)
        layers = tuple(pair for pair in self.layers if pair[0] in bodies)
        return replace(
            self,
            joints=joints,
            panels=panels,
            creases=creases,
            layers=layers,
            name=f"{self.name}, part {number}",
        )

    def with_creases_as_assigned(self) -> Mechanism:
        """The sheet whose assigned creases fold their way only: valleys from 0 to 180
        degrees, mountains from -180 to 0."""
        limits = {one.joint: (one.limits,) for one in self.creases}
        return self._with_limits(limits)

    def with_free_creases(self) -> Mechanism:
        """The sheet whose assigned creases fold either way."""
        return self._with_limits({one.joint: () for one in self.creases})

    def _with_limits(self, limits: Mapping[str, tuple[Limits, ...]]) -> Mechanism:
        joints = tuple(
            replace(joint, limits=limits.get(joint.name, joint.limits))
            for joint in self.joints
        )
        return replace(self, joints=joints)

    def with_locks(self, values: Mapping[str, float]) -> Mechanism:
        """The mechanism with variables, by label, locked at ``values`` (rad and unit of
        length), or those that they follow at what that takes; raises `GeometryError`
        for a label that it does not have, and for two locks of coupled variables."""
        if not values:
            return self
        labels = [variable.label for variable in self.variables]
        for label in values:
            allowed = f"one of {', '.join(labels)}"
            require(label in labels, "lock", quoted(label), allowed)
        locks: dict[str, float] = {}  # of the variables that those follow
        for variable in self.variables:
            if variable.label not in values:
                continue
            leader = self.variables[variable.leader.number].label
            allowed = f"given once for {leader} and all that is coupled to it"
            require(leader not in locks, "lock", quoted(variable.label), allowed)
            locks[leader] = variable.leader.value_of_leader(values[variable.label])
        joints = []
        for joint in self.joints:
            pairs = zip(joint.labels, joint.locked, strict=True)
            locked = tuple(locks.get(label, value) for label, value in pairs)
            joints.append(replace(joint, locked=locked))
        return replace(self, joints=tuple(joints))

    def scaled(self, factor: float) -> Mechanism:
        """The mechanism with all lengths times ``factor``."""
        check_number("factor", factor)
        require(factor > 0, "factor", factor, "positive")
        sizes = np.full(3, factor)
        joints = [_image(joint, sizes, np.ones(3), factor) for joint in self.joints]
        factors = {
            variable.label: 1.0 if variable.motion.is_turn else factor
            for variable in self.variables
        }
        scaled = self._image(joints, factors, sizes)
        return replace(scaled, rounding=factor * self.rounding)

    def mirrored(self) -> Mechanism:
        """The mirror image in the plane z = 0; turns change their sign."""
        joints = []
        signs: dict[str, float] = {}
        for joint in self.joints:
            # a turn about the mirrored direction has the other sense, so that the
            # direction is turned round as well; its values are those of the joint
            slides = bool(joint.motions) and not joint.motions[0].is_turn
            image = _image(joint, MIRROR, MIRROR if slides else -MIRROR, -1.0)
            signs |= zip(joint.labels, _signs_in_mirror(joint, image), strict=True)
            joints.append(image)
        mirrored = self._image(joints, signs, MIRROR)
        # seen from the other side, valleys and mountains are exchanged and angles change
        # their signs with the variables
        creases = [
            Crease(one.joint, one.letter, one.angle)
            if signs[one.joint] > 0
            else Crease(one.joint, "MV"[one.letter == "M"], -one.angle)
            for one in self.creases
        ]
        return replace(mirrored, creases=tuple(creases))

    def _image(
        self, joints: Iterable[Joint], factors: Mapping[str, float], sizes: np.ndarray
    ) -> Mechanism:
        """The mechanism of other ``joints``, all else times ``sizes`` (3,) and the
        values of variables times ``factors``, by label."""
        x, y, z = (sizes * self.origin).tolist()
        panels = []
        for panel in self.panels:
            corners = map(tuple, (sizes * np.array(panel.corners)).tolist())
            panels.append(Panel(panel.body, tuple(corners)))
        image = self.with_values_times(joints, factors)
        return replace(image, origin=(x, y, z), panels=tuple(panels))

    def with_values_times(
        self, joints: Iterable[Joint], factors: Mapping[str, float]
    ) -> Mechanism:
        """The mechanism of other ``joints`` with the values of all variables times
        ``factors``, by label: limits, locks and couplings."""
        return replace(
            self, joints=tuple(_with_values_times(joint, factors) for joint in joints)
        )

    def __repr__(self) -> str:
        kinds = [joint.kind.value for joint in self.joints]
        counts = [f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)]
        return (
            f"{self.name or 'Mechanism'}: {count_of(len(self.bodies), 'body')}, "
            f"{count_of(len(self.joints), 'joint')} ({', '.join(counts)}), "
            f"{count_of(self.independent_loops, 'independent loop')}"
        )


# --- other mechanisms -----------------------------------------------------------------


def _image(
    joint: Joint, sizes: np.ndarray, directions: np.ndarray, of_pitch: float
) -> Joint:
    """The joint with its point times ``sizes`` (3,), its directions times
    ``directions`` (3,), and its pitch times ``of_pitch``."""
    factors = {"point": sizes, "direction": directions, "second_direction": directions}
    vectors: dict[str, Any] = {
        key: tuple((factor * np.array(getattr(joint, key))).tolist())
        for key, factor in factors.items()
        if getattr(joint, key) is not None
    }
    pitch = None if joint.pitch is None else of_pitch * joint.pitch
    return replace(joint, pitch=pitch, **vectors)


def _with_values_times(joint: Joint, factors: Mapping[str, float]) -> Joint:
    own = [factors[label] for label in joint.labels]
    limits = []
    for factor, pair in zip(own, joint.limits, strict=True):
        ends = None if pair is None else sorted(factor * end for end in pair)
        limits.append(None if ends is None else (ends[0], ends[1]))
    locked = [
        None if value is None else factor * value
        for factor, value in zip(own, joint.locked, strict=True)
    ]
    coupled: list[Coupling | None] = []
    for factor, one in zip(own, joint.coupled, strict=True):
        if one is not None:
            ratio = one.ratio * factor / factors[one.to]
            one = Coupling(one.to, ratio, one.offset * factor)
        coupled.append(one)
    return replace(
        joint, limits=tuple(limits), locked=tuple(locked), coupled=tuple(coupled)
    )


def _signs_in_mirror(joint: Joint, image: Joint) -> list[float]:
    """What the variables of a joint are multiplied with in its image in the plane z = 0:
    +1.0 where it moves as the mirror image does, -1.0 where it moves against it."""
    signs = []
    for motion, of_image in zip(joint.motions, image.motions, strict=True):
        expected = MIRROR * motion.direction
        if motion.is_turn:
            expected = -expected
        signs.append(1.0 if float(expected @ of_image.direction) > 0 else -1.0)
    return signs * (len(joint.bodies) - 1)


# --- checks ---------------------------------------------------------------------------


def _checked_joints(joints: object) -> tuple[Joint, ...]:
    if isinstance(joints, str) or not isinstance(joints, Iterable):
        raise GeometryError("joints", quoted(joints), "a list of joints")
    checked = tuple(joints)
    for joint in checked:
        require(isinstance(joint, Joint), "joints", repr(joint), "a list of joints")
    for name, count in Counter(joint.name for joint in checked).items():
        require(count == 1, "name of a joint", quoted(name), "given once")
    require(len(checked) > 0, "number of joints", 0, "one or more")
    # no joint is called as a variable of another one, and no two variables alike
    owners: dict[str, Joint] = {}
    for joint in checked:
        for name in joint.names:
            other = owners.setdefault(name, joint)
            what = f"names of joints {other.name} and {joint.name}"
            allowed = "such that every joint and every variable has its own"
            require(other is joint, what, f"{quoted(name)} in both", allowed)
    return checked


def _check_layers(mechanism: Mechanism) -> None:
    for body, layer in mechanism.layers:
        allowed = f"one of {', '.join(mechanism.bodies)}"
        require(body in mechanism.bodies, "body in layers", quoted(body), allowed)
        is_number = isinstance(layer, int) and not isinstance(layer, bool)
        allowed = f"a whole number from 1 to {MOST_LAYERS}"
        is_within = is_number and 1 <= layer <= MOST_LAYERS
        require(is_within, f"layer of {body}", quoted(layer), allowed)


def _check_followers(mechanism: Mechanism) -> None:
    """Variables that others hold are within their limits."""
    for variable in mechanism.variables:
        if variable.locked is None or variable.limits is None:
            continue
        low, high = variable.limits
        leader = mechanism.variables[variable.leader.number]
        what = f"{variable.label}, which follows {leader.label},"
        is_within = low <= variable.locked <= high
        allowed = f"within its limits {[low, high]}"
        require(is_within, what, variable.locked, allowed)
