"""Compiled parts of bifurc: `bifurc/core`."""

from collections.abc import Callable
from enum import Enum

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
    def ends_of_pieces(self, derivative: int) -> np.ndarray: ...
    def rates_of_height(
        self, coefficients: np.ndarray, s: np.ndarray
    ) -> np.ndarray: ...
    def level_places(
        self,
        coefficients: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        tolerance: float,
    ) -> np.ndarray: ...
    def nearest(
        self, points: np.ndarray, within: float
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def turnings(self, unknown: int, share: float, jump: float) -> np.ndarray: ...
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

class Chebyshev:
    """What Chebyshev nodes determine: `bifurc.curves.kantorovich`."""

    def __init__(
        self,
        to_coefficients: np.ndarray,
        to_edges: np.ndarray,
        powers: np.ndarray,
        errors: np.ndarray,
        lebesgue: float,
        bend: float,
    ) -> None: ...
    def coefficients(self, values: np.ndarray) -> np.ndarray: ...
    def on_edges(self, series: np.ndarray) -> np.ndarray: ...
    def on_ellipses(self, sizes: np.ndarray) -> np.ndarray: ...
    def slack(self, series: np.ndarray) -> float: ...
    def largest(self, at_nodes: np.ndarray, in_coefficients: np.ndarray) -> float: ...

class SecondDerivative:
    """What is known of F'': `bifurc.curves.kantorovich`."""

    def __init__(
        self, bound: float, residual: float, growth: float, reach: float, error: float
    ) -> None: ...

class Arcs:
    """Arcs at their nodes: `bifurc.curves.kantorovich`."""

    def __init__(
        self,
        slopes: np.ndarray,
        residuals: np.ndarray,
        jacobians: np.ndarray,
        left: np.ndarray,
        images: np.ndarray,
        travel: np.ndarray,
        curvature: np.ndarray,
    ) -> None: ...

def travel_of_arcs(
    chebyshev: Chebyshev, points: np.ndarray, degree: int
) -> np.ndarray: ...
def doubts_of_arcs(
    chebyshev: Chebyshev,
    second: SecondDerivative,
    arcs: Arcs,
    degree: int,
    hessians: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def sizes_on_arcs(
    chebyshev: Chebyshev, arcs: Arcs, degree: int
) -> tuple[np.ndarray, np.ndarray]: ...
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
def mixed_cells(
    exponents: np.ndarray,
    sizes: np.ndarray,
    lifts: np.ndarray,
    most: int,
    seconds: float,
) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
def null_vector(
    matrix: np.ndarray, along: np.ndarray, negligible: float, agreeing: float
) -> np.ndarray: ...
def roots_of_waves(
    coefficients: np.ndarray, low: np.ndarray, high: np.ndarray, tolerance: float
) -> np.ndarray: ...
def singular_values(matrices: np.ndarray) -> np.ndarray: ...
def singular_value_rates(
    matrices: np.ndarray, changes: np.ndarray, number: int
) -> tuple[np.ndarray, np.ndarray]: ...
def solve_by_rank(matrix: np.ndarray, right: np.ndarray) -> np.ndarray: ...
def valley_residuals(residuals: np.ndarray, jacobians: np.ndarray) -> np.ndarray: ...
def valley_jacobians(
    residuals: np.ndarray, jacobians: np.ndarray, hessians: np.ndarray
) -> np.ndarray: ...
def eigenvalues(matrix: np.ndarray) -> np.ndarray: ...

class FactoredTape:
    def __init__(
        self,
        tape: Tape,
        units: np.ndarray,
        weights: np.ndarray,
        point: np.ndarray,
        tangent: np.ndarray,
    ) -> None: ...
    def smallest_singular_value(self) -> float: ...
    def solve(self, right: np.ndarray) -> np.ndarray: ...

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
    def divide(
        self,
        low: np.ndarray,
        high: np.ndarray,
        centers: np.ndarray,
        radii: np.ndarray,
        periods: np.ndarray,
        smallest: float,
        most: int,
    ) -> tuple[
        int,
        tuple[np.ndarray, np.ndarray],
        tuple[np.ndarray, np.ndarray],
        tuple[np.ndarray, np.ndarray],
        tuple[np.ndarray, np.ndarray],
        np.ndarray,
        np.ndarray,
    ]: ...
    def course(
        self,
        curve: Curve,
        centers: np.ndarray,
        radii: np.ndarray,
        periods: np.ndarray,
        residual: float,
        shortest: float,
        most: int,
    ) -> tuple[int, float]: ...
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
        is_sparse: bool,
    ) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
    def follow_paths(
        self,
        starts: np.ndarray,
        first: np.ndarray,
        last: np.ndarray,
        combinations: np.ndarray,
        order: int,
        tolerance: float,
        most_steps: int,
        places: int,
        farthest: float,
        is_precise: bool,
        ends_regular: bool,
        seconds: float,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
    def project(
        self,
        units: np.ndarray,
        weights: np.ndarray,
        starts: np.ndarray,
        noise: float,
        iterations: int,
        is_sparse: bool,
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
    def valley_points_at_nodes(
        self,
        units: np.ndarray,
        weights: np.ndarray,
        start: np.ndarray,
        heading: np.ndarray,
        offsets: np.ndarray,
        predictors: np.ndarray,
        enough: float,
        most: float,
    ) -> np.ndarray | None: ...

def called_equations(
    unknowns: int,
    residuals: Callable[[np.ndarray], np.ndarray],
    jacobians: Callable[[np.ndarray], np.ndarray],
    hessians: Callable[[np.ndarray], np.ndarray],
) -> object: ...
def rank_deflated(equations: object, rank: int) -> object: ...
def residuals_at(equations: object, points: np.ndarray) -> np.ndarray: ...
def jacobians_at(equations: object, points: np.ndarray) -> np.ndarray: ...
def tape_equations(tape: Tape, magnitude: float) -> object: ...
def normal_corrections(
    equations: object, scale: float, points: np.ndarray, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def slopes_above(
    equations: object, points: np.ndarray, planes: np.ndarray
) -> np.ndarray: ...
def follow_rays(
    equations: object,
    scale: float,
    centers: np.ndarray,
    planes: np.ndarray,
    positions: np.ndarray,
    shares: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
def rim_of(dimension: int) -> np.ndarray: ...

class Placement(Enum):
    """What becomes of a place at which a chart is wanted."""

    FITS = ...
    COVERED = ...
    UNFIT = ...
    BESIDE_BOUNDS = ...
    TIGHT = ...

class Growth(Enum):
    """Why no more charts were made."""

    COMPLETE = ...
    OUT_OF_TIME = ...
    UNDECIDED = ...
    CHART_LIMIT = ...
    DOUBT = ...

# placement, center, basis, normal, largest, radius, is_clear, height
_Candidate = tuple[
    Placement, np.ndarray, np.ndarray, np.ndarray, float, float, bool, float
]

class _Cover:
    """The charts of a component that is being covered: `bifurc.surfaces.covering`."""

    def __init__(
        self,
        equations: object,
        scale: float,
        periods: np.ndarray,
        bounds: np.ndarray,
        agree: float,
        smooth: float,
        largest: float,
        smallest: float,
        bend: float,
        flat: float,
        negligible: float,
    ) -> None: ...
    def __len__(self) -> int: ...
    @property
    def undecided(self) -> int: ...
    def grow(
        self, charts: int, undecided: int, seconds: float
    ) -> tuple[Growth, tuple[_Candidate, int, np.ndarray] | None]: ...
    def candidate(
        self, center: np.ndarray, near: np.ndarray, radius: float
    ) -> _Candidate: ...
    def disk(
        self,
        center: np.ndarray,
        basis: np.ndarray,
        normal: np.ndarray,
        largest: float,
        smallest: float,
    ) -> tuple[float, bool, float] | None: ...
    def add(
        self,
        center: np.ndarray,
        basis: np.ndarray,
        radius: float,
        is_clear: bool,
        height: float,
        normals: np.ndarray,
        offsets: np.ndarray,
        labels: np.ndarray,
    ) -> None: ...
    def refuse(self, chart: int, direction: np.ndarray, is_unfit: bool) -> None: ...
    def holes(self) -> np.ndarray: ...
    def charts(
        self, first: int, count: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...

class Cover(_Cover):
    def polygon(self, chart: int) -> tuple[np.ndarray, np.ndarray]: ...

class Cover3(_Cover):
    def facets(self, chart: int) -> np.ndarray: ...

class Cover4(Cover3): ...
class Cover5(Cover3): ...
