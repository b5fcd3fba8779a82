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

class Brackets:
    """Brackets that close in on a root each: `bifurc.numerics.roots`."""

    def __init__(
        self,
        low: np.ndarray,
        high: np.ndarray,
        at_low: np.ndarray,
        at_high: np.ndarray,
        tolerance: float,
    ) -> None: ...
    def points(self) -> np.ndarray: ...
    def narrow(self, values: np.ndarray) -> bool: ...
    def roots(self) -> np.ndarray: ...

def adjugates(
    slopes: np.ndarray,
    jacobians: np.ndarray,
    left: np.ndarray,
    to_coefficients: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
def returns(
    pieces: np.ndarray,
    centers: np.ndarray,
    radii: np.ndarray,
    periods: np.ndarray,
    number: int,
    s: float,
    first: int,
) -> list[tuple[float, float, float, float, np.ndarray]]: ...
def exit_of_bounds(
    pieces: np.ndarray,
    centers: np.ndarray,
    radii: np.ndarray,
    periods: np.ndarray,
    first: int,
    bounds: np.ndarray,
    slack: float,
) -> float | None: ...
def null_vector(
    matrix: np.ndarray, along: np.ndarray, negligible: float, agreeing: float
) -> np.ndarray: ...
def singular_values(matrices: np.ndarray) -> np.ndarray: ...
def singular_value_rates(
    matrices: np.ndarray, changes: np.ndarray, number: int
) -> tuple[np.ndarray, np.ndarray]: ...
def eigenvalues(matrix: np.ndarray) -> np.ndarray: ...

class Tape:
    """Recorded equations: `bifurc.equations.tape`."""

    def __init__(
        self,
        unknowns: int,
        operations: np.ndarray,
        operands: np.ndarray,
        constants: np.ndarray,
        outputs: np.ndarray,
    ) -> None: ...
    @property
    def unknowns(self) -> int: ...
    @property
    def equations(self) -> int: ...
    def residuals(self, points: np.ndarray) -> np.ndarray: ...
    def complex_residuals(self, points: np.ndarray) -> np.ndarray: ...
    def jacobians(self, points: np.ndarray) -> np.ndarray: ...
    def complex_jacobians(self, points: np.ndarray) -> np.ndarray: ...
    def hessian(self, point: np.ndarray) -> np.ndarray: ...
    def series(self, curve: np.ndarray) -> np.ndarray: ...
    def pattern(self) -> tuple[np.ndarray, np.ndarray]: ...
    def entries(self, point: np.ndarray) -> np.ndarray: ...
    def value_bounds(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def jacobian_bounds(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def march(
        self,
        units: np.ndarray,
        weights: np.ndarray,
        start: np.ndarray,
        tangent: np.ndarray,
        order: int,
        tolerance: float,
        shortest: float,
        longest: float,
        count: int,
        closing: float,
        misclosure: float,
        anchor: np.ndarray,
        within: float,
        periods: np.ndarray,
        bounds: np.ndarray,
        length: float,
    ) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
    def project(
        self,
        units: np.ndarray,
        weights: np.ndarray,
        starts: np.ndarray,
        noise: float,
        iterations: int,
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def project_to_sphere(
        self,
        units: np.ndarray,
        weights: np.ndarray,
        starts: np.ndarray,
        center: np.ndarray,
        radius: float,
        iterations: int,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
