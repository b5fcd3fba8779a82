"""Compiled parts of bifurc: `bifurc/core`."""

import numpy as np

def evaluate(
    breaks: np.ndarray,
    centers: np.ndarray,
    radii: np.ndarray,
    pieces: np.ndarray,
    travel: np.ndarray,
    s: np.ndarray,
    derivative: int,
) -> np.ndarray: ...
def feet(
    breaks: np.ndarray,
    centers: np.ndarray,
    radii: np.ndarray,
    pieces: np.ndarray,
    travel: np.ndarray,
    points: np.ndarray,
    s: np.ndarray,
    reach: float,
    periods: np.ndarray,
    iterations: int,
) -> tuple[np.ndarray, np.ndarray]: ...
