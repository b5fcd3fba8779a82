"""Every comparison on which a count, a kind, a level or a word hangs: the table
``decisions.toml``, whose decisions are imported from here by their names.

A decision compares a quantity without units with a threshold. The threshold of a
verdict stands in a gap: what is true gives quantities decades below it, what is false
decades above. Where the truth itself has no gap, as when a linkage misses a condition
by any amount, there is a third answer. `record_margins` notes the quantities that were
decided on, so that a study can show the gaps; see docs/decisions.md.

Singular values and residuals are over the problem's ``magnitude``, lengths over its
``scale``.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

# Names of decisions, with the quantities that each was taken on.
Margins: TypeAlias = dict[str, list[Floats]]

_recorded: ContextVar[Margins | None] = ContextVar("recorded", default=None)


@contextmanager
def record_margins() -> Iterator[Margins]:
    """The quantities of every decision that is taken inside the ``with`` block, by the
    decision's name."""
    margins: Margins = defaultdict(list)
    token = _recorded.set(margins)
    try:
        yield margins
    finally:
        _recorded.reset(token)


class Role(Enum):
    """What hangs on a decision."""

    # A count, a kind, a level or a word.
    VERDICT = "verdict"
    # Whether something is looked at more closely; both sides end in the same answer.
    LOOK = "look"
    # What is listed, or in which order: either side is as good, and one was chosen.
    CONVENTION = "convention"


@dataclass(frozen=True)
class Decision:
    """Whether a ``quantity`` is below a ``threshold``.

    ``claim`` is what is taken for true where it is, ``reason`` why the threshold stands
    where it does, ``role`` what hangs on it. ``third_answer`` is what is said where the
    quantity is neither plainly small nor plainly large, empty where that is not met.
    """

    name: str
    claim: str
    quantity: str
    threshold: float
    reason: str
    role: Role = Role.VERDICT
    third_answer: str = ""

    @overload
    def __call__(self, value: float, unit: float = 1.0) -> bool: ...
    @overload
    def __call__(
        self, value: Floats, unit: float | Floats = 1.0
    ) -> NDArray[np.bool_]: ...

    def __call__(
        self, value: float | Floats, unit: float | Floats = 1.0
    ) -> bool | NDArray[np.bool_]:
        """Whether the claim holds, of a value or of each of an array of them, measured
        in ``unit``."""
        margins = _recorded.get()
        if margins is not None:
            with np.errstate(divide="ignore", invalid="ignore"):
                quantities = np.asarray(value, dtype=float) / unit
            margins[self.name].append(np.ravel(quantities))
        if isinstance(value, np.ndarray):
            return np.less(value, self.threshold * unit)
        return bool(value < self.threshold * unit)


def read_decisions(table: Path) -> dict[str, Decision]:
    """The decisions of a table in TOML, by their names in code.

    Where a threshold is the name of an earlier decision it is that one's. Raises
    `ValueError` for two decisions of one name, and `TypeError` for a decision that
    lacks a text.
    """
    decisions: dict[str, Decision] = {}
    for name, entry in tomllib.loads(table.read_text(encoding="utf-8")).items():
        if isinstance(entry["threshold"], str):
            entry["threshold"] = decisions[entry["threshold"]].threshold
        entry["role"] = Role(entry.get("role", Role.VERDICT))
        decisions[name] = Decision(**entry)
    if len({decision.name for decision in decisions.values()}) < len(decisions):
        raise ValueError(f"{table}: two decisions have one name")
    return decisions


def unit_over_rounding(decision: Decision, by_rounding: float) -> float:
    """The unit in which a quantity is smaller than the threshold that rounding may have
    made: 1 where what comes ``by_rounding`` is below that."""
    return max(1.0, by_rounding / decision.threshold)


def by_name(table: Mapping[str, Decision]) -> Callable[[str], Decision]:
    """What a module gives for a name that it does not define: the decision of a table
    that has this name in code."""

    def decision_of(name: str) -> Decision:
        try:
            return table[name]
        except KeyError:
            raise AttributeError(f"there is no decision {name!r}") from None

    return decision_of


TABLE = read_decisions(Path(__file__).with_name("decisions.toml"))
__getattr__ = by_name(TABLE)
