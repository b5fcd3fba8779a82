"""Equations with free parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.system import ScaledTape
from bifurc.equations.tape import Tape, TapeWriter
from bifurc.errors import ProblemError
from bifurc.function_problem import (
    EXACT_HESSIAN,
    EquationProblem,
    FunctionProblem,
    NumericalProblem,
)
from bifurc.seeding import start_region
from bifurc.system import Accuracy

PROBES = 15  # points at which the size of F' is seen


@dataclass(frozen=True, eq=False)
class ParametrisedProblem:
    """The equations F(u, p) = 0 of unknowns u (n,) and parameters p (q,), on a ``tape``
    of u and then p; ``domain`` is that of u, ``parameters`` that of p."""

    tape: Tape
    domain: Domain
    parameters: Domain

    @property
    def n(self) -> int:
        """Number of unknowns, without the parameters."""
        return len(self.domain.names)

    @property
    def q(self) -> int:
        """Number of parameters."""
        return len(self.parameters.names)

    @property
    def sizes(self) -> np.ndarray:
        """Sizes (n + q,) of the unknowns and the parameters: a quarter of what their bounds
        leave, without these a part of the period or the scale."""
        return np.concatenate([_sizes(self.domain), _sizes(self.parameters)])

    def jacobian(self, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """F_u (m, n) at u (n,) and p (q,)."""
        point = np.concatenate([u, p])[None]
        jacobian: np.ndarray = self.tape.compiled.jacobians(point)[0, :, : self.n]
        return jacobian

    def at(self, p: np.ndarray) -> MemberProblem:
        """The equations at the parameters ``p`` (q,), as a problem of its own."""
        writer = TapeWriter(self.n)
        numbers = [writer.unknown(k) for k in range(self.n)]
        numbers += [writer.constant(float(value)) for value in p]
        slots = self.tape.write_on(writer, numbers)
        tape = writer.tape([slots[slot] for slot in self.tape.outputs.tolist()])
        return MemberProblem(tape, self.domain)

    @staticmethod
    def recorded(
        function: Callable[[np.ndarray, np.ndarray], Sequence[float] | np.ndarray],
        bounds: Sequence[Sequence[float]],
        parameter_bounds: Sequence[Sequence[float]],
        *,
        names: Sequence[str] | None = None,
        parameter_names: Sequence[str] | None = None,
    ) -> ParametrisedProblem:
        """The problem of a Python callable F(u, p), which is recorded: called once with
        numbers that write down what is done with them.

        ``bounds`` (n, 2) and ``parameter_bounds`` (q, 2) are finite. Raises `ProblemError`
        where it cannot be recorded, with the reason, as `FunctionProblem` does.
        """
        n = len(bounds)
        all_names = [*(names or [f"u{k + 1}" for k in range(n)])]
        all_names += parameter_names or [
            f"p{k + 1}" for k in range(len(parameter_bounds))
        ]
        problem = FunctionProblem(
            lambda both: function(both[:n], both[n:]),
            [*bounds, *parameter_bounds],
            names=all_names,
        )
        return ParametrisedProblem.of(problem, all_names[n:])

    @staticmethod
    def of(problem: EquationProblem, parameters: Sequence[str]) -> ParametrisedProblem:
        """The problem with those of its unknowns for parameters, in this order. Raises
        `ProblemError` where it is not recorded, with the reason."""
        tape = problem.equations.tape
        if tape is None:
            allowed = f"of functions that can be recorded; {problem.recording.reason}"
            raise ProblemError("function", problem, allowed)
        names = problem.domain.names
        last = [names.index(name) for name in parameters]
        order = [k for k in range(len(names)) if k not in last] + last
        n = len(order) - len(last)
        writer = TapeWriter(tape.n)
        slots = tape.write_on(
            writer, [writer.unknown(place) for place in np.argsort(order).tolist()]
        )
        return ParametrisedProblem(
            writer.tape([slots[slot] for slot in tape.outputs.tolist()]),
            _part(problem.domain, order[:n]),
            _part(problem.domain, order[n:]),
        )


class MemberProblem(NumericalProblem):
    """The equations on a ``tape`` of the unknowns of a ``domain``."""

    def __init__(self, tape: Tape, domain: Domain):
        self.domain = domain
        self.accuracy = Accuracy(
            derivatives="recorded",
            equations=f"recorded ({tape.size} operations)",
            hessian_error=EXACT_HESSIAN,
        )
        low, high = start_region(self).T
        points = np.random.default_rng(0).uniform(low, high, (PROBES, tape.n))
        jacobians = tape.compiled.jacobians(points)
        self.magnitude = float(np.median(np.linalg.norm(jacobians, 2, axis=(1, 2))))
        self.compiled: ScaledTape = ScaledTape(tape, self.magnitude, domain)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self.compiled.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self.compiled.jacobians(points)


def _sizes(domain: Domain) -> np.ndarray:
    """The typical size (n,) of each unknown of a domain."""
    widths = np.diff(domain.bounds, axis=1)[:, 0]
    of_circles = np.where(
        np.isfinite(domain.periods), domain.periods / (2.0 * np.pi), domain.scale
    )
    return np.where(np.isfinite(widths), 0.25 * widths, of_circles)


def _part(domain: Domain, numbers: Sequence[int]) -> Domain:
    """The domain of the unknowns with these numbers (from 0)."""
    bounds = domain.bounds[numbers]
    widths = np.diff(bounds, axis=1)
    finite = widths[np.isfinite(widths)]
    return Domain(
        tuple(domain.names[k] for k in numbers),
        tuple(domain.units[k] for k in numbers),
        domain.periods[numbers],
        bounds,
        scale=float(np.median(finite)) / 4.0 if len(finite) else domain.scale,
    )
