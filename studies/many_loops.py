"""What a form costs with many loops: sheets of Miura-ori, meshes of quadrilaterals and
lattices of Bennett linkages.

    python -m studies.many_loops [--out DIR] [--largest 10] [--sheets 100]

A sheet with k x k inner vertices has k^2 loops, of which one freedom is left. It is given
folded, as a FOLD file. So is a mesh of Lang and Howell (2018), of which all fold angles
have a closed form: how far its form is from that is measured at places all along it. A
lattice of k x k Bennett linkages is locked such that one is left, too, and is placed by
its closed form. Times are processor times of reading or placing it, of writing its
equations, and of the one form through its state. The error is the largest residual at
places all along the form. Memory is the largest resident one so far, which ascending
sizes make that of the last one. All mechanisms are measured three times, one after the
other; the least times are taken. With ``--sheets`` only meshes are, once.
"""

from __future__ import annotations

import csv
import json
import math
import resource
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields, replace
from itertools import product
from pathlib import Path

import click
import numpy as np
from matplotlib.figure import Figure

from bifurc import trace_branch
from linkages import Closure, Mechanism
from linkages.arrays.bennett_lattice import locked_lattice
from linkages.files.fold import read_fold
from linkages.sheets.entries import MESHES
from studies.miura import miura
from studies.study import Study

FOLD = 0.8  # rad, along the zigzags
PLACES = 2000  # along a form, at which it is checked,
NUMBERS = 2_000_000  # or as many as so many numbers hold, and no fewer than
FEWEST_PLACES = 100
MESH = "lang-howell-mesh"  # in the catalogue
FEWEST = 9  # loops from which on the exponent is taken
REPEATS = 3
TIMES = ("read", "equations", "form")


@dataclass(frozen=True)
class FormCost:
    """One mechanism of a ``family``: its loops and unknowns, seconds of reading it, of
    its equations and of its form, the form's pieces and length, the largest residual
    along it, the largest difference of an angle from the closed form (rad; nan where there
    is none), and megabytes."""

    family: str
    loops: int
    unknowns: int
    read: float
    equations: float
    form: float
    pieces: int
    length: float
    error: float
    memory: float
    off_closed_form: float = math.nan


def folded_sheet(side: int) -> Mechanism:
    """The sheet with so many inner vertices a side."""
    return read_fold(json.dumps(miura(side + 1, side + 1, FOLD)), "sheet")


def square_lattice(side: int) -> Mechanism:
    """The lattice of so many cells a side."""
    return locked_lattice(side, side)


def mesh(side: int) -> Mechanism:
    """The mesh of Lang and Howell with so many inner vertices a side."""
    content = MESHES[MESH].fold_content(rows=side, columns=side)
    return read_fold(json.dumps(content), "mesh")


def off_closed_form(mechanism: Mechanism, side: int, points: np.ndarray) -> float:
    """The largest difference (rad) of fold angles at configurations (k, n) of a mesh from
    those of its closed form, at the half tangent that the first column has."""
    sheet = MESHES[MESH].mesh(rows=side, columns=side)
    angles = {crease.joint: crease.angle for crease in mechanism.creases}
    creases = [_place_of_crease(name, side) for name in angles]
    reference = np.array(list(angles.values()))
    first = creases.index((1, 0, 0))
    largest = 0.0
    for point in points:
        folds = point + reference
        along, up = sheet.folds(np.tan(0.5 * folds[first]) / sheet.columns[0])
        exact = [(along, up)[kind][i, j] for kind, i, j in creases]
        gaps = np.remainder(folds - exact + np.pi, 2 * np.pi) - np.pi
        largest = max(largest, float(np.abs(gaps).max()))
    return largest


def _place_of_crease(name: str, side: int) -> tuple[int, int, int]:
    """Whether a crease runs up a column, and where it stands among those that do or
    do not, by the numbers of its vertices, "3-4"."""
    ends = [divmod(int(vertex), side + 2) for vertex in name.split("-")]
    (j, i), (last_j, last_i) = sorted(ends)
    return (1, i - 1, j) if i == last_i else (0, i, last_j - 1)


FAMILIES: dict[str, Callable[[int], Mechanism]] = {
    "Miura-ori": folded_sheet,
    "Lang-Howell mesh": mesh,
    "Bennett lattice": square_lattice,
}


def cost_of_form(family: str, side: int) -> FormCost:
    """What the form of a mechanism of a family with so many loops a side costs."""
    begin = time.process_time()
    mechanism = FAMILIES[family](side)
    read = time.process_time()
    problem = Closure(mechanism)
    problem.residuals(problem.reference[None])
    written = time.process_time()
    branch = trace_branch(problem, problem.reference)
    traced = time.process_time()
    places = min(PLACES, max(FEWEST_PLACES, NUMBERS // problem.n))
    points = branch.sample(places)
    residuals = [np.linalg.norm(problem.residuals(point[None])) for point in points]
    is_mesh = FAMILIES[family] is mesh
    return FormCost(
        family=family,
        loops=mechanism.independent_loops,
        unknowns=problem.n,
        read=read - begin,
        equations=written - read,
        form=traced - written,
        pieces=len(branch.pieces),
        length=branch.length,
        error=float(max(residuals)),
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        off_closed_form=off_closed_form(mechanism, side, points)
        if is_mesh
        else math.nan,
    )


def with_least_times(costs: list[FormCost]) -> FormCost:
    """The first of the costs of one mechanism with the least times of all."""
    times = {name: min(getattr(cost, name) for cost in costs) for name in TIMES}
    return replace(costs[0], **times)


def exponent(costs: list[FormCost], what: str) -> float:
    """The exponent of a time against the number of loops, from the fewest on that are
    many, by least squares."""
    many = [cost for cost in costs if cost.loops >= FEWEST]
    loops = np.log([cost.loops for cost in many])
    seconds = np.log([getattr(cost, what) for cost in many])
    return float(np.polyfit(loops, seconds, 1)[0])


def draw(costs: dict[str, list[FormCost]]) -> Figure:
    """Times of every family and memory against the number of loops."""
    figure = Figure(figsize=(12, 4), layout="constrained")
    panels = figure.subplots(1, len(costs) + 1)
    for axes, (family, of_family) in zip(panels, costs.items(), strict=False):
        loops = [cost.loops for cost in of_family]
        for name in TIMES:
            axes.loglog(loops, [getattr(c, name) for c in of_family], "o-", label=name)
        axes.set(title=family, xlabel="loops", ylabel="processor time (s)")
        axes.set(xticks=loops, xticklabels=loops)
        axes.minorticks_off()
        axes.legend()
    memory = panels[-1]
    for family, of_family in costs.items():
        loops = [cost.loops for cost in of_family]
        memory.plot(loops, [c.memory for c in of_family], "o-", label=family)
    memory.set(xlabel="loops", ylabel="resident memory (MB)", ylim=(0, None))
    memory.legend()
    return figure


@click.command(cls=Study)
@click.option("--out", type=Path, default=Path("out/many_loops"), show_default=True)
@click.option("--largest", type=click.IntRange(2, 20), default=10, show_default=True)
@click.option(
    "--sheets",
    type=click.IntRange(0, 200),
    default=0,
    show_default=True,
    help="Meshes of 10, 30 and so many vertices a side alone, once each.",
)
def main(out: Path, largest: int, sheets: int) -> None:
    """Measure sheets and lattices up to the largest number of loops a side."""
    if sheets:
        show_meshes(sorted({10, 30, sheets}))
        return
    sides = [side for side in sorted({2, 3, 4, 5, 7, largest}) if side <= largest]
    for family in FAMILIES:
        cost_of_form(family, 3)  # imports, which are no part of it
    mechanisms = list(product(sides, FAMILIES))
    passes = [
        [cost_of_form(family, side) for side, family in mechanisms]
        for _ in range(REPEATS)
    ]
    costs: dict[str, list[FormCost]] = {family: [] for family in FAMILIES}
    for of_mechanism in zip(*passes, strict=True):
        least = with_least_times(list(of_mechanism))
        costs[least.family].append(least)
    out.mkdir(parents=True, exist_ok=True)
    with (out / "costs.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(FormCost)])
        writer.writeheader()
        for of_family in costs.values():
            writer.writerows(asdict(cost) for cost in of_family)
    draw(costs).savefig(out / "many_loops.png", dpi=150)
    for family, of_family in costs.items():
        click.echo(family)
        for cost in of_family:
            click.echo(_line(cost))
        exponents = ", ".join(
            f"{name} {exponent(of_family, name):.2f}" for name in TIMES
        )
        click.echo(f"  exponents against loops, from {FEWEST} on: {exponents}")


def show_meshes(sides: list[int]) -> None:
    """Measure meshes with so many vertices a side, and say what they cost."""
    cost_of_form("Lang-Howell mesh", 3)  # imports, which are no part of it
    costs = []
    for side in sides:
        costs.append(cost_of_form("Lang-Howell mesh", side))
        click.echo(_line(costs[-1]))
    totals = [sum(getattr(cost, name) for name in TIMES) for cost in costs]
    loops = np.log([cost.loops for cost in costs])
    slope = float(np.polyfit(loops, np.log(totals), 1)[0])
    exponents = ", ".join(f"{name} {exponent(costs, name):.2f}" for name in TIMES)
    click.echo(f"  exponents against loops: {exponents}, all together {slope:.2f}")


def _line(cost: FormCost) -> str:
    return (
        f"  {cost.loops:4d} loops, {cost.unknowns:4d} unknowns: read {cost.read:.2f} s,"
        f" equations {cost.equations:.2f} s, form {cost.form:.3f} s in {cost.pieces}"
        f" pieces, within {cost.error:.1e}, {cost.memory:.0f} MB"
        + (
            ""
            if math.isnan(cost.off_closed_form)
            else f", {cost.off_closed_form:.1e} rad off the closed form"
        )
    )


if __name__ == "__main__":
    main()
