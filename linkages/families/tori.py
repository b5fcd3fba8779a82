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

from dataclasses import dataclass
from functools import partial
from typing import Any

from linkages.construction.conditions import decided, require_positive, require_within
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import atan, atan2, cos, pi_like, sin, sqrt
from linkages.construction.spatial_triangle import composite_link
from linkages.entry import Entry, Parameter
from linkages.loop import GeometryError, Loop

__all__ = ["ENTRIES", "TorusLink", "companion", "torus_4r", "torus_5r", "torus_link"]


@dataclass(frozen=True)
class TorusLink:
    """A link between two axes, and ``shift``: where the reference point stands on the
    second axis, from the foot of the common normal. The twist lies between 0 and pi;
    the length has a sign."""

    link: Link
    shift: Any

    @property
    def radius(self) -> Any:
        """Distance of the reference point from the first axis."""
        return sqrt(self.link.length**2 + (self.shift * sin(self.link.twist)) ** 2)

    @property
    def normal(self) -> Any:
        """Angle (rad) about the first axis from the reference point to the common
        normal."""
        return atan2(self.shift * sin(self.link.twist), self.link.length)

    @property
    def normal_at_end(self) -> Any:
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


def torus_link(radius: Any, chi: Any, theta: Any) -> TorusLink:
    """The link from the axis of a torus to that of its circle, with centre at
    ``radius``; angles in rad.

    For a pin at S give (s, zeta, kappa). Raises `GeometryError` for parallel axes.
    """
    x, y, z = sin(theta), -sin(chi) * cos(theta), cos(chi) * cos(theta)
    sine = sqrt(x * x + y * y)
    size = decided(sine)
    if size is not None and size < 1e-12:
        raise GeometryError(
            "sine of the angle between the axes", size, "greater than 0"
        )
    return TorusLink(Link(-radius * y / sine, atan2(sine, z)), radius * x / sine**2)


def companion(
    torus: TorusLink, circle: Any, mirrored: bool = False
) -> tuple[TorusLink, TorusLink, TorusLink]:
    """(pin, companion, its pin) of the torus with this link and radius ``circle`` of
    its circle.

    ``pin`` leads from the axis of the circle to that of S; the companion torus is the
    same surface drawn by another circle, and the second pin leads from that circle to
    the same axis S. Two companions exist, mirror images in the axis of the torus;
    ``mirrored`` chooses the second. Raises `GeometryError` when ``circle`` is too large
    for a torus without shift. Closed form found from the Bennett closure: tan^2 of the
    pin's twist is the positive root of tau^2 u^2 + (k^2 + tau^2 - s^2) u - s^2 = 0.
    """
    alpha, tau = torus.link.twist, torus.shift
    k = torus.link.length / sin(alpha)
    if tau == 0:
        require_positive(
            "length/sin(twist) of the torus less the radius of the circle",
            abs(k) - circle,
        )
        u = circle**2 / (k**2 - circle**2)
    else:
        p = k**2 + tau**2 - circle**2
        root = sqrt(p**2 + 4 * tau**2 * circle**2)
        u = 2 * circle**2 / (p + root)
    beta = atan(sqrt(u))
    t = tau / cos(beta)
    b = k * sin(beta) if mirrored else -k * sin(beta)
    pin = TorusLink(Link(b, beta), t)
    other, other_pin = (
        TorusLink(Link(b, beta), t * cos(alpha)),
        TorusLink(torus.link, t),
    )
    if mirrored:
        return pin, other, other_pin
    reversed_pin = Link(
        -torus.link.length, pi_like(alpha) - alpha
    )  # its first axis is turned round
    return pin, other.second_reversed(), TorusLink(reversed_pin, t)


def torus_4r(r1: Any, s1: Any, chi1: Any, theta1: Any, mirrored: bool = False) -> Loop:
    """The 4R of two equal tori, axes Q, R1, S, R2: a Bennett linkage. Lengths in one
    unit, angles in rad."""
    torus = torus_link(r1, chi1, theta1)
    pin, other, other_pin = companion(torus, s1, mirrored)
    return closed_chain(torus.link, pin.link, other_pin.link, other.link)


def torus_5r(
    r1: Any,
    s1: Any,
    chi1: Any,
    theta1: Any,
    ratio: Any,
    delta: Any,
    first: int = 1,
    second: int = 4,
    z_sign: int = 1,
    u_sign: int = 1,
    mirrored: bool = False,
) -> Loop:
    """The 5R of two pairs of tori, axes Q1, R of the other torus of the first pair, S,
    S', R' of the second.

    Torus 1 has ``r1, s1, chi1, theta1``. The circle of torus ``first`` (1 or 2) carries
    the torus ``second`` (3, with ``ratio`` s/r below 1, or 4, above 1), Z_i1 = z_sign
    Z_j, U_i = u_sign Z_j1; ``delta`` (rad) is where the other torus of that pair stands
    in this frame; ``mirrored`` takes its second companion. Lengths in one unit, angles
    in rad. Raises `GeometryError`.
    """
    low, high = (0, 1) if second == 3 else (1, float("inf"))
    require_within(f"s/r of torus {second}", ratio, low, high, "")
    torus = torus_link(r1, chi1, theta1)
    pin, other, other_pin = companion(torus, s1)
    if first == 2:
        torus, pin, other, other_pin = other, other_pin, torus, pin
    carried = pin if u_sign > 0 else pin.second_reversed()
    if z_sign < 0:
        carried = carried.first_reversed()
    pin_j, other_j, other_pin_j = companion(carried, ratio * pin.radius, mirrored)
    if u_sign < 0:
        pin_j = pin_j.first_reversed()
    turn = other_j.normal + delta
    kink = torus.normal_at_end - turn
    if z_sign < 0:
        other_j, kink = (
            other_j.first_reversed(),
            torus.normal_at_end + pi_like(turn) + turn,
        )
    joined = composite_link(other_j.link, torus.link, kink)
    links = (other.link, other_pin.link, pin_j.link, other_pin_j.link, joined.link)
    return closed_chain(*links, offsets=(joined.after[0], 0, 0, 0, joined.before[0]))


_FIRST_TORUS = (
    Parameter(
        "r1",
        1.5,
        "length",
        "distance of the circle's centre from the axis of torus 1",
        1.2,
        2.0,
    ),
    Parameter("s1", 0.9, "length", "radius of the circle of torus 1", 0.4, 1.1),
    Parameter("chi1", 0.8, "angle", "first angle of the circle's axis", 0.4, 1.3),
    Parameter("theta1", 0.25, "angle", "second angle of the circle's axis", -0.5, 0.5),
)
_DELTA = Parameter(
    "delta", 0.6, "angle", "place of the other torus of the second pair", -2.0, 2.0
)
_RATIOS = {(1, 3): 0.7, (1, 4): 1.6, (2, 3): 0.45, (2, 4): 1.02}
_MIRRORED = {
    (1, 3, "--"),
    (1, 4, "-+"),
    (1, 4, "--"),
    (2, 3, "++"),
    (2, 3, "+-"),
    (2, 4, "++"),
}
_SIGNS = {"++": (1, 1), "+-": (1, -1), "-+": (-1, 1), "--": (-1, -1)}
_WORDS = {"+": "plus", "-": "minus"}
_ERRATA = (
    "(2.1): r is added before the turn by sigma, as in (2.2); the axis of the turn by chi is X, not Y",
    "(2.3): the terms with sin(theta) of the second and third row take the other sign; (2.5): r is missing",
    "(2.6): the axis of the circle is Rz(sigma) (sin theta, -sin chi cos theta, cos chi cos theta)",
    "(3.5), (3.6): the centre (r1, 0, 0) is to be turned by sigma1",
)


def _entry(first: int, second: int, signs: str) -> Entry:
    z_sign, u_sign = _SIGNS[signs]
    mirrored = (
        first,
        second,
        signs,
    ) in _MIRRORED  # the source does not say which; both move
    ratio = _RATIOS[first, second]
    low, high = (0.3, 0.9) if second == 3 else (1.02, 1.8)
    which = f"circle {first} on torus {second}, Z{first}1 = {signs[0]}Z{second}, U{first} = {signs[1]}Z{second}1"
    return Entry(
        f"torus-5r-{first}{second}-{_WORDS[signs[0]]}-{_WORDS[signs[1]]}",
        f"5R of two pairs of tori, {which}",
        "Bil and Budniak (2015), eqs 3.1 to 3.4",
        partial(
            torus_5r,
            first=first,
            second=second,
            z_sign=z_sign,
            u_sign=u_sign,
            mirrored=mirrored,
        ),
        (
            *_FIRST_TORUS,
            Parameter("ratio", ratio, "number", f"s/r of torus {second}", low, high),
            _DELTA,
        ),
        (
            "r1^2 + s1^2 = r2^2 + s2^2, r1 s1 cos(theta1) = r2 s2 cos(theta2), likewise for the tori 3, 4",
            f"R{first} = Q{second}, s{first} = r{second}, Z{first}1 parallel to Z{second}",
            "equivalent to the generalized Goldberg 5R",
        ),
        errata=_ERRATA,
        facts={"joints": 5, "mobility": 1},
    )


ENTRIES = (
    Entry(
        "torus-4r",
        "4R of two equal tori",
        "Bil (2012); Bil and Budniak (2015), section 2",
        torus_4r,
        _FIRST_TORUS,
        (
            "r1^2 + s1^2 = r2^2 + s2^2, r1 s1 cos(theta1) = r2 s2 cos(theta2)",
            "s1 sin(chi1) = s2 sin(chi2), s1 sin(theta1) cos(chi1) = s2 sin(theta2) cos(chi2)",
            "a Bennett linkage whose joints are read at points moved along one axis",
        ),
        errata=_ERRATA[:3],
        facts={"joints": 4, "mobility": 1},
    ),
    *(_entry(*pair, signs) for pair in _RATIOS for signs in _SIGNS),
)
