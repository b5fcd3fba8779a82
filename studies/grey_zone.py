"""Between moving and not: linkages off their conditions by errors from a thousandth down
to rounding.

Run as ``python -m studies.grey_zone --out FOLDER``; it takes about five minutes. One
length, twist or offset of each of twenty overconstrained linkages is changed by 1e-3 to
1e-16 (of the characteristic length, or rad) in half decades. With an error e the loop
misses closure along its former motion by a multiple of e, so that the answers have to
come in one order: the linkage nearly moves, moves within the closing tolerance, moves.
The study writes a table of the answers and a figure. With ``--seeds`` it asks besides
whether the near motions hang on the random seed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc import Atlas
from bifurc.atlas import NearMotion
from bifurc.decisions import closes_to_rounding, is_solution
from bifurc.tables import table
from linkages import Loop, map_linkage
from linkages.app.options import FOLDER
from linkages.catalogue import entry
from studies.study import Study, require_known

# Powers of ten of the errors, in half decades.
ERRORS = 10.0 ** -np.arange(3.0, 16.25, 0.5)
COLUMNS = ("lengths", "twists", "offsets")
SAME = 1e-5  # share by which lengths and misclosures of the same near motion differ
MOST_ASSEMBLIES = 16  # of a 6R loop that does not move


class Verdict(IntEnum):
    """What a map says of a linkage, in the order of a growing error."""

    MOVES = 0
    MOVES_WITHIN_TOLERANCE = 1
    NEARLY_MOVES = 2
    RIGID = 3


COLOURS = {
    Verdict.MOVES: "#009E73",
    Verdict.MOVES_WITHIN_TOLERANCE: "#56B4E9",
    Verdict.NEARLY_MOVES: "#E69F00",
    Verdict.RIGID: "#D55E00",
}


@dataclass(frozen=True)
class Change:
    """The entry of the table of a linkage that is changed: ``column`` "lengths",
    "twists" or "offsets", and the ``joint``, from 1."""

    linkage: str
    column: str
    joint: int


CHANGES = (
    Change("bennett", "twists", 1),
    Change("bennett-line-symmetric", "lengths", 1),
    Change("goldberg-5r", "twists", 2),
    Change("generalized-goldberg-5r", "offsets", 1),
    Change("myard-plane-symmetric-5r", "lengths", 3),
    Change("torus-5r-13-plus-plus", "twists", 1),
    Change("serial-goldberg-6r", "offsets", 4),
    Change("l-shape-goldberg-6r", "lengths", 2),
    Change("wohlhart-double-goldberg", "twists", 1),
    Change("special-wohlhart-double-goldberg", "lengths", 1),
    Change("special-double-subtractive-goldberg", "twists", 3),
    Change("mixed-double-goldberg-type-i", "offsets", 2),
    Change("waldron-hybrid", "lengths", 1),
    Change("yu-baker", "twists", 2),
    Change("mavroidis-roth-opposite", "offsets", 2),
    Change("dietmaier", "lengths", 1),
    Change("bricard-line-symmetric", "lengths", 1),
    Change("bricard-plane-symmetric", "twists", 1),
    Change("bricard-trihedral", "twists", 1),
    Change("altmann", "offsets", 2),
)


@dataclass(frozen=True)
class Answer:
    """What the map of a changed linkage says.

    ``misclosure`` along its forms, or along the near motion that misses least (nan
    without either), the numbers of ``forms``, of those that ``stalled``, of
    ``bifurcations`` and of isolated ``assemblies``.
    """

    change: Change
    error: float
    verdict: Verdict
    misclosure: float
    forms: int
    stalled: int
    bifurcations: int
    assemblies: int


def off_condition(change: Change, error: float) -> Loop:
    """The linkage with one entry of its table off by ``error``, over the characteristic
    length, or rad."""
    loop = entry(change.linkage).build()
    columns = dict(zip(COLUMNS, loop.arrays, strict=True))
    unit = 1.0 if change.column == "twists" else loop.characteristic_length
    columns[change.column][change.joint - 1] += error * unit
    lengths, twists, offsets = (tuple(columns[name].tolist()) for name in COLUMNS)
    return Loop(lengths, twists, offsets)


def answer(change: Change, error: float) -> Answer:
    """What the map of a changed linkage says."""
    atlas = map_linkage(off_condition(change, error))
    return Answer(
        change=change,
        error=error,
        verdict=_verdict(atlas),
        misclosure=_misclosure(atlas),
        forms=len(atlas.forms),
        stalled=sum(not form.branch.closed for form in atlas.forms),
        bifurcations=len(atlas.bifurcations),
        assemblies=len(atlas.rigid),
    )


def hangs_on_seed(change: Change, error: float, seeds: int) -> bool:
    """Whether maps of a changed linkage with different random seeds list different near
    motions: in number, closed or not, by length, by what they miss."""
    loop = off_condition(change, error)
    maps = [map_linkage(loop, seed=seed).near_motions for seed in range(seeds)]
    return not all(_are_alike(maps[0], near_motions) for near_motions in maps)


def _are_alike(one: Sequence[NearMotion], other: Sequence[NearMotion]) -> bool:
    """Whether two lists of near motions are the same."""
    if len(one) != len(other):
        return False
    for a, b in zip(one, other, strict=True):
        is_same = a.is_closed == b.is_closed and a.mobility == b.mobility
        lengths = np.isclose(a.length, b.length, rtol=SAME, atol=0.0)
        misclosures = np.isclose(a.misclosure, b.misclosure, rtol=SAME, atol=1e-15)
        if not (is_same and lengths and misclosures):
            return False
    return True


def _verdict(atlas: Atlas) -> Verdict:
    if atlas.forms or atlas.surfaces:
        largest = max((form.misclosure for form in atlas.forms), default=0.0)
        if closes_to_rounding(largest):
            return Verdict.MOVES
        return Verdict.MOVES_WITHIN_TOLERANCE
    return Verdict.NEARLY_MOVES if atlas.near_motions else Verdict.RIGID


def _misclosure(atlas: Atlas) -> float:
    if atlas.forms:
        return max(form.misclosure for form in atlas.forms)
    if atlas.near_motions:
        return atlas.near_motions[0].misclosure
    return float("nan")


# --- what must hold -------------------------------------------------------------------


def faults(answers: Sequence[Answer]) -> list[str]:
    """What is wrong with the answers on one linkage, from the largest error to the
    smallest: an order that is none, a form that stalled, too many assemblies."""
    found = []
    verdicts = [one.verdict for one in answers]
    if verdicts != sorted(verdicts, reverse=True):
        found.append("the verdicts are not in order")
    for one in answers:
        if one.stalled:
            found.append(f"{one.stalled} forms stalled at {one.error:.1e}")
        if one.assemblies > MOST_ASSEMBLIES:
            found.append(f"{one.assemblies} assemblies at {one.error:.1e}")
    return found


# --- table and figure -----------------------------------------------------------------


def describe(groups: Iterable[Sequence[Answer]]) -> str:
    """One row for each linkage: where its verdict changes, what it misses closure by,
    over the error, and what is wrong."""
    rows = []
    for answers in groups:
        change = answers[0].change
        ratios = [
            one.misclosure / one.error
            for one in answers
            if one.verdict in (Verdict.NEARLY_MOVES, Verdict.MOVES_WITHIN_TOLERANCE)
        ]
        rows.append(
            (
                change.linkage,
                f"{change.column} {change.joint}",
                _smallest_error(answers, Verdict.NEARLY_MOVES),
                _smallest_error(answers, Verdict.MOVES_WITHIN_TOLERANCE),
                f"{min(ratios):.3g} to {max(ratios):.3g}",
                str(max(one.assemblies for one in answers)),
                "; ".join(faults(answers)) or "-",
            )
        )
    heads = (
        "linkage",
        "changed",
        "nearly moves from",
        "within tolerance from",
        "misclosure / error",
        "assemblies, most",
        "faults",
    )
    return table(heads, rows)


def _smallest_error(answers: Sequence[Answer], verdict: Verdict) -> str:
    errors = [one.error for one in answers if one.verdict is verdict]
    return f"{min(errors):.1e}" if errors else "-"


def draw(groups: Sequence[Sequence[Answer]]) -> Figure:
    """The misclosure of every linkage over its error, and below its verdicts."""
    figure = Figure(figsize=(9.0, 10.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.0, 1.1])
    _draw_misclosures(above, groups)
    _draw_verdicts(below, groups)
    return figure


def _draw_misclosures(axes: Axes, groups: Sequence[Sequence[Answer]]) -> None:
    for answers in groups:
        errors = [one.error for one in answers]
        sizes = [one.misclosure for one in answers]
        axes.plot(errors, sizes, color="0.8", linewidth=0.8, zorder=1)
    for verdict, colour in COLOURS.items():
        own = [one for group in groups for one in group if one.verdict is verdict]
        words = verdict.name.lower().replace("_", " ")
        errors = [one.error for one in own]
        sizes = [one.misclosure for one in own]
        axes.plot(errors, sizes, "o", color=colour, markersize=3.5, label=words)
    axes.axhline(is_solution.threshold, color="0.3", linewidth=0.8)
    axes.text(2e-3, 1.2e-12, "closing tolerance", ha="right", fontsize=8)
    axes.set(xscale="log", yscale="log", ylabel="misclosure")
    axes.legend(frameon=False, loc="upper left")


def _draw_verdicts(axes: Axes, groups: Sequence[Sequence[Answer]]) -> None:
    for row, answers in enumerate(groups):
        errors = [one.error for one in answers]
        colours = [COLOURS[one.verdict] for one in answers]
        axes.scatter(errors, [row] * len(errors), c=colours, marker="s", s=42)
    names = [answers[0].change.linkage for answers in groups]
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.invert_yaxis()
    axes.set(xlabel="error (of the characteristic length, or rad)")


@click.command(cls=Study, help=__doc__)
@click.option(
    "--out",
    type=FOLDER,
    required=True,
    help="Folder for the table and the figure.",
)
@click.option(
    "--seeds", default=1, help="Random seeds with which near motions are compared."
)
@click.option("--only", multiple=True, help="Linkages to look at; all without it.")
def main(out: Path, seeds: int, only: Sequence[str]) -> None:
    """Run the study."""
    require_known("--only", only, [change.linkage for change in CHANGES])
    groups = []
    for change in CHANGES:
        if only and change.linkage not in only:
            continue
        answers = [answer(change, error) for error in ERRORS]
        groups.append(answers)
        hanging = [
            f"{error:.1e}"
            for error in ERRORS
            if seeds > 1 and hangs_on_seed(change, error, seeds)
        ]
        if hanging:
            click.echo(f"{change.linkage}: hangs on the seed at {', '.join(hanging)}")
        click.echo(f"{change.linkage}: {'; '.join(faults(answers)) or 'in order'}")
    out.mkdir(parents=True, exist_ok=True)
    text = describe(groups)
    (out / "grey_zone.txt").write_text(text + "\n", encoding="utf-8")
    draw(groups).savefig(out / "grey_zone.png", dpi=150)
    click.echo(text)


if __name__ == "__main__":
    main()
