"""What is solved: a system F(u) = 0 of any number of equations whose solutions are
curves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from scipy.sparse import sparray

from bifurc import torus
from bifurc.errors import ProblemError
from bifurc.seeds import Seeds

__all__ = ["March", "MarchStatus", "Problem", "ProblemError"]


class MarchStatus(IntEnum):
    """Why a march of pieces ended. Compiled kernels return the numbers."""

    RAN = 0  # all pieces that were asked for are made
    STALLED = 1  # no trusted step is left
    OPEN = 2  # there is no solution at the start


@dataclass(frozen=True)
class March:
    """Consecutive polynomial pieces of a curve.

    ``pieces`` (k, order + 1, n) are coefficients in (s - centre) / radius, trusted from
    -1 to 1, s the arclength; ``steps`` (k,) the arclength to each centre from the one
    before it (from the start, for the first), ``radii`` (k,), ``residuals`` (k,) the
    largest residual seen on each piece relative to the problem's magnitude, or the gap
    at the start alone when the status is OPEN.
    """

    status: MarchStatus
    pieces: np.ndarray
    steps: np.ndarray
    radii: np.ndarray
    residuals: np.ndarray


class Problem(ABC):
    """F: R^n -> R^m with any m; the curves are where rank F' = n - 1 and F = 0.

    Redundant equations are normal: a spatial loop has six for five or fewer that are
    independent. This is what a search asks of its equations; `NumericalProblem` answers
    all of it from `residuals` and `jacobians` alone, and a problem that knows more
    about itself answers faster.

    ``names`` and ``units`` (n,) label the unknowns, ``periods`` (n,) are their periods
    (inf where there is none), ``bounds`` (n, 2) the region of interest (infinite where
    there is none), ``magnitude`` the typical size of F', by which residuals and
    singular values are divided, ``scale`` the typical size of the unknowns, and
    ``derivatives`` says how F' was made.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    periods: np.ndarray
    bounds: np.ndarray
    curvature_residual: float = np.inf
    magnitude: float = 1.0
    scale: float = 1.0
    derivatives: str = "exact"

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return len(self.names)

    @abstractmethod
    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""

    @abstractmethod
    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""

    def jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,), sparse where that is how it is made."""
        return self.jacobians(point[None])[0]

    @abstractmethod
    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,)."""

    def curvature_bound(self) -> float | None:
        """A constant K with |F'(x) - F'(y)| <= K |x - y|, over the magnitude; None
        where none is known.

        It need hold only where the relative residual is at most ``curvature_residual``.
        """
        return None

    @abstractmethod
    def march(
        self,
        start: np.ndarray,
        tangent: np.ndarray,
        order: int,
        tolerance: float,
        shortest: float,
        longest: float,
        count: int,
    ) -> March:
        """Up to ``count`` pieces of the curve from ``start`` (n,) along ``tangent``."""

    @abstractmethod
    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each."""

    @abstractmethod
    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Solutions (k, n) at distance ``radius`` from ``center`` (n,), relative
        residuals (k,) and last steps (k,)."""

    @abstractmethod
    def seeds(self, rng: np.random.Generator, count: int) -> Seeds:
        """Solutions to start from, ``count`` random starts among what they come of."""

    def difference(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """a - b (..., n) with periodic unknowns taken to within half a period of 0."""
        return torus.difference(a, b, self.periods)

    def check_point(self, point: np.ndarray, name: str) -> np.ndarray:
        """``point`` as a float array (n,); raises `ProblemError` for a wrong shape or
        values not finite."""
        out = np.array(point, dtype=float)
        if out.shape != (self.n,):
            raise ProblemError(f"shape of {name}", out.shape, f"({self.n},)")
        if not np.all(np.isfinite(out)):
            raise ProblemError(name, out, "finite")
        return out
