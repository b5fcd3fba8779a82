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
from collections.abc import Callable, Mapping
from functools import cache, partial
from importlib import resources
from pkgutil import resolve_name
from types import MappingProxyType
from typing import Any

from linkages.errata import conditions, equations, forms
from linkages.errata.erratum import Amounts, Erratum, WordErratum

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
            return partial(forms.compare_closed_forms, linkage, form, what)
        case "table":
            return partial(conditions.compare_mobility, linkage, what, where)
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
