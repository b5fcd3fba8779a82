"""The sizes of printed rods and hinges."""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkages.values import GeometryError, told_apart

PIN_SHARE = 0.5  # of the diameter of rods; 3 mm, an M3 bolt, for rods of 6 mm
# what touches along a curve only, or by whole faces, is hard on boolean operations:
EYE_OVER_ROD = 1.1  # so eyes are wider and taller than rods,
ELBOW_OVER_ROD = 1.05  # and the balls at the corners of rods, too
GRIP = 1.5  # how much of the pin a cap holds, in radii of the pin
GLUE_SHARE = 1 / 3  # of the play, between pin and cap
ARM_ROOM = 4.0  # in plays: between a hinge and the corner of a rod that leaves it


@dataclass(frozen=True)
class Dimensions:
    """Sizes of rods and hinges, mm: the ``diameter`` of rods, the ``play`` between
    surfaces that move on each other and the least thickness of a ``wall``.

    A hinge is a pin with a round head through the eyes of both links, and a cap on its
    end. From the middle between the eyes it reaches from ``bottom`` to ``top`` along
    its axis, with a half ball beyond each. Raises `GeometryError` for a rod or a play
    that cannot be printed.
    """

    diameter: float
    play: float
    wall: float

    def __post_init__(self) -> None:
        for name in ("diameter", "play", "wall"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise GeometryError(name, value, "positive and finite, in mm")
        if self.diameter < 2 * self.wall:
            shown, least = told_apart(self.diameter, 2 * self.wall)
            allowed = f"at least {least} mm, twice the wall"
            raise GeometryError("diameter", f"{shown} mm", allowed)

    @property
    def rod_radius(self) -> float:
        """That of the rods."""
        return self.diameter / 2

    @property
    def elbow_radius(self) -> float:
        """That of the balls at corners; no point of a rod is farther from its line."""
        return ELBOW_OVER_ROD * self.rod_radius

    @property
    def pin_radius(self) -> float:
        """That of the pins."""
        return PIN_SHARE * self.rod_radius

    @property
    def bore_radius(self) -> float:
        """That of the bores that turn on a pin."""
        return self.pin_radius + self.play

    @property
    def cap_bore_radius(self) -> float:
        """That of the bore by which a cap is glued or pressed on its pin."""
        return self.pin_radius + GLUE_SHARE * self.play

    @property
    def hinge_radius(self) -> float:
        """That of eyes, heads and caps."""
        return max(EYE_OVER_ROD * self.rod_radius, self.bore_radius + self.wall)

    @property
    def eye_height(self) -> float:
        """That of an eye, along its axis."""
        return 2 * EYE_OVER_ROD * self.rod_radius

    @property
    def step(self) -> float:
        """From the middle of a hinge to that of an eye."""
        return (self.eye_height + self.play) / 2

    @property
    def bottom(self) -> float:
        """Where the head of a pin ends, a flat face (below zero)."""
        return -(self.eye_height + 1.5 * self.play)

    @property
    def cap_height(self) -> float:
        """That of the straight part of a cap."""
        return GRIP * self.pin_radius

    @property
    def top(self) -> float:
        """Where the straight part of a cap ends."""
        return -self.bottom + self.cap_height

    @property
    def arm(self) -> float:
        """How far a rod goes straight out from an axis, so that what follows is beside
        the hinge."""
        return self.hinge_radius + self.elbow_radius + ARM_ROOM * self.play
