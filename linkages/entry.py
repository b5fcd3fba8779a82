"""What the catalogue keeps of a linkage: constructor, parameters, source, conditions,
named forms, closed forms, first guesses and relations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, StrEnum
from functools import cached_property
from html import escape
from typing import Any, TypeAlias

import numpy as np

from bifurc.errors import BifurcError
from linkages.closed_forms.closed_form import ClosedForm
from linkages.closed_forms.form_table import closed_form, form_tables
from linkages.construction.equations import equation_gaps
from linkages.construction.numbers import Number
from linkages.geometry_table import geometry_html, geometry_rows
from linkages.loop import Loop
from linkages.values import require

Guesses: TypeAlias = Callable[[np.ndarray], Iterable[Mapping[str, float]]]
COUNTS = ("rows", "columns", "units")
MOST = 400  # of each of them
BY_IDENTIFICATION = "found by identification"  # the source of a relation without one


class UnknownParameterError(BifurcError):
    """A linkage has no parameter of that name: ``linkage``, the ``name`` asked for and
    its ``parameters``."""

    def __init__(self, linkage: str, name: str, parameters: tuple[str, ...]):
        self.linkage = linkage
        self.name = name
        self.parameters = parameters
        allowed = "one of " + ", ".join(parameters)
        super().__init__(
            f"parameter of {linkage}: {name!r} is not allowed; it must be {allowed}"
        )


class ParameterKind(StrEnum):
    """What a parameter is: an angle in rad (degrees on the screen), a length, or a
    number without unit."""

    ANGLE = "angle"
    LENGTH = "length"
    NUMBER = "number"


@dataclass(frozen=True)
class Parameter:
    """A free parameter of a family.

    ``low`` and ``high`` bound the open range from which random members are drawn.
    """

    name: str
    default: float
    kind: ParameterKind
    meaning: str
    low: float
    high: float

    @property
    def is_count(self) -> bool:
        """Whether it is a whole number of units."""
        return self.name in COUNTS

    def require_in_range(self, value: float) -> None:
        """Raise `GeometryError` for a value out of the range, angles in degrees; a count
        may be larger than those that are drawn."""
        is_angle = self.kind is ParameterKind.ANGLE
        unit, word = (np.radians(1.0), " degrees") if is_angle else (1.0, "")
        low, high = self.low / unit, (MOST if self.is_count else self.high / unit)
        allowed = f"from {low:g} to {high:g}{word}"
        is_whole = not self.is_count or float(value).is_integer()
        if self.is_count:
            allowed = f"a whole number {allowed}"
        is_within = low * unit <= value <= high * unit
        require(is_whole and is_within, self.name, f"{value / unit:g}", allowed)


@dataclass(frozen=True)
class Condition:
    """A condition on the geometry: its ``text``, and the ``equations`` of it that the
    numbers of a table decide, see `linkages.construction.equations`; none where it is
    in words."""

    text: str
    equations: str = ""

    def __str__(self) -> str:
        return self.text

    def residual(self, table: np.ndarray) -> float | None:
        """The largest difference that ``table`` (3, n) leaves, in the units of the
        table; None where no equation has a value."""
        gaps = equation_gaps(self.equations, table) if self.equations else []
        return max(gaps) if gaps else None


@dataclass(frozen=True)
class FormPattern:
    """A form that the source names, by an equation that holds on it and on no other
    form.

    ``residual`` maps configurations (..., n), rad, to (..., k): zero everywhere along
    the form.
    """

    name: str
    residual: Callable[[np.ndarray], np.ndarray]


class RelationKind(Enum):
    """What a linkage is to another one."""

    SPECIAL_CASE = "special case of"
    SAME = "same linkage as"
    ISOMER = "isomer of"
    DEGENERATE = "degenerates to"
    CONSTRUCTED = "constructed from"


@dataclass(frozen=True)
class Relation:
    """What a linkage is to the one called ``other``; ``detail`` says how, ``source``
    who says so.

    ``joint`` (from 1) of the other is where its links are exchanged for an isomer;
    ``vanishing`` is the parameter that goes to 0 for a degenerate case.
    """

    kind: RelationKind
    other: str
    source: str = BY_IDENTIFICATION
    detail: str = ""
    joint: int = 0
    vanishing: str = ""


class WithParameters:
    """What has free ``parameters``."""

    parameters: tuple[Parameter, ...]

    @property
    def defaults(self) -> dict[str, float]:
        """Default value of every parameter."""
        return {p.name: p.default for p in self.parameters}

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Random parameters within their ranges (the constructor may still refuse
        them)."""
        return {p.name: float(rng.uniform(p.low, p.high)) for p in self.parameters}


@dataclass(frozen=True)
class Entry(WithParameters):
    """One linkage of the catalogue.

    ``construct`` takes the parameters by keyword (any number type) and returns the
    `Loop`, or raises `GeometryError` that says by how much a condition is violated.
    ``conditions`` state the geometry; ``facts`` are the published invariants that the
    tests assert, such as ``mobility`` or ``forms``. ``patterns`` takes the same
    parameters (floats) and returns the named forms. The closed forms stand in the table of
    the ``family``.

    Most parameters stand in the table of a member as they are, and recognition reads
    them there. For the others ``guesses`` maps a table (3, n) in normal form (lengths
    not negative, twists in [0, pi), offsets known by size only) to every candidate,
    parameters by name; wrong ones do no harm. Where there is no formula ``scan`` holds
    values of each hidden angle (rad) to start from. ``is_other_view`` marks the
    linkages of another entry in parameters that it does not need.
    """

    name: str
    family: str
    title: str
    source: str
    construct: Callable[..., Loop]
    parameters: tuple[Parameter, ...]
    conditions: tuple[Condition, ...] = ()
    patterns: Callable[..., tuple[FormPattern, ...]] | None = None
    guesses: Guesses | None = None
    scan: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    relations: tuple[Relation, ...] = ()
    errata: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    is_other_view: bool = False

    @cached_property
    def closed_forms(self) -> tuple[ClosedForm, ...]:
        """The closed forms of the motion; none where the sources give none."""
        tables = form_tables(self.family).get(self.name, [])
        return tuple(closed_form(self.name, table) for table in tables)

    def complete(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """``values`` completed by the defaults; raises `UnknownParameterError`."""
        defaults = self.defaults
        for name in values:
            if name not in defaults:
                raise UnknownParameterError(self.name, name, tuple(defaults))
        return {**defaults, **values}

    def build(self, **values: Number) -> Loop:
        """The member with the given parameters, the others at their defaults, named
        after the entry.

        Raises `GeometryError` and `UnknownParameterError`.
        """
        loop = self.construct(**self.complete(values))
        return replace(loop, name=self.name)


# --- what is mapped -------------------------------------------------------------------


@dataclass(frozen=True)
class Linkage:
    """A loop with the ``patterns`` of the forms that its source names."""

    loop: Loop
    patterns: tuple[FormPattern, ...] = ()

    @property
    def name(self) -> str:
        """What the linkage is called, in the catalogue or in its file."""
        return self.loop.name

    @property
    def parts(self) -> tuple[Linkage, ...]:
        """What does not hang together: the linkage itself."""
        return (self,)

    @property
    def extent(self) -> float:
        """The characteristic length."""
        return self.loop.characteristic_length

    def __repr__(self) -> str:
        if not self.patterns:
            return repr(self.loop)
        return f"{self.loop!r}\n  {self._named_forms()}"

    def _repr_html_(self) -> str:
        """The linkage as notebooks show it."""
        loop = self.loop
        title = f"{loop.name or 'Linkage'}: {loop.n} joints"
        rows = geometry_rows(loop.lengths, loop.twists, loop.offsets)
        parts = [f"<p><b>{escape(title)}</b></p>", geometry_html(rows)]
        if self.patterns:
            parts.append(f"<p>{escape(self._named_forms())}</p>")
        return "".join(parts)

    def _named_forms(self) -> str:
        names = [pattern.name for pattern in self.patterns]
        return f"forms named by the source: {', '.join(names)}"
