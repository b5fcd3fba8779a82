"""The part of docs/results.md that says where each number comes from, by
docs/results.csv.  ``python -m studies.pages results`` writes it.

A row of that table is a number: what it is called on the screen (``printed``), in JSON
(``key``) and in a dataset (``variable``), the ``function`` that makes it, and its
``meaning``; of a variable it is the long name in ``bifurc/files/variables.csv``, where
nothing else is said.
"""

from __future__ import annotations

import csv
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "results.md"
BEGIN = "## Where each number comes from\n"
HEAD = """
Each row is a number. It is *printed* under this head by `bifurc map` or `bifurc solve`, stands under this *key* in what
they write with `--json` (`forms.length`: in each of `forms`), and is this *variable* of `atlas.nc`. The function that
makes it is in the file of the module's name: `bifurc.curves.monitor.dead_points` in `bifurc/curves/monitor.py`.
`make pages` writes these tables by `docs/results.csv`.
"""


class Number(NamedTuple):
    """A row of the table; several keys or variables of one number stand apart by
    spaces, several heads by commas."""

    table: str
    printed: str
    key: str
    variable: str
    function: str
    meaning: str


def numbers() -> list[Number]:
    """All rows, those of variables with their long names."""
    meanings = {one["variable"]: one["long_name"] for one in variables()}
    rows = [Number(**row) for row in _read(ROOT / "docs" / "results.csv")]
    return [row._replace(meaning=row.meaning or meanings[row.variable]) for row in rows]


def variables() -> list[dict[str, str]]:
    """The variables of a dataset, as bifurc/files/variables.csv lists them."""
    return _read(ROOT / "bifurc" / "files" / "variables.csv")


def results_page() -> str:
    """The page as it stands, with these tables made anew."""
    before, begin, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, heading, after = rest.partition("\n## ")
    tables = [
        f"\n### {title}\n\n{_table(list(rows))}"
        for title, rows in groupby(numbers(), lambda row: row.table)
    ]
    return before + begin + HEAD + "".join(tables) + heading + after


def _table(rows: list[Number]) -> str:
    lines = [
        "printed | key | variable | made by | what it is",
        "--- | --- | --- | --- | ---",
    ]
    for row in rows:
        keys, names = row.key.split(), row.variable.split()
        cells = (
            row.printed,
            _code(keys),
            _code(names),
            _code([row.function]),
            row.meaning.replace("|", r"\|"),
        )
        lines.append(" | ".join(cells))
    return "".join(f"| {line} |\n" for line in lines)


def _code(words: list[str]) -> str:
    return ", ".join(f"`{word}`" for word in words)


def _read(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
