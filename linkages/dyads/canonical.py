"""One order of pins for all groups that differ in the numbers of their pins alone.

The pins of every body go in; out comes an order of the pins, in which groups of one type
have the same bodies. Pins are told apart by the bodies on them, and these by their pins;
where that leaves some that are alike, each of them is taken as the first one, and of all
orders that come of it the one is kept in which the bodies are first (McKay 1981).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice, pairwise
from typing import TypeAlias

Bodies: TypeAlias = tuple[tuple[int, ...], ...]
Colours: TypeAlias = list[int]

# Orders that are compared, at most: of a type with more symmetry some numberings have
# their generic solutions found anew.
MOST_ORDERS = 1000


@cache
def canonical_order(bodies: Bodies, standing: int) -> tuple[int, ...]:
    """The order of the pins (numbers) of ``bodies``, of which the first ``standing``
    stand and stay the first ones."""
    count = 1 + max(pin for pins in bodies for pin in pins)
    colours = [int(pin >= standing) for pin in range(count)]
    orders = islice(_orders(bodies, colours), MOST_ORDERS)
    return min(orders, key=lambda order: in_order(bodies, order))


def in_order(bodies: Bodies, order: Sequence[int]) -> Bodies:
    """The bodies where the pins are numbered in an ``order``, sorted, as are the pins of
    each."""
    number = numbers_in(order)
    return tuple(sorted(tuple(sorted(number[pin] for pin in pins)) for pins in bodies))


def numbers_in(order: Sequence[int]) -> list[int]:
    """The place of every pin in an ``order``."""
    return sorted(range(len(order)), key=order.__getitem__)


def _orders(bodies: Bodies, colours: Colours) -> Iterator[tuple[int, ...]]:
    """The orders of pins that differ in nothing but which of those alike are first."""
    colours = _told_apart(bodies, colours)
    pins = sorted(range(len(colours)), key=colours.__getitem__)
    alike = _first_alike(pins, colours)
    if not alike:
        yield tuple(pins)
    for pin in alike:
        # twice each, so that there is room for the one that is taken as the first
        chosen = [2 * colour for colour in colours]
        chosen[pin] -= 1
        yield from _orders(bodies, chosen)


def _told_apart(bodies: Bodies, colours: Colours) -> Colours:
    """The colours of pins, refined until pins of one colour have the same bodies on
    them."""
    while True:
        on_pins: list[list[tuple[int, ...]]] = [[] for _ in colours]
        for pins in bodies:
            seen = tuple(sorted(colours[pin] for pin in pins))
            for pin in pins:
                on_pins[pin].append(seen)
        keys = [
            (colour, sorted(seen))
            for colour, seen in zip(colours, on_pins, strict=True)
        ]
        kinds = sorted({repr(key): key for key in keys}.values())
        finer = [kinds.index(key) for key in keys]
        if len(set(finer)) == len(set(colours)):
            return finer
        colours = finer


def _first_alike(pins: Sequence[int], colours: Colours) -> list[int]:
    """The first pins, in their order, that have one colour; none where all differ."""
    for first, second in pairwise(pins):
        if colours[first] == colours[second]:
            return [pin for pin in pins if colours[pin] == colours[first]]
    return []
