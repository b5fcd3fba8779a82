"""A large problem in the units in which it is traced.

Unknowns are counted so that the length of a vector is the root mean square of the
field over its size, and the parameter over a quarter of its bounds; equations so that
the length of F is its root mean square. Nothing depends on the number of unknowns then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bifurc.decisions import is_singular_start
from bifurc.domain import Domain
from bifurc.errors import ProblemError
from bifurc.function_problem import NumericalProblem
from bifurc.large.bordered_system import (
    EXACT,
    ROUGH,
    BorderedSystem,
    Inverse,
    bordered_system,
)
from bifurc.large.large_problem import LargeProblem
from bifurc.numerics.collocation import PieceRules
from bifurc.system import Accuracy, Shortcuts, Solver
from bifurc.units import Units

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csr_array

DIFFERENCE = 1e-5  # length of the step of a difference of F'
SECOND_DIFFERENCE = 3e-3  # the same of a second difference
ROUNDS = 3  # of inverse iteration, by which the size of F' is seen
ALONG_AXIS = 1e-3  # share of the random vector that the first tangent comes from
BESIDE = 0.1  # how far beside a singular start F' is of an ordinary size


class ScaledProblem(NumericalProblem):
    """A `LargeProblem` with unknowns and equations in the ``own_units``.

    The magnitude is about the smallest singular value of F' at the ``start`` (n,) of
    the user, so that what is left of F over it is an error of the unknowns.
    """

    rules = PieceRules(norm=2)  # entries are small where they are many

    def __init__(self, problem: LargeProblem, start: np.ndarray):
        n = problem.n
        self.problem = problem
        sizes = np.full(n, problem.size * np.sqrt(n - 1))
        sizes[-1] = 0.25 * np.diff(problem.bounds)[0]
        weight = 1.0 / np.sqrt(n - 1)
        self.own_units = Units(np.zeros(n), sizes, np.full(n - 1, weight))
        self.domain = Domain(
            names=("u",) * (n - 1) + (problem.parameter,),
            units=("",) * n,
            periods=np.full(n, np.inf),
            bounds=problem.region / sizes[:, None],
            has_crossings=False,  # bridges take dense matrices
        )
        self.accuracy = Accuracy(derivatives=problem.derivatives)
        self.magnitude = self._size_of_jacobian(self.own_units.inwards(start))

    # --- values -----------------------------------------------------------------------

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, n - 1) at points (k, n)."""
        units = self.own_units
        outwards = (units.outwards(point) for point in np.atleast_2d(points))
        values = [units.weights * self.problem.value(point) for point in outwards]
        return np.array(values)

    def jacobian(self, point: np.ndarray) -> csr_array:
        """F' (n - 1, n) at one point (n,)."""
        units = self.own_units
        matrix = self.problem.jacobian(units.outwards(point)).copy()
        by_entry = units.weights[0] * units.sizes[matrix.indices]
        matrix.data = matrix.data * by_entry
        return matrix

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, n - 1, n) at points (k, n), dense: for few unknowns."""
        return np.array([self.jacobian(point).toarray() for point in points])

    def second_derivative(
        self, point: np.ndarray, a: np.ndarray, b: np.ndarray
    ) -> np.ndarray:
        """F''(a, b) (n - 1,), over the magnitude, by a central difference of F'; of
        several b (n, k) at once (n - 1, k)."""
        length = float(np.linalg.norm(a))
        if length == 0.0:
            return np.zeros((self.n - 1, *b.shape[1:]))
        step = DIFFERENCE / length
        upper = self.jacobian(point + step * a) @ b
        lower = self.jacobian(point - step * a) @ b
        derivative: np.ndarray = (upper - lower) / (2.0 * step * self.magnitude)
        return derivative

    def third_derivative(self, point: np.ndarray, a: np.ndarray) -> np.ndarray:
        """The third derivative F''' along a (n,), thrice, (n - 1,), over the magnitude,
        by a second difference of F': to some four digits."""
        step = SECOND_DIFFERENCE / float(np.linalg.norm(a))
        upper = self.jacobian(point + step * a) @ a
        lower = self.jacobian(point - step * a) @ a
        change = upper - 2.0 * (self.jacobian(point) @ a) + lower
        derivative: np.ndarray = change / (step**2 * self.magnitude)
        return derivative

    # --- linear systems ---------------------------------------------------------------

    @property
    def shortcuts(self) -> Shortcuts:
        """F' as a sparse matrix, and the solver of systems with it."""
        return Shortcuts(self.n - 1, self.jacobian, self.bordered_solver)

    def bordered_solver(self, point: np.ndarray, tangent: np.ndarray) -> Solver:
        """What solves systems with F' at a point (n,), over the magnitude, and the row
        ``tangent`` (n,) under it."""
        return self.bordered(point, tangent[None], accuracy=ROUGH).solve

    def bordered(
        self,
        point: np.ndarray,
        rows: np.ndarray,
        columns: np.ndarray | None = None,
        accuracy: float = EXACT,
    ) -> BorderedSystem:
        """The system with F' at a point (n,), over the magnitude, ``rows`` (k + 1, n)
        under it and ``columns`` (n - 1, k) beside it, solved to an ``accuracy``."""
        matrix = self.jacobian(point)
        matrix.data /= self.magnitude
        inverse = self._inverse(point)
        return bordered_system(matrix, rows, columns, inverse, accuracy)

    def _inverse(self, point: np.ndarray) -> Inverse | None:
        """The user's solver at a point (n,), in these units; None where there is
        none."""
        if self.problem.solver is None:
            return None
        units = self.own_units
        made = self.problem.solver(units.outwards(point))
        shape = getattr(made, "shape", (self.n - 1, self.n - 1))
        if shape != (self.n - 1, self.n - 1):
            allowed = f"({self.n - 1}, {self.n - 1})"
            raise ProblemError("shape of the solver", shape, allowed)
        solve = getattr(made, "matvec", made)
        if not callable(solve):
            allowed = "a LinearOperator or a function"
            raise ProblemError("what the solver gives", repr(made), allowed)
        transposed = _transposed(getattr(made, "rmatvec", solve), solve)
        factor = self.magnitude / (units.weights[0] * units.sizes[0])

        def checked(solver: Solver) -> Solver:
            return lambda right: factor * _checked_solution(solver(right), self.n - 1)

        return Inverse(checked(solve), checked(transposed))

    def _size_of_jacobian(self, point: np.ndarray) -> float:
        """About the smallest singular value of F' at a point (n,) across the curve, or,
        where the point is singular itself, a little way along the curve."""
        rng = np.random.default_rng(0)
        along = ALONG_AXIS * rng.normal(size=self.n) / np.sqrt(self.n)
        along[-1] = 1.0
        last = np.zeros(self.n)
        last[-1] = 1.0
        tangent = self.bordered(point, along[None]).solve(last)
        tangent /= np.linalg.norm(tangent)
        size = self._size_across(point, tangent)
        beside = self._size_across(point + BESIDE * tangent, tangent)
        is_singular = np.isfinite(beside) and is_singular_start(size, beside)
        return beside if is_singular else size

    def _size_across(self, point: np.ndarray, tangent: np.ndarray) -> float:
        """About the smallest singular value of F' at a point (n,) across a ``tangent``
        (n,), by inverse iteration."""
        system = self.bordered(point, tangent[None])
        vector = np.random.default_rng(1).normal(size=self.n - 1)
        size = 1.0
        for _ in range(ROUNDS):
            vector /= np.linalg.norm(vector)
            solution = system.solve(np.append(vector, 0.0))
            size = float(np.linalg.norm(solution))
            vector = solution[:-1]
        return 1.0 / size if size > 0.0 else 1.0


def _transposed(rmatvec: Solver, solve: Solver) -> Solver:
    """What solves with the transpose: ``solve`` itself for an operator that has no
    `rmatvec`, as it serves a symmetric F', and GMRES mends the rest."""

    def apply(right: np.ndarray) -> np.ndarray:
        try:
            return rmatvec(right)
        except NotImplementedError:
            return solve(right)

    return apply


def _checked_solution(solution: object, count: int) -> np.ndarray:
    """What a solver returned, as an array; raises `ProblemError` where it has another
    shape or is not finite."""
    checked = np.asarray(solution, dtype=float)
    if checked.shape == (count, 1):
        checked = checked[:, 0]
    if checked.shape != (count,):
        raise ProblemError(
            "shape of a solution by the solver", checked.shape, f"({count},)"
        )
    if not np.all(np.isfinite(checked)):
        bad = checked[~np.isfinite(checked)][0]
        raise ProblemError("solution by the solver", bad, "finite")
    return checked
