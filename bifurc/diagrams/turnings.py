"""Where a parameter turns back along forms: folds, and passes of singular points; and
how branches cross there."""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.branch import Branch, Outcome, Turning
from bifurc.curves.monitor import NODES
from bifurc.decisions import is_drawn_to_point, is_fold_of_crossing, stands_still
from bifurc.diagrams.diagram import DiagramPoint, Stretch
from bifurc.diagrams.fold import Fold, refined_fold
from bifurc.problem import Problem
from bifurc.singular.point import Kind

SAME_CUT = 1e-12  # of a length: a stretch ends at the very arclength of a pass


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
    return np.minimum(problem.scale, 0.5 * np.diff(problem.bounds, axis=1)[:, 0])


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
            if passing == form and is_fold_of_crossing(beside, problem.scale):
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
    before = problem.difference(start, point.point.u) / sizes
    after = problem.difference(reached, point.point.u) / sizes
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
