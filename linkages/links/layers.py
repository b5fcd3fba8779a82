"""Layers of planar linkages: in which of some planes, one above the other, every body
lies, so that bodies pass over each other and pins meet no body on the way.

Seen along the normal, a body covers its lines, and the pin of a joint a disc. Two that
come nearer than their widths anywhere along some forms have to be apart in height. A pin
reaches from the lowest to the highest body that it joins; the pins of a slide, two on one
body, run in a slot of the other one. So everything asked is of one kind: all layers of
one are above, or below, all layers of the other; the fewest that do are those of a mixed
integer linear program.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Form
from bifurc.branch import Branch
from linkages.decisions import is_one_pin
from linkages.links.clearance import TOLERANCE
from linkages.links.distances import (
    MARGIN,
    distances_by_ends,
    find_least_distance,
    places_along,
)
from linkages.links.layer_program import Separation, fewest_layers
from linkages.links.parts import STEP, Parts, Symbol, moved_lines
from linkages.mechanisms.joint import Shape
from linkages.values import require

SAMPLES = 361  # of a form, between which distances are bounded
GUIDE = 2.5  # from the middle of a slide to its pins, in radii of a pin
HINGES = (Shape.CYLINDER, Shape.BOX)  # what pins are made for


class Widths(NamedTuple):
    """The radii of rods and of pins with the eyes around them, and the ``gap`` that is
    kept between any two."""

    rod: float
    pin: float
    gap: float = 0.0

    @property
    def guide(self) -> float:
        """From the middle of a slide to its two pins, which leave room for another one
        between them."""
        return GUIDE * self.pin + self.gap


@dataclass(frozen=True, eq=False)
class Outline:
    """What a body or a pin covers: ``lines`` (m, 2, 3) that move with the body of this
    number, the ``holder``, and how far from them it reaches, the ``radii`` (m,). It lies
    in the layers of ``bodies``: one of a body, all that it joins of a pin."""

    name: str
    bodies: frozenset[int]
    holder: int
    lines: np.ndarray
    radii: np.ndarray
    symbol: Symbol | None = None

    @property
    def is_pin(self) -> bool:
        """Whether it is the pin of a joint, or of several on one axis."""
        return self.symbol is not None


@dataclass(frozen=True, eq=False)
class Meeting:
    """Where two outlines, by number, come nearest along a form: what is ``left`` between
    them, below zero where they overlap, at the arclength ``s`` and the configuration
    ``theta`` (n,); nowhere less by more than ``error``."""

    outlines: tuple[int, int]
    left: float
    form: Form
    s: float
    theta: np.ndarray
    error: float


@dataclass(frozen=True, eq=False)
class Layers:
    """The layer of every body, a number from 1 (b,), the lowest; what meets in them;
    and whether it ``is_proven`` that no layers are better: fewer, or some in which
    nothing meets."""

    plan: Plan
    numbers: np.ndarray
    meetings: tuple[Meeting, ...]
    is_proven: bool

    @property
    def count(self) -> int:
        """How many layers there are."""
        return int(self.numbers.max(initial=1))

    def span(self, outline: Outline) -> tuple[int, int]:
        """The lowest and the highest layer of an outline."""
        own = [int(self.numbers[body]) for body in outline.bodies]
        return min(own), max(own)

    def pairs(self) -> list[tuple[int, int]]:
        """Every two outlines, by number, that have a layer in common, where each is a
        body or a pin on its way past other bodies: at the bodies of a pin these count."""
        return [
            (i, j)
            for i, j in self.plan.pairs()
            if self._own_layers(i) & self._own_layers(j)
        ]

    def _own_layers(self, number: int) -> set[int]:
        """The layer of a body; those of a pin in which none of its bodies is."""
        outline = self.plan.outlines[number]
        low, high = self.span(outline)
        if not outline.is_pin:
            return {low}
        return {*range(low, high)} - {int(self.numbers[one]) for one in outline.bodies}


class Plan:
    """All ``outlines`` of some parts, bodies first, seen along the normal of their plane
    while they move along some ``forms``."""

    def __init__(self, parts: Parts, forms: Sequence[Form], widths: Widths):
        self.parts = parts
        self.forms = forms
        self.widths = widths
        samples = [form.branch.sample(SAMPLES) for form in forms]
        points = np.concatenate([*samples, *(places_along(f.branch)[0] for f in forms)])
        self._poses = parts.poses(points)
        bodies = _bodies(parts, points, widths)
        pins = _pins(parts, widths)
        self.outlines = [*_with_slots(bodies, pins, self), *self._merged(pins)]

    @property
    def pins(self) -> list[Outline]:
        """Those of joints."""
        return [outline for outline in self.outlines if outline.is_pin]

    # --- places -----------------------------------------------------------------------

    def flat(self, outline: Outline, poses: np.ndarray) -> np.ndarray:
        """The lines (k, m, 2, 3) of an outline in the plane, with bodies in these poses
        (k, b, 4, 4)."""
        lines = moved_lines(outline.lines, poses[:, outline.holder])
        normal = self.normal
        flat: np.ndarray = lines - (lines @ normal)[..., None] * normal
        return flat

    @cached_property
    def normal(self) -> np.ndarray:
        """That of the plane (3,)."""
        normal = self.parts.normal
        assert normal is not None  # asked of planar ones only
        return normal

    def range_of_slide(self, pin: Outline) -> tuple[float, float]:
        """How far, along its direction, the middle of a slide comes on its rail."""
        assert pin.symbol is not None
        box, rail = pin.symbol.bodies[:2]
        relative = np.linalg.inv(self._poses[:, rail]) @ self._poses[:, box]
        places = relative[:, :3, :3] @ pin.symbol.place + relative[:, :3, 3]
        along = (places - pin.symbol.place) @ pin.symbol.direction
        return float(along.min()), float(along.max())

    def _merged(self, pins: list[Outline]) -> list[Outline]:
        """Pins of which those on one axis are one."""
        merged: list[Outline] = []
        for pin in pins:
            twins = [one for one in merged if self._is_one_axis(one, pin)]
            for twin in twins:
                merged.remove(twin)
                name = f"{twin.name}, {pin.name.removeprefix('pin ')}"
                bodies = twin.bodies | pin.bodies
                pin = Outline(
                    name, bodies, twin.holder, twin.lines, twin.radii, twin.symbol
                )
            merged.append(pin)
        return merged

    def _is_one_axis(self, first: Outline, second: Outline) -> bool:
        if len(first.lines) != 1 or len(second.lines) != 1:
            return False
        if not first.bodies & second.bodies:
            return False
        places = self.flat(first, self._poses) - self.flat(second, self._poses)
        farthest = float(np.linalg.norm(places, axis=-1).max())
        return is_one_pin(farthest / self.parts.size)

    # --- what comes near --------------------------------------------------------------

    def nearest(self, pair: tuple[int, int], form: Form) -> Meeting:
        """Where two outlines are nearest along a form."""
        first, second = (self.outlines[number] for number in pair)
        branch = form.branch

        def left(_: np.ndarray, s: np.ndarray) -> np.ndarray:
            poses = self.parts.poses(branch(s))
            lines, others = self.flat(first, poses), self.flat(second, poses)
            return _left(first, second, lines, others)

        floor = -float(first.radii.max() + second.radii.max())
        speeds = self.speeds(branch)
        slope = np.array([speeds[pair[0]] + speeds[pair[1]]])
        error = TOLERANCE * self.parts.size
        least = find_least_distance(left, slope, branch.length, error, floor)
        place = branch(least.s)
        return Meeting(pair, least.value, form, least.s, place, least.error)

    def speeds(self, branch: Branch) -> np.ndarray:
        """How fast outlines move at most for each unit of arclength (o,)."""
        points, rates = places_along(branch)
        before, after = (self.parts.poses(points + h * rates) for h in (-STEP, STEP))
        speeds = []
        for outline in self.outlines:
            ways = self.flat(outline, after) - self.flat(outline, before)
            speeds.append(np.linalg.norm(ways, axis=-1).max(initial=0.0))
        return MARGIN * np.array(speeds) / (2 * STEP)

    def meetings(self) -> list[Meeting]:
        """Every two outlines that have to be apart in height, as they come nearer than
        the gap, each with a place where they do."""
        meetings: dict[tuple[int, int], Meeting] = {}
        for form in self.forms:
            sampled = _Sampled(self, form)
            for pair in self.pairs():
                meeting = None if pair in meetings else self._meeting(pair, sampled)
                if meeting is not None:
                    meetings[pair] = meeting
        return list(meetings.values())

    def _meeting(self, pair: tuple[int, int], sampled: _Sampled) -> Meeting | None:
        """Where two outlines come nearer than the gap; None where they do not."""
        gap = self.widths.gap
        lefts = sampled.lefts(pair)
        least = int(np.argmin(lefts))
        if lefts[least] <= gap:
            s, theta = float(sampled.s[least]), sampled.points[least]
            return Meeting(pair, float(lefts[least]), sampled.form, s, theta, 0.0)
        # between two samples it is less by no more than half the way
        lows = (lefts[:-1] + lefts[1:] - sampled.ways[list(pair)].sum()) / 2
        if lows.min() > gap:
            return None
        nearest = self.nearest(pair, sampled.form)
        return nearest if nearest.left - nearest.error <= gap else None

    def pairs(self) -> list[tuple[int, int]]:
        """Every two outlines that may meet: not a pin and a body that it joins, nor a
        body without lines."""
        joined = [one.bodies for one in self.outlines if one.is_pin]
        pairs = []
        seen = [k for k, one in enumerate(self.outlines) if len(one.lines)]
        for i, j in combinations(seen, 2):
            first, second = self.outlines[i], self.outlines[j]
            both = first.bodies | second.bodies
            if first.is_pin != second.is_pin and first.bodies & second.bodies:
                continue
            if not second.is_pin and any(both <= bodies for bodies in joined):
                continue  # they are in different layers anyway
            pairs.append((i, j))
        return pairs

    # --- layers -----------------------------------------------------------------------

    def layers(self, given: Mapping[int, int] | None = None) -> Layers:
        """The fewest layers in which nothing meets, or the best that can be had, with
        what meets then. Some bodies may be ``given`` theirs, by number; raises
        `GeometryError` where two that share a joint are given the same."""
        given = given or {}
        self._check(given)
        hopeless: list[Meeting] = []
        apart: list[Meeting] = []
        for meeting in self.meetings():
            first, second = (self.outlines[k].bodies for k in meeting.outlines)
            (hopeless if first & second else apart).append(meeting)
        separations = [
            Separation(*(self.outlines[k].bodies for k in meeting.outlines))
            for meeting in apart
        ]
        spans = [pin.bodies for pin in self.pins]
        count = len(self.parts.names)
        solution = fewest_layers(count, separations, spans, given)
        broken = [*hopeless, *(apart[k] for k in solution.broken)]
        meetings = tuple(self.nearest(one.outlines, one.form) for one in broken)
        is_proven = bool(hopeless) or solution.is_proven
        return Layers(self, solution.layers, meetings, is_proven)

    def _check(self, given: Mapping[int, int]) -> None:
        """Raise `GeometryError` where bodies that share a joint are given one layer."""
        names = self.parts.names
        for pin in self.pins:
            for pair in combinations(sorted(pin.bodies), 2):
                layers = [given.get(body) for body in pair]
                is_apart = layers[0] is None or layers[0] != layers[1]
                what = " and ".join(names[body] for body in pair)
                allowed = f"another one for each, as {pin.name} joins them"
                require(is_apart, f"layer of {what}", layers[0], allowed)


class _Sampled:
    """The outlines of a plan at samples of a form: where these are, and how far an
    outline can go from one to the next, the ``ways`` (o,)."""

    def __init__(self, plan: Plan, form: Form):
        self.form = form
        self.s = np.linspace(0.0, form.branch.length, SAMPLES)
        self.points = form.branch(self.s)
        self.ways = plan.speeds(form.branch) * (self.s[1] - self.s[0])
        self._outlines = plan.outlines
        poses = plan.parts.poses(self.points)
        self._flat = [plan.flat(outline, poses) for outline in plan.outlines]

    def lefts(self, pair: tuple[int, int]) -> np.ndarray:
        """What is left (k,) between two outlines at the samples."""
        first, second = (self._outlines[number] for number in pair)
        return _left(first, second, self._flat[pair[0]], self._flat[pair[1]])


def _left(
    first: Outline, second: Outline, lines: np.ndarray, others: np.ndarray
) -> np.ndarray:
    """What is left (k,) between two outlines whose lines are at (k, m, 2, 3)."""
    distances = distances_by_ends(lines[:, :, None], others[:, None])
    radii = first.radii[:, None] + second.radii
    left: np.ndarray = (distances - radii).min(axis=(1, 2))
    return left


# --- outlines -------------------------------------------------------------------------


def _bodies(parts: Parts, points: np.ndarray, widths: Widths) -> list[Outline]:
    """The lines of every body but for its rails, which come last; its first joint, where
    it has none."""
    outlines = []
    slides = [one for one in _hinges(parts) if one.shape is Shape.BOX]
    for body, drawn in enumerate(parts.lines(points)):
        rails = [one for one in slides if one.bodies[1] == body]
        lines = drawn[: len(drawn) - len(rails)]
        if not len(lines):
            places = [one.place for one in _hinges(parts) if one.is_on(body)]
            lines = np.array([[place, place] for place in places[:1]]).reshape(-1, 2, 3)
        name = parts.names[body]
        radii = np.full(len(lines), widths.rod)
        outlines.append(Outline(name, frozenset({body}), body, lines, radii))
    return outlines


def _pins(parts: Parts, widths: Widths) -> list[Outline]:
    """The pin of every joint that turns, and the two of one that slides."""
    pins = []
    for symbol in _hinges(parts):
        steps = np.zeros((1, 3))
        if symbol.shape is Shape.BOX and widths.guide > 0:
            steps = widths.guide * np.array([[-1.0], [1.0]]) * symbol.direction
        places = symbol.place + steps
        lines = np.stack([places, places], axis=1)
        name = symbol.name.replace("joint", "pin", 1)
        bodies = frozenset(symbol.bodies)
        radii = np.full(len(lines), widths.pin)
        pins.append(Outline(name, bodies, symbol.bodies[0], lines, radii, symbol))
    return pins


def _hinges(parts: Parts) -> list[Symbol]:
    return [
        symbol
        for body in range(len(parts.names))
        for symbol in parts.symbols_on(body)
        if symbol.shape in HINGES
    ]


def _with_slots(
    bodies: list[Outline], pins: list[Outline], plan: Plan
) -> list[Outline]:
    """Bodies with the bars around the slots that slides run in, and with those between
    the two pins of a slide."""
    widths = plan.widths
    outlines = list(bodies)
    for pin in pins:
        if pin.symbol is None or pin.symbol.shape is not Shape.BOX:
            continue
        box, rail = pin.symbol.bodies[:2]
        low, high = plan.range_of_slide(pin)
        ends = np.array([low - widths.guide, high + widths.guide])
        slot = pin.symbol.place + ends[:, None] * pin.symbol.direction
        bar = pin.lines[[0, -1], 0]
        outlines[rail] = _with_line(outlines[rail], slot, widths.pin)
        outlines[box] = _with_line(outlines[box], bar, widths.rod)
    return outlines


def _with_line(outline: Outline, line: np.ndarray, radius: float) -> Outline:
    lines = np.concatenate([outline.lines, line[None]])
    radii = np.append(outline.radii, radius)
    return Outline(outline.name, outline.bodies, outline.holder, lines, radii)
