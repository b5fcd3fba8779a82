"""Where a parameter turns back along forms: folds, and passes of singular points; and
how branches cross there.

A fold is the regular solution of a system of its own: the point u and the tangent v solve
F(u) = 0, F'(u) v = 0, v_p = 0, t . v = 1 with the tangent t nearby (Moore and Spence
1980), whatever the pieces of a curve are off.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.branch import Branch, Outcome, Turning
from bifurc.curves.deflation import WithNullVector
from bifurc.curves.monitor import NODES
from bifurc.decisions import is_drawn_to_point, is_fold_of_crossing, stands_still
from bifurc.diagrams.diagram import DiagramPoint, Stretch
from bifurc.problem import Problem
from bifurc.singular.point import Kind
from bifurc.system import hessian_at

SAME_CUT = 1e-12  # of a length: a stretch ends at the very arclength of a pass
STEPS = (
    60  # at a fold of higher order a step is no shorter than a part of the one before
)
SETTLED = 1e-15  # of the sizes of the unknowns: a step after which none follows
FARTHEST = 0.1  # of the sizes: a longer step leads elsewhere
RANK = 1e-14  # of singular values, over the largest: what is smaller is rounding


class Turnings(NamedTuple):
    """Where a parameter turns back: ``folds``, and passes of singular points by the
    numbers of these (``at_crossings``). ``resting`` are the forms along which it does
    not change."""

    folds: list[DiagramPoint]
    at_crossings: dict[int, list[TurningPass]]
    resting: set[int]


class _Pass(NamedTuple):
    """Singular point number ``point``, passed at arclength ``s``."""

    point: int
    s: float


def unknown_sizes(problem: Problem) -> np.ndarray:
    """Sizes (n,) of the unknowns: one that is counted in a unit of its own is no larger
    than its bounds."""
    return np.minimum(
        problem.domain.scale, 0.5 * np.diff(problem.domain.bounds, axis=1)[:, 0]
    )


def turnings_of(problem: Problem, atlas: Atlas, index: int) -> Turnings:
    """Where the unknown number ``index`` turns back along the forms of an atlas."""
    sizes = unknown_sizes(problem)
    turnings = Turnings([], {}, set())
    for number, form in enumerate(atlas.forms):
        branch = form.branch
        rates = np.abs(branch(branch.places(NODES).ravel(), 1)).max(axis=0)
        largest = float(rates[index])
        if stands_still(largest / sizes[index], float((rates / sizes).max())):
            turnings.resting.add(number)
            continue
        for place in branch.turnings(index):
            is_at_end = place.before * place.after == 0.0
            # a form that ends in its bounds goes on beyond them
            if not is_at_end or branch.outcome is Outcome.LEFT_REGION:
                _add(turnings, problem, atlas, number, place, index)
    for number, passes in turnings.at_crossings.items():
        turnings.at_crossings[number] = _odd_ones(passes)
    return turnings


def _odd_ones(passes: Sequence[TurningPass]) -> list[TurningPass]:
    """One turning for each pass at which rounding shows an odd number of them, none for
    an even one."""
    by_place: dict[tuple[int, float], list[TurningPass]] = {}
    for one in passes:
        by_place.setdefault((one.form, one.s), []).append(one)
    return [same[-1] for same in by_place.values() if len(same) % 2 == 1]


def _add(
    turnings: Turnings,
    problem: Problem,
    atlas: Atlas,
    form: int,
    place: Turning,
    index: int,
) -> None:
    """Add what the parameter does at a zero of its rate."""
    passing = _pass_at(problem, atlas, form, place)
    if passing is not None:
        side = place.after or -place.before
        turning = TurningPass(form, passing.s, side)
        turnings.at_crossings.setdefault(passing.point, []).append(turning)
        return
    branch = atlas.forms[form].branch
    start = branch(place.s)
    sizes = unknown_sizes(problem)
    fold = refined_fold(problem, start, branch(place.s, 1), index, sizes)
    reached = start if fold is None else fold.u
    if any(
        _is_drawn(problem, point, start, reached, sizes)
        for point in atlas.points
        if point.kind is not Kind.RANK_DROP
    ):
        return
    turnings.folds.append(_fold_point(branch, form, place, fold, index, sizes))


def _pass_at(problem: Problem, atlas: Atlas, form: int, place: Turning) -> _Pass | None:
    """The pass of a singular point that lies where rounding hides how a parameter
    turns, if there is one."""
    length = atlas.forms[form].branch.length
    middle, half = 0.5 * (place.low + place.high), 0.5 * (place.high - place.low)
    for number, point in enumerate(atlas.points):
        if point.kind is Kind.RANK_DROP:
            continue
        for passing, s in point.passes:
            gap = abs(s - middle)
            if atlas.forms[form].branch.closed:
                gap = min(gap, abs(length - gap))
            beside = gap - half - 2 * point.point.error
            if passing == form and is_fold_of_crossing(beside, problem.domain.scale):
                return _Pass(number, s)
    return None


def _is_drawn(
    problem: Problem,
    point: MeetingPoint,
    start: np.ndarray,
    reached: np.ndarray,
    sizes: np.ndarray,
) -> bool:
    """Whether Newton's method for a fold goes to a singular point."""
    before = problem.domain.difference(start, point.point.u) / sizes
    after = problem.domain.difference(reached, point.point.u) / sizes
    error = 3.0 * point.point.error / float(sizes.min())
    unit = max(float(np.linalg.norm(before)), error / is_drawn_to_point.threshold)
    return is_drawn_to_point(float(np.linalg.norm(after)), unit)


def _fold_point(
    branch: Branch,
    form: int,
    place: Turning,
    fold: Fold | None,
    index: int,
    sizes: np.ndarray,
) -> DiagramPoint:
    """The fold at a zero of the rate, where Newton's method found it if it stayed
    there."""
    half = 0.5 * (place.high - place.low)
    s, u, bend = place.s, branch(place.s), float(branch(place.s, 2)[index])
    if fold is not None:
        step = fold.u - u
        room = half / float(sizes.min()) + 1e-6
        if float(np.abs(step / sizes).max()) <= room:
            s += float(step @ branch(place.s, 1))
            u, bend = fold.u, fold.bend
    s = float(np.clip(s, 0.0, branch.length))
    return DiagramPoint("", Kind.FOLD, form, s, u, bend, error=half)


# --- how branches cross ---------------------------------------------------------------


class TurningPass(NamedTuple):
    """A pass of form number ``form`` at arclength ``s`` at which the parameter turns
    back; ``side`` is 1 where it grows after that, and -1 where it falls."""

    form: int
    s: float
    side: float


def branching_kind(
    atlas: Atlas,
    parameter: int,
    point: MeetingPoint,
    turning: Sequence[TurningPass],
    resting: Container[int],
    stretches: Sequence[Stretch],
) -> Kind | None:
    """What a singular point is along the parameter; None where no branches cross.

    ``turning`` are those of its passes at which the parameter turns back, ``resting``
    the forms along which it does not change, ``stretches`` those of all forms.
    """
    if point.kind is not Kind.BIFURCATION:
        return None
    if len(point.passes) != 2 or len(turning) > 1:
        return Kind.OTHER
    if not turning:
        stands = any(form in resting for form, _ in point.passes)
        return Kind.OTHER if stands else Kind.TRANSCRITICAL
    branch = turning[0]
    trunk = next(one for one in point.passes if one != (branch.form, branch.s))
    beside = _unstable_beside(stretches, branch.form, branch.s, 1.0)
    rises = float(atlas.forms[trunk[0]].branch(trunk[1], 1)[parameter])
    side = 1.0 if rises * branch.side > 0 else -1.0
    on_trunk = _unstable_beside(stretches, *trunk, side)
    if min(beside, on_trunk) < 0 or beside == on_trunk:
        return Kind.PITCHFORK
    if beside < on_trunk:
        return Kind.SUPERCRITICAL
    return Kind.SUBCRITICAL


def _unstable_beside(
    stretches: Sequence[Stretch], form: int, s: float, side: float
) -> int:
    """The number of unstable eigenvalues on a form next to ``s``, before or after it by
    the sign ``side``; -1 where it is not known."""
    own = [stretch for stretch in stretches if stretch.form == form]
    if not own:
        return -1
    first = own[0].start
    length = own[-1].end - first
    for stretch in own:
        here = stretch.start if side > 0 else stretch.end
        gap = abs(here - s)
        if min(gap, abs(gap - length)) <= SAME_CUT * max(length, 1.0):
            return stretch.unstable
    return -1


# --- folds ----------------------------------------------------------------------------


class Fold(NamedTuple):
    """A fold at ``u`` (n,), and the second derivative of the parameter in the arclength
    (``bend``) there."""

    u: np.ndarray
    bend: float


def refined_fold(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    parameter: int,
    sizes: np.ndarray,
) -> Fold | None:
    """The fold next to ``start`` (n,), where a curve has a ``tangent`` (n,); None where
    Newton's method leads away, and for many unknowns.

    ``parameter`` is the index of the unknown that turns back, ``sizes`` (n,) are those
    of the unknowns.
    """
    if problem.domain.is_large:
        return None
    n = problem.n
    across = tangent / sizes
    length = float(np.linalg.norm(across))
    system = WithNullVector(problem, across / sizes / length**2, np.eye(n)[parameter])
    units = np.concatenate([sizes, length * sizes])
    point = np.concatenate([start, tangent])
    for _ in range(STEPS):
        right = -system.residuals(point[None])[0]
        step = _scaled_least_squares(system.jacobians(point[None])[0], right, units)
        if step is None or np.abs(step).max() > FARTHEST:
            return None
        point = point + units * step
        if np.abs(step[:n]).max() <= SETTLED:
            break
    u, v = np.split(point, 2)
    return Fold(u, _bend(problem, u, v, parameter))


def _scaled_least_squares(
    matrix: np.ndarray, right: np.ndarray, units: np.ndarray
) -> np.ndarray | None:
    """The solution (n,) of a system in ``units`` (n,) of its unknowns, all equations
    weighted alike; None where it is not finite."""
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return None
    scaled = matrix * units
    weights = np.linalg.norm(scaled, axis=1)
    weights[weights == 0.0] = 1.0
    step: np.ndarray = np.linalg.lstsq(
        scaled / weights[:, None], right / weights, rcond=RANK
    )[0]
    return step


def _bend(
    problem: Problem, u: np.ndarray, tangent: np.ndarray, parameter: int
) -> float:
    """The second derivative of the parameter in the arclength: F' u'' = - F'' t t, u''
    across the unit tangent t."""
    t = tangent / np.linalg.norm(tangent)
    system = np.vstack([problem.jacobians(u[None])[0], t])
    right = np.einsum("mij,i,j->m", hessian_at(problem, u), t, t)
    bend = np.linalg.lstsq(system, np.append(-right, 0.0), rcond=RANK)[0]
    return float(bend[parameter])
