"""Loops built by the misprinted conditions, against those built by the corrected
ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import radians

import numpy as np

from linkages.catalogue import entry
from linkages.construction.equations import evaluate, numbers_of
from linkages.construction.link import (
    basic_links,
    half_angle_ratio,
    joined_chain,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.errata.erratum import Amounts
from linkages.identification.equivalence import as_loop, table
from linkages.loop import Loop
from linkages.mobility import held_gap, survey


def compare_mobility(linkage: str, build: Callable[[], Loop]) -> Amounts:
    """What keeps the loop by the misprint from moving, and what keeps the default
    member."""
    return Amounts(immobility(build()), immobility(entry(linkage).build()))


def immobility(loop: Loop) -> float:
    """0 if the loop moves; else its smallest singular value at a rigid assembly, or
    `held_gap`."""
    motion = survey(loop)
    if motion.mobility:
        return 0.0
    return motion.stiffness if motion.rigid else held_gap(loop)


def changed_member(linkage: str, changes: Mapping[str, str]) -> Loop:
    """The default member with other numbers: formulas of those that it has."""
    values = table(entry(linkage).build())
    names = numbers_of(values)
    changed = names | {name: evaluate(text, names) for name, text in changes.items()}
    numbers = np.reshape(list(changed.values()), (-1, 3))
    return as_loop(numbers.T)


def printed_syncopated() -> Loop:
    """The syncopated serial 6R by (2.4.2), whose triple product lacks a minus sign."""
    alpha, beta, gamma, delta = (radians(x) for x in (35.0, 62.0, 41.0, 22.0))
    links = basic_links(1.0, alpha, beta, gamma, delta)
    product: Number = 1.0
    for name in "acd":
        product = product * half_angle_ratio(links[name].twist, beta)
    joined = links["a"] + links["c"] + links["d"]
    links["e"] = syncopated_link(joined, product)
    return joined_chain("e-b a+c+d e-b d c a", links)
