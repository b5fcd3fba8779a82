"""Misprints of the sources, each with a measure of by how much the printed equation
fails and the corrected one holds.

For closed forms the measure is the closure defect max |T_1 ... T_n - I|: the median
over input angles for the print, the largest for the correction. For conditions it is
the smallest singular value at the rigid assemblies of the loop built by them, or the
smallest closure residual with joint 1 held; 0 if the loop moves. Equations between
numbers and matrices are evaluated as they stand. Where the root of a form changes, the
measure is the gap in its angles there. Of formulas lost in the copy the amount is for
what stands in their place. Misprints that are not equations (numbers of figures,
words), and conditions that are only stricter than needed, are not listed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from importlib import resources
from pkgutil import resolve_name
from types import MappingProxyType
from typing import Any

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.closed_form import ClosedForm
from linkages.closed_forms.form_table import (
    FormTable,
    changed,
    closed_form,
    form_tables,
)
from linkages.construction.equations import evaluate, numbers_of
from linkages.errata import equations
from linkages.errata.equations import FUNCTIONS, define
from linkages.errata.erratum import Amounts, Erratum, WordErratum, median_and_largest
from linkages.identification.equivalence import as_loop, table
from linkages.loop import Loop
from linkages.mobility import held_gap, survey

TABLE = "errata.toml"
NOTHING: Mapping[str, Any] = MappingProxyType({})


@cache
def _tables() -> dict[str, Any]:
    file = resources.files("linkages.errata") / TABLE
    return tomllib.loads(file.read_text(encoding="utf-8"))


@cache
def misprints() -> tuple[Erratum, ...]:
    """All misprints, in the order of the table."""
    return tuple(_erratum(**table) for table in _tables()["misprint"])


def _erratum(
    source: str, equation: str, linkage: str, printed: str, corrected: str, **by: Any
) -> Erratum:
    measure = _measure(linkage, **by)
    return Erratum(source, equation, linkage, printed, corrected, measure)


def _measure(
    linkage: str,
    form: int = 0,
    given: str = "",
    where: Mapping[str, Any] = NOTHING,
    **by: Any,
) -> Callable[[], Amounts]:
    """How a misprint of this linkage is measured, see the head of the table; raises
    `ValueError` for another way, and for several."""
    ((way, what),) = by.items()
    match way:
        case "measure":
            function: Callable[[], Amounts] = resolve_name(f"linkages.errata.{what}")
            return function
        case "closed_form":
            return partial(compare_closed_forms, linkage, form, what)
        case "table":
            return partial(compare_mobility, linkage, what, where)
        case "gaps":
            names = {**_tables()["definitions"].get(given, {}), **where}
            return partial(equations.compare_equations, linkage, names, **what)
    raise ValueError(f"misprint of {linkage}: nothing is measured by {way!r}")


def errata_of(name: str) -> tuple[Erratum, ...]:
    """The misprints that concern the linkage called ``name``."""
    return tuple(erratum for erratum in misprints() if erratum.linkage == name)


def word_errata() -> tuple[WordErratum, ...]:
    """What the sources say in words and is not so, statements of one figure or one
    example that are made of all linkages among it."""
    return tuple(_word_erratum(**table) for table in _tables()["statement"])


def _word_erratum(see: str = "", seen: str = "", **fields: str) -> WordErratum:
    if seen:
        return WordErratum(**fields, see=lambda: seen)
    return WordErratum(**fields, see=resolve_name(f"linkages.errata.words:{see}"))


def compare_mobility(
    linkage: str, changes: Mapping[str, str], where: Mapping[str, str]
) -> Amounts:
    """What keeps the default member from moving that has other numbers, and what keeps
    it as it is."""
    printed = printed_loop(linkage, changes, where)
    return Amounts(immobility(printed), immobility(entry(linkage).build()))


def printed_loop(
    linkage: str, changes: Mapping[str, str], where: Mapping[str, str] = NOTHING
) -> Loop:
    """The default member with the numbers that a source prints: formulas of those that
    it has, and of names defined ``where``."""
    numbers = numbers_of(table(entry(linkage).build()))
    names = {**FUNCTIONS, **numbers}
    define(names, where)
    others = numbers | {name: evaluate(text, names) for name, text in changes.items()}
    return as_loop(np.reshape(list(others.values()), (-1, 3)).T, linkage)


@dataclass(frozen=True)
class PrintedTable:
    """A table as a source prints it in an ``equation``, of which ``numbers`` are
    wrong."""

    source: str
    equation: str
    linkage: str
    numbers: tuple[str, ...]
    loop: Loop


def printed_tables() -> Iterator[PrintedTable]:
    """The misprinted tables of the sources, each with the default parameters."""
    for one in _tables()["misprint"]:
        if "table" in one:
            loop = printed_loop(one["linkage"], one["table"], one.get("where", NOTHING))
            numbers = tuple(one["table"])
            yield PrintedTable(
                one["source"], one["equation"], one["linkage"], numbers, loop
            )


def immobility(loop: Loop) -> float:
    """0 if the loop moves; else its smallest singular value at a rigid assembly, or
    `held_gap`."""
    motion = survey(loop)
    if motion.mobility:
        return 0.0
    return motion.stiffness if motion.rigid else held_gap(loop)


INPUTS = 60  # input angles along a form


def compare_closed_forms(linkage: str, number: int, printed: FormTable) -> Amounts:
    """Amounts for the closed form ``number`` of a linkage with what is ``printed`` in
    place of the entries of its table, and for the form as it is."""
    owner = entry(linkage)
    form = owner.closed_forms[number]
    right = form_tables(owner.family)[linkage][number]
    misprint = closed_form(linkage, changed(right, printed))
    parameters = owner.defaults
    rng = np.random.default_rng(0)
    while True:
        of_print = _defects(misprint, parameters)
        corrected = _defects(form, parameters)
        if len(of_print) and len(corrected):
            return median_and_largest(of_print, corrected)
        parameters = owner.draw(rng)  # no real configuration


def _defects(form: ClosedForm, parameters: Mapping[str, float]) -> np.ndarray:
    """Closure defects along the form, at all inputs and both roots."""
    loop = entry(form.linkage).build(**parameters)
    inputs = np.linspace(-3.0, 3.0, INPUTS)
    paths = [form.configurations(inputs, parameters, root) for root in form.roots]
    theta = np.concatenate(paths)
    theta = theta[np.isfinite(theta).all(axis=1)]
    product = loop.frames(theta)[:, -1]
    gap = np.abs(product - np.eye(4))
    gap[:, :3, 3] /= loop.characteristic_length
    return np.asarray(gap.max(axis=(1, 2)))
