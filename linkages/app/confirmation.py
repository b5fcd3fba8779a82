"""The singular points of a map found again at high precision: how many of its digits
are right."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import mpmath

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.singular.confirm import Confirmation, confirm_singular_point
from linkages.app.choice import choose_precisely
from linkages.app.summary import table
from linkages.closure.precise import precise_residual

__all__ = ["confirm_points", "describe_confirmation"]


def confirm_points(
    atlas: Atlas, linkage: str, parameters: Sequence[str] = (), digits: int = 50
) -> Iterator[tuple[MeetingPoint, Confirmation]]:
    """Every singular point of the map of a linkage with its `Confirmation`, the
    geometry at the same precision."""
    with mpmath.workdps(3 * digits + 30):
        residual = precise_residual(choose_precisely(linkage, parameters))
    for point in atlas.points:
        yield (
            point,
            confirm_singular_point(
                residual, point.point.u, point.point.null_space, digits
            ),
        )


def describe_confirmation(
    atlas: Atlas, linkage: str, parameters: Sequence[str] = (), digits: int = 50
) -> str:
    """What ``bifurc map --digits`` shows: a row for every singular point, and what the
    words for convergence mean."""
    rows, endings = [], {}
    for point, found in confirm_points(atlas, linkage, parameters, digits):
        within = (
            "holds" if found.distance <= point.point.error + found.error else "exceeded"
        )
        first = [x for x in found.singular_values if x > 0][
            : len(found.singular_values) - found.nullity
        ]
        rows.append(
            (
                point.name,
                point.kind.value,
                f"{found.agreeing_digits:.1f}",
                f"{found.distance:.1e}",
                f"{point.point.error:.1e} {within}",
                f"{found.angle:.1e}",
                str(found.nullity),
                f"{first[-1]:.3g}" if first else "-",
                f"{found.residual:.0e}",
                f"{found.error:.0e}",
                found.convergence.name.lower().replace("_", " "),
            )
        )
        endings[found.convergence] = found.convergence.value
    if not rows:
        return (
            f"Confirmation at {digits} digits: there is no singular point to confirm."
        )
    heads = (
        "name",
        "kind",
        "digits right",
        "distance (rad)",
        "error stated",
        "null space (rad)",
        "nullity",
        "next s.v.",
        "|F|",
        "error here",
        "convergence",
    )
    listed = "\n".join(f"  {sentence}" for sentence in endings.values())
    return f"Confirmation at {digits} digits\n{table(heads, rows)}\n\nConvergence\n{listed}"
