"""Surfaces with known answers, in any units: how many come out right.

Every surface of `data/surfaces.json` has a source, and each of its pieces a known Euler
characteristic and area, those of triply periodic ones by another quadrature; beside them
stand random pairs of spheres, tori and ellipsoids with gaps of 1e-1 to 1e-5 between
them. Each is explored as it stands, in other units, shifted and turned, and from other
random starts, as in `studies.curve_bank`. An answer is right where the pieces, their
Euler characteristics, their areas to 1e-6 and the number of isolated singular points
are; else it is in doubt if it says so, as an area does with an error as large as it is
off, or wrong. Seconds are those of the processor.

    python -m studies.surface_bank --names "Cayley cubic" --pairs 0
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
from scipy.special import elliprg

from bifurc import Atlas, Level, SearchSettings, explore
from studies.curve_bank import (
    Answer,
    Change,
    Curve,
    Run,
    Verdict,
    changes_of,
    print_table,
)
from studies.study import Study, require_known

BANK = Path(__file__).parent.parent / "data" / "surfaces.json"
GAPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
CLOSE = 1e-6  # error of an area that is right, over it
ROUNDING = 1e-10  # of the areas in the bank, over them
CHARTS = 8000  # at most, with which every surface of the bank is covered
NOTHING = Answer(0, 0, (), 0, 0, 0)


class Piece(NamedTuple):
    """A surface: its Euler characteristic and its ``area``, None where unknown."""

    euler: int | None
    area: float | None


@dataclass(frozen=True)
class KnownSurface:
    """A ``system`` of equations whose solutions are ``pieces``, none where they are not
    known, with so many isolated singular ``points``."""

    system: Curve
    pieces: tuple[Piece, ...]
    points: int = 0

    @property
    def name(self) -> str:
        """The name in the bank."""
        return self.system.name


def load_surfaces() -> list[KnownSurface]:
    """The surfaces of the bank."""
    return [_surface(entry) for entry in json.loads(BANK.read_text())]


def _surface(entry: dict[str, Any]) -> KnownSurface:
    n = len(entry["unknowns"])
    system = _system(
        entry["name"],
        entry["equations"],
        entry["bounds"],
        source=entry["source"],
        unknowns=tuple(entry["unknowns"]),
        periods=np.array(entry.get("periods", [np.inf] * n)),
        # those that leave the bounds are not turned
        answer=NOTHING._replace(open=int(entry["leaves_bounds"])),
    )
    pieces = tuple(Piece(*piece) for piece in entry["surfaces"])
    return KnownSurface(system, pieces, entry["points"])


def _system(name: str, equations: Sequence[str], bounds: Any, **others: Any) -> Curve:
    known: dict[str, Any] = {
        "source": "closed form",
        "unknowns": ("x", "y", "z"),
        "periods": np.full(3, np.inf),
        "answer": NOTHING,
        "parameter": "",
        "events": (),
        "noise": 0.0,
    }
    bounds = np.array(bounds, dtype=float)
    return Curve(name, equations=tuple(equations), bounds=bounds, **(known | others))


# --- random pairs ---------------------------------------------------------------------


class _Shape(NamedTuple):
    """One surface of a pair: its equation, its piece, and how far it reaches."""

    equation: str
    piece: Piece
    reach: float


def pairs_with_gaps(count: int, seed: int) -> Iterator[KnownSurface]:
    """So many random pairs, each with one of the gaps in turn."""
    rng = np.random.default_rng(seed)
    kinds = (
        _side_by_side,
        _sphere_in_sphere,
        _sphere_in_ellipsoid,
        _torus_in_torus,
        _sphere_in_hole,
    )
    for number in range(count):
        gap = GAPS[number % len(GAPS)]
        kind = kinds[(number // len(GAPS) + number) % len(kinds)]
        one, other = kind(gap, rng)
        reach = max(one.reach, other.reach) * rng.uniform(1.05, 1.5, (3, 2))
        system = _system(
            f"pair {number} of seed {seed}: {kind.__name__[1:]}, gap {gap:g}",
            [f"({one.equation})*({other.equation})"],
            reach * [-1.0, 1.0],
        )
        yield KnownSurface(system, (one.piece, other.piece))


def _sphere(radius: float, center: float = 0.0) -> _Shape:
    equation = f"(x-{center!r})**2+y**2+z**2-{radius!r}**2"
    return _Shape(equation, Piece(2, 4 * np.pi * radius**2), abs(center) + radius)


def _torus(radius: float, tube: float) -> _Shape:
    ring = f"4*{radius!r}**2*(x**2+y**2)"
    equation = f"(x**2+y**2+z**2+{radius!r}**2-{tube!r}**2)**2-{ring}"
    return _Shape(equation, Piece(0, 4 * np.pi**2 * radius * tube), radius + tube)


def _ellipsoid(axes: np.ndarray) -> _Shape:
    """An ellipsoid with these half-axes (3,); its area by Carlson's integral."""
    a, b, c = (axes**2).tolist()
    equation = f"x**2/{a!r}+y**2/{b!r}+z**2/{c!r}-1"
    area = 4 * np.pi * float(elliprg(a * b, b * c, c * a))
    return _Shape(equation, Piece(2, area), float(axes.max()))


def _side_by_side(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    axes, radius = rng.uniform(0.5, 1.2, 3), float(rng.uniform(0.3, 1.0))
    return _ellipsoid(axes), _sphere(radius, float(axes[0]) + gap + radius)


def _sphere_in_sphere(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    radius = float(rng.uniform(0.4, 0.95))
    shift = (1.0 - radius - gap) * float(rng.choice([0.0, 1.0]))
    inner = radius if shift else 1.0 - gap
    return _sphere(1.0), _sphere(inner, shift)


def _sphere_in_ellipsoid(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    axes = rng.uniform(0.6, 1.3, 3)
    return _ellipsoid(axes), _sphere(float(axes.min()) - gap)


def _torus_in_torus(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    tube = float(rng.uniform(0.3, 0.7))
    return _torus(1.0, tube), _torus(1.0, tube - gap)


def _sphere_in_hole(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    tube = float(rng.uniform(0.2, 0.6))
    return _torus(1.0, tube), _sphere(1.0 - tube - gap)


# --- verdicts -------------------------------------------------------------------------


class FoundSurface(NamedTuple):
    """Its Euler characteristic, None where unknown, its ``area`` with the ``error``,
    and the ``outcome`` of its covering."""

    euler: int | None = None
    area: float = 0.0
    error: float = np.inf
    outcome: str = "no charts"


class Found(NamedTuple):
    """What an atlas says: its ``surfaces``, the smallest first, the numbers of singular
    ``points`` and ``forms``, and whether it is in ``doubt``."""

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
                surfaces[number] = FoundSurface(euler, *size, outcome)
        level = atlas.completeness.level
        return Found(
            tuple(sorted(surfaces, key=lambda one: one.area)),
            points=len(atlas.points),
            forms=len(atlas.forms),
            doubt=atlas.completeness.is_in_doubt or level is Level.OUT_OF_TIME,
        )


def judge(known: KnownSurface, found: Found, scale: float | None) -> Verdict:
    """Whether what was found is right; lengths are divided by ``scale``, None where
    areas do not compare."""
    silent = Verdict.IN_DOUBT if found.doubt else Verdict.WRONG
    pieces = sorted(known.pieces, key=lambda piece: piece.area or 0.0)
    counts = len(found.surfaces), found.points, found.forms
    if not pieces or counts != (len(pieces), known.points, 0):
        return silent
    verdicts = set()
    for piece, one in zip(pieces, found.surfaces, strict=True):
        verdicts.add(_judge_shape(piece, one))
        if scale is not None and piece.area is not None:
            verdicts.add(_judge_area(piece.area / scale**2, one))
    if Verdict.WRONG in verdicts:
        return silent
    return Verdict.IN_DOUBT if Verdict.IN_DOUBT in verdicts else Verdict.RIGHT


def _judge_shape(piece: Piece, found: FoundSurface) -> Verdict:
    if found.euler == piece.euler:
        return Verdict.RIGHT
    return Verdict.IN_DOUBT if found.euler is None else Verdict.WRONG


def _judge_area(area: float, found: FoundSurface) -> Verdict:
    """Of a covering that leaves out singular points "more than" is said."""
    off = area - found.area
    error = found.error + ROUNDING * area
    if found.outcome == "SINGULAR":
        return Verdict.RIGHT if off > -error else Verdict.WRONG
    if abs(off) <= CLOSE * area:
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


@click.command(cls=Study, help=__doc__)
@click.option(
    "--changes", "kinds", multiple=True, help="Kind of change.  [default: all]"
)
@click.option("--names", multiple=True, help="A surface.  [default: all]")
@click.option("--pairs", default=50, show_default=True, help="Random pairs.")
@click.option("--seeds", default=1, show_default=True, help="Random seeds from 0 on.")
@click.option("--budget", default=60.0, show_default=True, help="Seconds for each.")
@click.option("--every", default=1, show_default=True, help="Only each k-th answer.")
def main(
    kinds: tuple[str, ...],
    names: tuple[str, ...],
    pairs: int,
    seeds: int,
    budget: float,
    every: int,
) -> None:
    """Run the bank and print what is not right, and the table."""
    bank = load_surfaces()
    require_known("--names", names, [known.name for known in bank])
    changes = [change.kind for known in bank for change in changes_of(known.system)]
    require_known("--changes", kinds, changes)
    chosen = [known for known in bank if not names or known.name in names]
    chosen += pairs_with_gaps(pairs, seed=0)
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
