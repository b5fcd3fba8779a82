"""Compiled parts of linkages: `linkages/core`."""

import numpy as np

def residuals(thetas: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def jacobians(thetas: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def hessians(thetas: np.ndarray, geometry: np.ndarray) -> np.ndarray: ...
def equations(geometry: np.ndarray, magnitude: float) -> object: ...
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
    length: float,
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
def valley_points_at_nodes(
    geometry: np.ndarray,
    start: np.ndarray,
    heading: np.ndarray,
    offsets: np.ndarray,
    predictors: np.ndarray,
    enough: float,
    most: float,
) -> np.ndarray | None: ...
def slice_configurations(
    geometry: np.ndarray, joint: int, angles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
def follow_paths(
    starts: np.ndarray,
    first: np.ndarray,
    last: np.ndarray,
    shares: np.ndarray,
    seconds: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def smallest_singular_values(
    configurations: np.ndarray, table: np.ndarray
) -> np.ndarray: ...
def quaternion_closure(configurations: np.ndarray, table: np.ndarray) -> np.ndarray: ...
def follow_sheets(
    geometry: np.ndarray,
    joint: int,
    starts: np.ndarray,
    ends: np.ndarray,
    shapes: np.ndarray,
    limits: np.ndarray,
    near: np.ndarray,
    first: np.ndarray,
    seconds: float,
) -> tuple[np.ndarray, np.ndarray]: ...
def find_fold(
    geometry: np.ndarray, joint: int, configuration: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float, float, float] | None: ...
def advance_along(
    geometry: np.ndarray, joint: int, sheet: np.ndarray, end: float
) -> tuple[bool, np.ndarray]: ...
def screws_and_error(
    geometry: np.ndarray, configuration: np.ndarray
) -> tuple[np.ndarray, np.ndarray]: ...
def ball_around(
    geometry: np.ndarray, configuration: np.ndarray, along: np.ndarray
) -> tuple[np.ndarray, float, float, np.ndarray]: ...
