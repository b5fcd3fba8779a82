"""A system with what a search asks of it besides: curves, solutions nearby, and seeds."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from bifurc.limits import Deadline
from bifurc.seeds import Seeds
from bifurc.system import March, MarchSettings, SphereProjection, System


class Problem(System):
    """What a search asks of its equations. `NumericalProblem` answers all of it from a
    domain, `residuals` and `jacobians` alone, and a problem that knows more about itself
    answers faster."""

    @property
    def given_state(self) -> np.ndarray | None:
        """The solution (n,) by which the equations are given, if they are."""
        return None

    @abstractmethod
    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Pieces of the curve from ``start`` (n,) along ``tangent`` (n,)."""

    @abstractmethod
    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each."""

    @abstractmethod
    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions near starts (k, n) at distance ``radius`` from ``center`` (n,)."""

    @abstractmethod
    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Solutions to start from, ``count`` random starts among what they come of, or
        as many of these as there is time for before a ``deadline``."""

    def is_given_at(self, point: np.ndarray) -> bool:
        """Whether the equations were given by their solution at ``point`` (n,), or one
        that is singular there as it is: it is there for certain, also where rounding
        does not tell it from two, or none."""
        return False
