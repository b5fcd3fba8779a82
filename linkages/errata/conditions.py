"""Loops built by the misprinted conditions, against those built by the corrected
ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkages.catalogue import entry
from linkages.construction.equations import evaluate, numbers_of
from linkages.errata.equations import FUNCTIONS, define
from linkages.errata.erratum import Amounts
from linkages.identification.equivalence import as_loop, table
from linkages.loop import Loop
from linkages.mobility import held_gap, survey


def compare_mobility(
    linkage: str, changes: Mapping[str, str], where: Mapping[str, str]
) -> Amounts:
    """What keeps the default member from moving that has other numbers: formulas of
    those that it has, and of names defined ``where``; and what keeps it as it is."""
    right = entry(linkage).build()
    numbers = numbers_of(table(right))
    names = {**FUNCTIONS, **numbers}
    define(names, where)
    changed = numbers | {name: evaluate(text, names) for name, text in changes.items()}
    printed = as_loop(np.reshape(list(changed.values()), (-1, 3)).T)
    return Amounts(immobility(printed), immobility(right))


def immobility(loop: Loop) -> float:
    """0 if the loop moves; else its smallest singular value at a rigid assembly, or
    `held_gap`."""
    motion = survey(loop)
    if motion.mobility:
        return 0.0
    return motion.stiffness if motion.rigid else held_gap(loop)
