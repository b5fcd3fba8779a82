"""What `bifurc tolerance` shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Atlas
from bifurc.curves.valley import Unfolding
from bifurc.text_tables import count_of, section
from linkages.app.answer.configurations import unit_of_arclengths
from linkages.app.reports.tolerance import (
    Ladder,
    Tolerance,
    half_branches,
    is_joined,
    is_whole,
    slope,
)
from linkages.app.subject import subject_at


def describe_tolerance(
    atlas: Atlas, copies: Sequence[Tolerance], ladder: Ladder
) -> str:
    """Closure gaps of the forms, what became of the bifurcations, and the powers of the
    error with which they grow."""
    head = (
        f"Errors{subject_at(atlas).places} of {copies[0].error:g} (standard deviation; rad, and "
        f"characteristic lengths) in {count_of(len(copies), 'copy')}"
    )
    parts = [head, _gaps(atlas, copies, ladder)]
    if atlas.bifurcations:
        parts += [_unfoldings(atlas, copies), _powers(atlas, ladder)]
    return "\n\n".join(parts)


def _gaps(atlas: Atlas, copies: Sequence[Tolerance], ladder: Ladder) -> str:
    rows = []
    for i, form in enumerate(atlas.forms):
        largest = max(copy.largest[i] for copy in copies)
        median = np.median([copy.median[i] for copy in copies])
        power = slope(ladder.errors, ladder.gaps[:, :, i])
        rows.append((form.name, f"{largest:.2e}", f"{median:.2e}", f"{power:.2f}"))
    heads = ("form", "largest", "median", "grows as error to the")
    return section("Closure gap along the forms", heads, sorted(rows))


def _unfoldings(atlas: Atlas, copies: Sequence[Tolerance]) -> str:
    rows = []
    for number, copy in enumerate(copies):
        points = zip(atlas.bifurcations, copy.unfoldings, strict=True)
        for point, unfolding in points:
            _, names = half_branches(atlas, point)
            width = f"{unfolding.distance:.3g}" if is_whole(unfolding) else "-"
            rows.append(
                (
                    point.name,
                    str(number),
                    _joined_half_branches(unfolding, names),
                    width,
                    f"{unfolding.weakest:.2e}",
                    f"{unfolding.gap:.1e}",
                )
            )
    heads = (
        "name",
        "copy",
        "joined now",
        f"near miss ({unit_of_arclengths(atlas)})",
        "smallest s.v.",
        "closure gap",
    )
    return section("What became of the bifurcations", heads, sorted(rows))


def _joined_half_branches(unfolding: Unfolding, names: Sequence[str]) -> str:
    """Which half-branches a valley joins now, and which of them end."""
    parts = []
    for (i, j), valley in zip(unfolding.pairs, unfolding.valleys, strict=True):
        if is_joined(valley):
            parts.append(f"{names[i]} - {names[j]}")
        else:
            parts.append(f"{names[i]} ends")
    return "; ".join(parts)


def _powers(atlas: Atlas, ladder: Ladder) -> str:
    rows = []
    for i, point in enumerate(atlas.bifurcations):
        widths = ladder.widths[:, :, i]
        missing = int(np.isnan(widths).sum())
        rows.append(
            (
                point.name,
                f"{slope(ladder.errors, widths):.3f}",
                f"{slope(ladder.errors, ladder.weakest[:, :, i]):.3f}",
                f"{missing} of {widths.size}",
            )
        )
    smallest, largest = ladder.errors.min(), ladder.errors.max()
    title = f"Power of the error, from {smallest:.0e} to {largest:.0e}"
    heads = ("name", "near miss", "smallest s.v.", "valley ends early")
    return section(title, heads, rows)
