"""The whole search: seeds -> branches -> singular points -> atlas."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Provenance
from bifurc.checks import (
    UnknownName,
    check_callable,
    check_type,
    index_of_unknown,
)
from bifurc.diagrams.diagram import Diagram
from bifurc.diagrams.events import EventRequests, events_of
from bifurc.diagrams.make_diagram import diagram_of, named_points
from bifurc.errors import ProblemError
from bifurc.function_problem import EquationProblem, FunctionProblem
from bifurc.limits import (
    CutOff,
    Deadline,
    HeldInterrupt,
    current_deadline,
    cut_off_after,
    deadline_within,
    made_in_time,
    one_thread,
    until,
)
from bifurc.problem import Problem
from bifurc.search.answer.assemble import assemble_atlas
from bifurc.search.answer.settled_in_boxes import settled_in_boxes
from bifurc.search.factor_by_factor import explored_by_factors
from bifurc.search.isolated_boxes import IsolatedInBoxes, isolated_in_boxes
from bifurc.search.many_unknowns import explore_many_unknowns, has_many_unknowns
from bifurc.search.one_form import explore_one_form, has_one_form
from bifurc.search.own_units.restated import restated
from bifurc.search.own_units.unit_problem import (
    UnitProblem,
    has_no_own_answers,
    in_one_size,
    in_own_units,
    is_of_equations,
)
from bifurc.search.search import Search
from bifurc.seeds import Seeds
from bifurc.settings import LOOSEST, SearchSettings

DEFAULT_SEARCH = SearchSettings()

log = logging.getLogger(__name__)

PIECES_IN_NOISE = 100.0  # times the noise: how well pieces of curves meet them
LARGEST_SEED = 2**63 - 1  # what a dataset can hold


def explore(
    problem: Problem,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    seed: int = 0,
    seeds: Seeds | None = None,
    progress: Callable[[str, int], None] | None = None,
    parameter: UnknownName | None = None,
    events: EventRequests | None = None,
    is_flow: bool = True,
) -> Atlas:
    """All solution curves of a problem, all singular points on them, nothing twice.

    Seeds come from `Problem.seeds` (complete slices where the problem has them, and
    random starts drawn with ``seed``) unless given. Every branch is traced whole and
    monitored; from every singular point the directions in which other branches leave
    become further starts. ``progress`` is called with what was found and in which
    step, and how many.
    Ctrl-C ends the search early, once it has begun: the atlas holds what was found, and
    its provenance says so. When the budget of time is used up, or that of what it is a
    part of, the completeness and the provenance say so. With a ``parameter``, an unknown
    by its name or symbol, or ``events``, functions of the unknowns, the atlas holds a
    diagram; see `diagram_of`, also for ``is_flow``. Raises
    `ProblemError` for settings or a seed that cannot be used.

    >>> import bifurc
    >>> problem = bifurc.FunctionProblem(
    ...     lambda u, p: [p * u[0] - u[0] ** 3], {"x": (-2, 2)}, parameters={"p": (-1, 3)}
    ... )
    >>> atlas = bifurc.explore(problem, parameter="p")
    >>> len(atlas.forms), len(atlas.bifurcations), atlas.diagram.branchings[0].kind.value
    (2, 1, 'supercritical pitchfork')
    """
    check_type("problem", problem, Problem)
    check_type("settings", settings, SearchSettings)
    if progress is not None:
        check_callable("progress", progress)
    _check_seeds(problem, seed, seeds)
    names = problem.domain.names
    if parameter is not None:
        parameter = names[index_of_unknown("parameter", parameter, names)]
    events_of({} if events is None else events, names)
    request = _Request(settings, int(seed), seeds, progress)
    interrupt = HeldInterrupt()
    # beside a rim of where equations are defined there are values that are no numbers
    quiet = np.errstate(all="ignore")
    with one_thread(problem.n), quiet, interrupt:
        with until(deadline_within(settings.budget, interrupt)):
            atlas = _with_diagram(problem, request, parameter, events, is_flow)
        if interrupt.was_pressed:
            provenance = replace(atlas.provenance, interrupted=True, out_of_time=False)
            atlas = replace(atlas, provenance=provenance)
            interrupt.settle()
    if atlas.provenance.interrupted:
        log.warning("interrupted: the atlas holds what was found so far")
    return atlas


def _check_seeds(problem: Problem, seed: int, seeds: Seeds | None) -> None:
    """Raise `ProblemError` for a seed or seeds that cannot be used."""
    if not isinstance(seed, int | np.integer) or not 0 <= seed <= LARGEST_SEED:
        raise ProblemError(
            "seed", repr(seed), f"a whole number from 0 to {LARGEST_SEED}"
        )
    if seeds is not None:
        check_type("seeds", seeds, Seeds)
        if seeds.points.ndim != 2 or seeds.points.shape[1] != problem.n:
            shape = f"(k, {problem.n})"
            raise ProblemError("shape of the seeds", seeds.points.shape, shape)


def _diagram_in_time(
    problem: Problem,
    atlas: Atlas,
    parameter: UnknownName | None,
    events: EventRequests | None,
    is_flow: bool,
) -> Diagram:
    """The diagram of an atlas; one that says so where there is no time for it."""
    diagram = made_in_time(
        lambda: diagram_of(problem, atlas, parameter, events, is_flow=is_flow)
    )
    if diagram is not None:
        return diagram
    remark = "the time ended before folds, events, stability and Hopf points were known"
    named = "" if parameter is None else str(parameter)
    return Diagram(named, (), (), (), (remark,))


class _Request(NamedTuple):
    """What `explore` is asked for."""

    settings: SearchSettings
    seed: int
    seeds: Seeds | None
    progress: Callable[[str, int], None] | None


def _with_diagram(
    problem: Problem,
    request: _Request,
    parameter: UnknownName | None,
    events: EventRequests | None,
    is_flow: bool,
) -> Atlas:
    """The atlas, with a diagram where there is a parameter, by its name, or an event."""
    if parameter is not None and request.seeds is None:
        index = problem.domain.names.index(str(parameter))
        if has_many_unknowns(problem, index):
            return _explored_along(problem, request, index, events, is_flow)
    atlas = _explored_in_any_units(problem, request)
    if parameter is None and not events:
        return atlas
    diagram = _diagram_in_time(problem, atlas, parameter, events, is_flow)
    return replace(atlas, diagram=diagram)


def _explored_along(
    problem: Problem,
    request: _Request,
    index: int,
    events: EventRequests | None,
    is_flow: bool,
) -> Atlas:
    """The atlas, with its diagram along unknown number ``index``, of a problem of many
    unknowns."""
    deadline = current_deadline()
    provenance = _provenance(problem, request, False, deadline)
    atlas = explore_many_unknowns(
        problem, index, provenance, deadline, is_flow=is_flow, progress=request.progress
    )
    if not events or atlas.diagram is None:
        return atlas
    along = _diagram_in_time(problem, atlas, None, events, is_flow)
    points = named_points(problem, [*atlas.diagram.points, *along.points])
    remarks = (*atlas.diagram.remarks, *along.remarks)
    diagram = replace(atlas.diagram, points=points, remarks=remarks)
    return replace(atlas, diagram=diagram)


def _explored_in_any_units(problem: Problem, request: _Request) -> Atlas:
    """The atlas, factor by factor or in units of the search's own where the problem lets
    it; of one that is given by a state, and has many unknowns and one freedom there, what
    leads on from that."""
    if request.seeds is None and has_one_form(problem):
        deadline = current_deadline()
        provenance = _provenance(problem, request, False, deadline)
        return explore_one_form(problem, provenance, deadline)
    if not is_of_equations(problem) or not has_no_own_answers(problem):
        return _explored_in_own_units(problem, request)
    if request.seeds is not None:
        return _explored_in_boxes(problem, request)
    return explored_by_factors(
        problem,
        lambda part: _explored_in_own_units(part, request),
        lambda: _explored_in_boxes(problem, request),
    )


def _explored_in_boxes(problem: FunctionProblem, request: _Request) -> Atlas:
    """The atlas, settled by boxes where these show the isolated solutions."""
    solutions = _solutions_of(problem, request)
    if solutions is None:
        return _explored_in_own_units(problem, request)
    # what units of its own let a search see is known where boxes show all
    search = _explored if solutions.is_complete else _explored_in_own_units
    return settled_in_boxes(search(problem, request), solutions, problem.domain)


def _solutions_of(
    problem: FunctionProblem, request: _Request
) -> IsolatedInBoxes | None:
    """All isolated solutions of as many equations as unknowns, as far as boxes show
    them; None of other equations, and where there are to be no boxes."""
    tape, domain = problem.recording.tape, problem.domain
    has_bounds = not np.any(domain.has_assumed_bounds)
    if tape is None or not problem.accuracy.is_exact or not has_bounds:
        return None
    if not request.settings.boxes:
        return None
    try:
        with cut_off_after(current_deadline()):
            return isolated_in_boxes(tape, domain, request.settings.boxes)
    except CutOff:
        return None


def _explored_in_own_units(problem: Problem, request: _Request) -> Atlas:
    """The atlas, found in units of the search's own where the problem lets it."""
    own = in_own_units(problem)
    if own is None:
        return _explored(problem, request)
    atlas = _explored_in_units(own, request)
    has_lengths = bool(atlas.surfaces or atlas.near_motions)
    if has_lengths and not own.own_units.is_uniform:
        # areas and lengths are those of the user only where all sizes are one: where
        # there is no time for these they are left out
        own = in_one_size(own)
        atlas = _explored_in_units(own, request)
    forms = [
        replace(
            form,
            multiplicity=form.multiplicity * own.multiplicity_along(form.branch),
            labels=own.labels_along(form.branch),
        )
        for form in atlas.forms
    ]
    return restated(replace(atlas, forms=tuple(forms)), problem, own.own_units)


def _explored_in_units(own: UnitProblem, request: _Request) -> Atlas:
    """The atlas of a problem in units of its own, in these units."""
    if request.seeds is not None:
        request = request._replace(seeds=own.seeds_inwards(request.seeds))
    return _explored(own, request, ends_at_surfaces=not own.own_units.is_uniform)


def _in_noise(problem: Problem, request: _Request) -> _Request:
    """The request with curves followed no closer than values of a problem are good; a
    polynomial next to them is as exact as any."""
    if isinstance(problem, EquationProblem) and problem.recording.tape is not None:
        return request
    tolerance = min(PIECES_IN_NOISE * problem.accuracy.noise, LOOSEST)
    tracing = request.settings.tracing
    if tolerance <= tracing.tolerance:
        return request
    coarser = replace(tracing, tolerance=tolerance)
    return request._replace(settings=replace(request.settings, tracing=coarser))


def _explored(
    problem: Problem, request: _Request, ends_at_surfaces: bool = False
) -> Atlas:
    """The atlas of a problem, in the units in which it stands."""
    request = _in_noise(problem, request)
    deadline = current_deadline()
    search = Search(problem, *request, deadline, ends_at_surfaces)
    try:
        search.take_steps()
        interrupted = deadline.is_interrupted
    except KeyboardInterrupt:  # the second one, or that of the function of a user
        interrupted = True
    provenance = _provenance(problem, request, interrupted, deadline)
    if search.findings.components.is_out_of_time and not interrupted:
        provenance = replace(provenance, out_of_time=True)
    return assemble_atlas(problem, search.findings, provenance, deadline)


def _provenance(
    problem: Problem, request: _Request, interrupted: bool, deadline: Deadline
) -> Provenance:
    """How the atlas of a problem comes about, as far as is known now."""
    return Provenance(
        seed=request.seed,
        settings=request.settings,
        interrupted=interrupted,
        out_of_time=deadline.passed and not interrupted,
        derivatives=problem.accuracy.derivatives,
        equations=problem.accuracy.equations,
        seconds=time.perf_counter() - deadline.began,
    )
