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
from numpy.typing import NDArray

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.branch import Branch, Outcome
from bifurc.curves.valley import Unfolding, unfold_crossing
from bifurc.numerics.null_spaces import correct_to_valley
from bifurc.tables import count_of, section, section_of
from linkages.app.texts.configurations import unit_of_arclengths
from linkages.subject import subject_at

Floats = NDArray[np.float64]

ERRORS = 10.0 ** -np.arange(2.0, 11.0)
AWAY = 0.3  # arclength from a bifurcation along half-branches, where unfolding begins
SHORTEST = 0.01  # of that: a form that ends sooner has no half-branch there
SAMPLES = 200  # points of a form whose closure gap is measured


@dataclass(frozen=True)
class Tolerance:
    """One copy of a linkage made with errors: the largest and the median closure gap of
    every form, (forms,) each, and the `Unfolding` of every bifurcation."""

    error: float
    largest: Floats
    median: Floats
    unfoldings: tuple[Unfolding, ...]


@dataclass(frozen=True)
class Ladder:
    """The same copies at a ladder of errors (e,): the largest closure gap (e, copies,
    forms), and for every bifurcation the width of its near miss and the smallest
    singular value (e, copies, bifurcations), nan where the valley ends."""

    errors: Floats
    gaps: Floats
    widths: Floats
    weakest: Floats


def half_branches(
    atlas: Atlas, point: MeetingPoint, away: float = AWAY
) -> tuple[Floats, list[str]]:
    """Points (h, n) on every half-branch of a bifurcation, ``away`` along the form from
    it or where the form ends before, and their names."""
    starts = []
    names = []
    for index, s in point.passes:
        form = atlas.forms[index]
        for sign, side in ((-1, "before"), (1, "after")):
            distance = min(away, room_beside(form.branch, s, sign))
            if distance < SHORTEST * away:
                continue
            offset = form.branch(s + sign * distance) - form.branch(s)
            starts.append(point.point.u + offset)
            names.append(f"{form.name} {side}")
    return np.array(starts), names


def room_beside(branch: Branch, s: float, sign: int) -> float:
    """How far a branch goes on from arclength ``s``, forwards or, with the ``sign`` -1,
    backwards."""
    if branch.closed:
        return np.inf
    return branch.length - s if sign > 0 else s


def measure(atlas: Atlas, error: float, seed: int) -> Tolerance:
    """The copy number ``seed`` of the linkage of an atlas, made with ``error``, against
    this atlas."""
    rng = np.random.default_rng(seed)
    problem = subject_at(atlas).closure_with_errors(error, rng)
    largest = []
    median = []
    for form in atlas.forms:
        _, gaps = correct_to_valley(problem, form.branch.sample(SAMPLES))
        largest.append(gaps.max())
        median.append(np.median(gaps))
    unfoldings = []
    for point in atlas.bifurcations:
        starts, _ = half_branches(atlas, point)
        unfoldings.append(unfold_crossing(problem, point.point.u, starts))
    return Tolerance(error, np.array(largest), np.array(median), tuple(unfoldings))


def climb(atlas: Atlas, seeds: Sequence[int], errors: Floats = ERRORS) -> Ladder:
    """The copies ``seeds`` at every one of ``errors``."""
    gaps = []
    widths = []
    weakest = []
    for error in errors:
        copies = [measure(atlas, float(error), seed) for seed in seeds]
        gaps.append(np.array([copy.largest for copy in copies]))
        widths.append(np.array([_of_whole(copy, "distance") for copy in copies]))
        weakest.append(np.array([_of_whole(copy, "weakest") for copy in copies]))
    return Ladder(
        np.asarray(errors), np.array(gaps), np.array(widths), np.array(weakest)
    )


def is_whole(unfolding: Unfolding) -> bool:
    """Whether every valley of an unfolding was followed to its end."""
    return all(is_joined(valley) for valley in unfolding.valleys)


def is_joined(valley: Branch) -> bool:
    """Whether a valley leads from one half-branch to another."""
    return valley.outcome is Outcome.LEFT_REGION


def _of_whole(copy: Tolerance, value: str) -> list[float]:
    """A value of what every bifurcation has become."""
    return [getattr(u, value) if is_whole(u) else np.nan for u in copy.unfoldings]


def slope(errors: Floats, values: Floats) -> float:
    """Exponent of the power law through the medians of ``values`` (e, copies), at
    errors where no copy is missing; nan where fewer than two are left."""
    medians = np.median(values, axis=1)  # nan where a copy is
    usable = np.isfinite(medians) & (medians > 0)
    if np.count_nonzero(usable) < 2:
        return np.nan
    exponent, _ = np.polyfit(np.log(errors[usable]), np.log(medians[usable]), 1)
    return float(exponent)


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
                {
                    "name": point.name,
                    "copy": str(number),
                    "joined now": _joined_half_branches(unfolding, names),
                    f"near miss ({unit_of_arclengths(atlas)})": width,
                    "smallest s.v.": f"{unfolding.weakest:.2e}",
                    "closure gap": f"{unfolding.gap:.1e}",
                }
            )
    rows.sort(key=lambda row: tuple(row.values()))
    return section_of("What became of the bifurcations", rows)


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
            {
                "name": point.name,
                "near miss": f"{slope(ladder.errors, widths):.3f}",
                "smallest s.v.": f"{slope(ladder.errors, ladder.weakest[:, :, i]):.3f}",
                "valley ends early": f"{missing} of {widths.size}",
            }
        )
    smallest, largest = ladder.errors.min(), ladder.errors.max()
    title = f"Power of the error, from {smallest:.0e} to {largest:.0e}"
    return section_of(title, rows)
