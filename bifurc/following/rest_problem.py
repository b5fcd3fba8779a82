"""The members of a parametrised problem along whose curve an unknown rests."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_rest_near
from bifurc.domain import Domain
from bifurc.function_problem import NumericalProblem
from bifurc.parametrised import ParametrisedProblem
from bifurc.system import Accuracy

PLACES = 8  # of a curve at which an unknown is to have one value


class RestProblem(NumericalProblem):
    """The members on which the unknown number ``resting`` (from 0) has one value at K
    places of a curve: F(u_k, p) = 0 at every one of them, equal values of that unknown, and
    t_k . (u_k - places_k) = 0, by which places stay apart.

    The unknowns are the K places u_k (n,) and the parameters p (q,). It starts from the
    ``places`` (K, n) with ``tangents`` (K, n) of the curve of the member ``p``, along which
    the unknown may move; `start` (K n + q,) is that. With more places than parameters few
    of these equations are independent where they hold, which is no more by chance.
    """

    def __init__(
        self,
        parametrised: ParametrisedProblem,
        places: np.ndarray,
        tangents: np.ndarray,
        p: np.ndarray,
        resting: int,
    ):
        self.parametrised = parametrised
        self.places, self.tangents = places, tangents
        self.resting = resting
        self.start = np.concatenate([places.ravel(), p])
        count = len(places)
        own, parameters = parametrised.domain, parametrised.parameters
        names = [f"{name}_{k + 1}" for k in range(count) for name in own.names]
        self.domain = Domain(
            names=(*names, *parameters.names),
            units=(*own.units * count, *parameters.units),
            periods=np.concatenate([*[own.periods] * count, parameters.periods]),
            bounds=np.concatenate([*[own.bounds] * count, parameters.bounds]),
            scale=own.scale,
        )
        self.accuracy = Accuracy(derivatives="recorded", equations="recorded")
        jacobian = self.jacobians(self.start[None])[0]
        self.magnitude = float(np.linalg.norm(jacobian, 2))

    @property
    def parameters(self) -> slice:
        """Where the parameters stand among the unknowns."""
        return slice(self.places.size, len(self.start))

    def place(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """u (..., K, n) and p (..., q) at points (..., K n + q)."""
        count, n = self.places.shape
        u = points[..., : count * n].reshape(*points.shape[:-1], count, n)
        return u, points[..., count * n :]

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """The equations (k, K m + 2 K - 1) at points (k, K n + q)."""
        u, _ = self.place(points)
        values = self.parametrised.tape.compiled.residuals(self._rows(points))
        at_rest = u[:, 1:, self.resting] - u[:, :1, self.resting]
        slid = np.einsum("ji,kji->kj", self.tangents, u - self.places)
        return np.concatenate([values.reshape(len(points), -1), at_rest, slid], axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Their derivatives (k, K m + 2 K - 1, K n + q) at points (k, K n + q)."""
        (count, n), m = self.places.shape, self.parametrised.tape.m
        rows = self.parametrised.tape.compiled.jacobians(self._rows(points))
        rows = rows.reshape(len(points), count, m, -1)
        jacobians = np.zeros((len(points), count * m + 2 * count - 1, self.n))
        for j in range(count):
            own = slice(n * j, n * (j + 1))
            jacobians[:, m * j : m * (j + 1), own] = rows[:, j, :, :n]
            jacobians[:, m * j : m * (j + 1), count * n :] = rows[:, j, :, n:]
            jacobians[:, j - count, own] = self.tangents[j]
            if j:
                jacobians[:, count * m + j - 1, n * j + self.resting] = 1.0
                jacobians[:, count * m + j - 1, self.resting] = -1.0
        return jacobians

    def _rows(self, points: np.ndarray) -> np.ndarray:
        """The unknowns of the tape (k K, n + q) at every place of points (k, K n + q)."""
        u, p = self.place(points)
        each = np.broadcast_to(p[:, None], (*u.shape[:2], p.shape[1]))
        rows = np.concatenate([u, each], axis=2)
        return np.ascontiguousarray(rows.reshape(-1, rows.shape[2]))


def rest_problems(
    parametrised: ParametrisedProblem,
    branch: Branch,
    p: np.ndarray,
    reach: float,
    recounted: Callable[[np.ndarray], np.ndarray] = np.asarray,
) -> list[RestProblem]:
    """The problems of a rest near the member ``p`` (1,), whose curve is ``branch``: one
    for each unknown whose differences along it go to zero together, to first order, as the
    parameter moves by no more than ``reach``. ``recounted`` are points (k, n) of the curve
    in the unknowns of the equations: shifted, and in other units."""
    s = branch.length * (np.arange(PLACES) + 0.5) / PLACES
    places, tangents = recounted(branch(s)), recounted(branch(s, derivative=1))
    tangents = tangents - recounted(np.zeros((1, branch.n)))
    rates = _rates(parametrised, places, tangents, p)
    values = places - places.mean(axis=0)
    rates -= rates.mean(axis=0)
    squares = np.einsum("ki,ki->i", rates, rates)
    overlaps = np.einsum("ki,ki->i", values, rates)
    steps = -np.divide(overlaps, squares, out=np.zeros_like(squares), where=squares > 0)
    left = np.linalg.norm(values + steps * rates, axis=0)
    moving = np.linalg.norm(values, axis=0)
    is_near = is_rest_near(left, moving) & (np.abs(steps) < reach)
    return [
        RestProblem(parametrised, places, tangents, p, unknown)
        for unknown in np.flatnonzero(is_near).tolist()
    ]


def _rates(
    parametrised: ParametrisedProblem,
    places: np.ndarray,
    tangents: np.ndarray,
    p: np.ndarray,
) -> np.ndarray:
    """How fast the places (K, n) of a curve with ``tangents`` (K, n) move across it with
    the parameter, (K, n)."""
    rows = np.column_stack([places, np.tile(p, (len(places), 1))])
    n = parametrised.n
    rates = []
    for jacobian, tangent in zip(
        parametrised.tape.compiled.jacobians(rows), tangents, strict=True
    ):
        matrix = np.vstack([jacobian[:, :n], tangent])
        moved, *_ = np.linalg.lstsq(matrix, np.append(jacobian[:, n], 0.0), rcond=None)
        rates.append(-moved)
    return np.array(rates)
