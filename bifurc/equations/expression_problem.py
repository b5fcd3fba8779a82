"""Problems of what is a tape from the beginning, and those of written expressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bifurc.equations.program import Program
from bifurc.equations.recording import Recording
from bifurc.equations.tape import Tape, TapeWriter, real_values
from bifurc.function_problem import Bounds, FunctionProblem

if TYPE_CHECKING:
    import mpmath

    from bifurc.checks import UnknownName
    from bifurc.system import PreciseResidual


@dataclass(frozen=True)
class FirstOutput:
    """The first equation of a ``tape`` as a function of unknowns (n,)."""

    tape: Tape

    def __call__(self, point: np.ndarray) -> float:
        row = np.ascontiguousarray(point, dtype=float)[None]
        return float(self.tape.compiled.residuals(row)[0, 0])


@dataclass(frozen=True)
class TapeFunction:
    """The equations of a ``tape`` as a function of unknowns (n,), with values (m,)."""

    tape: Tape

    def __call__(self, point: np.ndarray) -> np.ndarray:
        row = np.ascontiguousarray(point, dtype=float)[None]
        values: np.ndarray = self.tape.compiled.residuals(row)[0]
        return values


class TapeProblem(FunctionProblem):
    """The problem that the equations of a ``tape`` are zero; the other arguments are
    those of `FunctionProblem`."""

    def __init__(
        self,
        tape: Tape,
        bounds: Bounds,
        *,
        names: Sequence[str],
        units: Sequence[str] | Mapping[UnknownName, str] | None = None,
        periods: Sequence[float] | Mapping[UnknownName, float] | None = None,
    ):
        self._tape = tape
        function = TapeFunction(tape)
        super().__init__(function, bounds, names=names, units=units, periods=periods)

    def _recorded(self, points: np.ndarray) -> Recording:
        """The tape that was given."""
        return Recording(self._tape)


class ExpressionProblem(TapeProblem):
    """The problem that what stands at ``places`` of a ``program`` is zero, in the
    unknowns of the ``names``. At high precision the numbers in it are exact: a third is
    a third."""

    has_exact_constants = True

    def __init__(
        self,
        program: Program,
        places: Sequence[int],
        names: Sequence[str],
        bounds: Sequence[Sequence[float]],
        *,
        units: Sequence[str] | None = None,
        periods: Sequence[float] | None = None,
    ):
        self.program = program
        self.places = places
        tape = tape_of(program, places, names)
        super().__init__(tape, bounds, names=names, units=units, periods=periods)

    def precise_residual(self) -> PreciseResidual:
        """F over mpmath numbers, to whatever precision is set; it raises `ValueError`
        where it is not real."""
        import mpmath  # it takes longer to import than a small problem to solve

        def residual(unknowns: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
            symbols = dict(zip(self.domain.names, unknowns, strict=True))
            ratio = mpmath.fraction
            return real_values(self.program.over(self.places, symbols, mpmath, ratio))

        return residual


def tape_of(program: Program, places: Sequence[int], names: Sequence[str]) -> Tape:
    """The tape of what stands at ``places`` of a program, in the unknowns ``names``."""
    writer = TapeWriter(len(names))
    outputs = program.write_on(writer, places, names)
    return writer.tape(writer.where_all_is_defined(outputs))
