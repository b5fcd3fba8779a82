"""Compiled parts of linkages: `linkages/core`."""

import numpy as np

def residuals(thetas: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def jacobians(thetas: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def hessian(theta: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def march(
    start: np.ndarray,
    tangent: np.ndarray,
    geometry: np.ndarray,
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
    coupling: np.ndarray | None = None,
) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
def project(
    starts: np.ndarray, geometry: np.ndarray, noise: float, iterations: int
) -> tuple[np.ndarray, np.ndarray]: ...
def project_to_sphere(
    starts: np.ndarray,
    center: np.ndarray,
    radius: float,
    geometry: np.ndarray,
    iterations: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
