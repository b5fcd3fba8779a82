"""From a large problem and a start to one branch with its special points."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.checks import check_type, check_whole, floats_of
from bifurc.curves.continuation import follow_curve, joined_branch
from bifurc.curves.track import Place
from bifurc.decisions import (
    is_derivative_along,
    is_far_below_size,
    is_solution,
    is_trivial_field,
)
from bifurc.errors import ProblemError
from bifurc.large.hopf_points import eigenvalues_along, hopf_points_on
from bifurc.large.large_branch import LargeBranch, LargePoint
from bifurc.large.large_problem import LargeProblem
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_triples import singular_profile, unit_tangent
from bifurc.large.special_points import crossings_on, folds_on, near_misses_on
from bifurc.limits import one_thread
from bifurc.numerics.null_spaces import null_vector
from bifurc.settings import TraceSettings
from bifurc.system import relative_gaps, relative_residuals

NEWTON_STEPS = 12
RESIZINGS = 4  # tracings at most, each with the size that was seen by the one before
SAMPLES = 40  # of a curve at which the size of its field is seen
DIFFERENCE = 1e-5  # length of the step along a tangent by which F' is checked
SHORTER = 0.1  # a second step, over the first, which shows the error of a difference
SETTLED = 1e-9  # a step after which the next one, its square, would be rounding


TRACING = TraceSettings(
    order=6, tolerance=1e-6, shortest=1e-7, longest=1.0, max_length=6.0
)


@dataclass(frozen=True)
class LargeSettings:
    """How a large problem is traced, and what is looked for on the curve.

    Lengths in ``tracing`` are arclengths in the problem's units. With ``values`` of the
    smallest singular values, taken at ``places`` of each piece, crossings and near
    misses are looked for; with none only folds. With ``eigenvalues`` of those that lie
    next to a ``shift`` Hopf points are. ``both_ways``: whether the curve is
    followed to both sides of the start, and not only along its direction. Raises
    `ProblemError` for negative numbers and other kinds of things.
    """

    tracing: TraceSettings = TRACING
    values: int = 0
    places: int = 6
    both_ways: bool = False
    eigenvalues: int = 0
    shift: complex = 0.0

    def __post_init__(self) -> None:
        check_type("tracing", self.tracing, TraceSettings)
        check_whole("values", self.values, 0)
        check_whole("places", self.places, 1)
        check_type("both_ways", self.both_ways, bool)
        check_whole("eigenvalues", self.eigenvalues, 0)
        is_number = isinstance(self.shift, int | float | complex)
        if not is_number or not np.isfinite(self.shift):
            raise ProblemError("shift", repr(self.shift), "a finite number")


DEFAULT_SETTINGS = LargeSettings()


def trace_large_branch(
    problem: LargeProblem,
    start: Sequence[float] | np.ndarray,
    direction: Sequence[float] | np.ndarray | None = None,
    settings: LargeSettings = DEFAULT_SETTINGS,
) -> LargeBranch:
    """The curve through a solution next to ``start`` (n,), with folds, crossings, near
    misses and Hopf points located.

    It is followed to the side of ``direction`` (n,), which is that of a growing
    parameter unless given, until it closes, leaves the bounds, or is
    as long as the settings allow. Trouble on the way is the `Outcome` of the branch. A
    typical size of the field that is far too large is replaced by the one that is seen. Raises `ProblemError` for
    a start, a direction, a value, a jacobian or a solution by the solver that has
    another shape or is not finite, for a start outside of the bounds, for one that cannot
    be corrected to a solution, for a jacobian that is
    not the derivative at the start or along the curve, and where
    the solver is so poor that the first systems are not solved.

    >>> import bifurc, numpy as np
    >>> def bratu(x):  # u'' + p exp(u) = 0 by differences, the parameter last
    ...     walls = np.concatenate([[0.0], x[:-1], [0.0]])
    ...     return 100**2 * (walls[2:] - 2 * walls[1:-1] + walls[:-2]) + x[-1] * np.exp(x[:-1])
    >>> problem = bifurc.LargeProblem(bratu, 100, bounds=(0, 4))
    >>> branch = bifurc.trace_large_branch(problem, np.zeros(100))
    >>> [round(float(fold.parameter), 5) for fold in branch.folds]
    [3.51365]
    """
    check_type("problem", problem, LargeProblem)
    check_type("settings", settings, LargeSettings)
    checked = problem.check_start(start)
    along = _checked_direction(problem, direction)
    import scipy.linalg  # noqa: F401  its BLAS is limited where it is loaded before

    # threads of BLAS share only a solver of the user's: vectors are too short for them
    threads = one_thread(problem.n) if problem.solver is None else nullcontext()
    with threads, np.errstate(over="ignore", invalid="ignore"):
        scaled, branch = _traced_at_its_size(problem, checked, along, settings)
        _check_is_solved(scaled, checked, branch)
        points = folds_on(scaled, branch)
        profile = singular_profile(scaled, branch, settings.places, settings.values)
        crossings = crossings_on(scaled, branch, profile)
        points += crossings
        points += near_misses_on(scaled, branch, profile, crossings)
        eigenvalues = eigenvalues_along(
            scaled,
            branch,
            settings.places,
            settings.eigenvalues,
            complex(settings.shift),
        )
        search = hopf_points_on(scaled, branch, eigenvalues)
        points += search.points
        _check_jacobian_along(scaled, branch, points)
    points.sort(key=lambda point: point.s)
    return LargeBranch(
        branch,
        scaled.own_units,
        tuple(points),
        profile.places,
        profile.values,
        eigenvalues,
        search.unsettled,
    )


def _check_is_solved(scaled: ScaledProblem, start: np.ndarray, branch: Branch) -> None:
    """Raises `ProblemError` where no correction of the ``start`` (n,) of a curve led to
    a solution."""
    if len(branch.pieces):
        return
    point = scaled.own_units.inwards(start)
    gap = float(relative_gaps(scaled, point[None])[0])
    if is_solution(gap):
        return
    allowed = (
        f"{is_solution.threshold:g} at most after its correction: give a start nearer "
        "to a solution"
    )
    left = min(gap, branch.gap) if branch.outcome is Outcome.OPEN else gap
    largest = np.abs(scaled.problem.value(start)).max()
    value = f"{left:.2g}, with equations of up to {largest:.2g} at the start"
    raise ProblemError("relative residual of the start", value, allowed)


def _check_jacobian_along(
    scaled: ScaledProblem, branch: Branch, points: list[LargePoint]
) -> None:
    """Raises `ProblemError` where F' is not the derivative along a curve, in the middle,
    at its end or at one of its special ``points``.

    At a start with u = 0 much that is wrong is hidden, and along a random direction
    differences of neighbours hide what the equations add to them. A tangent is smooth.
    """
    if scaled.problem.is_recorded or not len(branch.pieces):
        return
    places = [0.5 * branch.length, branch.length, *(point.s for point in points)]
    for s in places:
        _check_along_tangent(scaled, branch(s), unit_tangent(branch, s))


def _check_along_tangent(
    scaled: ScaledProblem, point: np.ndarray, tangent: np.ndarray
) -> None:
    def difference(step: float) -> np.ndarray:
        both = np.stack([point + step * tangent, point - step * tangent])
        upper, lower = relative_residuals(scaled, both)
        derivative: np.ndarray = (upper - lower) / (2.0 * step)
        return derivative

    product = scaled.jacobian(point) @ tangent / scaled.magnitude
    expected = difference(DIFFERENCE)
    error = np.linalg.norm(expected - difference(SHORTER * DIFFERENCE))
    misses = np.abs(product - expected)
    if not is_derivative_along(float(np.linalg.norm(misses) - error)):
        row = int(np.argmax(misses))
        in_units = scaled.magnitude / scaled.own_units.weights[row]
        parameter = scaled.own_units.outwards(point)[-1]
        raise ProblemError(
            f"product of row {row} of the jacobian with the tangent of the curve at "
            f"{scaled.problem.parameter} = {parameter:.6g}",
            f"{in_units * product[row]:.6g}",
            f"the derivative of the function, {in_units * expected[row]:.6g}",
        )


def _checked_direction(problem: LargeProblem, direction: object) -> np.ndarray:
    """A direction as an array (n,), along the parameter where there is none."""
    if direction is None:
        along = np.zeros(problem.n)
        along[-1] = 1.0
        return along
    along = floats_of("direction", direction)  # type: ignore[arg-type]
    if along.shape != (problem.n,):
        raise ProblemError("shape of the direction", along.shape, f"({problem.n},)")
    if not np.all(np.isfinite(along)) or not np.any(along):
        raise ProblemError("direction", along, "a finite vector other than zero")
    return along


def _traced_at_its_size(
    problem: LargeProblem,
    start: np.ndarray,
    direction: np.ndarray,
    settings: LargeSettings,
) -> tuple[ScaledProblem, Branch]:
    """The curve in the units of the problem, and these: where its field is far smaller
    than the size that the user gives, those of the size that is seen.

    In units that are far too large a fold is a sharp bend, at which tracing stalls.
    """
    for _ in range(RESIZINGS):
        scaled = ScaledProblem(problem, start)
        branch = _traced(scaled, start, direction, settings)
        seen = _largest_field(branch)
        if is_trivial_field(seen) or not is_far_below_size(seen):
            break
        problem = problem.with_size(seen * problem.size)
    return scaled, branch


def _largest_field(branch: Branch) -> float:
    """The largest root mean square of the field along a curve, over its size."""
    if not len(branch.pieces):
        return 0.0
    fields = branch.sample(SAMPLES)[:, :-1]
    return float(np.linalg.norm(fields, axis=1).max())


def _traced(
    scaled: ScaledProblem,
    start: np.ndarray,
    direction: np.ndarray,
    settings: LargeSettings,
) -> Branch:
    """The curve in the units of the problem."""
    point = scaled.own_units.inwards(start)
    along = direction / scaled.own_units.sizes
    tangent = null_vector(scaled, point, along)
    forward = follow_curve(scaled, Place(point, tangent), settings.tracing)
    if not len(forward.pieces):
        # corrected across the curve, the start may have left the bounds
        point = solution_at_parameter(scaled, point)
        tangent = null_vector(scaled, point, along)
        forward = follow_curve(scaled, Place(point, tangent), settings.tracing)
    ends_here = forward.outcome in (Outcome.CLOSED, Outcome.OPEN)
    if not settings.both_ways or ends_here:
        return forward
    backward = follow_curve(scaled, Place(point, -tangent), settings.tracing)
    if backward.length <= settings.tracing.shortest:
        return forward
    return joined_branch(backward.reversed(), forward)


def solution_at_parameter(scaled: ScaledProblem, start: np.ndarray) -> np.ndarray:
    """The solution (n,) near ``start`` (n,) with the same parameter; ``start`` itself
    where Newton's method does not settle."""
    point: np.ndarray = start.copy()
    only_parameter = np.zeros((1, scaled.n))
    only_parameter[0, -1] = 1.0
    for _ in range(NEWTON_STEPS):
        system = scaled.bordered(point, only_parameter)
        step = system.solve(np.append(-relative_residuals(scaled, point[None])[0], 0.0))
        length = float(np.linalg.norm(step))
        if not length < np.inf:
            return start
        point = point + step
        point[-1] = start[-1]
        if length < SETTLED:
            return point
    return start
