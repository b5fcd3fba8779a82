"""Maps of random mechanisms of one freedom, compared with samples by other means.

    python -m studies.random_mechanisms --kind planar [--count 200] [--seed 0]

A mechanism is drawn in a closed configuration: planar and spherical eight-bars of all
topologies, planar platforms of three legs with two joints locked, and loops and platforms
of three legs in space with joints of several kinds, chosen by Gruebler's count.

The other means know bodies only, six coordinates each, and what a joint lets two bodies
do (`Bodies`). Random positions of all bodies are brought to closed ones by Levenberg's
and Marquardt's method; a few of these are followed by small steps. What is sampled has to lie on
one form; what one path joins has to lie on the same one; and every form has to be closed
by the equations of the bodies.
"""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import click
import numpy as np
from scipy.spatial import cKDTree

from bifurc import Atlas, SearchSettings
from bifurc.tables import table
from linkages import GeometryError, Joint, JointKind, Mechanism, Readout, map_linkage
from studies.study import Study

FRAME = "frame"
X, Y, Z = np.eye(3)
R, P, C, U, S = (
    JointKind.REVOLUTE,
    JointKind.PRISMATIC,
    JointKind.CYLINDRICAL,
    JointKind.UNIVERSAL,
    JointKind.SPHERICAL,
)
FREEDOMS = {R: 1, P: 1, C: 2, U: 2, S: 3}
SLIDING = (P, C)
LINKS, TURNS = 8, 10  # of an eight-bar of one freedom
MOST_JOINTS = 7  # of a loop in space
LEGS = ((R, P, R), (P, R, R), (R, R, P), (R, R, R))  # of platforms in the plane

SAMPLES = 3000  # along a form
CLOSED = 1e-7  # residual, lengths over the size of the mechanism
ON_FORM = 1e-6  # distance of the positions of all bodies
ZOOMS, GRID = 5, 21  # of the nearest place on a form
ITERATIONS = 60
STEP, SHORTEST, BEND = 0.2, 1e-6, 0.1  # along paths, whose directions change so much
CORRECTIONS, EXACT = 4, 1e-11  # residual
MOST_STEPS = 6000
CHECKED = 7  # every point of this number on a path is looked at


# --- random mechanisms ----------------------------------------------------------------


def eight_bar(rng: np.random.Generator) -> list[tuple[int, int]]:
    """Which links of an eight-bar of one freedom, none of whose parts stands still,
    turning joints join."""
    everywhere = list(itertools.combinations(range(LINKS), 2))
    while True:
        chosen = rng.choice(len(everywhere), TURNS, replace=False)
        edges = [everywhere[k] for k in chosen]
        if _every_part_moves(edges):
            return edges


def _every_part_moves(edges: Sequence[tuple[int, int]]) -> bool:
    """Whether Gruebler's count is one or more for links and all parts of them, and no
    link hangs on one joint."""
    degrees = Counter(itertools.chain(*edges))
    if len(degrees) < LINKS or min(degrees.values()) < 2:
        return False
    for size in range(3, LINKS + 1):
        for links in itertools.combinations(range(LINKS), size):
            inner = sum(a in links and b in links for a, b in edges)
            if 3 * (size - 1) - 2 * inner < 1:
                return False
    return True


def planar_eight_bar(rng: np.random.Generator) -> Mechanism:
    """An eight-bar in the plane z = 0."""
    joints = [
        Joint(f"J{k}", R, _bodies(edge), _vector([*rng.normal(size=2), 0.0]), tuple(Z))
        for k, edge in enumerate(eight_bar(rng), start=1)
    ]
    return Mechanism(tuple(joints), "eight-bar", is_planar=True)


def spherical_eight_bar(rng: np.random.Generator) -> Mechanism:
    """An eight-bar all of whose axes meet at 0."""
    joints = [
        Joint(f"J{k}", R, _bodies(edge), (0.0, 0.0, 0.0), _vector(rng.normal(size=3)))
        for k, edge in enumerate(eight_bar(rng), start=1)
    ]
    return Mechanism(tuple(joints), "spherical eight-bar")


def planar_platform(rng: np.random.Generator) -> Mechanism:
    """A platform on three legs in the plane, 3-RPR or others, with a joint of each of
    two legs locked."""
    legs = [(R, P, R)] * 3
    if rng.random() < 0.5:
        legs = [LEGS[k] for k in rng.choice(len(LEGS), 3)]
    joints = []
    for leg, kinds in zip("ABC", legs, strict=True):
        # a slide of the first two legs, or the first joint
        locked = max(range(3), key=lambda k: kinds[k] is P)
        for k, (kind, bodies) in enumerate(zip(kinds, _leg(leg, 3), strict=True)):
            point, angle = [*rng.normal(size=2), 0.0], rng.uniform(0, np.pi)
            along = (0, 0, 1) if kind is R else (np.cos(angle), np.sin(angle), 0)
            lock = (0.0,) if leg != "C" and k == locked else ()
            at = (_vector(point), _vector(along))
            joints.append(Joint(f"{leg}{k + 1}", kind, bodies, *at, locked=lock))
    return Mechanism(tuple(joints), "platform", is_planar=True)


def spatial_mechanism(rng: np.random.Generator) -> Mechanism:
    """A loop, or a platform on three legs, in space."""
    chains = 1 if rng.random() < 0.5 else 3
    loops = max(1, chains - 1)
    while True:
        words = [_word(rng, MOST_JOINTS if chains == 1 else 4) for _ in range(chains)]
        freedoms = sum(FREEDOMS[kind] for word in words for kind in word)
        freedoms -= sum((S, S) in itertools.pairwise(word) for word in words)
        if freedoms != 6 * loops + 1 or (chains == 1 and len(words[0]) < 3):
            continue
        joints = []
        for leg, word in zip("ABC", words, strict=False):
            bodies = _leg(leg, len(word), FRAME if chains == 1 else "platform")
            for k, (kind, pair) in enumerate(zip(word, bodies, strict=True), start=1):
                joints.append(_spatial_joint(f"{leg}{k}", kind, pair, rng))
        name = " ".join("".join(kind.value[0] for kind in word) for word in words)
        mechanism = Mechanism(tuple(joints), name.upper())
        if Bodies(mechanism).freedoms_as_drawn == 1:
            return mechanism


def _word(rng: np.random.Generator, most: int) -> list[JointKind]:
    """The joints of a chain, at most two of them spherical, and these on one rod: what
    is between two spherical joints turns about their line."""
    while True:
        word = [(R, P, C, U, S)[k] for k in rng.choice(5, rng.integers(1, most + 1))]
        spherical = [k for k, kind in enumerate(word) if kind is S]
        is_rod = len(spherical) < 2 or np.ptp(spherical) == 1
        if len(spherical) < 3 and is_rod:
            return word


def _spatial_joint(
    name: str, kind: JointKind, bodies: tuple[str, str], rng: np.random.Generator
) -> Joint:
    point = _vector(rng.normal(size=3))
    first, second = _vector(rng.normal(size=3)), rng.normal(size=3)
    if kind is S:
        return Joint(name, kind, bodies, point)
    if kind is U:
        across = _vector(np.cross(first, second))
        return Joint(name, kind, bodies, point, first, across)
    return Joint(name, kind, bodies, point, first)


def _bodies(edge: tuple[int, int]) -> tuple[str, str]:
    first, second = (f"link {k}" if k else FRAME for k in edge)
    return first, second


def _leg(leg: str, count: int, end: str = "platform") -> list[tuple[str, str]]:
    """The pairs of bodies along a leg of so many joints."""
    names = [FRAME, *(f"{leg}{k}" for k in range(1, count)), end]
    return list(itertools.pairwise(names))


def _vector(values: Sequence[float] | np.ndarray) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z


KINDS = {
    "planar": planar_eight_bar,
    "platform": planar_platform,
    "spherical": spherical_eight_bar,
    "spatial": spatial_mechanism,
}


# --- the other means ------------------------------------------------------------------


class Poses(NamedTuple):
    """The rotations (k, b, 3, 3) of all bodies and their translations (k, b, 3), over
    the size of the mechanism."""

    turn: np.ndarray
    shift: np.ndarray

    def take(self, which: Any) -> Poses:
        """Some of them."""
        return Poses(self.turn[which], self.shift[which])

    @property
    def rows(self) -> np.ndarray:
        """All as rows (k, 12 b)."""
        count = len(self.shift)
        return np.hstack([self.turn.reshape(count, -1), self.shift.reshape(count, -1)])


class Bodies:
    """The positions of the bodies of a ``mechanism``, and the equations of its joints.

    An equation is of vectors that bodies carry along, or of points of them: two that are
    the same, or two differences whose inner product is given. A rod between two
    spherical joints is no body, but a given distance. In the plane and about a point
    bodies have three coordinates only.
    """

    def __init__(self, mechanism: Mechanism):
        joints = mechanism.joints
        self.mechanism = mechanism
        at_centers = Counter(
            body for joint in joints if joint.kind is S for body in joint.bodies
        )
        all_joints = Counter(body for joint in joints for body in joint.bodies)
        rods = {b for b, k in all_joints.items() if k == at_centers[b] == 2}
        self.names = [FRAME, *(set(mechanism.bodies) - rods - {FRAME})]
        self.names.sort(key=mechanism.bodies.index)
        self.columns = [mechanism.bodies.index(name) for name in self.names]
        places = np.array([joint.place for joint in joints])
        self.size = float(np.linalg.norm(places, axis=1).max()) or 1.0
        self.vectors: list[np.ndarray] = []
        self.owners: list[int] = []
        self.is_point: list[float] = []
        self.equal: list[tuple[int, int]] = []
        self.products: list[tuple[int, int, int, int]] = []
        for joint in joints:
            if not rods & set(joint.bodies):
                self._add_joint(joint)
        for rod in rods:
            self._add_rod([joint for joint in joints if rod in joint.bodies], rod)
        self.free = self._free_columns()
        count = len(self.names)
        turns = np.tile(np.eye(3), (1, count, 1, 1))
        self.reference = Poses(turns, np.zeros((1, count, 3)))
        self.given = self._products(self._carried(self.reference)[0])[0]

    def _add(self, body: str, vector: np.ndarray, is_point: bool) -> int:
        self.owners.append(self.names.index(body))
        self.vectors.append(vector / self.size if is_point else vector)
        self.is_point.append(float(is_point))
        return len(self.vectors) - 1

    def _add_joint(self, joint: Joint) -> None:
        """The equations of a joint of two bodies."""
        first, second = joint.bodies

        def point(body: str) -> int:
            return self._add(body, joint.place, True)

        def share(*vectors: np.ndarray) -> None:
            for one in vectors:
                ends = self._add(first, one, False), self._add(second, one, False)
                self.equal.append(ends)

        axis, *across = _frame_along(joint.direction)
        if joint.locked == (0.0,):
            share(X, Y, Z)
        elif joint.kind in (R, C):
            share(axis)
        elif joint.kind is P:
            share(X, Y, Z)
        if joint.kind in (R, U, S) or joint.locked == (0.0,):
            self.equal.append((point(first), point(second)))
        else:
            for vector in across:
                nothing = self._add(first, 0.0 * vector, False)
                direction = self._add(first, vector, False)
                self.products.append((direction, nothing, point(first), point(second)))
        if joint.kind is U:
            other = np.array(joint.second_direction)
            nothing = self._add(first, 0.0 * other, False)
            one = self._add(first, axis, False)
            other_one = self._add(second, other, False)
            self.products.append((one, nothing, other_one, nothing))

    def _add_rod(self, ends: Sequence[Joint], rod: str) -> None:
        """The given distance between the centers of two joints."""
        one, other = (
            self._add(next(b for b in joint.bodies if b != rod), joint.place, True)
            for joint in ends
        )
        self.products.append((one, other, one, other))

    def _free_columns(self) -> np.ndarray:
        """The coordinates of bodies, turns and shifts in x, y and z each, that are not
        held."""
        kinds = {joint.kind for joint in self.mechanism.joints}
        free = np.ones((len(self.names), 6), dtype=bool)
        if self.mechanism.is_planar:
            free[:] = (False, False, True, True, True, False)
        elif kinds == {R} and not np.any([j.place for j in self.mechanism.joints]):
            free[:] = (True, True, True, False, False, False)
        free[self.names.index(FRAME)] = False
        return np.flatnonzero(free)

    # --- equations --------------------------------------------------------------------

    def _carried(self, poses: Poses) -> tuple[np.ndarray, np.ndarray]:
        """The vectors and points (k, f, 3), and the vectors without the shifts of points."""
        owners = np.array(self.owners)
        turned = np.einsum("kfij,fj->kfi", poses.turn[:, owners], self.vectors)
        is_point = np.array(self.is_point)[:, None]
        return turned + is_point * poses.shift[:, owners], turned

    def _products(self, values: np.ndarray) -> np.ndarray:
        """The inner products (k, p) of differences of vectors (k, f, 3)."""
        a, b, c, d = self._factors
        first, second = values[:, a] - values[:, b], values[:, c] - values[:, d]
        products: np.ndarray = (first * second).sum(axis=2)
        return products

    @property
    def _factors(self) -> np.ndarray:
        return np.array(self.products, dtype=int).reshape(-1, 4).T

    @property
    def _partners(self) -> np.ndarray:
        return np.array(self.equal, dtype=int).reshape(-1, 2).T

    def residuals(self, poses: Poses) -> np.ndarray:
        """By how much the equations are missed (k, m)."""
        values, _ = self._carried(poses)
        one, other = self._partners
        same = (values[:, one] - values[:, other]).reshape(len(values), -1)
        return np.hstack([same, self._products(values) - self.given])

    def jacobians(self, poses: Poses) -> np.ndarray:
        """How they change with the coordinates (k, m, c)."""
        values, turned = self._carried(poses)
        owners, is_point = np.array(self.owners), np.array(self.is_point)
        count, bodies = len(values), len(self.names)
        whole = np.zeros((count, len(owners), 3, bodies, 6))
        each = np.arange(len(owners))
        for axis in range(3):
            about = np.swapaxes(np.cross(np.eye(3)[axis], turned), 0, 1)
            whole[:, each, :, owners, axis] = about
            whole[:, each, axis, owners, 3 + axis] = is_point
        rates = whole.reshape(count, len(owners), 3, -1)[..., self.free]
        one, other = self._partners
        same = rates[:, one] - rates[:, other]
        a, b, c, d = self._factors
        first, second = values[:, a] - values[:, b], values[:, c] - values[:, d]
        products = np.einsum("kpi,kpic->kpc", second, rates[:, a] - rates[:, b])
        products += np.einsum("kpi,kpic->kpc", first, rates[:, c] - rates[:, d])
        same = same.reshape(count, 3 * len(one), len(self.free))
        return np.concatenate([same, products], axis=1)

    def moved(self, poses: Poses, steps: np.ndarray) -> Poses:
        """The poses after steps (k, c) of the coordinates."""
        whole = np.zeros((len(steps), len(self.names) * 6))
        whole[:, self.free] = steps
        turn, shift = np.split(whole.reshape(len(steps), -1, 6), 2, axis=2)
        return Poses(_rotations(turn) @ poses.turn, poses.shift + shift)

    @property
    def freedoms_as_drawn(self) -> int:
        """How many freedoms there are in the configuration that is given, to first
        order."""
        (change,) = self.jacobians(self.reference)
        return len(self.free) - int(np.linalg.matrix_rank(change, tol=1e-8))

    # --- samples ----------------------------------------------------------------------

    def random(self, rng: np.random.Generator, count: int) -> Poses:
        """Random positions of the bodies."""
        steps = rng.normal(size=(count, len(self.free)))
        is_turn = self.free % 6 < 3
        steps[:, is_turn] *= np.pi
        return self.moved(_repeated(self.reference, count), steps)

    def closed(self, poses: Poses) -> Poses:
        """Closed positions next to others, where these lead to such."""
        residuals = self.residuals(poses)
        norms = np.linalg.norm(residuals, axis=1)
        damping = np.full(len(norms), 1e-2)
        for _ in range(ITERATIONS):
            change = self.jacobians(poses)
            matrix = np.swapaxes(change, 1, 2) @ change
            matrix += damping[:, None, None] * np.eye(len(self.free))
            right = np.einsum("kmc,km->kc", change, residuals)
            steps = -np.linalg.solve(matrix, right[..., None])[..., 0]
            new = self.moved(poses, steps)
            of_new = self.residuals(new)
            norms_of_new = np.linalg.norm(of_new, axis=1)
            better = norms_of_new < norms
            pick = better[:, None]
            turn = np.where(pick[..., None, None], new.turn, poses.turn)
            poses = Poses(turn, np.where(pick[..., None], new.shift, poses.shift))
            residuals = np.where(pick, of_new, residuals)
            norms = np.where(better, norms_of_new, norms)
            damping = np.clip(np.where(better, damping / 5, damping * 5), 1e-12, 1e6)
        for _ in range(2):
            poses, norms, _ = self._corrected(poses)
        return poses.take(norms < EXACT)

    def _corrected(self, poses: Poses) -> tuple[Poses, np.ndarray, np.ndarray]:
        """A step of Gauss and Newton, and before it the residuals (k,) and the unit
        vectors (k, c) along which the bodies move."""
        residuals, change = self.residuals(poses), self.jacobians(poses)
        missing = change.shape[2] - change.shape[1]
        if missing > 0:
            residuals = np.pad(residuals, ((0, 0), (0, missing)))
            change = np.pad(change, ((0, 0), (0, missing), (0, 0)))
        left, sizes, right = np.linalg.svd(change, full_matrices=False)
        # off the curve the last one is small, and no zero
        inverse = np.append(1.0 / sizes[:, :-1], np.zeros((len(sizes), 1)), axis=1)
        along = np.einsum("kms,km->ks", left, residuals) * inverse
        steps = -np.einsum("ksc,ks->kc", right, along)
        return self.moved(poses, steps), np.linalg.norm(residuals, axis=1), right[:, -1]

    def path(self, start: Poses, sign: float) -> tuple[Poses, bool]:
        """What is met from a closed position on until it comes back, or leaves the
        limits, and whether it comes back."""
        here, _, direction = self._corrected(start)
        direction = sign * direction
        visited, step = [start], STEP
        for _ in range(MOST_STEPS):
            ahead = self.moved(here, step * direction)
            gap, turned = np.full(1, np.inf), direction
            for _ in range(CORRECTIONS):
                if gap[0] < EXACT:
                    break
                ahead, gap, turned = self._corrected(ahead)
            turned = turned * (np.sign(turned[0] @ direction[0]) or 1.0)
            bend = float(np.linalg.norm(turned - direction))
            if (bend > BEND or gap[0] > EXACT) and step > SHORTEST:
                step /= 2
                continue
            here, direction = ahead, turned
            visited.append(here)
            distance = float(np.linalg.norm(here.rows - start.rows))
            # a turn by an angle moves the entries of its matrix by the root of 2 times it
            if len(visited) > 4 and distance < 1.5 * step:
                return _joined(visited), True
            if not self.is_within_limits(here)[0]:
                break
            if bend < BEND / 3:
                step = min(1.5 * step, STEP)
        return _joined(visited), False

    # --- limits -----------------------------------------------------------------------

    def is_within_limits(self, poses: Poses, margin: float = 0.0) -> np.ndarray:
        """Which poses (k,) have all slides within the limits of the map, by so much."""
        inside = np.ones(len(poses.shift), dtype=bool)
        for joint in self.mechanism.joints:
            if joint.kind not in SLIDING or joint.locked == (0.0,):
                continue
            low, high = self.limits[joint.labels[-1]]
            first, second = map(self.names.index, joint.bodies)
            place = joint.place / self.size
            gap = (poses.turn[:, second] - poses.turn[:, first]) @ place
            gap += poses.shift[:, second] - poses.shift[:, first]
            axis, *_ = _frame_along(joint.direction)
            slide = self.size * np.einsum("ki,ki->k", poses.turn[:, first] @ axis, gap)
            room = margin * (high - low)
            inside &= (slide > low + room) & (slide < high - room)
        return inside

    @cached_property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Within which slides are followed."""
        return Readout(self.mechanism).limits()


def _frame_along(direction: Sequence[float] | None) -> tuple[np.ndarray, ...]:
    """The unit vector along a direction, and two across it."""
    if direction is None:
        return X, Y, Z
    basis, _ = np.linalg.qr(np.column_stack([direction, np.eye(3)]))
    sign = np.sign(basis[:, 0] @ np.array(direction))
    return sign * basis[:, 0], basis[:, 1], basis[:, 2]


def _rotations(vectors: np.ndarray) -> np.ndarray:
    """The rotations (..., 3, 3) about vectors (..., 3) by their lengths."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    cross = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / 2 / np.pi) ** 2
    rotations: np.ndarray = np.eye(3) + first * cross + second * cross @ cross
    return rotations


def _repeated(poses: Poses, count: int) -> Poses:
    return poses.take(np.zeros(count, dtype=int))


def _joined(parts: Sequence[Poses]) -> Poses:
    turns, shifts = zip(*parts, strict=True)
    return Poses(np.concatenate(turns), np.concatenate(shifts))


# --- comparison -----------------------------------------------------------------------


class Curves:
    """The forms of an ``atlas`` as positions of bodies."""

    def __init__(self, atlas: Atlas, bodies: Bodies):
        self.bodies = bodies
        self.branches = [form.branch for form in atlas.forms]
        self.readout = Readout(bodies.mechanism)
        self.places = [
            np.linspace(0.0, branch.length, SAMPLES) for branch in self.branches
        ]
        self.samples = [self.poses(number, s) for number, s in enumerate(self.places)]
        rows = [poses.rows for poses in self.samples]
        self.gaps = [np.linalg.norm(np.diff(one, axis=0), axis=1).max() for one in rows]
        self.trees = [cKDTree(one) for one in rows]

    def poses(self, form: int, s: np.ndarray) -> Poses:
        """Where the bodies are at arclengths (k,) of a form."""
        poses = self.readout.poses(self.branches[form](s))[:, self.bodies.columns]
        return Poses(poses[..., :3, :3], poses[..., :3, 3] / self.bodies.size)

    def misclosure(self) -> float:
        """The largest residual along the forms."""
        gaps = [np.abs(self.bodies.residuals(one)).max() for one in self.samples]
        return float(max(gaps, default=0.0))

    def holding(self, poses: Poses) -> np.ndarray:
        """Which forms hold which poses (k, forms)."""
        distances = [self._distances(k, poses.rows) for k in range(len(self.branches))]
        holding: np.ndarray = np.reshape(distances, (-1, len(poses.shift))).T < ON_FORM
        return holding

    def _distances(self, form: int, rows: np.ndarray) -> np.ndarray:
        """How far positions (k, d) are from a form."""
        distances: np.ndarray
        distances, nearest = self.trees[form].query(rows)
        length = self.branches[form].length
        step = length / (SAMPLES - 1)
        near = distances < self.gaps[form]  # others are on other forms, or on none
        if not near.any():
            return distances
        s, rows = self.places[form][nearest[near]], rows[near]
        grid = np.linspace(-1, 1, GRID)
        for _ in range(ZOOMS):
            places = s[:, None] + step * grid
            if not self.branches[form].closed:
                places = np.clip(places, 0.0, length)
            flat = np.mod(places, length) if self.branches[form].closed else places
            there = self.poses(form, flat.ravel()).rows.reshape(*places.shape, -1)
            gaps = np.linalg.norm(there - rows[:, None], axis=2)
            best = gaps.argmin(axis=1)[:, None]
            s = np.take_along_axis(places, best, axis=1)[:, 0]
            distances[near] = np.take_along_axis(gaps, best, axis=1)[:, 0]
            step *= 2 / GRID
        return distances


@dataclass(frozen=True)
class Comparison:
    """A mechanism by its ``number``, its map and what the samples say of it: ``faults``,
    none where it is right, how many closed positions were ``sampled``, and how many
    curves ``followed``."""

    number: int
    name: str
    atlas: Atlas
    seconds: float
    faults: tuple[str, ...]
    sampled: int
    followed: int

    @property
    def verdict(self) -> str:
        """In one word or two."""
        if self.faults:
            return self.faults[0]
        if self.atlas.provenance.out_of_time:
            return "out of time"
        return "in doubt" if self.atlas.completeness.is_in_doubt else "right"

    @property
    def reasons(self) -> tuple[str, ...]:
        """The kinds of what it is that the map is sure of least, and of its doubts."""
        completeness = self.atlas.completeness
        claims = [one.kind for one in completeness.claims if one.level == self.level]
        doubts = [f"in doubt: {one.kind}" for one in completeness.doubts]
        kinds = [one.kind for one in completeness.claims]
        return tuple(dict.fromkeys(doubts or claims or kinds))

    @property
    def level(self) -> str:
        """How sure the map is."""
        return self.atlas.completeness.level.value


def draw(kind: str, seed: int, number: int) -> Mechanism:
    """The random mechanism of a kind with this number."""
    rng = np.random.default_rng([seed, number])
    while True:
        try:
            return KINDS[kind](rng)
        except GeometryError:
            continue


def compare(
    mechanism: Mechanism, number: int, budget: float, starts: int
) -> Comparison:
    """The map of a mechanism beside so many samples."""
    before = time.process_time()
    atlas = map_linkage(mechanism, settings=SearchSettings(budget=budget))
    seconds = time.process_time() - before
    bodies = Bodies(mechanism)
    rng = np.random.default_rng(number)
    samples = bodies.closed(bodies.random(rng, starts))
    samples = samples.take(bodies.is_within_limits(samples, margin=1e-3))
    curves = Curves(atlas, bodies)
    faults, followed = faults_of(atlas, bodies, curves, samples)
    count = len(samples.shift)
    return Comparison(
        number, mechanism.name, atlas, seconds, tuple(faults), count, followed
    )


def faults_of(
    atlas: Atlas, bodies: Bodies, curves: Curves, samples: Poses
) -> tuple[list[str], int]:
    """What is wrong with an atlas, and how many curves were followed."""
    faults = []
    if curves.misclosure() > CLOSED:
        faults.append("wrong")
    holding = curves.holding(samples)
    if not holding.any(axis=1).all():
        faults.append("missing")
    if (holding.sum(axis=1) > 1).any():
        faults.append("listed twice")
    if atlas.surfaces or len(atlas.rigid):
        faults.append("a surface or an assembly")
    firsts = {form: k for k, form in reversed(list(enumerate(holding.argmax(axis=1))))}
    for form, first in firsts.items():
        if not _is_one_form(bodies, curves, samples.take([first]), form):
            faults.append("joined wrongly")
    return faults, len(firsts)


def _is_one_form(bodies: Bodies, curves: Curves, start: Poses, form: int) -> bool:
    """Whether all that is met from a start lies on the form, and on no other one."""
    for sign in (1.0, -1.0):
        path, comes_back = bodies.path(start, sign)
        path = path.take(slice(None, None, CHECKED))
        holding = curves.holding(path.take(bodies.is_within_limits(path, margin=1e-3)))
        if not holding[:, form].all():
            return False
        if comes_back:
            break
    return True


# --- report ---------------------------------------------------------------------------


def comparisons(
    kind: str, count: int, seed: int, budget: float, starts: int
) -> Iterator[Comparison]:
    """Random mechanisms of a kind, one after the other."""
    for number in range(count):
        yield compare(draw(kind, seed, number), number, budget, starts)


def summary(results: Sequence[Comparison]) -> str:
    """How many are what, at which level, and why others are not certified."""
    counts = Counter((one.verdict, one.level) for one in results)
    rows = [(*what, str(number)) for what, number in sorted(counts.items())]
    lines = [table(("verdict", "level", "mechanisms"), rows)]
    reasons = Counter(one.reasons for one in results if one.level == "estimated")
    for kinds, number in reasons.most_common():
        lines.append(f"estimated {number} times: {'; '.join(kinds)}")
    seconds = np.array([one.seconds for one in results])
    lines.append(
        f"processor time {np.median(seconds):.2f} s (median), {seconds.max():.1f} s (most)"
    )
    return "\n".join(lines)


@click.command(cls=Study, help=__doc__)
@click.option("--kind", type=click.Choice(list(KINDS)), required=True)
@click.option("--count", default=200, show_default=True, type=click.IntRange(1))
@click.option("--seed", default=0, show_default=True)
@click.option("--budget", default=20.0, show_default=True, help="Of a map, s.")
@click.option("--starts", default=150, show_default=True, help="Random positions.")
def main(kind: str, count: int, seed: int, budget: float, starts: int) -> None:
    results = []
    for one in comparisons(kind, count, seed, budget, starts):
        results.append(one)
        forms = len(one.atlas.forms)
        click.echo(
            f"{one.number} {one.name}: {one.verdict}, {one.level}, {forms} forms, "
            f"{one.followed} followed, {one.sampled} samples, {one.seconds:.2f} s, "
            f"{'; '.join(one.reasons)}"
        )
    click.echo(summary(results))


if __name__ == "__main__":
    main()
