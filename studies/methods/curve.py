"""What every method returns: a curve that can be evaluated anywhere, and why there is
none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline


class MethodFailure(RuntimeError):
    """The method cannot follow this curve to its end; the message says why."""


@dataclass(frozen=True)
class Curve:
    """A curve over a parameter from 0 to ``end``; ``points`` is the number of points or
    pieces it was made of.

    ``seconds`` is the processor time it took where that is spent in a program of its
    own, else None.
    """

    evaluate: Callable[[np.ndarray], np.ndarray]
    end: float
    points: int
    seconds: float | None = None

    def sample(self, count: int) -> np.ndarray:
        """Points (count, n) at equally spaced parameters."""
        return self.evaluate(np.linspace(0.0, self.end, count))


def through_points_and_tangents(
    points: list[np.ndarray], tangents: list[np.ndarray], length: float
) -> Curve:
    """Cubic Hermite pieces through points and unit tangents, cut off at arclength
    ``length``.

    The arclength of a piece is its chord, times 1 + angle^2 / 24 for the arc above it.
    """
    u = np.array(points)
    t = np.array(tangents)
    chords = np.linalg.norm(np.diff(u, axis=0), axis=1)
    turns = np.linalg.norm(np.diff(t, axis=0), axis=1)
    s = _sums(chords * (1 + turns**2 / 24))
    spline = CubicHermiteSpline(s, u, t)
    end = min(length, s[-1])
    return Curve(spline, end, len(u))


def through_points(
    points: list[np.ndarray], length: float, seconds: float | None = None
) -> Curve:
    """A cubic spline through points over their chord length, cut off at ``length``."""
    u = np.array(points)
    s = _sums(np.linalg.norm(np.diff(u, axis=0), axis=1))
    spline = CubicSpline(s, u)
    end = min(length, s[-1])
    return Curve(spline, end, len(u), seconds)


def _sums(lengths: np.ndarray) -> np.ndarray:
    """Arclengths (k + 1,) at the ends of stretches of these lengths (k,)."""
    return np.concatenate([[0.0], np.cumsum(lengths)])
