"""A change of the map, solved for anew at other members, and to more digits there.

In goes a value of a parameter at which the equations of a singular point or of a joint at
rest hold. With all parameters of the family free these equations are followed to other
values of the rest; Newton's method with many digits ends there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from bifurc.decisions import is_null, is_start_solved
from bifurc.equations.differentiation import with_null_vectors
from bifurc.equations.tape import Tape
from bifurc.following.rest_problem import RestProblem
from bifurc.following.singular_problem import SingularPointProblem
from linkages.parameters.members import Members, PreciseEquations
from linkages.values import GeometryError

if TYPE_CHECKING:
    import mpmath

STEPS, NEWTON_STEPS, PRECISE_STEPS = 12, 12, 12
SMALLEST_STEP = 1e-14  # rad: what follows is rounding
DIGITS = 50  # to which a value is found
GUARD = 12  # further ones that are computed with


class MovedChange:
    """The equations ``problem``, of a change at the first of ``members``, all of whose
    parameters are free; the one called ``free`` is the unknown one at others."""

    def __init__(
        self,
        members: Members,
        free: str,
        problem: SingularPointProblem | RestProblem,
        solution: np.ndarray,
    ):
        self.members = members
        self.names = tuple(members.ranges)
        closure = members.problem
        u, _ = problem.place(solution)
        p = members.start
        self.problem: SingularPointProblem | RestProblem
        if isinstance(problem, RestProblem):
            tangents, resting = problem.tangents, problem.resting
            self.problem = RestProblem(closure, u, tangents, p, resting)
        else:
            self.problem = SingularPointProblem(closure, u, p, problem.nullity)
        first = self.problem.parameters.start
        held = [first + k for k, name in enumerate(self.names) if name != free]
        self._held = np.array(held)
        self._free = np.setdiff1d(np.arange(len(self.problem.start)), self._held)
        self._name = free

    def at(self, values: Mapping[str, float]) -> dict[str, mpmath.mpf] | None:
        """All parameters where the others have these ``values``, the free one to `DIGITS`;
        None where the solution is lost on the way, and where there is no member."""
        point = self._moved(values)
        if point is None:
            return None
        try:
            return self._precise(point)
        except GeometryError:
            return None

    def _moved(self, values: Mapping[str, float]) -> np.ndarray | None:
        """The solution where the other parameters have these ``values``, followed there
        on a straight line; None where it is lost on the way."""
        point = self._solved(self.problem.start)
        if point is None:
            return None
        others = np.array([values[name] for name in self.names if name != self._name])
        step = (others - point[self._held]) / STEPS
        for _ in range(STEPS):
            jacobian = self.problem.jacobians(point[None])[0]
            change = jacobian[:, self._held] @ step
            ahead, *_ = np.linalg.lstsq(jacobian[:, self._free], -change, rcond=None)
            point[self._held] += step
            point[self._free] += ahead
            point = self._solved(point)
            if point is None:
                return None
        return point

    def _solved(self, start: np.ndarray) -> np.ndarray | None:
        """The solution near a start with its values of the held parameters; None where
        there is none, or one that is not isolated."""
        point = start.copy()
        for _ in range(NEWTON_STEPS):
            residual = self.problem.residuals(point[None])[0] / self.problem.magnitude
            matrix = self.problem.jacobians(point[None])[0][:, self._free]
            matrix = matrix / self.problem.magnitude
            step, _, _, sigma = np.linalg.lstsq(matrix, -residual, rcond=None)
            point[self._free] += step
            if np.abs(step).max() < SMALLEST_STEP:
                break
        gap = np.abs(self.problem.residuals(point[None])).max() / self.problem.magnitude
        if not is_start_solved(float(gap)) or is_null(float(sigma[-1])):
            return None
        return point

    # --- many digits ------------------------------------------------------------------

    def _precise(self, point: np.ndarray) -> dict[str, mpmath.mpf] | None:
        """All parameters at a solution, the others as the doubles that they are; None where
        Newton's method does not get there."""
        import mpmath

        jacobian = self.problem.jacobians(point[None])[0][:, self._free]
        inverse = np.linalg.pinv(jacobian)
        with mpmath.workdps(DIGITS + GUARD):
            place = [mpmath.mpf(float(x)) for x in point]
            for _ in range(PRECISE_STEPS):
                residual = self._precise_residual(place)
                step = inverse @ np.array([float(r) for r in residual])
                for number, change in zip(
                    self._free.tolist(), step.tolist(), strict=True
                ):
                    place[number] -= mpmath.mpf(change)
                if np.abs(step).max() < 10.0 ** -(DIGITS + GUARD // 2):
                    own = place[self.problem.parameters]
                    return dict(zip(self.names, own, strict=True))
        return None

    def _precise_residual(self, place: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
        """The equations of the problem over mpmath numbers, with the member built of
        them."""
        equations = self._precise_equations
        numbers = equations.numbers_of(place[self.problem.parameters])
        return self._residual_of(place, numbers)

    @cached_property
    def _precise_equations(self) -> PreciseEquations:
        return self.members.precise_equations()

    @cached_property
    def _residual_of(self) -> Callable[[Sequence[Any], Sequence[Any]], list[Any]]:
        """The equations at a place and numbers of the geometry of any kind."""
        n, tape = self.problem.parametrised.n, self._precise_equations.tape
        if isinstance(self.problem, RestProblem):
            return partial(_rest_residual, self.problem, tape)
        whole = with_null_vectors(tape, n, self.problem.basis)
        return partial(_singular_residual, self.problem, whole)


def _singular_residual(
    problem: SingularPointProblem,
    whole: Tape,
    place: Sequence[Any],
    numbers: Sequence[Any],
) -> list[Any]:
    """The equations of a singular point, from the closure of any geometry on a tape."""
    import mpmath

    vectors = place[problem.parameters.stop :]
    rows = whole.over([*place[: problem.parametrised.n], *numbers, *vectors], mpmath)
    weights = np.ones(len(rows))
    weighted = np.tile(problem.weights, problem.nullity + 1)
    weights[: len(weighted)] = weighted
    return [row * weight for row, weight in zip(rows, weights.tolist(), strict=True)]


def _rest_residual(
    problem: RestProblem, tape: Tape, place: Sequence[Any], numbers: Sequence[Any]
) -> list[Any]:
    """The equations of a joint at rest, from the closure of any geometry on a tape."""
    import mpmath

    count, n = problem.places.shape
    places = [place[n * k : n * (k + 1)] for k in range(count)]
    closed = [row for u in places for row in tape.over([*u, *numbers], mpmath)]
    resting = problem.resting
    at_rest = [u[resting] - places[0][resting] for u in places[1:]]
    slid = []
    for u, start, tangent in zip(
        places, problem.places.tolist(), problem.tangents.tolist(), strict=True
    ):
        moved = [a - mpmath.mpf(b) for a, b in zip(u, start, strict=True)]
        slid.append(mpmath.fdot(moved, tangent))
    return closed + at_rest + slid
