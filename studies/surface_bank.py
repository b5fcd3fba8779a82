"""Surfaces with known answers, in any units: how many come out right.

Every surface of `data/surfaces.json` has a source, and each of its pieces a known Euler
characteristic and area; beside them stand random pairs of spheres, tori and ellipsoids
with gaps of 1e-1 to 1e-5 between them, and planes, spheres and cylinders that cross.
Each is explored as it stands, in other units, shifted and turned, and from other
random starts, as in `studies.curve_bank`. An answer is right where the pieces, their
Euler characteristics, their areas to 1e-6, the number of isolated singular points and
the curves of such points are; else it is in doubt if it says so, as an area does with
an error as large as it is off, or wrong. Seconds are those of the processor.

With `--measure` the areas and Euler characteristics of the bank are held against those
that `studies.surface_measures` finds along lines and on a grid, without charts.

    python -m studies.surface_bank --names "Cayley cubic" --pairs 0 --crossing 0
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import NamedTuple

import click
import numpy as np

from bifurc import Atlas, Kind, Level, SearchSettings, explore
from studies.curve_bank import Change, Run, Verdict, changes_of, print_table
from studies.known_surfaces import (
    KnownSurface,
    Piece,
    crossing_surfaces,
    load_surfaces,
    pairs_with_gaps,
)
from studies.study import Study, require_known
from studies.surface_measures import area_along_lines, can_be_measured, shape_on_grid

CLOSE = 1e-6  # error of an area that is right, over it
ROUNDING = 1e-10  # of the areas in the bank, over them
CHARTS = 8000  # at most, with which every surface of the bank is covered
LINES, SHIFTS, CUBES = 120, 4, 80  # by which surfaces are measured


# --- verdicts -------------------------------------------------------------------------


class FoundSurface(NamedTuple):
    """Its Euler characteristic, None where unknown, its ``area`` with the ``error``,
    the ``outcome`` of its covering, and the ``note`` on its singular points."""

    euler: int | None = None
    area: float = 0.0
    error: float = np.inf
    outcome: str = "no charts"
    note: str = ""


class Found(NamedTuple):
    """What an atlas says: its ``surfaces``, the smallest first, the numbers of singular
    ``points``, but for samples of curves, and ``forms``, and whether it is in
    ``doubt``."""

    surfaces: tuple[FoundSurface, ...]
    points: int
    forms: int
    doubt: bool

    @staticmethod
    def of(atlas: Atlas) -> Found:
        """What is found in an atlas."""
        surfaces = [FoundSurface()] * len(atlas.surfaces)
        for number, surface in enumerate(atlas.surfaces):
            charts = surface.charts
            if charts is not None:
                euler, outcome = charts.euler_characteristic, charts.outcome.name
                size = charts.area, charts.area_error
                surfaces[number] = FoundSurface(euler, *size, outcome, surface.note)
        level = atlas.completeness.level
        return Found(
            tuple(sorted(surfaces, key=lambda one: one.area)),
            points=sum(p.kind is not Kind.CURVE_SAMPLE for p in atlas.points),
            forms=len(atlas.forms),
            doubt=atlas.completeness.is_in_doubt or level is Level.OUT_OF_TIME,
        )


def judge(known: KnownSurface, found: Found, scale: float | None) -> Verdict:
    """Whether what was found is right; lengths are divided by ``scale``, None where
    areas do not compare."""
    silent = Verdict.IN_DOUBT if found.doubt else Verdict.WRONG
    pieces = sorted(known.pieces, key=lambda piece: piece.area or 0.0)
    counts = len(found.surfaces), found.points, found.forms
    if not pieces or counts != (len(pieces), known.points, known.forms):
        return silent
    if any(one.note != known.note for one in found.surfaces):
        return silent
    verdicts = set()
    for piece, one in zip(pieces, found.surfaces, strict=True):
        verdicts.add(_judge_shape(piece, one))
        if scale is not None and piece.area is not None:
            verdicts.add(_judge_area(piece, scale, one))
    if Verdict.WRONG in verdicts:
        return silent
    return Verdict.IN_DOUBT if Verdict.IN_DOUBT in verdicts else Verdict.RIGHT


def _judge_shape(piece: Piece, found: FoundSurface) -> Verdict:
    if found.euler == piece.euler:
        return Verdict.RIGHT
    return Verdict.IN_DOUBT if found.euler is None else Verdict.WRONG


def _judge_area(piece: Piece, scale: float, found: FoundSurface) -> Verdict:
    """Of a covering that leaves out singular points "more than" is said."""
    assert piece.area is not None
    area, known_to = piece.area / scale**2, piece.error / scale**2
    off = area - found.area
    error = found.error + ROUNDING * area + known_to
    if found.outcome == "SINGULAR":
        return Verdict.RIGHT if off > -error else Verdict.WRONG
    if abs(off) <= CLOSE * area + known_to:
        return Verdict.RIGHT
    return Verdict.IN_DOUBT if abs(off) <= error else Verdict.WRONG


def run_surface(known: KnownSurface, change: Change, seed: int, budget: float) -> Run:
    """The verdict on one answer, found within a ``budget`` of seconds."""
    began = time.process_time()
    found: Found | str
    factors = np.linalg.svd(change.matrix, compute_uv=False)
    scale = float(factors[0]) if np.allclose(factors, factors[0]) else None
    try:
        settings = SearchSettings(budget=budget, charts=CHARTS)
        found = Found.of(
            explore(change.problem(known.system), settings=settings, seed=seed)
        )
        verdict = judge(known, found, scale)
    except Exception as error:  # whatever it is, a user would see it
        verdict, found = Verdict.WRONG, f"{type(error).__name__}: {error}"
    seconds = time.process_time() - began
    return Run(known.name, change, seed, verdict, found, seconds)


def _print_run(run: Run) -> None:
    """One line for an answer that is not right."""
    if run.verdict is Verdict.RIGHT:
        return
    where = f"{run.name}, {run.change.name}, seed {run.seed}"
    print(f"{run.verdict}: {where}: {run.answer} ({run.seconds:.1f} s)", flush=True)


def print_measures(bank: Sequence[KnownSurface]) -> None:
    """What the bank says of each surface, and what lines and a grid do."""
    print("| surface | area | along lines | pieces, Euler | on a grid |")
    print("|---|---|---|---|---|")
    rng = np.random.default_rng(0)
    for known in bank:
        if not can_be_measured(known.system):
            continue
        area = area_along_lines(known.system, LINES, SHIFTS, rng)
        shape = shape_on_grid(known.system, CUBES)
        areas = [piece.area for piece in known.pieces if piece.area is not None]
        characters = [piece.euler for piece in known.pieces if piece.euler is not None]
        cells = [known.name, f"{sum(areas):.8g}"]
        cells += [f"{area.value:.8g} +- {area.error:.1g}"]
        cells += [f"{len(known.pieces)}, {sum(characters)}"]
        cells += [f"{shape.pieces}, {shape.euler}"]
        print("| " + " | ".join(cells) + " |", flush=True)


@click.command(cls=Study, help=__doc__)
@click.option(
    "--changes", "kinds", multiple=True, help="Kind of change.  [default: all]"
)
@click.option("--names", multiple=True, help="A surface.  [default: all]")
@click.option("--pairs", default=50, show_default=True, help="Pairs with gaps.")
@click.option("--crossing", default=20, show_default=True, help="Pairs that cross.")
@click.option("--seeds", default=1, show_default=True, help="Random seeds from 0 on.")
@click.option("--budget", default=60.0, show_default=True, help="Seconds for each.")
@click.option("--every", default=1, show_default=True, help="Only each k-th answer.")
@click.option("--measure", is_flag=True, help="Measure the bank without charts.")
def main(
    kinds: tuple[str, ...],
    names: tuple[str, ...],
    pairs: int,
    crossing: int,
    seeds: int,
    budget: float,
    every: int,
    measure: bool,
) -> None:
    """Run the bank and print what is not right, and the table."""
    bank = load_surfaces()
    require_known("--names", names, [known.name for known in bank])
    changes = [change.kind for known in bank for change in changes_of(known.system)]
    require_known("--changes", kinds, changes)
    chosen = [known for known in bank if not names or known.name in names]
    if measure:
        print_measures(chosen)
        return
    chosen += [*pairs_with_gaps(pairs, seed=0), *crossing_surfaces(crossing, seed=0)]
    runs: list[Run] = []
    questions = [
        (known, change, seed)
        for known in chosen
        for change in changes_of(known.system)
        for seed in range(seeds)
        if not kinds or change.kind in kinds
    ]
    for known, change, seed in questions[::every]:
        run = run_surface(known, change, seed, budget)
        _print_run(run)
        runs.append(run)
    print_table(runs)


if __name__ == "__main__":
    main()
