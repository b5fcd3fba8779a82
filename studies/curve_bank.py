"""Curves with known answers, in five scales of the unknowns and five of the equations.

    python -m studies.curve_bank [--only TEXT] [--seed 0] [--own-scale] [--budget 20]

`data/curves.json` lists curves with the number of forms, bifurcations, cusps and
isolated points that they have, and a source for each. A run of one of them is right,
or undecided, if the atlas says that it is in doubt, or silently wrong. Equations are
scaled row by row, each by another power of the factor.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
import sympy

import bifurc
from bifurc.equations.expression import Part, parse_expression
from bifurc.text_tables import table

__all__ = ["Answer", "BankCurve", "Outcome", "Scales", "judge", "load_bank", "run"]

BANK = Path(__file__).parents[1] / "data" / "curves.json"
FACTORS = (1.0, 1e-6, 1e-3, 1e3, 1e6)


class Outcome(StrEnum):
    """What an answer is worth."""

    RIGHT = "right"
    UNDECIDED = "undecided"
    SILENT_WRONG = "silent wrong"


class Answer(NamedTuple):
    """How many there are of each kind."""

    forms: int
    bifurcations: int
    cusps: int
    isolated: int


class Scales(NamedTuple):
    """Factors of the unknowns without a period, and of the equations."""

    unknowns: float = 1.0
    equations: float = 1.0


@dataclass(frozen=True)
class BankCurve:
    """A curve of the bank: ``equations`` as texts, bounds of the ``unknowns``, their
    ``periods`` as texts, and what is known of it."""

    name: str
    equations: Sequence[str]
    unknowns: dict[str, tuple[float, float]]
    periods: dict[str, str]
    expected: Answer

    def problem(self, scales: Scales) -> bifurc.SymbolicProblem:
        """Its equations in other units."""
        own = {name: Part(sympy.Symbol(name)) for name in self.unknowns}
        constants: dict[str, Part] = {}
        periods = {
            name: float(parse_expression(text, constants).value or 0.0)
            for name, text in self.periods.items()
        }
        factors = {
            name: 1.0 if name in periods else scales.unknowns for name in self.unknowns
        }
        changed = {
            part.expression: part.expression / sympy.Float(factors[name], 30)
            for name, part in own.items()
            if factors[name] != 1.0
        }
        expressions = []
        for row, text in enumerate(self.equations):
            left, _, right = text.partition("=")
            difference = (
                parse_expression(left, own).expression
                - parse_expression(right or "0", own).expression
            )
            weight = scales.equations ** (1.0 if row % 2 == 0 else -1.0)
            expressions.append(weight * difference.subs(changed))
        bounds = [
            (factors[name] * low, factors[name] * high)
            for name, (low, high) in self.unknowns.items()
        ]
        for k, name in enumerate(self.unknowns):
            if name in periods:
                bounds[k] = (0.0, periods[name])
        return bifurc.SymbolicProblem(
            expressions,
            [own[name].expression for name in self.unknowns],
            bounds,
            periods=[periods.get(name, np.inf) for name in self.unknowns],
        )


def load_bank() -> list[BankCurve]:
    """The curves of the bank."""
    content = json.loads(BANK.read_text(encoding="utf-8"))
    return [_curve(entry) for entry in content["curves"]]


def _curve(entry: dict[str, Any]) -> BankCurve:
    return BankCurve(
        name=entry["name"],
        equations=entry["equations"],
        unknowns={name: tuple(ends) for name, ends in entry["unknowns"].items()},
        periods=entry.get("periods", {}),
        expected=Answer(*(entry[key] for key in Answer._fields)),
    )


# --- runs -----------------------------------------------------------------------------


class Run(NamedTuple):
    """One run: what came out, what that is worth, and the seconds it took."""

    curve: str
    scales: Scales
    answer: Answer | str
    outcome: Outcome
    seconds: float


def answer_of(atlas: bifurc.Atlas) -> Answer:
    """How many there are of each kind in an atlas."""
    kinds = Counter(point.kind for point in atlas.points)
    return Answer(
        forms=len(atlas.forms),
        bifurcations=kinds[bifurc.Kind.BIFURCATION],
        cusps=kinds[bifurc.Kind.CUSP],
        isolated=kinds[bifurc.Kind.ISOLATED] + len(atlas.rigid),
    )


def judge(atlas: bifurc.Atlas, expected: Answer) -> Outcome:
    """What an atlas is worth where the ``expected`` answer is known."""
    if answer_of(atlas) == expected:
        return Outcome.RIGHT
    is_open = any(point.kind is bifurc.Kind.UNDECIDED for point in atlas.points)
    is_in_doubt = atlas.completeness.statement.startswith("in doubt")
    is_late = atlas.completeness.level is bifurc.Level.OUT_OF_TIME
    if is_open or is_in_doubt or is_late:
        return Outcome.UNDECIDED
    return Outcome.SILENT_WRONG


def run(curve: BankCurve, scales: Scales, seed: int, budget: float) -> Run:
    """One run; an exception counts as silently wrong."""
    settings = bifurc.SearchSettings(budget=budget)
    began = time.perf_counter()
    try:
        problem = curve.problem(scales)
        atlas = bifurc.explore(problem, settings=settings, seed=seed)
    except Exception as error:  # whatever it is, a user would see it
        seconds = time.perf_counter() - began
        words = f"{type(error).__name__}: {error}"
        return Run(curve.name, scales, words, Outcome.SILENT_WRONG, seconds)
    seconds = time.perf_counter() - began
    outcome = judge(atlas, curve.expected)
    return Run(curve.name, scales, answer_of(atlas), outcome, seconds)


def all_scales() -> Iterator[Scales]:
    """Five scales of the unknowns, and then five of the equations."""
    for factor in FACTORS:
        yield Scales(unknowns=factor)
    for factor in FACTORS[1:]:
        yield Scales(equations=factor)


# --- report ---------------------------------------------------------------------------


def summary(runs: Sequence[Run]) -> str:
    """Right, undecided and silently wrong, for each pair of scales."""
    rows = []
    for scales in dict.fromkeys(one.scales for one in runs):
        own = [one for one in runs if one.scales == scales]
        counts = Counter(one.outcome for one in own)
        median = 1e3 * np.median([one.seconds for one in own])
        row = [f"{scales.unknowns:g}", f"{scales.equations:g}"]
        row += [str(counts[outcome]) for outcome in Outcome]
        rows.append([*row, f"{median:.0f}", f"{max(o.seconds for o in own):.1f}"])
    heads = ["unknowns x", "equations x", *Outcome, "median ms", "longest s"]
    return table(heads, rows)


def failures(runs: Sequence[Run], bank: Sequence[BankCurve]) -> str:
    """Every run that was not right."""
    expected = {curve.name: curve.expected for curve in bank}
    rows = []
    for one in runs:
        if one.outcome is Outcome.RIGHT:
            continue
        shown = one.answer
        if isinstance(shown, Answer):
            shown = " ".join(map(str, shown))
        wanted = " ".join(map(str, expected[one.curve]))
        scales = f"{one.scales.unknowns:g} {one.scales.equations:g}"
        rows.append([one.outcome.value, one.curve, scales, wanted, shown[:60]])
    heads = ("outcome", "curve", "scales", "known", "found")
    return table(heads, rows)


@click.command()
@click.option("--only", default="", help="Curves whose name holds this text.")
@click.option("--seed", default=0, help="Seed of the random starts.")
@click.option("--own-scale", is_flag=True, help="Each curve as it is listed only.")
@click.option("--budget", default=20.0, help="Seconds for each run.")
def main(only: str, seed: int, own_scale: bool, budget: float) -> None:
    """Run the bank and print what came out."""
    bank = [curve for curve in load_bank() if only in curve.name]
    scales = [Scales()] if own_scale else list(all_scales())
    runs = []
    for curve in bank:
        for pair in scales:
            runs.append(run(curve, pair, seed, budget))
    click.echo(summary(runs))
    click.echo("\nnot right (forms, bifurcations, cusps, isolated points)")
    click.echo(failures(runs, bank))


if __name__ == "__main__":
    main()
