"""The records of the stability study: what every method did on every case."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """What a method's answer is worth."""

    RIGHT = "right"
    """It follows the true arc to its end, or reports the true number."""
    FAILED = "failed"
    """It says that it failed, or its certificate refuses the answer."""
    JUMPED = "jumped"
    """It goes over to another arc without a word."""
    MISSED = "missed"
    """It reports fewer bifurcations than there are."""
    INVENTED = "invented"
    """It reports more bifurcations than there are."""


@dataclass(frozen=True)
class Run:
    """What one method did: ``difficulty`` is the imperfection or the true number of
    bifurcations, ``width`` that of the near miss, ``found`` the number reported.
    ``pieces`` and the ``certificate`` with its points and its time (s), beside
    ``seconds``, are this project's."""

    case: str
    difficulty: float
    method: str
    step: str
    verdict: Verdict
    found: int
    evaluations: int
    seconds: float
    note: str = ""
    width: float = 0.0
    pieces: int = 0
    certificate: str = ""
    certificate_points: int = 0
    certificate_seconds: float = 0.0
