"""What the rounding of the numbers in equations does to them."""

from __future__ import annotations

import numpy as np

from bifurc.equations.tape import Tape

DIGITS = 40
DRAWS = 8  # times that all constants are moved, each up or down at random
MOST = 4.0  # times the largest change that is seen is the largest one there is
DYADIC = 2.0**20  # times a number is whole where it is meant as it stands


def rounding_of_constants(tape: Tape, point: np.ndarray) -> np.ndarray:
    """How far off the equations (m,) of a tape are at a point (n,) where each of its
    constants is off by the last bit; whole numbers and short binary fractions are not.

    Raises `ValueError` where an equation is not real.
    """
    is_rounded = tape.constants * DYADIC % 1 != 0
    if not is_rounded.any():
        return np.zeros(tape.m)
    import mpmath  # it takes long to import

    rng = np.random.default_rng(0)
    largest = np.zeros(tape.m)
    with mpmath.workdps(DIGITS):
        unknowns = [mpmath.mpf(float(x)) for x in point]
        plain = tape.over(unknowns, mpmath)
        for _ in range(DRAWS):
            ends = rng.choice([-np.inf, np.inf], len(tape.constants))
            moved = np.nextafter(tape.constants, ends)
            constants = np.where(is_rounded, moved, tape.constants)
            other = Tape(
                tape.n, tape.operations, tape.operands, constants, tape.outputs
            )
            values = other.over(unknowns, mpmath)
            pairs = zip(values, plain, strict=True)
            changes = [float(abs(value - before)) for value, before in pairs]
            largest = np.maximum(largest, changes)
    return MOST * largest
