"""All ways in which sheets of vertices of four creases leave their flat state, counted
and each traced.

    python -m studies.ways_out_of_flat [--largest 4]

Creases fold either way. Miura-ori with r rows and c columns of inner vertices folds along
all its straight lines with some of its zigzags, or along one straight line by itself: 2^c + r - 1
ways. Square twists leave it in 4^r + 4^c - 2 ways. About flat vertices of four creases
that fold flat the half tangents of fold angles keep the ratios that they have to leading
order, which is a closed form of every way. From a folded state each is followed through
that in which all is folded over, and through the flat one, until it is closed, and compared
with it all along.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass
from typing import NamedTuple

import click
import numpy as np

from bifurc import trace_branch
from bifurc.numerics.singular_values import singular_values
from bifurc.tables import table
from linkages import Closure, Mechanism
from linkages.files.fold import mechanism_of_fold
from linkages.sheets.entries import PATTERNS
from studies.miura import miura
from studies.study import Study

START = 0.3  # largest half tangent where a way is entered
PLACES = 100  # along a way
SINGULAR = 1e-7  # singular value of a surface
NEAR = 1e-3  # rad: to the flat state, and to that folded over, where ratios are not looked at
COLUMNS = (
    *("sheet", "creases", "ways", "formula", "traced", "on surfaces"),
    *("off closed form", "its residual"),
)


class Sheet(NamedTuple):
    """A sheet of rows and columns, and how many ways it is said to have."""

    build: Callable[[int, int], Mechanism]
    ways: Callable[[int, int], int]


def miura_ori(rows: int, columns: int) -> Mechanism:
    """The flat Miura-ori with so many inner vertices."""
    return mechanism_of_fold(miura(columns + 1, rows + 1), "miura-ori")


def square_twists(rows: int, columns: int) -> Mechanism:
    """So many flat square twists."""
    return PATTERNS["square-twist"].build(rows=rows, columns=columns)


FAMILIES = {
    "miura-ori": Sheet(miura_ori, lambda rows, columns: 2**columns + rows - 1),
    "square-twist": Sheet(
        square_twists, lambda rows, columns: 4**rows + 4**columns - 2
    ),
}


@dataclass(frozen=True)
class WaysOut:
    """What became of the ways of a sheet with so many ``creases``: how many there are
    and should be, how many were traced until they closed, how many lie ``on_surfaces``,
    where several straight lines fold freely, the largest difference of half tangents
    from the closed form, over the largest of them, and the largest ``residual`` of the
    closed form."""

    name: str
    creases: int
    ways: int
    expected: int
    traced: int
    on_surfaces: int
    error: float
    residual: float


def ways_out(name: str, rows: int, columns: int) -> WaysOut:
    """The ways of the sheet of this name, each traced. Raises `ValueError` where they
    are too many to be written down."""
    sheet = FAMILIES[name]
    mechanism = sheet.build(rows, columns).with_free_creases()
    problem = Closure(mechanism)
    folds = problem.structure.ways_by_modes
    if folds is None:
        raise ValueError(f"{name}, {rows} x {columns}: more ways than are written down")
    folds = folds[:, list(problem.structure.column_of)]
    half_tangents = np.tan(np.linspace(0.01, 1.56, PLACES))
    points = [2.0 * np.arctan(t * folds) + problem.reference for t in half_tangents]
    residuals = [np.abs(problem.residuals(one)).max() for one in points]
    starts = 2.0 * np.arctan(START * folds) + problem.reference
    are_curves = singular_values(problem, starts)[:, problem.n - 2] > SINGULAR
    errors = [_error_along(problem, fold) for fold in folds[are_curves]]
    return WaysOut(
        name=f"{name} {rows} x {columns}",
        creases=len(mechanism.joints),
        ways=len(folds),
        expected=sheet.ways(rows, columns),
        traced=int(np.count_nonzero(np.isfinite(errors))),
        on_surfaces=int(np.count_nonzero(~are_curves)),
        error=float(np.nanmax(errors)),
        residual=float(max(residuals)),
    )


def _error_along(problem: Closure, fold: np.ndarray) -> float:
    """The largest difference of half tangents along the way of a ``fold`` (n,) from the
    closed form; nan where it is no closed curve."""
    start = problem.reference + 2.0 * np.arctan(START * fold)
    tangent = fold / (1.0 + (START * fold) ** 2)
    branch = trace_branch(problem, start, tangent / np.linalg.norm(tangent))
    if not branch.closed:
        return float("nan")
    points = branch.sample(PLACES) - problem.reference
    points = np.remainder(points + np.pi, 2 * np.pi) - np.pi
    sizes = np.abs(points).max(axis=1)
    half = np.tan(0.5 * points[(sizes > NEAR) & (sizes < np.pi - NEAR)])
    largest = np.argmax(np.abs(fold))
    ratios = half / half[:, [largest]]
    return float(np.abs(ratios - fold / fold[largest]).max())


@click.command(cls=Study, help="Count and trace all ways out of flat of sheets.")
@click.option("--largest", default=4, show_default=True, help="Vertices a side.")
def main(largest: int) -> None:
    """Print a row for each square sheet."""
    rows = []
    for name in FAMILIES:
        for side in range(1, largest + 1):
            try:
                found = ways_out(name, side, side)
            except ValueError as error:
                click.echo(str(error), err=True)
                break
            values = astuple(found)
            sizes = [f"{value:.1e}" for value in values[6:]]
            rows.append((*map(str, values[:6]), *sizes))
    click.echo(table(COLUMNS, rows))


if __name__ == "__main__":
    main()
