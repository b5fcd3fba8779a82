"""A family of systems: equations in unknowns and parameters, on one tape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bifurc.equations.recorded import RecordedNumber, Recorder, unknowns_of
from bifurc.equations.tape import Tape

SQUARING_SEED = 28  # of the combinations of equations: any generic ones will do


@dataclass(frozen=True, eq=False)
class Family:
    """Equations F(x; p) = 0: the first ``n`` unknowns of the ``tape`` are x, the others
    the parameters p. All are complex.

    There are as many equations as unknowns x, or more, of which generic combinations
    are followed. ``is_projective``: whether x, or the first so many ``places`` of them
    where these are not 0, are homogeneous coordinates, the first of which is zero at
    infinity. ``has_regular_ends``: whether paths lead to generic members only, so that no
    end has to be looked at from all sides. Raises `ValueError` where there are fewer
    equations.
    """

    tape: Tape
    n: int
    is_projective: bool = False
    places: int = 0
    has_regular_ends: bool = False

    def __post_init__(self) -> None:
        if self.tape.m < self.n:
            raise ValueError(
                f"equations: {self.tape.m} are not allowed for {self.n} unknowns; there "
                "must be as many or more"
            )

    @staticmethod
    def of(
        equations: Callable[[np.ndarray, np.ndarray], Sequence[Any]],
        n: int,
        parameters: int,
    ) -> Family:
        """The family of ``equations`` (x (n,), p (q,)) -> (m,) of numbers that can be
        recorded."""
        writer = Recorder(n + parameters)
        numbers = unknowns_of(writer)
        values = equations(numbers[:n], numbers[n:])
        slots = [
            one.slot if isinstance(one, RecordedNumber) else writer.constant(float(one))
            for one in values
        ]
        return Family(writer.tape(slots), n)

    @property
    def coordinates(self) -> int:
        """How many of the unknowns x are homogeneous coordinates."""
        return (self.places or self.n) if self.is_projective else 0

    @property
    def parameters(self) -> int:
        """The number of parameters."""
        return self.tape.n - self.n

    @property
    def combinations(self) -> np.ndarray:
        """What combinations (n, m) of the equations are followed; (0, n) where these
        are the equations themselves."""
        if self.tape.m == self.n:
            return np.empty((0, self.n), dtype=complex)
        rng = np.random.default_rng(SQUARING_SEED)
        return complex_normal(rng, (self.n, self.tape.m))

    def residuals(self, points: np.ndarray, parameters: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n) of the member with ``parameters`` (q,), or each of
        a member of its own (k, q)."""
        at = self._with_parameters(points, parameters)
        values: np.ndarray = self.tape.compiled.complex_residuals(at)
        return values

    def jacobians(self, points: np.ndarray, parameters: np.ndarray) -> np.ndarray:
        """Derivatives (k, m, n) of F by x there."""
        at = self._with_parameters(points, parameters)
        jacobians: np.ndarray = self.tape.compiled.complex_jacobians(at)
        return jacobians[:, :, : self.n]

    def affine(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) without further unknowns, and no longer in homogeneous
        coordinates where they are."""
        if not self.is_projective:
            return points
        with np.errstate(all="ignore"):
            places: np.ndarray = points[:, 1 : self.coordinates] / points[:, :1]
        return places

    def is_regular(self, point: np.ndarray, parameters: np.ndarray) -> bool:
        """Whether the equations are independent at a point (n,)."""
        (jacobian,) = self.jacobians(point[None], parameters)
        return int(np.linalg.matrix_rank(jacobian)) == self.n

    def _with_parameters(
        self, points: np.ndarray, parameters: np.ndarray
    ) -> np.ndarray:
        repeated = np.broadcast_to(parameters, (len(points), self.parameters))
        joined: np.ndarray = np.hstack([points, repeated]).astype(complex)
        return joined


def on_patch(points: np.ndarray, patch: np.ndarray) -> np.ndarray:
    """Points (k, n) in homogeneous coordinates (k, n + 1) of which a linear function
    with the coefficients ``patch`` (n + 1,) is 1."""
    places = np.insert(points.astype(complex), 0, 1.0, axis=1)
    scaled: np.ndarray = places / (places @ patch)[:, None]
    return scaled


def complex_normal(rng: np.random.Generator, shape: Any) -> np.ndarray:
    """Complex numbers of normal distribution, 1 in the mean square."""
    numbers: np.ndarray = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    numbers *= np.sqrt(0.5)
    return numbers
