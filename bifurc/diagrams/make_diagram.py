"""From an atlas and a parameter to a bifurcation diagram."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Event
from bifurc.checks import check_type
from bifurc.decisions import is_fold_of_crossing
from bifurc.diagrams.branching import TurningPass, branching_kind
from bifurc.diagrams.diagram import (
    Branching,
    Diagram,
    DiagramPoint,
    PointKind,
)
from bifurc.diagrams.events import EventFunction, EventRequests, event_places, events_of
from bifurc.diagrams.stability import (
    FormStability,
    HopfPlace,
    has_square_rest,
    stability_along,
    unknown_stability,
)
from bifurc.errors import ProblemError
from bifurc.problem import Problem
from bifurc.search.canonical_course import wrapped_periods
from bifurc.singular.point import Kind
from bifurc.torus import wrap

__all__ = ["diagram_of", "parameter_index"]

INITIALS = {PointKind.FOLD: "F", PointKind.HOPF: "H", PointKind.EVENT: "E"}


def diagram_of(
    problem: Problem,
    atlas: Atlas,
    parameter: str | None = None,
    events: EventRequests | None = None,
    *,
    is_flow: bool = True,
) -> Diagram:
    """What happens along the forms of an atlas of a problem as a parameter changes.

    ``parameter`` is the name of an unknown. Where there are as many equations as other
    unknowns, they are taken as the right-hand sides of u' = F(u), the first for the
    first of the others, and so on; with ``is_flow`` False they are not, and there is no
    stability. ``events`` are functions of the unknowns (n,) by
    their names, of which the zeros are looked for; with (function, value) the places
    where it takes the value, or each of several. The name of an unknown may stand for a
    function. Raises `ProblemError` for a parameter that is no unknown, and for events
    of another kind.
    """
    check_type("problem", problem, Problem)
    check_type("atlas", atlas, Atlas)
    check_type("is_flow", is_flow, bool)
    functions = events_of({} if events is None else events, problem.names)
    found = [
        place for event in functions for place in _event_points(problem, atlas, event)
    ]
    if parameter is None:
        return Diagram("", _named(problem, found), (), ())
    index = parameter_index(problem.names, parameter)
    folds, at_crossings = _turnings(problem, atlas, index)
    has_stability = is_flow and bool(atlas.forms) and has_square_rest(problem)
    along = _stability(problem, atlas, index, folds, has_stability)
    hopf_points = [
        _hopf_point(atlas, form, place)
        for form, one in enumerate(along)
        for place in one.hopf_places
    ]
    stretches = tuple(stretch for one in along for stretch in one.stretches)
    branchings = []
    for number, point in enumerate(atlas.points):
        turning = at_crossings.get(number, [])
        kind = branching_kind(atlas, index, point, turning, stretches)
        if kind is not None:
            branchings.append(Branching(number, kind))
    points = _named(problem, [*folds, *hopf_points, *found])
    return Diagram(parameter, points, stretches, tuple(branchings))


def parameter_index(names: Sequence[str], parameter: object) -> int:
    """The index of the unknown called ``parameter``; raises `ProblemError` with the
    nearest name where there is none."""
    if parameter not in names:
        near = difflib.get_close_matches(str(parameter), names, n=1)
        hint = f" (the nearest is {near[0]})" if near else ""
        allowed = f"one of the unknowns {', '.join(names)}{hint}"
        raise ProblemError("parameter", repr(parameter), allowed)
    return list(names).index(str(parameter))


class _Turnings(NamedTuple):
    """Where a parameter turns back: ``folds``, and passes of singular points by the
    numbers of these."""

    folds: list[DiagramPoint]
    at_crossings: dict[int, list[TurningPass]]


def _turnings(problem: Problem, atlas: Atlas, index: int) -> _Turnings:
    """Where the unknown number ``index`` turns back."""
    turnings = _Turnings([], {})
    for event in atlas.dead_points:
        if event.index != index:
            continue
        crossing = _crossing_at(problem, atlas, event)
        bend = float(atlas.forms[event.form].branch(event.s, 2)[index])
        if crossing is None:
            fold = DiagramPoint("", PointKind.FOLD, event.form, event.s, event.u, bend)
            turnings.folds.append(fold)
        else:
            passing = TurningPass(event.form, crossing.s, bend)
            turnings.at_crossings.setdefault(crossing.point, []).append(passing)
    return turnings


class _Crossing(NamedTuple):
    """Singular point number ``point``, passed at arclength ``s``."""

    point: int
    s: float


def _crossing_at(problem: Problem, atlas: Atlas, event: Event) -> _Crossing | None:
    """The bifurcation at which an event of a form lies, if there is one."""
    length = atlas.forms[event.form].branch.length
    for number, point in enumerate(atlas.points):
        if point.kind is not Kind.BIFURCATION:
            continue
        for form, s in point.passes:
            gap = abs(s - event.s)
            gap = min(gap, abs(length - gap))
            beside = gap - 2 * point.point.error
            if form == event.form and is_fold_of_crossing(beside, problem.scale):
                return _Crossing(number, s)
    return None


def _stability(
    problem: Problem,
    atlas: Atlas,
    index: int,
    folds: Sequence[DiagramPoint],
    is_known: bool,
) -> list[FormStability]:
    """The stretches and Hopf points of every form."""
    along = []
    for number, form in enumerate(atlas.forms):
        cuts = [fold.s for fold in folds if fold.form == number]
        passes = [one for point in atlas.points for one in point.passes]
        cuts += [s for passing, s in passes if passing == number]
        if is_known:
            one = stability_along(problem, form.branch, number, index, cuts)
        else:
            one = unknown_stability(form.branch, number, cuts)
        along.append(one)
    return along


def _hopf_point(atlas: Atlas, form: int, place: HopfPlace) -> DiagramPoint:
    branch = atlas.forms[form].branch
    s = place.s % branch.length if branch.closed else place.s
    return DiagramPoint("", PointKind.HOPF, form, s, branch(s), place.frequency)


def _event_points(
    problem: Problem, atlas: Atlas, event: EventFunction
) -> list[DiagramPoint]:
    """The places on all forms where a function takes its value."""
    # an unknown that is counted in a unit of its own is no larger than its bounds
    sizes = np.minimum(problem.scale, 0.5 * np.diff(problem.bounds, axis=1)[:, 0])
    points = []
    for number, form in enumerate(atlas.forms):
        branch = form.branch
        for s in event_places(branch, event, sizes).tolist():
            u, value = branch(s), event.value
            point = DiagramPoint("", PointKind.EVENT, number, s, u, value, event.label)
            points.append(point)
    return points


def _named(
    problem: Problem, points: Sequence[DiagramPoint]
) -> tuple[DiagramPoint, ...]:
    """The points with wrapped unknowns, numbered kind by kind, in the order of forms
    and arclengths."""
    periods = wrapped_periods(problem)
    named = []
    for kind, initial in INITIALS.items():
        of_kind = [point for point in points if point.kind is kind]
        of_kind.sort(key=lambda point: (point.label, point.form, point.s))
        for number, point in enumerate(of_kind, start=1):
            name, u = f"{initial}{number}", wrap(point.u, periods)
            named.append(replace(point, name=name, u=u))
    return tuple(named)
