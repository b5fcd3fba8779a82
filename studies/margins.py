"""How clear is every decision that the search takes?

    python -m studies.margins [--members 2] [--near 60] [--page docs/decisions.md]

The quantities on which `bifurc.decisions` and `linkages.decisions` decide are noted over
the catalogue and random members of its linkages, linkages that nearly bifurcate, curves
on which other methods fail, and random plane curves. For every decision the study
prints how many quantities fell into which decade, where the threshold stands, and how
wide the empty gap around it is. With --page the table and the histogram are written as
a page of the docs.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple, TypeAlias

import click
import numpy as np
from numpy.typing import NDArray

import bifurc.decisions
import linkages.decisions
from bifurc.decisions import Decision, Margins, record_margins
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Seeds
from linkages.catalogue import catalogue
from linkages.linkage import load
from linkages.loop import GeometryError
from linkages.mapping import map_linkage
from studies.hard_cases import crossings
from studies.near_misses import near_misses
from studies.near_something_larger import FAMILIES

__all__ = [
    "DECISIONS",
    "PAGE",
    "Margin",
    "heading",
    "histogram",
    "margin_of",
    "page",
    "random_curve",
]

Floats: TypeAlias = NDArray[np.float64]

DECISIONS = (*bifurc.decisions.TABLE.values(), *linkages.decisions.TABLE.values())
SETTINGS = SearchSettings(budget=30.0)  # no case may hold up the study
LOWEST, HIGHEST = (
    -18,
    4,
)  # decades of the histogram; what lies outside is put at its ends
CURVES = 40
DECADES = (2.0, 5.0, 8.0)  # of the members of families that end in something larger
DEGREE = 4  # of the random plane curves
PAGE = Path("docs/decisions.md")
WIDTH = 118  # of the lines of the page


class Margin(NamedTuple):
    """The quantities nearest to a threshold: the largest ``below`` and the smallest
    ``above``, and how many quantities there were on each side."""

    below: float
    above: float
    count_below: int
    count_above: int

    @property
    def decades(self) -> float:
        """Width of the empty gap; infinite where nothing lies on one side."""
        if not self.count_below or not self.count_above or self.below == 0:
            return float("inf")
        return float(np.log10(self.above / self.below))


@dataclass(frozen=True)
class Case:
    """Something to search, and the group that it belongs to."""

    group: str
    search: Callable[[], object]


def margin_of(decision: Decision, quantities: Floats) -> Margin:
    """How near to its threshold a decision was taken."""
    is_below = quantities < decision.threshold
    below, above = quantities[is_below], quantities[~is_below]
    return Margin(
        below=float(below.max(initial=0.0)),
        above=float(above.min(initial=np.inf)),
        count_below=len(below),
        count_above=len(above),
    )


def histogram(decision: Decision, quantities: Floats) -> str:
    """One character a decade: the number of digits of the count, a point where it is
    0, and a bar where the threshold stands."""
    size = np.maximum(np.abs(quantities), 10.0**LOWEST)
    decades = np.clip(np.floor(np.log10(size)), LOWEST, HIGHEST).astype(int)
    counts = np.bincount(decades - LOWEST, minlength=HIGHEST - LOWEST + 1)
    characters = ["." if count == 0 else str(len(str(count))) for count in counts]
    place = int(np.ceil(np.log10(decision.threshold) - 1e-9)) - LOWEST
    return "".join([*characters[:place], "|", *characters[place:]])


# --- cases ----------------------------------------------------------------------------


def _catalogue_cases(members: int) -> Iterator[Case]:
    """The linkages of the catalogue, as listed and as drawn at random."""
    rng = np.random.default_rng(0)
    for name, entry in catalogue().items():
        yield Case("catalogue", partial(map_linkage, load(name), settings=SETTINGS))
        for _ in range(members):
            values = entry.draw(rng)
            try:
                loop = entry.build(**values)
            except GeometryError:
                continue
            yield Case("members", partial(map_linkage, loop, settings=SETTINGS))


def _near_bifurcations(count: int) -> Iterator[Case]:
    """Linkages off a bifurcating one by 1e-8 to 1e-2."""
    for miss in near_misses(count, np.random.default_rng(0)):
        search = partial(explore, miss.problem, settings=SETTINGS)
        yield Case("near bifurcations", search)


def _hard_curves() -> Iterator[Case]:
    """The curves of the stability study, each from its own start."""
    for crossing in crossings():
        problem = crossing.problem
        nothing = np.empty((0, problem.n))
        seeds = Seeds(
            crossing.start[None], np.ones(1, dtype=bool), np.empty(0), nothing
        )
        yield Case("hard curves", partial(explore, problem, seeds=seeds))


def random_curve(rng: np.random.Generator) -> FunctionProblem:
    """A plane curve p(x, y) = 0 of degree 4 with random coefficients, in the square from
    -2 to 2."""
    coefficients = rng.normal(size=(DEGREE + 1, DEGREE + 1))
    powers = np.arange(DEGREE + 1)
    coefficients[np.add.outer(powers, powers) > DEGREE] = 0.0

    def value(u: Floats) -> Floats:
        x, y = u
        return np.array([(x**powers) @ coefficients @ (y**powers)])

    return FunctionProblem(value, [(-2.0, 2.0), (-2.0, 2.0)])


def _near_something_larger() -> Iterator[Case]:
    """Members of families that end in a surface, or in more motions."""
    for family in FAMILIES:
        for decades in DECADES:
            member = family.member(10.0**-decades)
            search = partial(map_linkage, member, settings=SETTINGS)
            yield Case("near something larger", search)


def _plane_curves(count: int) -> Iterator[Case]:
    """Random plane curves."""
    rng = np.random.default_rng(0)
    for _ in range(count):
        problem = random_curve(rng)
        yield Case("plane curves", partial(explore, problem))


# --- the page -------------------------------------------------------------------------


def _gather(cases: Iterator[Case]) -> dict[str, Floats]:
    """The quantities of every decision over the cases."""
    gathered: dict[str, list[Floats]] = {one.name: [] for one in DECISIONS}
    for case in cases:
        margins: Margins
        with record_margins() as margins:
            case.search()
        for name, quantities in margins.items():
            gathered[name] += quantities
    joined = {
        name: np.concatenate([np.empty(0), *own]) for name, own in gathered.items()
    }
    return {name: own[~np.isnan(own)] for name, own in joined.items()}


HEAD = """# Decisions, and how clear they are

What *proved*, *certified*, *estimated*, *in doubt* and *undecided* mean stands in [how sure](how_sure.md).

Every comparison on which a count, a kind, a level or a word hangs compares one quantity with one threshold. They stand
in `bifurc/decisions.py` and `linkages/decisions.py`; singular values and residuals are over the problem's magnitude,
lengths over its scale. `python -m studies.margins --page` writes this page: it notes every quantity that was decided on
over the catalogue, random members of its linkages, linkages that nearly bifurcate or end in something larger, hard
cases and random plane curves.

A *verdict* decides a count, a kind, a level or a word. A *look* decides only whether something is looked at more
closely, and a *convention* only what is listed: neither needs a gap.
"""


def page(quantities: dict[str, Floats]) -> str:
    """The page of the docs, as Markdown."""
    parts = [HEAD, "## The table\n"]
    for decision in DECISIONS:
        parts.append(_entry(decision, quantities[decision.name]))
    parts.append("## The histogram\n")
    parts.append(
        "One character a decade, from 1e-18 and below to 1e4 and above: the number of\n"
        "digits of the count, a point for none; the bar is the threshold.\n"
    )
    width = max(len(decision.name) for decision in DECISIONS)
    rows = []
    for decision in DECISIONS:
        row = histogram(decision, quantities[decision.name])
        rows.append(f"{decision.name:{width}s}  {row}")
    parts.append("```text\n" + "\n".join(rows) + "\n```\n")
    return "\n".join(parts)


def _entry(decision: Decision, quantities: Floats) -> str:
    """What a decision says, and its margin, as an item of a list."""
    margin = margin_of(decision, quantities)
    text = (
        f"{heading(decision)} {decision.claim}. Quantity: {decision.quantity}; "
        f"{decision.reason}. {_margin_text(margin)}"
    )
    return textwrap.fill(text, WIDTH) + "\n"


def heading(decision: Decision) -> str:
    """How the entry of a decision on the page begins."""
    role, threshold = decision.role.value, decision.threshold
    return f"**{decision.name}** ({role}, below {threshold:.3g}):"


def _margin_text(margin: Margin) -> str:
    """Where the nearest quantities lie, in a sentence."""
    below = f"{margin.count_below} below, up to {margin.below:.1e}"
    above = f"{margin.count_above} above, from {margin.above:.1e}"
    if margin.count_below and margin.count_above and margin.below > 0:
        return f"{below}; {above}: a gap of {margin.decades:.1f} decades."
    if margin.count_below and margin.count_above:
        return f"{margin.count_below} zeros; {above}."
    if margin.count_below:
        return f"{below}; none above."
    if margin.count_above:
        return f"None below; {above}."
    return "Not met in these cases."


@click.command()
@click.option("--members", default=2, help="random members of each linkage")
@click.option("--near", default=60, help="linkages that nearly bifurcate")
@click.option("--page", "target", is_flag=True, help=f"write {PAGE}")
def main(members: int, near: int, target: bool) -> None:
    """Print how clear every decision is."""

    def cases() -> Iterator[Case]:
        yield from _catalogue_cases(members)
        yield from _near_bifurcations(near)
        yield from _near_something_larger()
        yield from _hard_curves()
        yield from _plane_curves(CURVES)

    text = page(_gather(cases()))
    if target:
        PAGE.write_text(text, encoding="utf-8")
    else:
        click.echo(text)


if __name__ == "__main__":
    main()
