"""What happens along the curve of a singular point."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_same_point
from bifurc.diagrams.zeros import ZeroKind, zeros_along
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.numerics.null_spaces import null_spaces

ROUNDING = 4e-16  # of a point, that doubles leave
BESIDE = np.array([-0.1, 0.0, 0.1])  # arclengths over the scale


class PlaceKind(Enum):
    """What happens at a place of a followed curve."""

    # The only parameter turns back: on one side of it there are two of the points.
    BIRTH = "birth"
    # One of two parameters turns back.
    TURN = "turn"
    # Of a fold, both parameters turn back.
    CUSP = "cusp"
    # Of a fold, the eigenvalue 0 is double.
    BOGDANOV_TAKENS = "bogdanov-takens"
    # Of a fold, another pair of eigenvalues is imaginary.
    ZERO_HOPF = "zero-hopf"


@dataclass(frozen=True, eq=False)
class FollowedPlace:
    """A place of a followed curve: its ``kind``, the arclength ``s``, the unknowns ``u``
    (n,), the parameters ``p`` (q,), and the ``error``: how far off the latter may be, in
    doubles. Where one ``parameter`` (from 0) turns back, whether that ``is_minimum``."""

    kind: PlaceKind
    s: float
    u: np.ndarray
    p: np.ndarray
    error: float
    parameter: int | None = None
    is_minimum: bool = False


def places_on(
    problem: SingularPointProblem, branch: Branch
) -> tuple[FollowedPlace, ...]:
    """All places of a followed curve at which something happens, in order."""
    parametrised = problem.parametrised
    places = [
        place
        for parameter in range(parametrised.q)
        for place in _turns(problem, branch, parameter)
    ]
    is_fold = problem.nullity == 1 and parametrised.tape.m == parametrised.n
    if is_fold and parametrised.q == 2:
        columns = slice(parametrised.n, parametrised.n + 2)
        places = _with_cusps(places, branch, columns, problem.domain.scale)
        for kind, function in (
            (PlaceKind.BOGDANOV_TAKENS, _second_zero),
            (PlaceKind.ZERO_HOPF, _imaginary_pair),
        ):
            places += _of_eigenvalues(problem, branch, kind, function)
    return tuple(sorted(places, key=lambda place: place.s))


def _place(
    problem: SingularPointProblem, branch: Branch, s: float, kind: PlaceKind
) -> FollowedPlace:
    point = branch(s)
    # where two points meet, their tangents do, and the equations lose rank at that place
    # alone: how well it is known shows beside it
    near = np.clip(s + BESIDE * problem.domain.scale, 0.0, branch.length)
    sigma, _ = null_spaces(problem, branch(near))
    steepest = max(float(sigma[:, -2].max()), ROUNDING)
    size = 1.0 + float(np.abs(point).max())
    error = (ROUNDING * size + branch.max_residual) / steepest
    u, p = problem.place(point)
    largest = float(problem.sizes[problem.parametrised.n :].max())
    return FollowedPlace(kind, s, u, p, error * largest)


def _turns(
    problem: SingularPointProblem, branch: Branch, parameter: int
) -> Iterator[FollowedPlace]:
    """Where a parameter (from 0) turns back."""
    kind = PlaceKind.BIRTH if problem.parametrised.q == 1 else PlaceKind.TURN
    for turning in branch.turnings(problem.parametrised.n + parameter):
        if turning.before * turning.after < 0.0:
            place = _place(problem, branch, turning.s, kind)
            is_minimum = turning.after > 0.0
            yield replace(place, parameter=parameter, is_minimum=is_minimum)


def _with_cusps(
    turns: list[FollowedPlace], branch: Branch, parameters: slice, scale: float
) -> list[FollowedPlace]:
    """The turns of two parameters, and those as one cusp at which neither moves."""
    places: list[FollowedPlace] = []
    for place in turns:
        rates = np.linalg.norm(branch(place.s, derivative=1)[parameters])
        if not is_same_point(float(rates), 1.0):
            places.append(place)
        elif not any(is_same_point(abs(one.s - place.s), scale) for one in places):
            cusp = replace(place, kind=PlaceKind.CUSP, parameter=None, is_minimum=False)
            places.append(cusp)
    return places


# --- eigenvalues of a fold ------------------------------------------------------------


def _of_eigenvalues(
    problem: SingularPointProblem,
    branch: Branch,
    kind: PlaceKind,
    function: Callable[[np.ndarray], np.ndarray],
) -> list[FollowedPlace]:
    """The places at which a function of the matrices F_u (k, n, n) is zero."""
    parametrised = problem.parametrised
    n = parametrised.n

    def along(s: np.ndarray) -> np.ndarray:
        # in the user's units: others of the equations have other eigenvalues
        points = np.concatenate(problem.place(branch(s)), axis=1)
        return function(parametrised.tape.compiled.jacobians(points)[:, :, :n])

    zeros = zeros_along(branch, along).zeros
    return [
        _place(problem, branch, zero.s, kind)
        for zero in zeros
        if zero.kind is ZeroKind.CROSSING
    ]


def _second_zero(matrices: np.ndarray) -> np.ndarray:
    """The trace (k,) of the adjugates of singular matrices (k, n, n): the product of
    their other eigenvalues, zero where 0 is a double one."""
    left, sigma, right = np.linalg.svd(matrices)
    signs = np.linalg.det(left) * np.linalg.det(right)
    overlaps = np.einsum("ki,ki->k", left[:, :, -1], right[:, -1, :])
    product: np.ndarray = signs * sigma[:, :-1].prod(axis=1) * overlaps
    return product


def _imaginary_pair(matrices: np.ndarray) -> np.ndarray:
    """The product (k,) of the real parts of the pairs of complex eigenvalues of singular
    matrices (k, n, n); 1 where there are none."""
    values = np.linalg.eigvals(matrices)
    is_of_pair = values.imag > 0.0
    product: np.ndarray = np.where(is_of_pair, values.real, 1.0).prod(axis=1)
    return product
