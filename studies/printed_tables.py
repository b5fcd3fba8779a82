"""What becomes of tables as they are printed: rounded, or with a misprint.

20 linkages of the catalogue with random parameters are rounded to three and to four
digits, and 20 are printed to four digits with one gross misprint: another sign, 30
degrees more, two rows exchanged; those of up to five joints also with two numbers wrong
that have nothing to do with each other. For each, is the map drawn, is the exact member
returned, and is the wrong number named? The misprinted tables of the sources follow.

A misprint that makes a linkage of the catalogue, such as a parallelogram that another
sign makes an antiparallelogram, is none, and is drawn anew. What is returned counts as
the exact member if every number of it that is not said to be wrong is within two units of
the last printed decimal of the true one. Where a table cannot tell which of two
numbers is wrong, both are named.

python -m studies.printed_tables --out out/printed_tables
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from bifurc import plot_transition_map
from bifurc.figures.planes import shown_branches
from bifurc.figures.plotting import save_figure
from bifurc.tables import section
from linkages import GeometryError, map_linkage
from linkages.app.options import FOLDER
from linkages.app.reports.corrections import best_corrections
from linkages.catalogue import catalogue
from linkages.entry import Entry
from linkages.errata.misprints import printed_tables
from linkages.identification.corrections import (
    EXCESS,
    Change,
    Correction,
    corrections_of,
    roundings_of,
)
from linkages.identification.equivalence import as_loop, table
from linkages.identification.identify import identify

NAMES = (
    "bennett",
    "goldberg-5r",
    "subtractive-goldberg-5r",
    "generalized-goldberg-5r",
    "myard-plane-symmetric-5r",
    "extended-myard-5r",
    "serial-goldberg-6r",
    "l-shape-goldberg-6r",
    "wohlhart-double-goldberg",
    "double-subtractive-goldberg",
    "special-wohlhart-double-goldberg",
    "special-double-subtractive-goldberg",
    "mixed-double-goldberg-type-i",
    "double-goldberg-type-ii",
    "waldron-hybrid",
    "yu-baker",
    "dietmaier",
    "bricard-line-symmetric",
    "bricard-plane-symmetric",
    "bricard-trihedral",
)
MOST_JOINTS = 5  # of the tables that are printed with two wrong numbers
MORE = np.radians(30.0)
TRIES = 200  # of random parameters, and of misprints
HEADS = ("linkage", "printed", "map", "member", "named", "s")


@dataclass(frozen=True)
class Printed:
    """A table as it is printed (3, n) and as it should be, with its ``kind``."""

    name: str
    kind: str
    values: np.ndarray
    true: np.ndarray
    half_units: np.ndarray


@dataclass(frozen=True)
class Verdict:
    """What became of a printed table."""

    printed: Printed
    is_drawn: bool
    is_returned: bool
    is_named: bool
    named: str
    seconds: float

    @property
    def is_right(self) -> bool:
        """Whether nothing is missing."""
        return self.is_drawn and self.is_returned and self.is_named

    def row(self) -> tuple[str, ...]:
        """The cells of a table."""
        marks = ["yes" if one else "NO" for one in (self.is_drawn, self.is_returned)]
        named = self.named if self.is_named else f"NO: {self.named}"
        kind = self.printed.kind
        return (self.printed.name, kind, *marks, named, f"{self.seconds:.1f}")


# --- what is printed ------------------------------------------------------------------


def random_table(entry: Entry, rng: np.random.Generator) -> np.ndarray:
    """The table (3, n) of a random member."""
    for _ in range(TRIES):
        try:
            return table(entry.construct(**entry.draw(rng)))
        except (GeometryError, ArithmeticError, ValueError):
            continue
    raise RuntimeError(f"{entry.name}: no random member in {TRIES} tries")


def rounded(values: np.ndarray, digits: int) -> tuple[np.ndarray, np.ndarray]:
    """A table (3, n) to so many digits, and half a unit of the last ones (3, 1): with a
    decimal less for angles in degrees, which have two digits before the point."""
    decimals = (digits - 1, digits - 2, digits - 1)
    rows = [values[0], np.degrees(values[1]), values[2]]
    printed = np.array(
        [np.round(row, k) for row, k in zip(rows, decimals, strict=True)]
    )
    printed[1] = np.radians(printed[1])
    units = 0.5 * 10.0 ** -np.array(decimals, dtype=float)
    units[1] = np.radians(units[1])
    return printed, units[:, None]


def another_sign(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A table (3, n) of which an offset or a twist has another sign."""
    places = [place for place in np.argwhere(values != 0).tolist() if place[0] > 0]
    row, column = places[rng.integers(len(places))]
    values = values.copy()
    values[row, column] *= -1
    return values


def thirty_more(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A table (3, n) of which one twist is 30 degrees larger, as 90 for 60."""
    values = values.copy()
    values[1, rng.integers(values.shape[1])] += MORE
    return values


def exchanged_rows(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A table (3, n) of which two rows are exchanged."""
    one, other = rng.choice(values.shape[1], 2, replace=False)
    values = values.copy()
    values[:, [one, other]] = values[:, [other, one]]
    return values


def two_numbers(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A table (3, n) of which two numbers are others: twists by 20 to 30 degrees, lengths
    and offsets by a tenth to three."""
    spots = [spot for spot in np.argwhere(values != 0).tolist() if spot[0] != 1]
    spots += [[1, column] for column in range(values.shape[1])]
    values = values.copy()
    for number in rng.choice(len(spots), 2, replace=False):
        row, column = spots[number]
        if row == 1:
            values[row, column] += np.radians(rng.choice([-25.0, 20.0, 30.0]))
        else:
            values[row, column] *= rng.choice([0.8, 1.1, 1.3])
    return values


MISPRINTS: dict[str, Callable[[np.ndarray, np.random.Generator], np.ndarray]] = {
    "another sign": another_sign,
    "30 deg more": thirty_more,
    "rows exchanged": exchanged_rows,
}
TWO = "two numbers"


def misprinted(
    true: np.ndarray, kind: str, digits: int, rng: np.random.Generator
) -> np.ndarray | None:
    """A table (3, n) to so many digits with a misprint of a kind; None where all that
    are tried make linkages of the catalogue."""
    values, _ = rounded(true, digits)
    for _ in range(TRIES):
        wrong = (
            two_numbers(values, rng) if kind == TWO else MISPRINTS[kind](values, rng)
        )
        if np.array_equal(wrong, values):
            continue
        found = identify(as_loop(wrong), locking=False)
        if not found.matches and not roundings_of(found):
            return wrong
    return None


def tables(seed: int) -> Iterator[Printed]:
    """All tables of the study."""
    for number, name in enumerate(NAMES):
        rng = np.random.default_rng([seed, number])
        true = random_table(catalogue()[name], rng)
        for digits in (3, 4):
            values, half_units = rounded(true, digits)
            yield Printed(name, f"{digits} digits", values, true, half_units)
        if true.shape[1] <= MOST_JOINTS:
            wrong = misprinted(true, TWO, 4, np.random.default_rng([seed, number, 1]))
            if wrong is not None:
                yield Printed(name, TWO, wrong, true, rounded(true, 4)[1])
        kinds = list(MISPRINTS)
        for kind in kinds[number % 3 :] + kinds[: number % 3]:
            wrong = misprinted(true, kind, 4, rng)
            if wrong is not None:
                _, half_units = rounded(true, 4)
                yield Printed(name, kind, wrong, true, half_units)
                break


# --- what becomes of it ---------------------------------------------------------------


def judge(printed: Printed) -> tuple[Verdict, Correction | None]:
    """What becomes of a printed table, and the correction that is right, if any."""
    start = time.perf_counter()
    loop = as_loop(printed.values, printed.name)
    identification = identify(loop, locking=False)
    if identification.matches:  # rounding leaves some linkages what they are
        best = [Correction(identification.matches[0])]
    else:
        best = best_corrections(corrections_of(identification).found)
    right = next((one for one in best if is_right(printed, one)), None)
    wrong = places_off(printed)
    is_named = any(places(one.changes) == wrong for one in best)
    shown = as_loop(right.match.member) if right and wrong else loop
    atlas = map_linkage(shown)
    seconds = time.perf_counter() - start
    named = " or ".join(words(one, loop.n) for one in best) or "nothing"
    is_drawn = bool(shown_branches(atlas) or atlas.surfaces)
    verdict = Verdict(printed, is_drawn, right is not None, is_named, named, seconds)
    return verdict, right


def places_off(printed: Printed) -> set[tuple[int, int]]:
    """Row and column of the numbers that rounding does not account for."""
    off = np.abs(printed.values - printed.true) > 1.01 * printed.half_units
    return {(row, column) for row, column in np.argwhere(off).tolist()}


def places(changes: tuple[Change, ...]) -> set[tuple[int, int]]:
    """Row and column of the numbers that are said to be wrong."""
    return {(change.row.value, change.column) for change in changes}


def is_right(printed: Printed, correction: Correction) -> bool:
    """Whether a linkage is the true one but for rounding: half a unit of the last decimal
    and what the fit leaves beside that, ten times as much of numbers that follow from
    the others."""
    gaps = np.abs(np.sin((correction.match.member - printed.true) / 2) * 2)
    gaps[[0, 2]] = np.abs(correction.match.member - printed.true)[[0, 2]]
    allowed = (1.0 + EXCESS) * printed.half_units * np.ones_like(gaps)
    for place in places_off(printed):
        allowed[place] *= 10.0
    return bool(np.all(gaps <= allowed))


def words(correction: Correction, n: int) -> str:
    """What is said to be wrong."""
    if correction.mistake:
        return correction.mistake
    return ", ".join(change.name(n) for change in correction.changes) or "rounded"


def of_sources() -> Iterator[tuple[str, ...]]:
    """A row for each misprinted table of the sources: what is wrong, and what is said to
    be."""
    for one in printed_tables():
        start = time.perf_counter()
        found = identify(one.loop, locking=False)
        best = (
            best_corrections(corrections_of(found).found) if not found.matches else []
        )
        named = " or ".join(words(each, one.loop.n) for each in best) or "nothing"
        seconds = f"{time.perf_counter() - start:.1f}"
        place = f"{one.source} {one.equation}"
        yield place, one.linkage, ", ".join(one.numbers), named, seconds


@click.command()
@click.option("--out", type=FOLDER, help="Folder for the tables and the maps.")
@click.option("--seed", default=0, help="Seed of the parameters and the misprints.")
@click.option("--only", default="", help="Only linkages whose names contain this.")
@click.option("--kind", default="", help="Only misprints of which this is a part.")
@click.option("--sources", is_flag=True, help="Only the tables of the sources.")
def main(out: Path | None, seed: int, only: str, kind: str, sources: bool) -> None:
    """What becomes of tables that are rounded or have a misprint."""
    rows = []
    for printed in tables(seed) if not sources else ():
        if only not in printed.name or kind not in printed.kind:
            continue
        verdict, right = judge(printed)
        click.echo("  ".join(verdict.row()))
        rows.append((verdict, right))
    texts = [section("Random members", HEADS, [one.row() for one, _ in rows])]
    count = sum(one.is_right for one, _ in rows)
    texts.append(f"{count} of {len(rows)} tables: drawn, returned and named.")
    heads = ("source", "linkage", "wrong", "named", "s")
    texts.append(section("Tables of the sources", heads, list(of_sources())))
    text = "\n\n".join(texts)
    click.echo("\n" + text)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "printed_tables.txt").write_text(text + "\n", encoding="utf-8")
        for one, right in rows:
            values = right.match.member if right else one.printed.values
            if not places_off(one.printed):
                values = one.printed.values
            atlas = map_linkage(as_loop(values, one.printed.name))
            stem = f"{one.printed.name} {one.printed.kind}".replace(" ", "_")
            save_figure(plot_transition_map(atlas), out / stem)


if __name__ == "__main__":
    main()
