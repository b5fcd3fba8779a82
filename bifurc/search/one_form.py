"""The one form through the state by which equations of many unknowns are given, as an
atlas.

All matrices are sparse. The form is followed both ways; that the null space of F' has one
dimension is looked at all along it, and so is every equation. Others are not looked for.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Form, Provenance
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Claim, Completeness, Doubt, Level, Scope
from bifurc.curves.continuation import trace_branch
from bifurc.curves.monitor import Profile
from bifurc.decisions import is_only_null_vector, is_singular_on_form, is_solution
from bifurc.limits import CutOff, Deadline, cut_off_after, until
from bifurc.numerics.null_spaces import null_vector
from bifurc.problem import Problem
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt, ended_early
from bifurc.system import relative_gaps, relative_residuals

LEAST = 120  # unknowns: with fewer all is looked at
SHARES = (np.arange(8) + 0.5) / 8  # of a piece, at which it is looked at
FOLLOWING = 0.7  # of the time, for following the form; the rest to look at it


def has_one_form(problem: Problem) -> bool:
    """Whether a problem of many unknowns is given by a state in which it has one
    freedom, and F' is factored as a sparse matrix."""
    shortcuts = problem.shortcuts
    is_sparse = shortcuts.jacobian is not None and shortcuts.smallest_value is not None
    if problem.n < LEAST or not is_sparse:
        return False
    state = problem.given_state
    if state is None or not is_solution(float(relative_gaps(problem, state[None])[0])):
        return False
    tangent = null_vector(problem, state)
    # another border leads to the same vector where there is no other
    rng = np.random.default_rng(1)
    other = null_vector(problem, state, tangent + rng.normal(size=problem.n))
    return is_only_null_vector(1.0 - abs(float(tangent @ other)))


def explore_one_form(
    problem: Problem, provenance: Provenance, deadline: Deadline
) -> Atlas:
    """The atlas of a problem that `has_one_form`; its form is cut off where the time
    ends."""
    state = problem.given_state
    assert state is not None
    look = _Look()
    is_cut_off = False
    settings = provenance.settings.tracing
    try:
        with cut_off_after(deadline):
            with until(deadline.share(FOLLOWING)):
                branch = trace_branch(problem, state, settings=settings)
            look = _Look(_unmonitored(problem, branch))
            look = _monitored(problem, branch)
    except CutOff:
        is_cut_off = True
    provenance = provenance.at_end(deadline, is_cut_off)
    return _atlas(problem, look, provenance)


class _Look(NamedTuple):
    """A ``form``, if there is one, and the largest ``residual`` along it."""

    form: Form | None = None
    residual: float = 0.0


def _atlas(problem: Problem, look: _Look, provenance: Provenance) -> Atlas:
    form = look.form
    doubts = [SearchDoubt.OTHER_FORMS.doubt()]
    if form is not None:
        doubts += _doubts(problem, form)
    claims = (*ended_early(provenance, left=0), _claim(problem, look))
    domain = problem.domain
    return Atlas(
        names=domain.names,
        units=domain.units,
        periods=domain.periods,
        forms=() if form is None else (form,),
        points=(),
        near_misses=(),
        dead_points=(),
        rigid=np.empty((0, problem.n)),
        surfaces=(),
        completeness=Completeness(claims, tuple(doubts), 1.0),
        provenance=provenance,
    )


def _claim(problem: Problem, look: _Look) -> Claim:
    return SearchClaim.ONE_FORM.claim(
        Scope.STARTS,
        Level.ESTIMATED,
        unknowns=problem.n,
        count=0 if look.form is None else look.form.profile.arclength.size,
        residual=look.residual,
    )


def _unmonitored(problem: Problem, branch: Branch) -> Form:
    """A form of which no singular value is known."""
    shape = (len(branch.pieces), 0)
    profile = Profile(np.empty(shape), np.empty((*shape, problem.n)), problem.n - 1)
    return Form("Form 1", branch, profile, np.nan)


def _monitored(problem: Problem, branch: Branch) -> _Look:
    """The form with the smallest regular singular value of F' along it, about, and the
    largest residual along it. What no correction removes is at most that of the worst
    equation where this is least."""
    smallest_value = problem.shortcuts.smallest_value
    assert smallest_value is not None
    places = branch.places(SHARES)
    values = np.full((*places.shape, problem.n), np.nan)
    values[..., -1] = 0.0
    largest, misclosure = 0.0, np.inf
    for index in np.ndindex(places.shape):
        point, slope = branch(places[index]), branch(places[index], 1)
        values[index][-2] = smallest_value(point, slope / np.linalg.norm(slope))
        residual = relative_residuals(problem, point[None])[0]
        largest = max(largest, float(np.linalg.norm(residual)))
        misclosure = min(misclosure, float(np.abs(residual).max()))
    profile = Profile(places, values, problem.n - 1)
    smallest = float(np.min(values[..., -2], initial=np.inf))
    if not places.size:
        misclosure = 0.0
    form = Form("Form 1", branch, profile, smallest, misclosure=misclosure)
    return _Look(form, largest)


def _doubts(problem: Problem, form: Form) -> list[Doubt]:
    """What is open of a form: where it did not end, and singular places on it."""
    doubts = []
    branch = form.branch
    if branch.outcome in (Outcome.STEP_LIMIT, Outcome.TIME_LIMIT):
        doubts.append(SearchDoubt.TOO_LONG.doubt(form.name))
    if branch.outcome is Outcome.STALLED:
        ends = branch(np.array([0.0, branch.length]))
        stalled = int(np.count_nonzero(~problem.domain.are_at_bounds(ends)))
        doubts.append(SearchDoubt.STALLED.doubt(form.name, ends=stalled))
    places = _singular_places(form)
    if places:
        doubts.append(SearchDoubt.SINGULAR_ON_FORM.doubt(form.name, count=places))
    return doubts


def _singular_places(form: Form) -> int:
    """How many minima of the smallest singular value along a form are far below its
    usual size."""
    smallest = form.profile.values[..., -2].ravel()
    if len(smallest) < 3:
        return 0
    usual = float(np.median(smallest))
    beside = np.concatenate([[np.inf], smallest, [np.inf]])
    is_minimum = (smallest <= beside[:-2]) & (smallest <= beside[2:])
    return sum(is_singular_on_form(float(one), usual) for one in smallest[is_minimum])
