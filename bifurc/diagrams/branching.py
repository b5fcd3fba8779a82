"""How branches cross at a singular point, seen along a parameter."""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import NamedTuple

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.diagrams.diagram import Stretch
from bifurc.singular.point import Kind

SAME_CUT = 1e-12  # of a length: a stretch ends at the very arclength of a pass


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
