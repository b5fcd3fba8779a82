"""Certificates: of a branch that was traced, before it is recorded, and of all forms of an
atlas."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch, Outcome
from bifurc.checks import check_type
from bifurc.curves.certificate import (
    HANDOVER,
    Certificate,
    CertificateStatus,
    certify_branch,
)
from bifurc.curves.jumps import changes_of_course, kinks, repeats_itself
from bifurc.curves.monitor import Profile
from bifurc.errors import ProblemError
from bifurc.numerics.blur import known_to
from bifurc.problem import Problem
from bifurc.search.records import TracedBranch
from bifurc.settings import TraceSettings

CUSP_REACH = 0.2  # of a cusp, in scales: so far from it a branch may end
FINEST = 1e-14  # tolerance with which a refused branch is traced again
LONGEST = 0.1  # trusted radius, in scales
# Beside a crossing near something larger rounding bends a curve over from farther away:
# shorter radii than this, in scales, are not trusted, and a bridge is laid across.
SHORTEST = 1e-3
# Distance, over the scale, to which a point is known: from there on finer steps follow
# rounding.
BLURRED = 1e-10


def certificate_of(
    problem: Problem, branch: Branch, profile: Profile, singular: Sequence[float]
) -> Certificate | None:
    """What is certified of a branch with singular points at some arclengths.

    Where it must have jumped is a gap of the certificate. For a problem without the
    bounds that a certificate takes there is one only if it says that.
    """
    certificate = certify_branch(problem, branch, profile, singular)
    if certificate.status is CertificateStatus.CERTIFIED:
        return certificate
    is_possible = problem.curvature is not None
    cuts = np.array(singular)
    if is_possible:
        open_intervals = np.concatenate([certificate.gaps, certificate.blurred])
        cuts = np.concatenate([cuts, open_intervals.mean(axis=1)])
    jumps = _jumps(problem, branch, profile, np.sort(cuts))
    if len(jumps):
        return certificate.with_gaps(jumps)
    return certificate if is_possible else None


def _jumps(
    problem: Problem, branch: Branch, profile: Profile, cuts: np.ndarray
) -> np.ndarray:
    """Intervals (k, 2) of arclength about the ``cuts`` (c,) in one of which at least
    the branch must have jumped; all of it where there are none."""
    if repeats_itself(problem, branch):
        if not len(cuts):
            return np.array([[0.0, branch.length]])
        jumps = cuts
    else:
        changes = changes_of_course(branch, profile, cuts)
        from_ends = 0.0
        if branch.outcome is Outcome.STALLED:
            # a curve that stalls at a cusp ends in what rounding leaves
            from_ends = CUSP_REACH * problem.domain.scale
            to_end = np.minimum(changes, branch.length - changes)
            changes = changes[to_end > from_ends]
        jumps = np.union1d(changes, kinks(branch, from_ends))
    handover = HANDOVER * problem.domain.scale
    return np.column_stack([jumps - handover, jumps + handover])


def may_be_mended(problem: Problem, traced: TracedBranch) -> bool:
    """Whether a branch that is refused may be traced better: not where its points are
    known so poorly that doubles do not follow one arc, but for a kink at a located
    singular point, which one march has and another has not."""
    certificate = traced.certificate
    if certificate is None or problem.curvature is None:
        return False
    gaps = certificate.gaps
    if not len(gaps):
        return True
    passes = np.array(traced.passes)
    are_inside = (gaps[:, :1] <= passes) & (passes <= gaps[:, 1:])
    is_known = known_to(problem, traced.branch(gaps.mean(axis=1))) < BLURRED
    return bool(np.any(are_inside) or np.any(is_known))


def finer_settings(settings: TraceSettings) -> Iterator[TraceSettings]:
    """With what a branch is traced again that has no certificate, in turn."""
    longest = min(LONGEST, settings.longest)
    shortest = max(SHORTEST, settings.shortest)
    finest = settings.to_tolerance(FINEST)
    yield replace(finest, longest=longest)
    if shortest < longest:
        yield replace(finest, shortest=shortest)
        yield replace(finest, shortest=shortest, longest=longest)


def certify_atlas(problem: Problem, atlas: Atlas) -> Atlas:
    """The atlas with a certificate on every form, from singular point to singular
    point.

    >>> import bifurc, linkages
    >>> loop = linkages.load("bennett").loop
    >>> uncertified = bifurc.SearchSettings(certify=False)
    >>> atlas = linkages.map_linkage(loop, settings=uncertified)
    >>> certified = bifurc.certify_atlas(linkages.Closure(loop), atlas)
    >>> atlas.forms[0].certificate is None, certified.forms[0].certificate.holds
    (True, True)
    """
    check_type("problem", problem, Problem)
    check_type("atlas", atlas, Atlas)
    if atlas.names != problem.domain.names:
        raise ProblemError(
            "unknowns of the atlas", atlas.names, str(problem.domain.names)
        )
    forms = []
    for number, form in enumerate(atlas.forms):
        stops = [s for p in atlas.points for index, s in p.passes if index == number]
        certificate = certify_branch(problem, form.branch, form.profile, stops)
        forms.append(replace(form, certificate=certificate))
    return replace(atlas, forms=tuple(forms))
