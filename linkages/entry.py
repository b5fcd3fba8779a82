"""What the catalogue keeps of a linkage: constructor, parameters, source, conditions
and named forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkages.loop import GeometryError, Loop

__all__ = ["Entry", "FormPattern", "Parameter"]


@dataclass(frozen=True)
class Parameter:
    """A free parameter of a family: ``kind`` is "angle" (rad; degrees on the screen),
    "length" or "number".

    ``low`` and ``high`` bound the open range from which random members are drawn.
    """

    name: str
    default: float
    kind: str
    meaning: str
    low: float
    high: float


@dataclass(frozen=True)
class FormPattern:
    """A form that the source names, by an equation that holds on it and on no other
    form.

    ``residual`` maps configurations (..., n), rad, to (..., k): zero everywhere along
    the form.
    """

    name: str
    residual: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Entry:
    """One linkage of the catalogue.

    ``construct`` takes the parameters by keyword (any number type) and returns the
    `Loop`, or raises `GeometryError` that says by how much a condition is violated.
    ``patterns`` takes the same parameters (floats) and returns the named forms.
    ``conditions`` states the geometry in words and symbols; ``facts`` the published
    invariants that the tests assert, such as ``mobility`` or ``forms``.
    """

    name: str
    title: str
    source: str
    construct: Callable[..., Loop]
    parameters: tuple[Parameter, ...]
    conditions: tuple[str, ...] = ()
    patterns: Callable[..., tuple[FormPattern, ...]] | None = None
    errata: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)

    @property
    def defaults(self) -> dict[str, float]:
        """Default value of every parameter."""
        return {p.name: p.default for p in self.parameters}

    def complete(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """``values`` completed by the defaults; raises `GeometryError` for an unknown
        parameter."""
        known = self.defaults
        for key in values:
            if key not in known:
                raise GeometryError(
                    f"parameter of {self.name}", repr(key), "one of " + ", ".join(known)
                )
        return {**known, **values}

    def build(self, **values: Any) -> Loop:
        """The member with the given parameters, the others at their defaults, named
        after the entry."""
        loop = self.construct(**self.complete(values))
        return Loop(loop.lengths, loop.twists, loop.offsets, self.name)

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Random parameters within their ranges (the constructor may still refuse
        them)."""
        return {p.name: float(rng.uniform(p.low, p.high)) for p in self.parameters}
