"""Negative controls: change a linkage by a thousandth, entry by entry, and see whether
it still moves.

``python -m studies.pages negative_controls`` writes the table of it.
Every length, twist and offset of the table is changed alone, which breaks whatever
condition holds it; then entries that are alike are changed together, which keeps their
equality and breaks what else ties them: ratios, sums, or nothing, if they are free.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkages import Loop
from linkages.catalogue import catalogue
from linkages.mobility import survey

SAME = 1e-9  # difference below which two entries are of equal size
BREAK = 1e-3  # of the characteristic length, or rad
TYPES = (("lengths", "a"), ("twists", "alpha"), ("offsets", "R"))


@dataclass(frozen=True)
class Control:
    """What became of a loop when ``changed`` was changed: ``mobility`` 0 if it no
    longer moves.

    ``stiffness`` is the smallest singular value at the rigid assemblies, nan where
    there is none: no real configuration, or flat ones alone that are isolated.
    """

    changed: str
    mobility: int
    stiffness: float


def _name(letter: str, i: int, n: int) -> str:
    return f"R{i + 1}" if letter == "R" else f"{letter}{i + 1}{(i + 1) % n + 1}"


def _changed(loop: Loop, which: str, signs: dict[int, float]) -> Loop:
    step = BREAK * (1.0 if which == "twists" else loop.characteristic_length)
    values = {key: list(getattr(loop, key)) for key, _ in TYPES}
    for i, sign in signs.items():
        values[which][i] += sign * step
    return Loop(
        tuple(values["lengths"]), tuple(values["twists"]), tuple(values["offsets"])
    )


def break_conditions(loop: Loop) -> Iterator[tuple[str, Loop]]:
    """Every entry of the table changed alone, then every group of entries of equal
    size, not 0, changed together."""
    for (which, letter), row in zip(TYPES, loop.arrays, strict=True):
        for i in range(loop.n):
            yield _name(letter, i, loop.n), _changed(loop, which, {i: 1.0})
        for group in _equal_entries(row):
            names = ", ".join(_name(letter, i, loop.n) for i in group)
            signs = {i: float(np.sign(row[i])) for i in group}
            yield f"{names} together", _changed(loop, which, signs)


def _equal_entries(row: np.ndarray) -> list[list[int]]:
    """The indices of entries of equal size, not 0, in groups of two or more."""
    sizes = np.abs(row)
    groups = []
    grouped: set[int] = set()
    for i, size in enumerate(sizes):
        if size <= SAME or i in grouped:
            continue
        group = np.flatnonzero(np.abs(sizes - size) < SAME).tolist()
        if len(group) > 1:
            grouped.update(group)
            groups.append(group)
    return groups


def controls(loop: Loop, starts: int = 20) -> Iterator[Control]:
    """The controls of one loop, one after the other."""
    for changed, broken in break_conditions(loop):
        outcome = survey(broken, starts)
        yield Control(changed, outcome.mobility, outcome.stiffness)


MOST_JOINTS = 6  # a loop of more moves without a condition
HEAD = """# Negative controls

Each linkage of the catalogue of six joints or fewer, as loops of more move without a condition, with its default
parameters, changed by a thousandth (of the characteristic length, or rad): every entry of its table alone, then entries
of equal size together. "Stops" counts the changes after which no motion curve is left. The smallest singular value at
any rigid assembly found then says how nearly it moves; it is small beside flat configurations, where the linkage itself
is nearly singular. "Still moves" lists the changes that leave it mobile: these entries are free, or no condition of
their own. Misprinted conditions are in [errata.md](errata.md).

Findings: no change of a single entry leaves a linkage mobile, but for the lengths of planar and the twists of spherical
four-bars, which are free. Of changes together, those of the Mavroidis and Roth, Dietmaier and Bricard families keep
a stated symmetry. Length and twist of the links 12 and 45 (a + c or a - c) of the double-Goldberg linkages WDG and
DSG are stated as conditions, but the loop moves whatever they are as long as the two links are alike: it has then the
links of a linkage of Mavroidis and Roth without offsets.

Written by `python -m studies.pages negative_controls`.

| linkage | changes | stops | smallest singular value | still moves after a change of |
|---|---|---|---|---|
"""


def conditioned_loops() -> dict[str, Loop]:
    """The linkages of the catalogue, by name, that would be rigid without a condition."""
    loops = {name: entry.build() for name, entry in catalogue().items()}
    return {name: loop for name, loop in loops.items() if loop.n <= MOST_JOINTS}


def controls_page() -> str:
    """The page as Markdown."""
    rows = []
    for name, loop in conditioned_loops().items():
        results = list(controls(loop))
        rigid = [control for control in results if not control.mobility]
        mobile = [control for control in results if control.mobility]
        cells = (
            name,
            str(len(results)),
            str(len(rigid)),
            _smallest([control.stiffness for control in rigid]),
            "; ".join(control.changed for control in mobile) or "nothing",
        )
        rows.append(f"| {' | '.join(cells)} |")
    return HEAD + "\n".join(rows) + "\n"


def _smallest(values: list[float]) -> str:
    finite = [value for value in values if np.isfinite(value)]
    return f"{min(finite):.0e}" if finite else "-"
