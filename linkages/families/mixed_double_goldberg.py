"""The double-Goldberg 6R family: mixed Types I to VI, and the twelve linkages of two
equal kinds of 5R.

Two 5R linkages, each a Goldberg or a subtractive Goldberg linkage, are joined on the
link pair a, c or across the Bennett loop a, c. Up to the sign with which c is added,
the links come in six orders.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import Any

import numpy as np

from linkages.construction.link import Link, basic_links, joined_chain
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import twist_pairs
from linkages.entry import Guesses
from linkages.entry_table import Model, read_entries
from linkages.families.goldberg_6r import difference_guesses
from linkages.loop import Loop

POSITION = 100


class Order(Enum):
    """The six types, and the order of their links: * takes the sign of the first 5R, +
    that of the second."""

    I = "a*c b d a+c d b"
    II = "a b*c d a+c d b"
    III = "a b*c d+c a d b"
    IV = "a b*c d a d+c b"
    V = "a b*c d c d+a b"
    VI = "a b*c d+a c d b"


@dataclass(frozen=True)
class _Joints:
    """Signs with which the first and the second 5R join their links, and the name."""

    first: int
    second: int
    prefix: str


class Kind(Enum):
    """Of which 5R linkages a member is made."""

    MIXED = _Joints(-1, 1, "mixed-double-goldberg")
    GOLDBERG = _Joints(1, 1, "double-goldberg")
    SUBTRACTIVE = _Joints(-1, -1, "double-subtractive-goldberg")

    @classmethod
    def of_prefix(cls, prefix: str) -> Kind:
        """The kind whose members' names begin so."""
        return next(kind for kind in cls if kind.value.prefix == prefix)


def double_goldberg_type(
    *parameters: Number,
    order: Order = Order.I,
    kind: Kind = Kind.MIXED,
    **others: Any,
) -> Loop:
    """The double-Goldberg 6R of Type ``order``, I to VI, made of the two 5R linkages of
    ``kind``, with the parameters of `basic_links` and no offsets.

    Source: Song and Chen (2012), tables 2 and 3; Song (2013), tables 3.3.1 and 3.5.3,
    equations (3.4.3) to (3.4.22). The latter's "alpha34 = alpha + gamma" in (3.4.11) is
    alpha45.
    """
    return double_goldberg_chain(basic_links(*parameters, **others), order, kind)


def double_goldberg_chain(links: Mapping[str, Link], order: Order, kind: Kind) -> Loop:
    """The loop of Type ``order`` and ``kind`` of the basic links a, b, c, d, whatever
    their ratios; -c is allowed."""
    return joined_chain(link_order(order, kind), links)


def link_order(order: Order, kind: Kind) -> str:
    """The links 12 to 61 as `joined_chain` reads them."""
    signs = {1: "+", -1: "-"}
    text = order.value.replace("+", signs[kind.value.second])
    return text.replace("*", signs[kind.value.first])


# --- first guesses


def _type_one_guesses(kind: Kind, form: np.ndarray) -> Iterator[dict[str, float]]:
    """Links a*c, b, d, a+c, d, b, the two composite ones with the signs of ``kind``."""
    lengths, twists, _ = form
    ratio = lengths[1] / np.sin(twists[1])
    if kind is Kind.MIXED:
        mean = (twists[0] + twists[3]) / 2
        half = (twists[3] - twists[0]) / 2
        pairs = [(mean + turn, (half + turn) % np.pi) for turn in (0, np.pi / 2)]
    else:
        pairs = twist_pairs(twists[0], lengths[0] / ratio, kind.value.second)
    for alpha, gamma in pairs:
        twist = alpha % np.pi
        yield {"alpha": twist, "gamma": gamma, "a": ratio * np.sin(twist)}


def _guesses(order: Order, kind: Kind) -> Guesses | None:
    if order is Order.I:
        return partial(_type_one_guesses, kind)
    if order in (Order.II, Order.III, Order.IV):
        return partial(difference_guesses, "gamma", 1, 5)
    return None


def _name(order: Order, kind: Kind) -> str:
    return f"{kind.value.prefix}-type-{order.name.lower()}"


ENTRIES = read_entries(
    "mixed_double_goldberg",
    {
        _name(order, kind): Model(
            partial(double_goldberg_type, order=order, kind=kind),
            guesses=_guesses(order, kind),
        )
        for kind in Kind
        for order in Order
    },
)
