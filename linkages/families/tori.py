"""Linkages in the geometry of tori: the 4R of two equal tori and the 5R of two such
pairs.

A torus is drawn by a circle that turns about the axis through Q: R is the centre of the
circle, r its distance from Q, s its radius, S a point of it; chi and theta turn the
axis of the circle. Two tori that are one surface give a 4R with the axes Q, R1, S, R2:
it is a Bennett linkage, whose pins are read at reference points moved by t along the
axis S. Two such pairs with an axis and a link in common give a 5R in sixteen variants:
it is the generalized Goldberg linkage. Nothing has to be iterated.

Source: Bil and Budniak (2015); Bil (2012) for the 4R. Where their equations (2.1),
(2.3), (2.5), (2.6), (3.5) and (3.6) are misprinted, the geometry here follows (2.2) and
closure.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import NamedTuple

import numpy as np

from linkages.construction.conditions import (
    decided,
    require_different,
    require_positive,
    require_within,
)
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import (
    Number,
    asin,
    atan,
    atan2,
    cos,
    pi_like,
    sin,
    sqrt,
)
from linkages.construction.possible_angles import kinks
from linkages.construction.spatial_triangle import composite_link
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop
from linkages.values import GeometryError

POSITION = 60


@dataclass(frozen=True)
class TorusLink:
    """A link between two axes, and ``shift``: where the reference point stands on the
    second axis, from the foot of the common normal. The twist lies between 0 and pi;
    the length has a sign."""

    link: Link
    shift: Number

    @property
    def radius(self) -> Number:
        """Distance of the reference point from the first axis."""
        return sqrt(self.link.length**2 + (self.shift * sin(self.link.twist)) ** 2)

    @property
    def chi(self) -> Number:
        """Angle (rad) that turns the second axis, first."""
        twist = self.link.twist
        return atan2(self.link.length * sin(twist), self.radius * cos(twist))

    @property
    def theta(self) -> Number:
        """Angle (rad) that turns it then."""
        return asin(self.shift * sin(self.link.twist) ** 2 / self.radius)

    @property
    def normal(self) -> Number:
        """Angle (rad) about the first axis from the reference point to the common
        normal."""
        return atan2(self.shift * sin(self.link.twist), self.link.length)

    @property
    def normal_at_end(self) -> Number:
        """The same angle about the second axis, in the frame Rx(chi) Ry(theta) of the
        circle."""
        return atan2(
            self.shift * sin(self.link.twist) * cos(self.link.twist), self.link.length
        )

    def first_reversed(self) -> TorusLink:
        """The same with the first axis pointing the other way."""
        pi = pi_like(self.link.twist)
        return TorusLink(Link(-self.link.length, pi - self.link.twist), self.shift)

    def second_reversed(self) -> TorusLink:
        """The same with the second axis pointing the other way."""
        pi = pi_like(self.link.twist)
        return TorusLink(Link(-self.link.length, pi - self.link.twist), -self.shift)


class Companion(NamedTuple):
    """The pin of a torus, the torus that is the same surface, and the pin of that
    one."""

    pin: TorusLink
    other: TorusLink
    other_pin: TorusLink


def torus_link(radius: Number, chi: Number, theta: Number) -> TorusLink:
    """The link from the axis of a torus to that of its circle, with centre at
    ``radius``; angles in rad.

    For a pin at S give (s, zeta, kappa). Raises `GeometryError` for parallel axes.
    """
    x = sin(theta)
    y = -sin(chi) * cos(theta)
    z = cos(chi) * cos(theta)
    sine = sqrt(x * x + y * y)
    require_different("sine of the angle between the axes", sine, 0, "parallel axes")
    link = Link(-radius * y / sine, atan2(sine, z))
    return TorusLink(link, radius * x / sine**2)


def companion(torus: TorusLink, circle: Number, mirrored: bool = False) -> Companion:
    """The companion of the torus with this link and radius ``circle`` of its circle.

    The pin leads from the axis of the circle to that of S; the companion torus is the
    same surface drawn by another circle, and the second pin leads from that circle to
    the same axis S. Two companions exist, mirror images in the axis of the torus;
    ``mirrored`` chooses the second. Raises `GeometryError` when ``circle`` is too large
    for a torus without shift. Closed form found from the Bennett closure: tan^2 of the
    pin's twist is the positive root of tau^2 u^2 + (k^2 + tau^2 - s^2) u - s^2 = 0.
    """
    require_positive("radius of the circle of the torus", circle)
    alpha = torus.link.twist
    tau = torus.shift
    sine = sin(alpha)
    require_different("sine of the twist of the torus", sine, 0, "parallel axes")
    k = torus.link.length / sine
    beta = atan(sqrt(_squared_tangent(k, tau, circle)))
    t = tau / cos(beta)
    b = k * sin(beta) if mirrored else -k * sin(beta)
    pin = TorusLink(Link(b, beta), t)
    other = TorusLink(Link(b, beta), t * cos(alpha))
    if mirrored:
        return Companion(pin, other, TorusLink(torus.link, t))
    # the first axis of the second pin is turned round
    reversed_pin = Link(-torus.link.length, pi_like(alpha) - alpha)
    return Companion(pin, other.second_reversed(), TorusLink(reversed_pin, t))


def _squared_tangent(k: Number, tau: Number, s: Number) -> Number:
    """tan^2 of the twist of the pin."""
    if tau == 0:
        size = decided(k)
        distance = k if size is None or size >= 0 else -k
        name = "length/sin(twist) of the torus less the radius of the circle"
        require_positive(name, distance - s)
        return s**2 / (k**2 - s**2)
    p = k**2 + tau**2 - s**2
    root = sqrt(p**2 + 4 * tau**2 * s**2)
    require_different("circle of the torus", p + root, 0, "a point", scale=0)
    return 2 * s**2 / (p + root)


def torus_4r(
    r1: Number, s1: Number, chi1: Number, theta1: Number, mirrored: bool = False
) -> Loop:
    """The 4R of two equal tori, axes Q, R1, S, R2: a Bennett linkage. Lengths in one
    unit, angles in rad."""
    torus = torus_link(r1, chi1, theta1)
    pair = companion(torus, s1, mirrored)
    links = (torus, pair.pin, pair.other_pin, pair.other)
    return closed_chain(*(part.link for part in links))


class Sense(Enum):
    """Whether an axis points as the one that it coincides with, or the other way."""

    PLUS = "+"
    MINUS = "-"


@dataclass(frozen=True)
class Variant:
    """One of the sixteen ways in which two pairs of tori make a 5R.

    The circle of torus ``first`` (1 or 2) carries the torus ``second`` (3, with the
    ratio s/r below 1, or 4, above 1), Z_i1 = ``z_sense`` Z_j, U_i = ``u_sense`` Z_j1.
    ``mirrored`` takes the second companion of the torus ``second``: the source does not
    say which one, and both move.
    """

    first: int
    second: int
    z_sense: Sense
    u_sense: Sense
    mirrored: bool

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        senses = f"{self.z_sense.name}-{self.u_sense.name}".lower()
        return f"torus-5r-{self.first}{self.second}-{senses}"


STANDARD = Variant(1, 4, Sense.PLUS, Sense.PLUS, mirrored=False)


@dataclass(frozen=True)
class _Stage:
    """What both pairs of tori of a 5R are, before they are joined at the angle delta:
    of the first pair the ``torus`` that carries, the ``other`` one and its pin, and the
    companion that makes the second ``pair``."""

    torus: TorusLink
    other: TorusLink
    other_pin: TorusLink
    pair: Companion


def _stage(
    variant: Variant,
    r1: Number,
    s1: Number,
    chi1: Number,
    theta1: Number,
    ratio: Number,
) -> _Stage:
    torus = torus_link(r1, chi1, theta1)
    pin, other, other_pin = companion(torus, s1)
    if variant.first == 2:
        torus, pin, other, other_pin = other, other_pin, torus, pin
    carried = pin
    if variant.u_sense is Sense.MINUS:
        carried = carried.second_reversed()
    if variant.z_sense is Sense.MINUS:
        carried = carried.first_reversed()
    pair = companion(carried, ratio * pin.radius, variant.mirrored)
    return _Stage(torus, other, other_pin, pair)


def torus_5r(
    r1: Number,
    s1: Number,
    chi1: Number,
    theta1: Number,
    ratio: Number,
    delta: Number,
    variant: Variant = STANDARD,
) -> Loop:
    """The 5R of two pairs of tori, axes Q1, R of the other torus of the first pair, S,
    S', R' of the second.

    Torus 1 has ``r1, s1, chi1, theta1``; ``ratio`` is s/r of the torus that is carried;
    ``delta`` (rad) is where the other torus of that pair stands in this frame. Lengths
    in one unit, angles in rad. Raises `GeometryError`.
    """
    low, high = (0, 1) if variant.second == 3 else (1, math.inf)
    require_within(f"s/r of torus {variant.second}", ratio, low, high, "")
    stage = _stage(variant, r1, s1, chi1, theta1, ratio)
    pin_j, other_j, other_pin_j = stage.pair
    if variant.u_sense is Sense.MINUS:
        pin_j = pin_j.first_reversed()
    turn = other_j.normal + delta
    at_end = stage.torus.normal_at_end
    if variant.z_sense is Sense.MINUS:
        other_j = other_j.first_reversed()
        kink = at_end + pi_like(turn) + turn
    else:
        kink = at_end - turn
    joined = composite_link(other_j.link, stage.torus.link, kink)
    links = (
        stage.other.link,
        stage.other_pin.link,
        pin_j.link,
        other_pin_j.link,
        joined.link,
    )
    offsets = (joined.after.offset, 0, 0, 0, joined.before.offset)
    return closed_chain(*links, offsets=offsets)


# --- first guesses: parameters read off the table of a generalized Goldberg 5R. The
# shift along the axis of S is redundant: it is chosen so that the ratio s/r lies on the
# side of 1 that the variant asks for.

SHIFTS = (0.0, 0.3, 0.6, 1.0, 1.7, 3.0)  # in units of the first length, either sign
MARGIN = 1.01  # of the ratio s/r from 1
LOOSE = 0.05  # of the mean length, and rad: a 5R that misses by more is another


def _guesses(variant: Variant, form: np.ndarray) -> Iterator[dict[str, float]]:
    if not _is_goldberg_like(form):
        return
    for shift, supplement in itertools.product(SHIFTS, (False, True)):
        is_reached = False
        for sign in (1, -1) if shift else (1,):
            distance = sign * shift * form[0, 0]
            for parameters in _guesses_at_shift(variant, form, distance, supplement):
                is_reached = True
                yield parameters
        if is_reached and supplement:
            return


def _is_goldberg_like(form: np.ndarray) -> bool:
    """Whether links 12 and 45 are alike, link 23 has their Bennett ratio, and joints 2,
    3, 4 no offset, nearly."""
    lengths, twists, offsets = form
    unit = lengths.mean()
    ratio_gap = lengths[1] * np.sin(twists[0]) - lengths[0] * np.sin(twists[1])
    gaps = [lengths[0] - lengths[3], ratio_gap, *offsets[1:4]]
    return bool(
        min(lengths[:4]) > 0
        and max(map(abs, gaps)) < LOOSE * unit
        and abs(np.sin(twists[0] - twists[3])) < LOOSE
    )


def _guesses_at_shift(
    variant: Variant, form: np.ndarray, shift: float, supplement: bool
) -> Iterator[dict[str, float]]:
    parameters = _parameters_at_shift(variant, form, shift, supplement)
    is_below_one = parameters["ratio"] < 1 / MARGIN
    is_above_one = parameters["ratio"] >= MARGIN
    if not (is_below_one if variant.second == 3 else is_above_one):
        return
    try:
        stage = _stage(variant, **parameters)
    except (GeometryError, ArithmeticError):
        return
    twists = form[1].tolist()
    candidates = kinks(twists[2], twists[1], twists[4])
    for kink, turn in itertools.product(candidates, (0.0, math.pi)):
        delta = _delta(variant, stage, kink + turn)
        wrapped = (delta + math.pi) % (2 * math.pi) - math.pi
        yield {**parameters, "delta": wrapped}


def _parameters_at_shift(
    variant: Variant, form: np.ndarray, shift: float, supplement: bool
) -> dict[str, float]:
    """The parameters but delta, for a shift of the reference points on the axis of
    S."""
    lengths = form[0].tolist()
    twists = form[1].tolist()
    main, side = (1, 0) if variant.first == 1 else (0, 1)
    length = lengths[main]
    twist = math.pi - twists[main] if supplement else twists[main]
    torus = TorusLink(Link(length, twist), shift)
    cosine = abs(math.cos(twists[side]))
    pin = shift / cosine if cosine > 1e-9 else 0.0
    carried = math.hypot(lengths[2], pin * math.tan(twists[2]))
    carrying = math.hypot(lengths[0], pin * math.sin(twists[0]))
    return {
        "r1": float(torus.radius),
        "s1": math.hypot(lengths[side], pin * math.sin(twists[side])),
        "chi1": float(torus.chi),
        "theta1": float(torus.theta),
        "ratio": carried / carrying,
    }


def _delta(variant: Variant, stage: _Stage, kink: float) -> float:
    """The angle delta (rad) at which `torus_5r` locks its composite link at
    ``kink``."""
    at_end = float(stage.torus.normal_at_end)
    normal = float(stage.pair.other.normal)
    if variant.z_sense is Sense.MINUS:
        return kink - (at_end + math.pi + normal)
    return -(kink - (at_end - normal))


def _bennett_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    yield {"r1": form[0, 0], "s1": form[0, 1], "chi1": form[1, 0], "theta1": 0.0}


# --- variants

MIRRORED = {
    (1, 3, "--"),
    (1, 4, "-+"),
    (1, 4, "--"),
    (2, 3, "++"),
    (2, 3, "+-"),
    (2, 4, "++"),
}


def _variants() -> Iterator[Variant]:
    for first, second, z_sense, u_sense in itertools.product(
        (1, 2), (3, 4), Sense, Sense
    ):
        mirrored = (first, second, z_sense.value + u_sense.value) in MIRRORED
        yield Variant(first, second, z_sense, u_sense, mirrored)


ENTRIES = read_entries(
    "tori",
    {
        "torus-4r": Model(torus_4r, guesses=_bennett_guesses),
        **{
            variant.name: Model(
                partial(torus_5r, variant=variant), guesses=partial(_guesses, variant)
            )
            for variant in _variants()
        },
    },
)
