"""Yu and Baker's syncopated 6R: a collinear Waldron hybrid taken from a primary Bennett
loop."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from math import radians, sin

import numpy as np

from linkages.construction.basic_links import EQUAL_RATIOS, length_a, twist_of
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import half_tangents, twists_with
from linkages.construction.table_equations import zero_offsets
from linkages.entry import Condition, Entry, Parameter, Relation, RelationKind
from linkages.loop import Loop

POSITION = 130


def yu_baker(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Yu and Baker's syncopated 6R of one Bennett ratio: links e - b, a + c, e - d, c,
    b - d, a.

    Twists in rad; the lengths b, c, d follow and are checked if given; e/epsilon
    follows. Raises `GeometryError` for another ratio, and where the loop of e does not
    exist: for alpha = beta and for gamma = delta. Source: Yu and Baker (1981); equation
    (2.4.10) in Song (2013).
    """
    links = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return _syncopated(*links)


def yu_baker_two_ratios(
    a: Number,
    alpha: Number,
    beta: Number,
    c: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Yu and Baker's syncopated 6R with one Bennett ratio for a, b and another for c,
    d.

    Errors and source as `yu_baker`; equation (2.4.10) in Song (2013) asks for one
    ratio, which is not needed.
    """
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    link_c, link_d = bennett_links(c, gamma, d=(delta, d))
    return _syncopated(link_a, link_b, link_c, link_d)


def _syncopated(a: Link, b: Link, c: Link, d: Link) -> Loop:
    product = half_angle_ratio(a.twist, b.twist) * half_angle_ratio(c.twist, d.twist)
    e = syncopated_link(a + c, product)
    return closed_chain(e - b, a + c, e - d, c, b - d, a)


def _guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """A cubic equation for tan(beta/2): delta is beta less the twist of link 56,
    epsilon beta plus that of link 12."""
    twists = form[1]
    half_twists = twists / 2
    a = float(np.tan(half_twists[5]))
    c = float(np.tan(half_twists[3]))
    firsts = _signed(twists[0])
    fifths = _signed(twists[4])
    for s, r in itertools.product(firsts, fifths):
        for beta in twists_with(np.roots(_cubic(a, c, s, r))):
            half_delta = np.tan(beta / 2 - np.arctan(r))
            delta = 2 * np.arctan(half_delta)
            yield {"beta": beta, "delta": delta % np.pi}


def _cubic(a: float, c: float, s: float, r: float) -> np.ndarray:
    """Coefficients, the highest first, of the equation for x = tan(beta/2) by the half
    tangents of a, c and of the links 12, 56."""
    # tan(delta/2) is x - r over 1 + r x
    left = np.convolve([1.0, r * (a * c - 1.0), a * c], [-s, 1.0])
    right = np.convolve([c * r, a + c, -a * r], [1.0, s])
    cubic: np.ndarray = (a + c) * left - (1.0 - a * c) * right
    return cubic


def _signed(twist: float) -> list[float]:
    """Half tangents of the twist and of its opposite, each with and without a half
    turn."""
    return half_tangents(twist) + half_tangents(-twist)


# --- entries

A = length_a(35)
C = Parameter.length("c", 1.25 * sin(radians(81)), "length of link c", 0.3, 3.0)
ALPHA, BETA = twist_of("a", 35), twist_of("b", 62)
GAMMA, DELTA = twist_of("c", 81), twist_of("d", 48)
CONDITIONS = (
    Condition(
        "links e-b, a+c, e-d, c, b-d, a, twists likewise, R = 0", (zero_offsets(),)
    ),
    Condition(
        "sin(epsilon)/e = sin(alpha+gamma)/(a+c), "
        "m(alpha,beta) m(gamma,delta) = m(epsilon, alpha+gamma)"
    ),
)
TWO_RATIOS = Condition("sin(alpha)/a = sin(beta)/b and sin(gamma)/c = sin(delta)/d")
SOURCE = "Yu and Baker (1981); Song (2013), eq. 2.4.10"
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "yu-baker",
        "Yu and Baker's syncopated 6R",
        SOURCE,
        yu_baker,
        (A, ALPHA, BETA, GAMMA, DELTA),
        conditions=(EQUAL_RATIOS, *CONDITIONS),
        guesses=_guesses,
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE, "yu-baker-two-ratios", "Yu and Baker (1981)"
            ),
        ),
        facts=FACTS,
    ),
    Entry(
        "yu-baker-two-ratios",
        "Yu and Baker's syncopated 6R with two Bennett ratios",
        SOURCE,
        yu_baker_two_ratios,
        (A, ALPHA, BETA, C, GAMMA, DELTA),
        conditions=(TWO_RATIOS, *CONDITIONS),
        guesses=_guesses,
        relations=(
            Relation(
                RelationKind.CONSTRUCTED,
                "waldron-collinear",
                "Yu and Baker (1981)",
                "taken from a primary Bennett loop",
            ),
        ),
        errata=("four equal Bennett ratios are printed; two pairs suffice",),
        facts=FACTS,
    ),
)
