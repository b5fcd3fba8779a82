"""Compiled parts of bifurc: `bifurc/core`."""

import numpy as np

class Curve:
    def __init__(
        self,
        breaks: np.ndarray,
        centers: np.ndarray,
        radii: np.ndarray,
        pieces: np.ndarray,
        periods: np.ndarray,
        travel: np.ndarray,
    ) -> None: ...
    def evaluate(self, s: np.ndarray, derivative: int) -> np.ndarray: ...
    def nearest(
        self, points: np.ndarray, within: float
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def turning_points(self, unknown: int) -> np.ndarray: ...
    def passes(self, point: np.ndarray, within: float, same: float) -> np.ndarray: ...

def determinants_and_inverses(
    matrices: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]: ...
def foot_on_piece(
    piece: np.ndarray, point: np.ndarray, periods: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]: ...
def singular_values(matrices: np.ndarray) -> np.ndarray: ...
