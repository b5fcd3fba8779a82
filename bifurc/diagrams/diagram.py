"""A bifurcation diagram as data: what happens along the forms as a parameter changes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from bifurc.singular.point import Kind
from bifurc.tables import count_of


class Stability(Enum):
    """Stability of the equilibria of u' = F(u)."""

    # All eigenvalues have negative real parts.
    STABLE = "stable"
    # Some have positive real parts.
    UNSTABLE = "unstable"
    # None is positive, and some lie on the imaginary axis all along.
    NEUTRAL = "neutral"
    # There are not as many equations as unknowns besides the parameter.
    UNKNOWN = "unknown"


@dataclass(frozen=True, eq=False)
class DiagramPoint:
    """A fold, a Hopf point or an event at arclength ``s`` of a form, ``u`` (n,) there.

    ``label`` is the name of the event; at a Hopf point what becomes of the pair,
    "becomes unstable as p grows", "becomes stable as p grows", or "where p turns back" at
    a fold; empty at a fold itself. ``value`` is the second
    derivative of the parameter in the arclength at a fold, the angular frequency at a
    Hopf point, and the value that the function takes at an event. ``error`` is the
    arclength to either side within which rounding hides where it is, 0 where that is no
    more than rounding.
    """

    name: str
    kind: Kind
    form: int
    s: float
    u: np.ndarray
    value: float
    label: str = ""
    error: float = 0.0

    @property
    def words(self) -> str:
        """Its kind and its label."""
        return f"{self.kind.value} {self.label}".rstrip()

    def __repr__(self) -> str:
        place = f"forms[{self.form}] at s = {self.s:.6g}"
        return (
            f"<DiagramPoint {self.name!r}: {self.words} on {place}, "
            f"value {self.value:.6g}>"
        )


@dataclass(frozen=True)
class Stretch:
    """Part of a form along which the stability does not change, from arclength
    ``start`` to ``end``, which may exceed the length of a closed form.

    ``unstable`` is the number of eigenvalues with positive real part, -1 where it is
    not known.
    """

    form: int
    start: float
    end: float
    stability: Stability
    unstable: int


@dataclass(frozen=True)
class Branching:
    """What singular point number ``point`` of the atlas is along the parameter."""

    point: int
    kind: Kind


@dataclass(frozen=True)
class Diagram:
    """What happens along the forms of an atlas as a ``parameter`` changes.

    ``parameter`` is the name of an unknown, empty where there is none but events were
    asked for. ``points`` are folds, Hopf points and events, ``stretches`` cover all
    forms, ``branchings`` are the singular points at which forms cross, ``remarks`` what
    is to be said of events.
    """

    parameter: str
    points: tuple[DiagramPoint, ...]
    stretches: tuple[Stretch, ...]
    branchings: tuple[Branching, ...]
    remarks: tuple[str, ...] = ()

    @property
    def folds(self) -> tuple[DiagramPoint, ...]:
        """The points where the parameter turns back."""
        return tuple(p for p in self.points if p.kind is Kind.FOLD)

    @property
    def hopf_points(self) -> tuple[DiagramPoint, ...]:
        """The points where a pair of eigenvalues crosses the imaginary axis."""
        return tuple(p for p in self.points if p.kind is Kind.HOPF)

    def events(self, label: str = "") -> tuple[DiagramPoint, ...]:
        """The events called ``label``, or all of them."""
        return self._called(Kind.EVENT, label)

    def touches(self, label: str = "") -> tuple[DiagramPoint, ...]:
        """The places at which the event called ``label``, or any, takes its value and
        turns back."""
        return self._called(Kind.TOUCH, label)

    def _called(self, kind: Kind, label: str) -> tuple[DiagramPoint, ...]:
        of_kind = [p for p in self.points if p.kind is kind]
        return tuple(p for p in of_kind if label in ("", p.label))

    def __repr__(self) -> str:
        kinds = [point.kind for point in self.points]
        counts = [(kinds.count(kind), kind.value) for kind in Kind if kind.plural]
        counts.append((len(self.branchings), "branching"))
        words = ", ".join(count_of(*count) for count in counts)
        return f"<Diagram in {self.parameter or 'no parameter'!r}: {words}>"
