"""Goldberg's 6R linkages: three Bennett loops in series or in L-shape, their
syncopations, Baker's variants, and all of these with kink angles.

They are the outer loops of three or four Bennett loops with the links a/alpha, b/beta,
c/gamma, d/delta of one Bennett ratio. Twists in rad. Only the length of link a is free:
b, c, d follow from the Bennett ratio, and are checked where they are given. Every offset
is zero unless a kink angle brings one.

Baker's variants with kink angles, and the isomer of the L-shape, are left by a network
of Bennett loops when two of its joints are locked; Song (2013), sections 5.4.3 and
5.4.6, names them without formulas. How they move follows from
`linkages.networks.network`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    constant,
    cosine_of,
    joint,
    minus,
    negative,
    only,
    plus,
    ratio,
    reciprocal,
    sine_of,
    tangent,
)
from linkages.construction import numbers
from linkages.construction.constructions import lock
from linkages.construction.link import (
    Link,
    basic_links,
    chain_constructor,
    half_angle_ratio,
    joined_chain,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import half_tangents, kink_pairs, twists_with
from linkages.construction.spatial_triangle import KinkAngle
from linkages.entry_table import Model, read_entries
from linkages.families.goldberg_5r import syncopation_guesses
from linkages.loop import Loop

POSITION = 70

# Goldberg (1943): links a, c, d in line
serial_goldberg = chain_constructor("b a+c+d b d c a")
# Goldberg (1943): a Goldberg 5R and a Bennett loop across it on link a
l_shape_goldberg = chain_constructor("b+d a+c b c d a")
# Baker (1993a), equations (2.4.5) and (2.4.6) in Song (2013)
serial_variant = chain_constructor("b a+c d b c+d a")
l_shape_variant = chain_constructor("b+d a c b c+d a")


def syncopated_serial_goldberg(*parameters: Number, **others: Any) -> Loop:
    """Syncopated serial Goldberg 6R of `basic_links`: a serial one taken from a Bennett
    loop with sides a + c + d and e.

    Raises `GeometryError` for a beta equal to one of the other twists. Source: Goldberg
    (1943), equation (2.4.2) in Song (2013), whose triple product lacks a minus sign.
    """
    links = basic_links(*parameters, **others)
    product = _product_with_b(links, "acd")
    links["e"] = syncopated_link(links["a"] + links["c"] + links["d"], -product)
    return joined_chain("e-b a+c+d e-b d c a", links)


def syncopated_l_shape_goldberg(*parameters: Number, **others: Any) -> Loop:
    """Syncopated L-shape Goldberg 6R of `basic_links`: an L-shape one taken from a
    Bennett loop with sides a + c and e.

    Raises `GeometryError` for a beta equal to alpha or gamma. Source: Goldberg (1943),
    equation (2.4.4) in Song (2013).
    """
    links = basic_links(*parameters, **others)
    product = _product_with_b(links, "ac")
    links["e"] = syncopated_link(links["a"] + links["c"], product)
    return joined_chain("b+d-e a+c e-b c d a", links)


def _product_with_b(links: Mapping[str, Link], names: str) -> Number:
    """The product of the half-angle ratios of these links with b."""
    product, *others = (
        half_angle_ratio(links[name].twist, links["b"].twist) for name in names
    )
    for factor in others:
        product = product * factor
    return product


def _locked_ring(order: str, *locks: tuple[int, str]) -> Callable[..., Loop]:
    """The constructor of the loop that a ring of basic links leaves when joints are
    locked, one after the other, each at the kink (rad, or a `Kink`) of this name."""

    def construct(
        a: Number,
        alpha: Number,
        beta: Number,
        gamma: Number,
        delta: Number,
        **kink_angles: KinkAngle,
    ) -> Loop:
        loop = joined_chain(order, basic_links(a, alpha, beta, gamma, delta))
        for number, name in locks:
            loop = lock(loop, number, kink_angles[name])
        return loop

    return construct


# links b, [[a c] d], b, d, c, a, and [b d], [a c], b, c, d, a: named by Goldberg (1943) and
# Song (2013), section 2.4.1, without formulas
generalized_serial_goldberg = _locked_ring(
    "b a c d b d c a", (3, "kink_1"), (3, "kink_2")
)
generalized_l_shape_goldberg = _locked_ring(
    "d b a c b c d a", (4, "kink_1"), (2, "kink_2")
)
# links [b d], a, c, b, [c d], a: case 2 of section 5.4.3 of Song (2013)
generalized_l_shape_variant = _locked_ring(
    "d b a c b c d a", (7, "kink_2"), (2, "kink_1")
)
# links b, [a c], d, b, [c d], a: section 5.4.6 of Song (2013)
generalized_serial_variant = _locked_ring(
    "b a c d b d c a", (7, "kink_2"), (3, "kink_1")
)
# links [b d], [a c], b, d, c, a: case 3 of section 5.4.3 of Song (2013)
isomerized_l_shape = _locked_ring("d b a c b d c a", (4, "kink_1"), (2, "kink_2"))


# --- closed forms


class _Joined(NamedTuple):
    """What the joints before and after a link of two gain, and the kink at which it is
    locked, as pairs; the constants in which these are written."""

    before: Pair
    after: Pair
    kink: Pair
    constants: Mapping[str, Number]


STRAIGHT = _Joined(ZERO, ZERO, ZERO, {})


def _joined(number: int, first: str, second: str) -> _Joined:
    """Links with these twists, locked at the kink of this number, by the projections of
    the spatial triangle."""
    u_1, u_2, u_kink = tangent(first), tangent(second), tangent(f"kink_{number}")
    c_1, s_1 = cosine_of(u_1), sine_of(u_1)
    c_2, s_2 = cosine_of(u_2), sine_of(u_2)
    c_kink, s_kink = cosine_of(u_kink), sine_of(u_kink)
    names = [f"{name}_{number}" for name in "xyzwnk"]
    x, y, z, w, n, k = (constant(name) for name in names)
    values = (
        c_kink * s_2 * c_1 + c_2 * s_1,
        s_kink * s_2,
        c_kink * s_1 * c_2 + c_1 * s_2,
        s_kink * s_1,
        numbers.sqrt(x**2 + y**2),
        u_kink,
    )
    constants = dict(zip(names, values, strict=True))
    return _Joined((y, n + x), (w, n + z), (k, 1), constants)


def _closed_form(
    linkage: str,
    joints: Sequence[Pair],
    factors: Mapping[str, tuple[str, str]],
    first: _Joined,
    second: _Joined,
) -> tuple[ClosedForm, ...]:
    """The closed form with the ``factors`` of the Bennett loops, each by the twists whose
    ratio it is."""
    constants = {name: ratio(*twists) for name, twists in factors.items()}
    form = ClosedForm(
        linkage,
        "form of three Bennett loops",
        "from the network of Bennett loops of Song 2013, section 5.4",
        ("alpha", "beta", "gamma", "delta"),
        only(*joints),
        {**constants, **first.constants, **second.constants},
    )
    if first is not STRAIGHT:
        form = replace(
            form,
            form="form of the network",
            source="from the network of Bennett loops of Song (2013), section 5.4",
            angles=(*form.angles, "kink_1", "kink_2"),
        )
    return (form,)


def _l_shape_variant_formulas(kinked: bool, linkage: str) -> tuple[ClosedForm, ...]:
    """Three cells around a common axis, locked at joints 2 and 0: p is the angle of a
    cell at its outer joint, v that at the joint before."""
    b_d = _joined(1, "delta", "beta") if kinked else STRAIGHT
    c_d = _joined(2, "gamma", "delta") if kinked else STRAIGHT
    p_1 = minus(joint(1), b_d.before)
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = plus(minus(v_1, HALF_TURN), b_d.kink)
    p_2 = reciprocal(v_2, constant("m_b"))
    p_3 = negative(plus(c_d.kink, plus(p_1, p_2)))
    v_3 = reciprocal(p_3, constant("m_c"))
    joints = (
        joint(1),
        plus(p_2, b_d.after),
        plus(minus(HALF_TURN, v_2), v_3),
        p_3,
        plus(negative(v_3), c_d.before),
        plus(v_1, c_d.after),
    )
    factors = {
        "m_a": ("delta", "alpha"),
        "m_b": ("alpha", "beta"),
        "m_c": ("beta", "gamma"),
    }
    return _closed_form(linkage, joints, factors, b_d, c_d)


def _serial_variant_formulas(kinked: bool, linkage: str) -> tuple[ClosedForm, ...]:
    """Three cells in a row, locked at joints U1 and V2."""
    a_c = _joined(1, "alpha", "gamma") if kinked else STRAIGHT
    d_c = _joined(2, "delta", "gamma") if kinked else STRAIGHT
    p_1 = negative(joint(1))
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = minus(minus(a_c.kink, p_1), HALF_TURN)
    p_2 = reciprocal(v_2, constant("m_c"))
    p_3 = minus(minus(HALF_TURN, v_2), d_c.kink)
    v_3 = reciprocal(p_3, constant("m_d"))
    joints = (
        joint(1),
        plus(v_1, a_c.before),
        plus(plus(plus(p_2, v_3), HALF_TURN), a_c.after),
        p_3,
        plus(negative(v_3), d_c.before),
        plus(minus(HALF_TURN, plus(v_1, p_2)), d_c.after),
    )
    factors = {
        "m_a": ("beta", "alpha"),
        "m_c": ("beta", "gamma"),
        "m_d": ("beta", "delta"),
    }
    return _closed_form(linkage, joints, factors, a_c, d_c)


def _isomer_formulas(linkage: str) -> tuple[ClosedForm, ...]:
    """Four cells around a common axis, locked at joints 2 and 4."""
    b_d = _joined(2, "delta", "beta")
    a_c = _joined(1, "alpha", "gamma")
    p_1 = minus(joint(1), b_d.before)
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = plus(minus(v_1, HALF_TURN), b_d.kink)
    p_2 = reciprocal(v_2, constant("m_b"))
    v_3 = plus(minus(v_2, HALF_TURN), a_c.kink)
    p_3 = reciprocal(v_3, constant("m_c"))
    p_4 = negative(plus(p_1, plus(p_2, p_3)))
    v_4 = reciprocal(p_4, constant("m_d"))
    joints = (
        joint(1),
        plus(plus(p_2, b_d.after), a_c.before),
        plus(p_3, a_c.after),
        plus(minus(HALF_TURN, v_3), v_4),
        p_4,
        plus(minus(HALF_TURN, v_4), v_1),
    )
    factors = {
        "m_a": ("delta", "alpha"),
        "m_b": ("alpha", "beta"),
        "m_c": ("beta", "gamma"),
        "m_d": ("gamma", "delta"),
    }
    return _closed_form(linkage, joints, factors, a_c, b_d)


# --- first guesses


def difference_guesses(
    name: str, whole: int, part: int, form: np.ndarray
) -> Iterator[dict[str, float]]:
    """The twist ``name`` of a link that is added to, or subtracted from, the link in
    column ``part`` and makes the one in column ``whole``.

    The opposite difference comes too: a link c - b reads b - c where that is longer.
    """
    x = form[1, whole]
    y = form[1, part]
    for twist in (x - y, y - x, x + y):
        yield {name: twist % np.pi}


def _serial_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """A quadratic equation for tan(beta/2), from elementary symmetric functions of the
    other three tangents."""
    others = np.tan(form[1, 3:6] / 2)
    e1 = others.sum()
    e3 = others.prod()
    e2 = (e1**2 - (others**2).sum()) / 2
    for side in half_tangents(form[1, 0]):
        quadratic = [side * (e1 - e3), -(e1 * e2 - e3), side * e3 * (1 - e2)]
        for beta in twists_with(np.roots(quadratic)):
            yield {"beta": beta}


# every 30 degrees, none of them collinear
KINKS = tuple((np.linspace(-np.pi, np.pi, 12, endpoint=False) + 0.01).tolist())
KINK_SCAN = {"kink_1": KINKS, "kink_2": KINKS}


def _hidden_twists(
    length: float, twist: float, ratio: float, known: float
) -> Iterator[float]:
    """The other twists of a link made of two, of ``length`` and ``twist``, one of which
    has the twist ``known``: length = ratio (cos x + cos y) tan(twist / 2)."""
    for joined, sign in itertools.product((twist, twist + np.pi), (1, -1)):
        tangent = np.tan(joined / 2)
        if not tangent:
            continue
        cosine = sign * length / (ratio * tangent) - np.cos(known)
        if abs(cosine) < 1:
            yield float(np.arccos(cosine))


def _hidden_twist_guesses(
    name: str,
    simple: int,
    first: tuple[int, int],
    second: tuple[int, int],
    form: np.ndarray,
) -> Iterator[dict[str, float]]:
    """The twist ``name`` from the lengths of both links that are made of two, and the
    kinks from their twists.

    ``simple`` is the column of a basic link; ``first`` and ``second`` are those of a link
    made of two and of the other link in it.
    """
    lengths, twists, _ = form
    ratio = lengths[simple] / np.sin(twists[simple])
    hidden: list[float] = []
    for joined, known in (first, second):
        hidden += _hidden_twists(lengths[joined], twists[joined], ratio, twists[known])
    for twist in hidden:
        locked = [(twists[known], twist, twists[i]) for i, known in (first, second)]
        for pair in kink_pairs(*locked):
            yield {name: twist, **pair}


def _isomer_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The kinks from the twists of the links that are made of two."""
    twists = form[1]
    beta, delta, gamma, alpha = twists[2:]
    yield from kink_pairs((alpha, gamma, twists[1]), (beta, delta, twists[0]))


ENTRIES = read_entries(
    "goldberg_6r",
    {
        "serial-goldberg-6r": Model(serial_goldberg),
        "syncopated-serial-goldberg-6r": Model(
            syncopated_serial_goldberg, guesses=_serial_guesses
        ),
        "l-shape-goldberg-6r": Model(l_shape_goldberg),
        "syncopated-l-shape-goldberg-6r": Model(
            syncopated_l_shape_goldberg,
            guesses=syncopation_guesses(side=2, alpha=5, gamma=3),
        ),
        "serial-goldberg-variant-6r": Model(
            serial_variant,
            formulas=partial(_serial_variant_formulas, False),
            guesses=partial(difference_guesses, "gamma", 1, 5),
        ),
        "l-shape-goldberg-variant-6r": Model(
            l_shape_variant,
            formulas=partial(_l_shape_variant_formulas, False),
            guesses=partial(difference_guesses, "delta", 0, 3),
        ),
        "generalized-serial-goldberg-6r": Model(
            generalized_serial_goldberg, scan=KINK_SCAN
        ),
        "generalized-l-shape-goldberg-6r": Model(
            generalized_l_shape_goldberg, scan=KINK_SCAN
        ),
        "generalized-serial-goldberg-variant-6r": Model(
            generalized_serial_variant,
            formulas=partial(_serial_variant_formulas, True),
            guesses=partial(_hidden_twist_guesses, "gamma", 5, (1, 5), (4, 2)),
        ),
        "generalized-l-shape-goldberg-variant-6r": Model(
            generalized_l_shape_variant,
            formulas=partial(_l_shape_variant_formulas, True),
            guesses=partial(_hidden_twist_guesses, "delta", 1, (0, 3), (4, 2)),
        ),
        "isomerized-generalized-l-shape-goldberg-6r": Model(
            isomerized_l_shape, formulas=_isomer_formulas, guesses=_isomer_guesses
        ),
    },
)
