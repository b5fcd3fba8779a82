"""One misprint and the measure of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

HOLDS = 1e-11  # what a correct equation may leave in doubles


class Amounts(NamedTuple):
    """By how much the printed and the corrected equation fail."""

    printed: float
    corrected: float


@dataclass(frozen=True)
class Erratum:
    """One misprint of a ``source``; ``measure`` evaluates the printed and the corrected
    equation for the ``linkage``."""

    source: str
    equation: str
    linkage: str
    printed: str
    corrected: str
    measure: Callable[[], Amounts]


@dataclass(frozen=True)
class WordErratum:
    """A statement of a ``source`` and what holds in its place; ``see`` says in a few
    words what the program finds."""

    source: str
    place: str
    printed: str
    corrected: str
    see: Callable[[], str]


def median_and_largest(printed: np.ndarray, corrected: np.ndarray) -> Amounts:
    """The median of what the print leaves along a path, and the largest of what the
    correction leaves."""
    return Amounts(float(np.median(printed)), float(np.max(corrected)))
