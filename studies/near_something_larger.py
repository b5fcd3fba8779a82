"""Linkages beside something larger: is the map right, or said to be in doubt?

    python -m studies.near_something_larger --out out/near_something_larger [--seeds 5]

Twelve families that end, as e goes to 0, in a linkage with a surface of configurations
or with more motions. For every e > 0 the forms and bifurcations of a member are known.
Each family is mapped for e = 1e-1 to 1e-14 in half decades, from several random seeds.
A map is right when its counts are those of the family, every form closes, and there is
neither a surface nor a rigid assembly; it is in doubt when it is not right and says so;
all else is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import click
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from bifurc import Atlas, SearchSettings
from bifurc.tables import table
from linkages import Linkage, Loop, load_linkage, map_linkage
from linkages.app.options import NamedPath
from linkages.catalogue import entry
from linkages.families.bennett import bennett
from linkages.families.four_bar import four_bar, kite, parallelogram
from studies.study import Study

HALF_DECADES = tuple(0.5 * k for k in range(2, 29))  # -log10 e, from 1 to 14
BUDGET = 60.0  # s for one map

Member = Callable[[float], Linkage | Loop]


class Verdict(Enum):
    """What a map is worth: the name, and its colour in the figure."""

    RIGHT = ("right", "#009E73")
    RIGHT_IN_DOUBT = ("right, and said to be in doubt", "#A6DBC8")
    IN_DOUBT = ("said to be in doubt", "#E6E6E6")
    WRONG = ("wrong", "#D55E00")

    @property
    def words(self) -> str:
        """The verdict in words."""
        return self.value[0]

    @property
    def colour(self) -> str:
        """Its colour."""
        return self.value[1]


@dataclass(frozen=True)
class Family:
    """Linkages that end in something larger, and how many ``forms`` and
    ``bifurcations`` each ``member`` has before that."""

    name: str
    member: Member
    forms: int
    bifurcations: int


@dataclass(frozen=True)
class Answer:
    """The verdict on one map, of the member of a ``family`` with e = 10 ** -
    ``decades``, from a random ``seed``."""

    family: str
    decades: float
    seed: int
    verdict: Verdict
    level: str


# --- families -------------------------------------------------------------------------


def _special(name: str) -> Member:
    """A special double-Goldberg linkage whose twists delta and beta become equal."""
    return lambda e: load_linkage(name, alpha=2.0, beta=1.0, delta=1.0 + e)


def _bricard(e: float) -> Linkage:
    """The zero-offset line-symmetric Bricard linkage whose links 12 and 23 become
    equal."""
    name = "bricard-line-symmetric-zero-offset"
    default = {each.name: each.default for each in entry(name).parameters}
    return load_linkage(name, a23=default["a12"] + e, alpha23=default["alpha12"] + e)


def _short_bennett(e: float) -> Loop:
    """The Bennett linkage with one pair of links e times as long as the other."""
    return bennett(1.0, 1.0, float(np.arcsin(e * np.sin(1.0))))


# Forms of a planar four-bar: two where the shortest and the longest link together are
# shorter than the others, one where they are longer (Grashof 1883).
FAMILIES = (
    Family(
        "subtractive double-Goldberg, delta to beta",
        _special("special-double-subtractive-goldberg"),
        4,
        4,
    ),
    Family(
        "Wohlhart double-Goldberg, delta to beta",
        _special("special-wohlhart-double-goldberg"),
        4,
        4,
    ),
    Family("zero-offset Bricard, equal links", _bricard, 4, 4),
    Family("kite to rhombus", lambda e: kite(1.0, 1.0 + e), 2, 2),
    Family("parallelogram to rhombus", lambda e: parallelogram(1.0, 1.0 + e), 2, 2),
    Family("four-bar to kite", lambda e: four_bar(1.0, 2.0, 2.0 + e, 1.0), 1, 0),
    Family(
        "four-bar to parallelogram", lambda e: four_bar(1.0, 2.0, 1.0 + e, 2.0), 2, 0
    ),
    Family(
        "four-bar to rhombus", lambda e: four_bar(1.0, 1.0 + e, 1.0, 1.0 - e / 2), 1, 0
    ),
    Family("Bennett to equilateral", lambda e: bennett(1.0, 1.0, 1.0 + e), 1, 0),
    Family("kite, two short links", lambda e: kite(1.0, e), 2, 2),
    Family("parallelogram, two short links", lambda e: parallelogram(1.0, e), 2, 2),
    Family("Bennett, two short links", _short_bennett, 1, 0),
)


# --- judging --------------------------------------------------------------------------


def judge(family: Family, atlas: Atlas) -> Verdict:
    """What the atlas of a member is worth."""
    counts = (len(atlas.forms), len(atlas.bifurcations), len(atlas.points))
    are_closed = all(form.branch.closed for form in atlas.forms)
    has_nothing_else = not (len(atlas.rigid) or atlas.surfaces)
    expected = (family.forms, family.bifurcations, family.bifurcations)
    is_right = counts == expected and are_closed and has_nothing_else
    is_in_doubt = atlas.completeness.is_in_doubt
    if is_right:
        return Verdict.RIGHT_IN_DOUBT if is_in_doubt else Verdict.RIGHT
    return Verdict.IN_DOUBT if is_in_doubt else Verdict.WRONG


def answers(
    families: Iterable[Family], decades: Sequence[float], seeds: int
) -> Iterator[Answer]:
    """One answer for every family, half decade and seed."""
    settings = SearchSettings(budget=BUDGET)
    for family in families:
        for number in decades:
            member = family.member(10.0**-number)
            for seed in range(seeds):
                atlas = map_linkage(member, settings=settings, seed=seed)
                verdict = judge(family, atlas)
                level = atlas.completeness.level.value
                yield Answer(family.name, number, seed, verdict, level)


# --- table and figure -----------------------------------------------------------------


def describe(found: Sequence[Answer]) -> str:
    """A row for every family: how many maps are right, in doubt and wrong, and down to
    which e all are right."""
    rows = []
    for name in dict.fromkeys(answer.family for answer in found):
        own = [answer for answer in found if answer.family == name]
        verdicts = [answer.verdict for answer in own]
        counts = [str(verdicts.count(verdict)) for verdict in Verdict]
        rows.append((name, str(len(own)), *counts, _right_down_to(own)))
    heads = ("family", "maps", "right", "in doubt", "in doubt", "wrong", "right to")
    first = ("", "", "", "but right", "", "", "e =")
    return table(heads, [first, *rows])


def _right_down_to(own: Sequence[Answer]) -> str:
    """The smallest e of a family down to which every map is right."""
    wrong = [
        answer.decades
        for answer in own
        if answer.verdict in (Verdict.IN_DOUBT, Verdict.WRONG)
    ]
    all_decades = sorted({answer.decades for answer in own})
    right = [each for each in all_decades if each < min(wrong, default=np.inf)]
    return f"{10.0 ** -right[-1]:.1e}" if right else "none"


def draw(found: Sequence[Answer]) -> Figure:
    """A cell for every family and half decade, one stripe in it for each seed."""
    names = list(dict.fromkeys(answer.family for answer in found))
    decades = sorted({answer.decades for answer in found})
    seeds = 1 + max(answer.seed for answer in found)
    order = list(Verdict)
    cells = _cells(found, names, decades, seeds)
    figure = Figure(figsize=(9.0, 0.38 * len(names) + 1.6), layout="constrained")
    axes = figure.subplots()
    colours = ListedColormap([verdict.colour for verdict in order])
    axes.pcolormesh(cells, cmap=colours, vmin=-0.5, vmax=len(order) - 0.5)
    for row in range(1, len(names)):
        axes.axhline(row * seeds, color="white", linewidth=3)
    axes.invert_yaxis()
    axes.set_yticks([(k + 0.5) * seeds for k in range(len(names))], names)
    whole = [k for k, number in enumerate(decades) if number == int(number)]
    labels = [f"$10^{{-{decades[k]:.0f}}}$" for k in whole]
    axes.set_xticks([k + 0.5 for k in whole], labels)
    axes.set_xlabel("e, the distance from something larger")
    axes.tick_params(length=0)
    handles = [Patch(color=each.colour, label=each.words) for each in order]
    figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False)
    return figure


def _cells(
    found: Sequence[Answer], names: list[str], decades: list[float], seeds: int
) -> np.ndarray:
    """Numbers of the verdicts, a row for each family and seed, a column for each half
    decade; nan where there is none."""
    order = list(Verdict)
    cells = np.full((len(names) * seeds, len(decades)), np.nan)
    for answer in found:
        row = names.index(answer.family) * seeds + answer.seed
        cells[row, decades.index(answer.decades)] = order.index(answer.verdict)
    return cells


@click.command(cls=Study, help=__doc__)
@click.option("--out", type=NamedPath(), required=True)
@click.option("--seeds", type=click.IntRange(1), default=5, show_default=True)
def main(out: Path, seeds: int) -> None:
    """Run the study, and write its table and its figure."""
    out.mkdir(parents=True, exist_ok=True)
    found: list[Answer] = []
    for answer in answers(FAMILIES, HALF_DECADES, seeds):
        found.append(answer)
        if answer.verdict is Verdict.WRONG:
            click.echo(
                f"wrong: {answer.family}, e = {10.0**-answer.decades:.1e}, seed "
                f"{answer.seed}, {answer.level}"
            )
    text = describe(found)
    (out / "near_something_larger.txt").write_text(text + "\n")
    draw(found).savefig(out / "near_something_larger.svg")
    draw(found).savefig(out / "near_something_larger.png", dpi=150)
    click.echo(text)


if __name__ == "__main__":
    main()
