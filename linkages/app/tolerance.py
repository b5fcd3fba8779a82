"""What manufacturing errors make of a transition map: `bifurc tolerance NAME --error
1e-4`.

A linkage of this kind moves only because its redundant closure equations agree; made
with errors it does not close any more. Its joints have play, or its links bend, and it
follows the valley in which the equations are nearly solved. The study follows that
valley and says how far from closing it is along every form, and what becomes of every
bifurcation: a crossing turns into a near miss whose width grows with the square root of
the error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.curves.valley import (
    Unfolding,
    ValleyEnd,
    correct_to_valley,
    unfold_crossing,
)
from linkages.app.summary import table
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop
from linkages.tolerance import make_with_errors

__all__ = [
    "Ladder",
    "Tolerance",
    "climb",
    "describe",
    "half_branches",
    "measure",
    "slope",
]

ERRORS = 10.0 ** -np.arange(2.0, 11.0)
AWAY = 0.3  # rad from a bifurcation along every half-branch, where its unfolding begins
SAMPLES = 200  # points of a form whose closure gap is measured


@dataclass(frozen=True)
class Tolerance:
    """One copy of a linkage made with errors: the largest and the median closure gap of
    every form, (forms,) each, and the `Unfolding` of every bifurcation."""

    error: float
    largest: np.ndarray
    median: np.ndarray
    unfoldings: tuple[Unfolding, ...]


@dataclass(frozen=True)
class Ladder:
    """The same copies at a ladder of errors (e,): the largest closure gap (e, copies,
    forms), and for every bifurcation the width of its near miss and the smallest
    singular value (e, copies, bifurcations), nan where the valley ends."""

    errors: np.ndarray
    gaps: np.ndarray
    widths: np.ndarray
    weakest: np.ndarray


def half_branches(
    atlas: Atlas, point: MeetingPoint, away: float = AWAY
) -> tuple[np.ndarray, list[str]]:
    """Points (h, n) on every half-branch of a bifurcation, ``away`` along the form from
    it, and their names."""
    starts, names = [], []
    for index, s in point.passes:
        form = atlas.forms[index]
        for sign, side in ((-1, "before"), (1, "after")):
            offset = form.branch(s + sign * away) - form.branch(s)
            starts.append(point.point.u + offset)
            names.append(f"{form.name} {side}")
    return np.array(starts), names


def measure(atlas: Atlas, loop: Loop, error: float, seed: int) -> Tolerance:
    """The copy number ``seed`` of a linkage, made with ``error``, against its nominal
    atlas."""
    problem = LoopClosure(make_with_errors(loop, error, np.random.default_rng(seed)))
    gaps = [
        correct_to_valley(problem, form.branch.sample(SAMPLES))[1]
        for form in atlas.forms
    ]
    unfoldings = [
        unfold_crossing(problem, point.point.u, half_branches(atlas, point)[0])
        for point in atlas.bifurcations
    ]
    return Tolerance(
        error,
        np.array([g.max() for g in gaps]),
        np.array([np.median(g) for g in gaps]),
        tuple(unfoldings),
    )


def climb(
    atlas: Atlas, loop: Loop, seeds: Sequence[int], errors: np.ndarray = ERRORS
) -> Ladder:
    """The copies ``seeds`` at every one of ``errors``."""
    rows = [
        [measure(atlas, loop, float(error), seed) for seed in seeds] for error in errors
    ]
    return Ladder(
        np.asarray(errors),
        np.array([[made.largest for made in row] for row in rows]),
        np.array(
            [[[_width(u) for u in made.unfoldings] for made in row] for row in rows]
        ),
        np.array(
            [
                [
                    [u.weakest if _whole(u) else np.nan for u in made.unfoldings]
                    for made in row
                ]
                for row in rows
            ]
        ),
    )


def _whole(unfolding: Unfolding) -> bool:
    return all(valley.end is ValleyEnd.DONE for valley in unfolding.valleys)


def _width(unfolding: Unfolding) -> float:
    return unfolding.distance if _whole(unfolding) else np.nan


def slope(errors: np.ndarray, values: np.ndarray) -> float:
    """Exponent of the power law through the medians of ``values`` (e, copies), at
    errors where no copy is missing."""
    medians = np.median(values, axis=1)  # nan where a copy is
    use = np.isfinite(medians) & (medians > 0)
    if np.count_nonzero(use) < 2:
        return np.nan
    return float(np.polyfit(np.log(errors[use]), np.log(medians[use]), 1)[0])


# --- what is shown ------------------------------------------------------------------------------------


def describe(atlas: Atlas, copies: Sequence[Tolerance], ladder: Ladder) -> str:
    """The tables of the command."""
    forms = [
        (
            form.name,
            f"{max(c.largest[i] for c in copies):.2e}",
            f"{np.median([c.median[i] for c in copies]):.2e}",
            f"{slope(ladder.errors, ladder.gaps[:, :, i]):.2f}",
        )
        for i, form in enumerate(atlas.forms)
    ]
    parts = [
        f"Errors of {copies[0].error:g} (standard deviation; rad, and characteristic lengths) in {len(copies)} copies",
        "Closure gap along the forms\n"
        + table(("form", "largest", "median", "grows as error to the"), sorted(forms)),
    ]
    if atlas.bifurcations:
        heads = (
            "name",
            "copy",
            "joined now",
            "near miss (rad)",
            "smallest s.v.",
            "closure gap",
        )
        rows = [
            row for k, copy in enumerate(copies) for row in _unfolded(atlas, copy, k)
        ]
        parts.append("What became of the bifurcations\n" + table(heads, sorted(rows)))
        powers = [
            (
                point.name,
                f"{slope(ladder.errors, ladder.widths[:, :, i]):.3f}",
                f"{slope(ladder.errors, ladder.weakest[:, :, i]):.3f}",
                f"{int(np.isnan(ladder.widths[:, :, i]).sum())} of {ladder.widths[:, :, i].size}",
            )
            for i, point in enumerate(atlas.bifurcations)
        ]
        title = f"Power of the error, from {ladder.errors.min():.0e} to {ladder.errors.max():.0e}\n"
        parts.append(
            title
            + table(("name", "near miss", "smallest s.v.", "valley ends early"), powers)
        )
    return "\n\n".join(parts)


def _unfolded(atlas: Atlas, copy: Tolerance, number: int) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for point, unfolding in zip(atlas.bifurcations, copy.unfoldings, strict=True):
        names = half_branches(atlas, point)[1]
        joined = "; ".join(
            f"{names[i]} - {names[j]}"
            if valley.end is ValleyEnd.DONE
            else f"{names[i]} ends"
            for (i, j), valley in zip(unfolding.pairs, unfolding.valleys, strict=True)
        )
        width = f"{unfolding.distance:.3g}" if _whole(unfolding) else "-"
        rows.append(
            (
                point.name,
                str(number),
                joined,
                width,
                f"{unfolding.weakest:.2e}",
                f"{unfolding.gap:.1e}",
            )
        )
    return rows
