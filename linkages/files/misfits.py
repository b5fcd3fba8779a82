"""How far angles of a file may be from closed ones: as far as rounding takes them."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from linkages.decisions import keeps_angle
from linkages.values import GeometryError

log = logging.getLogger(__name__)

# Angles of a file are rounded. Near a singular configuration they move by the root of
# that, of two decimals of a degree by about one; angles that were never closed move by
# tens of degrees.
LARGEST_MOVE = 5.0  # degrees
MOST_SHOWN = 12  # angles in a message


def check_moved(
    what: str, before: np.ndarray, after: np.ndarray, gap: float, names: Sequence[str]
) -> None:
    """Warn of angles (n,), rad, of the joints of these ``names`` that were moved to be
    closed.

    Raises `GeometryError` where one of them went by more than `LARGEST_MOVE`: they were
    not closed, but left a ``gap`` of the characteristic length.
    """
    changes = np.abs(np.remainder(after - before + np.pi, 2 * np.pi) - np.pi)
    largest = int(np.argmax(changes))
    change = float(np.degrees(changes[largest]))
    if change > LARGEST_MOVE:
        value = (
            f"not closed, by a gap of {gap:.3g} of the characteristic length; joint "
            f"{names[largest]} is {change:.4g} degrees off the closed configuration that "
            "is found from there, which"
        )
        allowed = f"closed to {LARGEST_MOVE:g} degrees, as rounded numbers are"
        if len(names) <= MOST_SHOWN:
            wrapped = np.remainder(after + np.pi, 2 * np.pi) - np.pi
            degrees = np.degrees(wrapped).round(6).tolist()
            allowed += f"; closed would be {degrees} degrees for {', '.join(names)}"
        raise GeometryError(what, value, allowed)
    if not keeps_angle(float(changes[largest])):
        log.warning("%s: moved by up to %.3g degrees to be closed", what, change)
