"""The parameters of linkages that are made of basic links a/alpha, b/beta, c/gamma,
d/delta."""

from __future__ import annotations

from math import radians, sin

from linkages.entry import Condition, Parameter

TWISTS = {"a": "alpha", "b": "beta", "c": "gamma", "d": "delta"}
EQUAL_RATIOS = Condition("sin(twist)/length is the same for the links a, b, c, d")


def length_a(degrees: float, meaning: str = "length of link a") -> Parameter:
    """The length of link a, by default 1.7 times the sine of its default twist."""
    return Parameter.length("a", 1.7 * sin(radians(degrees)), meaning, 0.3, 3.0)


def twist_of(link: str, degrees: float) -> Parameter:
    """The twist of a basic link "a", "b", "c" or "d"."""
    return Parameter.angle(TWISTS[link], degrees, f"twist of link {link}", 15, 110)


def twists_of_links(**degrees: float) -> tuple[Parameter, ...]:
    """The twists of the links that are given, with these defaults."""
    return tuple(twist_of(link, value) for link, value in degrees.items())
