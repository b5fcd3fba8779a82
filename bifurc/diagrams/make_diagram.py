"""From an atlas and a parameter to a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.checks import UnknownName, check_type, index_of_unknown
from bifurc.decisions import is_same_point
from bifurc.diagrams.diagram import (
    Branching,
    Diagram,
    DiagramPoint,
    Stretch,
)
from bifurc.diagrams.events import EventRequests, events_along, events_of
from bifurc.diagrams.stability import (
    FormStability,
    HopfPlace,
    Spectrum,
    has_square_rest,
    stability_along,
    unknown_stability,
)
from bifurc.diagrams.turnings import (
    Turnings,
    branching_kind,
    turnings_of,
    unknown_sizes,
)
from bifurc.problem import Problem
from bifurc.singular.point import Kind
from bifurc.torus import wrap, wrapped_periods


def diagram_of(
    problem: Problem,
    atlas: Atlas,
    parameter: UnknownName | None = None,
    events: EventRequests | None = None,
    *,
    is_flow: bool = True,
) -> Diagram:
    """What happens along the forms of an atlas of a problem as a parameter changes.

    ``parameter`` is an unknown by its name, or by its symbol of sympy. Where there are as many equations as other
    unknowns, they are taken as the right-hand sides of u' = F(u), the first for the
    first of the others, and so on; with ``is_flow`` False they are not, and there is no
    stability. ``events`` are functions of the unknowns (n,) by
    their names, of which the zeros are looked for; with (function, value) the places
    where it takes the value, or each of several. The name of an unknown, its symbol, or an
    expression of sympy may stand for a function. Raises `ProblemError` for a parameter
    that is no unknown, and for events of another kind.

    >>> import bifurc
    >>> cusp = bifurc.FunctionProblem(lambda u: [u[0] ** 3 - u[0] - u[1]], [(-2, 2), (-3, 3)])
    >>> atlas = bifurc.explore(cusp)
    >>> diagram = bifurc.diagram_of(cusp, atlas, "u2", {"one": ("u1", 1.0)})
    >>> [round(float(fold.u[1]), 9) for fold in diagram.folds]
    [0.384900179, -0.384900179]
    >>> [event.u[0].round(12).item() for event in diagram.events("one")]
    [1.0]
    """
    check_type("problem", problem, Problem)
    check_type("atlas", atlas, Atlas)
    check_type("is_flow", is_flow, bool)
    names = problem.domain.names
    functions = events_of({} if events is None else events, names)
    found, remarks = events_along(problem, atlas, functions)
    if parameter is None:
        return Diagram("", named_points(problem, found), (), (), tuple(remarks))
    index = index_of_unknown("parameter", parameter, names)
    turnings = turnings_of(problem, atlas, index)
    has_stability = is_flow and bool(atlas.forms) and has_square_rest(problem)
    along = _stability(problem, atlas, index, turnings.folds, has_stability)
    hopf_points = [
        _hopf_point(atlas, index, form, place, turnings)
        for form, one in enumerate(along)
        for place in one.hopf_places
    ]
    stretches = tuple(stretch for one in along for stretch in one.stretches)
    points = named_points(problem, [*turnings.folds, *hopf_points, *found])
    return Diagram(
        parameter=names[index],
        points=points,
        stretches=stretches,
        branchings=_branchings(atlas, index, turnings, stretches),
        remarks=(*remarks, *_double_hopf_points(atlas, points)),
    )


def _branchings(
    atlas: Atlas, index: int, turnings: Turnings, stretches: Sequence[Stretch]
) -> tuple[Branching, ...]:
    """What the singular points at which forms cross are along the parameter."""
    branchings = []
    for number, point in enumerate(atlas.points):
        turning = turnings.at_crossings.get(number, [])
        resting = turnings.resting
        kind = branching_kind(atlas, index, point, turning, resting, stretches)
        if kind is not None:
            branchings.append(Branching(number, kind))
    return tuple(branchings)


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
            spectrum = Spectrum(problem, form.branch, index, unknown_sizes(problem))
            one = stability_along(spectrum, number, cuts)
        else:
            one = unknown_stability(form.branch, number, cuts)
        along.append(one)
    return along


def _hopf_point(
    atlas: Atlas,
    index: int,
    form: int,
    place: HopfPlace,
    turnings: Turnings,
) -> DiagramPoint:
    branch = atlas.forms[form].branch
    s = place.s % branch.length if branch.closed else place.s
    grows = branch(s, 1)[index] >= 0.0
    after = "unstable" if place.is_unstable_after == grows else "stable"
    label = f"becomes {after} as {atlas.names[index]} grows"
    if any(_is_at(fold, form, s, branch) for fold in turnings.folds):
        label = f"where {atlas.names[index]} turns back"
    return DiagramPoint(
        name="",
        kind=Kind.HOPF,
        form=form,
        s=s,
        u=branch(s),
        value=place.frequency,
        label=label,
        error=place.error,
    )


def _is_at(point: DiagramPoint, form: int, s: float, branch: Branch) -> bool:
    """Whether a point is at arclength ``s`` of form number ``form``, to 1e-6 of it."""
    apart = abs(point.s - s)
    if branch.closed:
        apart = min(apart, branch.length - apart)
    return point.form == form and is_same_point(apart, branch.length)


def _double_hopf_points(atlas: Atlas, points: Sequence[DiagramPoint]) -> Iterator[str]:
    """What is to be said of Hopf points, in the order of their names, at one place."""
    of_kind = [point for point in points if point.kind is Kind.HOPF]
    for one, other in pairwise(of_kind):
        if _is_at(one, other.form, other.s, atlas.forms[other.form].branch):
            places = f"{one.name} and {other.name}"
            yield f"two pairs cross at one place, to 1e-6 of the form: {places}"


def named_points(
    problem: Problem, points: Sequence[DiagramPoint]
) -> tuple[DiagramPoint, ...]:
    """The points with wrapped unknowns, numbered kind by kind, in the order of forms
    and arclengths."""
    periods = wrapped_periods(problem.domain.periods, problem.domain.bounds)
    named = []
    for kind in Kind:
        of_kind = [point for point in points if point.kind is kind]
        of_events = kind in (Kind.EVENT, Kind.TOUCH)
        of_kind.sort(
            key=lambda point: (point.label if of_events else "", point.form, point.s)
        )
        for number, point in enumerate(of_kind, start=1):
            name, u = f"{kind.initial}{number}", wrap(point.u, periods)
            named.append(replace(point, name=name, u=u))
    return tuple(named)
