"""A planar mechanism in layers, as parts that a printer makes: how high layers are, and
where pins begin and end.

All parts stand in a frame whose z axis is the normal of the plane, z = 0 in the middle of
the lowest layer, mm. Seen along z nothing is wider than the outlines of
`linkages.links.layers`. Between two layers there is room for caps, and above it for heads
of pins, so that these meet nothing that their eyes do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from linkages.links.layers import Layers, Outline, Plan, Widths
from linkages.mechanisms.joint import Shape
from linkages.printing.assembly import GRIP, Dimensions

NOTHING = 1e-6  # mm: a rod that is none


class Span(NamedTuple):
    """From where to where something reaches along z, mm."""

    low: float
    high: float


class Bar(NamedTuple):
    """The two ends (2, 3) of a rod, or of the middle line of a slot."""

    start: np.ndarray
    end: np.ndarray


class Eye(NamedTuple):
    """An eye with its bore, about a ``place`` (3,) at z = 0."""

    place: np.ndarray
    span: Span


class Hinge(NamedTuple):
    """A pin from the ``bottom`` of its shaft, at which its head is, to the ``top`` of the
    straight part of its cap, which begins at ``cap``; about a ``place`` (3,) at z = 0 of
    the body of this number, the ``holder``."""

    name: str
    holder: int
    place: np.ndarray
    bottom: float
    cap: float
    top: float


@dataclass(frozen=True, eq=False)
class FlatBody:
    """A body of ``rods``, of bars with ``slots`` and of ``eyes``."""

    name: str
    rods: tuple[Bar, ...]
    slots: tuple[Bar, ...]
    eyes: tuple[Eye, ...]


def widths_of(dimensions: Dimensions, scale: float) -> Widths:
    """What parts cover in the plane, in a unit of the mechanism that is ``scale`` mm."""
    radii = (dimensions.elbow_radius, dimensions.hinge_radius, dimensions.play)
    return Widths(*(radius / scale for radius in radii))


@dataclass(frozen=True, eq=False)
class Stack:
    """The parts of a mechanism in its ``layers``, of a unit that is ``scale`` mm."""

    layers: Layers
    dimensions: Dimensions
    scale: float

    @property
    def plan(self) -> Plan:
        """What bodies and pins cover."""
        return self.layers.plan

    @property
    def pitch(self) -> float:
        """From one layer to the next: an eye, a cap and a head, with play between."""
        sizes = self.dimensions
        cap = GRIP * sizes.pin_radius + sizes.round_end
        return sizes.eye_height + cap + sizes.round_end + 3 * sizes.play

    @cached_property
    def turn(self) -> np.ndarray:
        """The rotation (3, 3) that makes the normal the z axis."""
        normal = self.plan.normal
        across = np.eye(3)[np.argmin(np.abs(normal))]
        if abs(normal[2]) > abs(normal[0]):
            across = np.array([1.0, 0.0, 0.0])
        x_axis = across - (across @ normal) * normal
        x_axis /= np.linalg.norm(x_axis)
        return np.array([x_axis, np.cross(normal, x_axis), normal])

    def height(self, body: int) -> float:
        """The middle of the layer of a body."""
        return self.pitch * float(self.layers.numbers[body] - 1)

    def poses(self, points: np.ndarray) -> np.ndarray:
        """The transforms (k, b, 4, 4) of all bodies at configurations (k, n)."""
        turn = np.eye(4)
        turn[:3, :3] = self.turn
        poses: np.ndarray = turn @ self.plan.parts.poses(points) @ turn.T
        poses[..., :3, 3] *= self.scale
        # they move in the plane, as the layers have their heights
        poses[..., 2, 3] = 0.0
        return poses

    # --- parts ------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> list[FlatBody]:
        """All bodies, each in the frame that moves with it."""
        parts = self.plan.parts
        bodies = []
        for body, outline in enumerate(self.plan.outlines[: len(parts.names)]):
            height = np.array([0.0, 0.0, self.height(body)])
            bars = [Bar(*(self._flat(line) + height)) for line in outline.lines]
            is_slot = outline.radii == self.plan.widths.pin
            long = [np.linalg.norm(bar.end - bar.start) > NOTHING for bar in bars]
            rows = list(zip(bars, is_slot, long, strict=True))
            rods = tuple(bar for bar, slot, is_long in rows if is_long and not slot)
            slots = tuple(bar for bar, slot, _ in rows if slot)
            bodies.append(
                FlatBody(parts.full_names[body], rods, slots, self._eyes(body))
            )
        return bodies

    @cached_property
    def hinges(self) -> list[Hinge]:
        """All pins with their caps; a slide has two."""
        sizes = self.dimensions
        hinges = []
        for pin in self.plan.pins:
            low, high = (self.pitch * (layer - 1) for layer in self.layers.span(pin))
            bottom = low - sizes.eye_height / 2 - sizes.play
            cap = high + sizes.eye_height / 2 + sizes.play
            top = cap + GRIP * sizes.pin_radius
            for line in pin.lines:
                place = self._flat(line)[0]
                hinges.append(Hinge(pin.name, pin.holder, place, bottom, cap, top))
        return hinges

    def _flat(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 3) of a body in the plane z = 0, mm."""
        flat: np.ndarray = self.scale * points @ self.turn.T
        flat[..., 2] = 0.0
        return flat

    def _eyes(self, body: int) -> tuple[Eye, ...]:
        eyes = []
        for pin in self.plan.pins:
            if body not in pin.bodies or _is_rail(pin, body):
                continue
            span = self._span_of_eye(pin, body)
            eyes += [Eye(self._flat(line)[0], span) for line in pin.lines]
        return tuple(eyes)

    def _span_of_eye(self, pin: Outline, body: int) -> Span:
        """An eye reaches up to that of the next body of the pin; that of what slides to
        its rail, above or below."""
        half, play = self.dimensions.eye_height / 2, self.dimensions.play
        middle = self.height(body)
        above = [self.height(one) for one in pin.bodies if self.height(one) > middle]
        if above:
            return Span(middle - half, min(above) - half - play)
        low = middle - half
        if is_slide(pin):
            below = [self.height(one) for one in pin.bodies if one != body]
            low = max(below) + half + play
        return Span(low, middle + half)


def is_slide(pin: Outline) -> bool:
    """Whether it is the pins of a slide."""
    return pin.symbol is not None and pin.symbol.shape is Shape.BOX


def _is_rail(pin: Outline, body: int) -> bool:
    return is_slide(pin) and body != pin.holder
