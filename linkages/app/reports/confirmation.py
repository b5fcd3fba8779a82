"""The singular points of a map found again at high precision: how many of its digits
are right."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import mpmath

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.singular.confirm import (
    Confirmation,
    Convergence,
    confirm_singular_point,
)
from bifurc.system import PreciseResidual
from bifurc.tables import section_of
from linkages.app.choice import choose_precisely
from linkages.closure.precise import precise_residual
from linkages.linkage import is_linkage_file
from linkages.subject import subject_at

# where rounded numbers leave a gap: the word for how a point was refined
ROUNDED = "rounded"


def confirm_points(
    atlas: Atlas, linkage: str, parameters: Sequence[str] = (), digits: int = 50
) -> Iterator[tuple[MeetingPoint, Confirmation]]:
    """Every singular point of the map of a linkage with its `Confirmation`, the
    geometry at the same precision; that of a mechanism is taken from its doubles."""
    residual: PreciseResidual | None
    if subject_at(atlas).is_exact:
        with mpmath.workdps(3 * digits + 30):
            residual = precise_residual(choose_precisely(linkage, parameters))
    else:
        # the equations in which the points were located: others, as they are rounded,
        # have their singular points elsewhere
        atlas = subject_at(atlas).in_loop_angles(atlas)
        residual = subject_at(atlas).closure.precise_residual()
    assert residual is not None
    for meeting in atlas.points:
        point = meeting.point
        confirmation = confirm_singular_point(
            residual, point.u, point.null_space, digits
        )
        yield meeting, confirmation


def describe_confirmation(
    atlas: Atlas, linkage: str, parameters: Sequence[str] = (), digits: int = 50
) -> str:
    """What ``bifurc map --digits`` shows: a row for every singular point, and what the
    words for convergence mean."""
    rows = []
    endings = {}
    gap = 0.0
    is_rounded = not subject_at(atlas).is_exact or is_linkage_file(linkage)
    for point, confirmation in confirm_points(atlas, linkage, parameters, digits):
        word = confirmation.convergence.name.lower().replace("_", " ")
        if is_rounded and confirmation.convergence is Convergence.INCONSISTENT:
            word = ROUNDED
        rows.append({**_row(point, confirmation), "convergence": word})
        endings[confirmation.convergence] = f"  {confirmation.convergence.value}"
        if confirmation.convergence is Convergence.INCONSISTENT:
            gap = max(gap, confirmation.residual)
    if is_rounded and Convergence.INCONSISTENT in endings:
        endings[Convergence.INCONSISTENT] = _of_rounded_numbers(gap)
    title = f"Confirmation at {digits} digits"
    if not rows:
        return f"{title}: there is no singular point to confirm."
    explanations = "\n".join(endings.values())
    return f"{section_of(title, rows)}\n\nConvergence\n{explanations}"


def _of_rounded_numbers(gap: float) -> str:
    """The words for points at which rounded numbers leave a ``gap`` |F|."""
    return (
        f"  {ROUNDED}: the numbers of the linkage are rounded, and exactly as they are "
        f"written it does not close there, by up to {gap:.1e} (|F|); these are the "
        "points that come nearest"
    )


def _row(meeting: MeetingPoint, confirmation: Confirmation) -> dict[str, str]:
    stated = meeting.point.error
    within = confirmation.distance <= stated + confirmation.error
    return {
        "name": meeting.name,
        "kind": meeting.kind.value,
        "digits right": f"{confirmation.agreeing_digits:.1f}",
        "distance (rad)": f"{confirmation.distance:.1e}",
        "error stated": f"{stated:.1e} {'holds' if within else 'exceeded'}",
        "null space (rad)": f"{confirmation.angle:.1e}",
        "nullity": str(confirmation.nullity),
        "next s.v.": _smallest_regular(confirmation),
        "|F|": f"{confirmation.residual:.0e}",
        "error here": f"{confirmation.error:.0e}",
    }


def _smallest_regular(confirmation: Confirmation) -> str:
    """The smallest singular value that is not zero to the precision reached."""
    rank = len(confirmation.singular_values) - confirmation.nullity
    positive = [value for value in confirmation.singular_values if value > 0]
    regular = positive[:rank]
    return f"{regular[-1]:.3g}" if regular else "-"
