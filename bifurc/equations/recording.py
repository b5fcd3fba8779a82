"""A callable as a tape: called once with recorded unknowns, then checked against
itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bifurc.decisions import is_same_function
from bifurc.equations.recorded import (
    PLAIN,
    NotRecordable,
    RecordedNumber,
    Recorder,
    unknowns_of,
)
from bifurc.equations.tape import LONGEST, Tape, TooLong
from bifurc.tables import count_of

SENTENCE = 160  # characters of a foreign error that are quoted
SMALLEST = 1e-300  # difference that counts where the value is 0 and exact


@dataclass(frozen=True)
class Recording:
    """What came of recording: a ``tape``, or None and the ``reason`` why not; of a tape
    that is not the function itself, what it is."""

    tape: Tape | None
    reason: str = ""

    def __str__(self) -> str:
        if self.tape is None:
            return f"not recorded: {self.reason}"
        return f"{self.reason or 'recorded'} ({count_of(self.tape.size, 'operation')})"


def record(function: Callable[[np.ndarray], Any], points: np.ndarray) -> Recording:
    """The tape of ``function``: (n,) -> (m,), if it can be recorded and is equal to the
    function, to rounding, at ``points`` (k, n)."""
    try:
        tape = _tape_of(function, points.shape[1])
    except NotRecordable as refusal:
        return Recording(None, refusal.reason)
    difference = _difference(function, tape, points)
    return Recording(None, difference) if difference else Recording(tape)


# --- recording ------------------------------------------------------------------------


def _tape_of(function: Callable[[np.ndarray], Any], n: int) -> Tape:
    """The tape of a function of n unknowns; raises `NotRecordable`."""
    writer = Recorder(n)
    unknowns = unknowns_of(writer)
    try:
        value = function(unknowns)
        outputs = writer.where_all_is_defined(_outputs(writer, value))
        tape = writer.tape(outputs)
    except NotRecordable:
        raise
    except TooLong:
        reason = f"it takes more than {LONGEST} operations"
        raise NotRecordable(reason) from None
    except Exception as error:  # whatever a user's function raises: it is not for this
        raise NotRecordable(writer.refusal or _sentence(error)) from error
    if writer.refusal:
        raise NotRecordable(writer.refusal)
    return tape


def _outputs(writer: Recorder, value: Any) -> list[int]:
    """The slots of what a function returned."""
    equations = np.asarray(value, dtype=object)
    if equations.ndim != 1 or not len(equations):
        raise NotRecordable("it returns no vector")
    slots = []
    for equation in equations:
        if isinstance(equation, np.ndarray) and equation.ndim == 0:
            equation = equation.item()
        if isinstance(equation, RecordedNumber):
            slots.append(equation.slot)
        else:
            slots.append(writer.constant(float(equation)))
    return slots


def _sentence(error: Exception) -> str:
    """Why a function that raised an error cannot be recorded."""
    text = str(error)
    if "Cannot cast ufunc" in text and "output" in text:
        return PLAIN
    if "has no callable" in text:
        return (
            "it takes a function of an array of unknowns and plain numbers that numpy "
            "keeps for no array of numbers; np.stack or np.concatenate make one of u "
            "that can be recorded"
        )
    kind = type(error).__name__
    return (
        f"it calls something that takes plain numbers only ({kind}: {text[:SENTENCE]})"
    )


# --- the check ------------------------------------------------------------------------


def _difference(
    function: Callable[[np.ndarray], Any], tape: Tape, points: np.ndarray
) -> str:
    """Where the tape differs from the function at points (k, n) by more than rounding
    explains: a sentence, empty where it does not."""
    recorded = tape.compiled.residuals(np.ascontiguousarray(points))
    low, high = tape.compiled.value_bounds(points, points)
    with np.errstate(all="ignore"):
        for point, value, width in zip(points, recorded, high - low, strict=True):
            expected = np.array(function(point.copy()), dtype=float)
            is_known = np.isfinite(expected)
            if not np.all(is_known):  # the tape may be undefined in another equation
                is_known &= np.isfinite(value)
            gaps = np.abs(value - expected)[is_known]
            units = _rounding(expected, width)[is_known]
            if not np.all(is_same_function(gaps / units)):
                return f"what was recorded is not equal to the function at {point}"
    return ""


def _rounding(values: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """What rounding may make of values (m,): the width of the interval that holds all
    of it; where that is not known, by the size of the value."""
    by_size = np.sqrt(np.finfo(float).eps) * (1.0 + np.abs(values))
    known = np.where(np.isfinite(widths), widths, by_size)
    return known + SMALLEST
