"""How clear is every decision that the search takes?

    python -m studies.margins [--members 2] [--near 60] [--page] [--nearest NAME]

The quantities on which `bifurc.decisions` and `linkages.decisions` decide are noted
over the catalogue and random members of its linkages, linkages that nearly bifurcate or
end in something larger, surfaces, curves on which other methods fail, random plane
curves, and lines through one point or next to one. For every decision the study prints
how many quantities fell into which decade, where the threshold stands, and how wide the
empty gap around it is. With --page the table and the histogram are written as a page of
the docs; with --nearest the study says in which cases the quantities of one decision
lie nearest to its threshold.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import NamedTuple, TypeAlias

import click
import numpy as np
from numpy.typing import NDArray

import bifurc.decisions
import linkages.decisions
from bifurc import FunctionProblem, Problem, SearchSettings, Seeds, explore
from bifurc.decisions import Decision, Margins, Role, record_margins
from linkages import (
    Closure,
    GeometryError,
    Joint,
    Loop,
    Mechanism,
    load,
    map_linkage,
)
from linkages.app.answer.document import make_document
from linkages.catalogue import catalogue
from linkages.files.bars import read_bars
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.entries import NETWORKS
from linkages.networks.lock_routes import NetworkPlace, find_lock_route
from linkages.networks.network import Network
from studies.hard_cases import crossings
from studies.near_misses import near_misses
from studies.near_something_larger import FAMILIES
from studies.study import Study

Floats: TypeAlias = NDArray[np.float64]

# The quantities of every decision, by its name and the name of the case.
Quantities: TypeAlias = dict[str, dict[str, Floats]]

DECISIONS = (*bifurc.decisions.TABLE.values(), *linkages.decisions.TABLE.values())
SETTINGS = SearchSettings(budget=30.0)  # no case may hold up the study
LOWEST, HIGHEST = (
    -18,
    4,
)  # decades of the histogram; what lies outside is put at its ends
CURVES = 40
DECADES = (2.0, 5.0, 8.0)  # of the members of families that end in something larger
DEGREE = 4  # of the random plane curves
BOX = [(-1.0, 1.0)] * 3  # in which surfaces in space lie
GAP = 3.0  # decades in which nothing lies on which a clear verdict was taken
NEAREST = 5  # cases on either side of a threshold that are named
PAGE = Path("docs/decisions.md")
MECHANISMS = Path("data/mechanisms.json")
MAPPED = (  # of the mechanisms there, those whose maps are quick
    "spatial RPRP, equal distances and opposite slopes",
    "planar RPRP",
    "planar slider-crank RRRP",
    "Sarrus with a P joint between base and platform",
    "Bennett geometry with joints CRCR",
    "K(2,3)",
    "Dixon I, K(3,3)",
    "three equal parallel cranks, pivots on a line",
)
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
    """Something to search, and what it is called."""

    name: str
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


def is_clear(decision: Decision, margin: Margin) -> bool:
    """Whether a decision stands in a gap of three decades, has a third answer, or is no
    verdict."""
    is_verdict = decision.role is Role.VERDICT
    return not is_verdict or bool(decision.third_answer) or margin.decades >= GAP


def nearest(decision: Decision, cases: dict[str, Floats]) -> str:
    """The cases with the quantities nearest to a threshold, in lines."""
    below: list[tuple[float, str]] = []
    above: list[tuple[float, str]] = []
    for name, quantities in cases.items():
        margin = margin_of(decision, quantities)
        if margin.count_below:
            below.append((margin.below, name))
        if margin.count_above:
            above.append((margin.above, name))
    lines = [heading(decision)]
    for number, name in sorted(below, reverse=True)[:NEAREST]:
        lines.append(f"  below, {number:.2e}: {name}")
    for number, name in sorted(above)[:NEAREST]:
        lines.append(f"  above, {number:.2e}: {name}")
    return "\n".join(lines)


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
        yield Case(name, partial(map_linkage, load(name), settings=SETTINGS))
        for number in range(members):
            values = entry.draw(rng)
            try:
                loop = entry.build(**values)
            except GeometryError:
                continue
            search = partial(map_linkage, loop, settings=SETTINGS)
            yield Case(f"{name}, member {number}", search)


def _near_bifurcations(count: int) -> Iterator[Case]:
    """Linkages off a bifurcating one by 1e-8 to 1e-2."""
    for number, miss in enumerate(near_misses(count, np.random.default_rng(0))):
        search = partial(explore, miss.problem, settings=SETTINGS)
        yield Case(f"near bifurcation {number}", search)


def _hard_curves() -> Iterator[Case]:
    """The curves of the stability study, each from its own start."""
    for number, crossing in enumerate(crossings()):
        problem = crossing.problem
        nothing = np.empty((0, problem.n))
        seeds = Seeds(
            crossing.start[None], np.ones(1, dtype=bool), np.empty(0), nothing
        )
        search = partial(explore, problem, seeds=seeds)
        yield Case(f"hard curve {number}", search)


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
    """Members of families that end in a surface, or in more motions, and these."""
    for family in FAMILIES:
        for decades in DECADES:
            member = family.member(10.0**-decades)
            search = partial(map_linkage, member, settings=SETTINGS)
            yield Case(f"{family.name}, 1e-{decades:g}", search)
        try:
            limit = family.member(0.0)
        except GeometryError:
            continue
        search = partial(map_linkage, limit, settings=SETTINGS)
        yield Case(f"{family.name}, 0", search)


def _surfaces() -> Iterator[Case]:
    """Surfaces, regular and singular ones, and curves along which F' has a lower
    rank."""
    zeros = (0.0,) * 5
    lengths, twists = (1.0, 1.0, 1.2, 0.9, 1.1), (1.0, 1.1, 1.2, 0.9, 0.8)
    problems: dict[str, Problem] = {
        "planar loop of five": Closure(Loop(lengths, zeros, zeros)),
        "spherical loop of five": Closure(Loop(zeros, twists, zeros)),
        "sphere": FunctionProblem(lambda u: [u @ u - 0.5], BOX),
        "cone": FunctionProblem(lambda u: [u[2] ** 2 - u[0] ** 2 - u[1] ** 2], BOX),
        "two planes": FunctionProblem(lambda u: [u[0] * u[1]], BOX),
        "plane and line": FunctionProblem(lambda u: [u[2] * u[0], u[2] * u[1]], BOX),
        "umbrella": FunctionProblem(lambda u: [u[0] ** 2 - u[1] ** 2 * u[2]], BOX),
        "double circle": FunctionProblem(lambda u: [(u @ u - 0.5) ** 2], BOX[:2]),
    }
    for name, problem in problems.items():
        yield Case(name, partial(explore, problem, settings=SETTINGS))


def _mechanisms() -> Iterator[Case]:
    """Known mechanisms with slides, and planar ones."""
    content = json.loads(MECHANISMS.read_text(encoding="utf-8"))
    for case in content["cases"]:
        if case["name"] not in MAPPED:
            continue
        if "bars" in case:
            mechanism = read_bars(case, case["name"])
        else:
            joints = tuple(Joint(**joint) for joint in case["joints"])
            mechanism = Mechanism(joints, case["name"])
        search = partial(_describe, mechanism)
        yield Case(case["name"], search)


def _describe(mechanism: Mechanism) -> None:
    """Map a mechanism and take what is said of it besides."""
    make_document(map_linkage(mechanism, settings=SETTINGS))


def _networks() -> Iterator[Case]:
    """Networks of Bennett loops under all pairs and triples of locks, and a route over
    their locks."""
    for name, entry in NETWORKS.items():
        yield Case(name, partial(_lock_all, entry.build()))
    four = NETWORKS["four-bennett-network"].build()
    start = NetworkPlace({"2": 0.7, "6": -1.3}, {"4": 0.5})
    goal = NetworkPlace({"1": 0.7, "5": 1.0}, {"4": 0.5})
    explore_locked = partial(map_linkage, settings=SETTINGS)
    search = partial(find_lock_route, four, start, goal, explore_locked)
    yield Case("route over locks", search)


def _lock_all(network: Network) -> None:
    """Assemble a network at random kinks of every two and every three joints."""
    rng = np.random.default_rng(0)
    for count in (2, 3):
        for axes in combinations(network.plan.ring, count):
            kinks = dict(zip(axes, rng.uniform(-np.pi, np.pi, count), strict=True))
            for states in assemble(network, kinks)[:3]:
                motion_at(network, axes, states).still(network.plan.ring)


def _plane_curves(count: int) -> Iterator[Case]:
    """Random plane curves."""
    rng = np.random.default_rng(0)
    for number in range(count):
        problem = random_curve(rng)
        yield Case(f"plane curve {number}", partial(explore, problem))


def _products_of_lines(count: int) -> Iterator[Case]:
    """Lines through one point, with numbers that are rounded, and next to one."""
    rng = np.random.default_rng(0)
    for number in range(count):
        lines = int(rng.integers(3, 12))
        apart = 0.0 if number % 2 else 10.0 ** -rng.uniform(2, 6)
        angles = np.pi * (np.arange(lines) + rng.uniform(0.1, 0.9, lines)) / lines
        normals = np.column_stack([np.cos(angles), np.sin(angles)])
        distances = normals @ rng.uniform(-1, 1, 2) + apart * rng.normal(size=lines)
        function = partial(_product_of_lines, normals, distances)
        problem = FunctionProblem(function, [(-2.0, 2.0)] * 2)
        name = f"{lines} lines {apart:.1e} from one point"
        yield Case(name, partial(explore, problem))


def _product_of_lines(
    normals: np.ndarray, distances: np.ndarray, u: np.ndarray
) -> list[float]:
    """The product of the distances of a point (2,) from lines."""
    pairs = zip(normals.tolist(), distances.tolist(), strict=True)
    product: float = np.prod([a * u[0] + b * u[1] - c for (a, b), c in pairs])
    return [product]


# --- the page -------------------------------------------------------------------------


def _gather(cases: Iterator[Case]) -> Quantities:
    """The quantities of every decision in every case."""
    gathered: Quantities = {one.name: {} for one in DECISIONS}
    for case in cases:
        margins: Margins
        with record_margins() as margins:
            case.search()
        for name, quantities in margins.items():
            joined = np.concatenate([np.empty(0), *quantities])
            gathered[name][case.name] = joined[~np.isnan(joined)]
    return gathered


def _joined(cases: dict[str, Floats]) -> Floats:
    """The quantities of all cases."""
    return np.concatenate([np.empty(0), *cases.values()])


HEAD = """# Decisions, and how clear they are

What *counted*, *certified*, *estimated*, *in doubt* and *undecided* mean stands in [how sure](how_sure.md).

Every comparison on which a count, a kind, a level or a word hangs compares one quantity with one threshold. They stand
in the tables `decisions.toml` of both packages; singular values and residuals are over the problem's magnitude,
lengths over its scale. `python -m studies.margins --page` writes this page: it notes every quantity that was decided on
over the catalogue, random members of its linkages, linkages that nearly bifurcate or end in something larger, surfaces,
mechanisms, networks, hard cases, random plane curves and lines.
`python -m studies.margins --nearest "same point"` says in which cases the quantities of a decision lie nearest to
its threshold.

A *verdict* decides a count, a kind, a level or a word. Its threshold stands in an empty gap of three decades or more.
Where the truth itself has no gap (a linkage may miss a condition by any amount), it has a *third answer*: what is said
where the quantity is neither plainly small nor plainly large. A *look* decides only whether something is looked at more
closely, and a *convention* only what is listed or in which order: neither needs a gap.
"""


def page(quantities: dict[str, Floats]) -> str:
    """The page of the docs, as Markdown."""
    parts = [HEAD, _unclear(quantities), "## The table\n"]
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


def _unclear(quantities: dict[str, Floats]) -> str:
    """Which verdicts are not clear, in a sentence."""
    names = [
        f"*{one.name}*"
        for one in DECISIONS
        if not is_clear(one, margin_of(one, quantities[one.name]))
    ]
    text = f"Verdicts with neither: {', '.join(names) or 'none'}."
    return textwrap.fill(text, WIDTH) + "\n"


def _entry(decision: Decision, quantities: Floats) -> str:
    """What a decision says, and its margin, as an item of a list."""
    margin = margin_of(decision, quantities)
    text = (
        f"{heading(decision)} {decision.claim}. Quantity: {decision.quantity}; "
        f"{decision.reason}. {_margin_text(margin)}"
    )
    if decision.third_answer:
        text += f" Third answer: {decision.third_answer}."
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


@click.command(cls=Study)
@click.option("--members", default=2, help="random members of each linkage")
@click.option("--near", default=60, help="linkages that nearly bifurcate")
@click.option("--page", "target", is_flag=True, help=f"write {PAGE}")
@click.option(
    "--nearest",
    "name",
    type=click.Choice([one.name for one in DECISIONS]),
    help="name the cases nearest to the threshold of this decision",
)
def main(members: int, near: int, target: bool, name: str | None) -> None:
    """Print how clear every decision is."""

    def cases() -> Iterator[Case]:
        yield from _catalogue_cases(members)
        yield from _near_bifurcations(near)
        yield from _near_something_larger()
        yield from _surfaces()
        yield from _mechanisms()
        yield from _networks()
        yield from _hard_curves()
        yield from _plane_curves(CURVES)
        yield from _products_of_lines(CURVES)

    gathered = _gather(cases())
    if name is not None:
        (decision,) = (one for one in DECISIONS if one.name == name)
        click.echo(nearest(decision, gathered[name]))
        return
    text = page({one: _joined(own) for one, own in gathered.items()})
    if target:
        PAGE.write_text(text, encoding="utf-8")
    else:
        click.echo(text)


if __name__ == "__main__":
    main()
