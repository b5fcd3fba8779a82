"""Curves with known answers, in any units: how many come out right.

Every curve of `data/curves.json` has a source and a known number of forms, closed and
open, of bifurcations with their half-branches, of cusps, of points where the rank drops
on a single branch, and of isolated points; its forms have multiplicities, 1 as a rule.
A cusp ends a form; through a point like that of x^3 = y^4, with half-branches to
opposite sides, a single one passes. Some have a parameter, and a known number of folds,
Hopf points and events along it; some are known with noise only. Each is explored as it stands, with its unknowns or
its equations in other units, turned, shifted, and from other random starts. An answer
is right, or wrong and said to be in doubt, or wrong without a word, as an exception is.
Seconds are those of the processor.

    python -m studies.curve_bank --changes plain --changes unknowns --seeds 2
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

from bifurc import Atlas, FunctionProblem, Kind, Level, SearchSettings, explore
from studies.study import Study, require_known

BANK = Path(__file__).parent.parent / "data" / "curves.json"
SCALES = (1e-6, 1e-3, 10.0, 1e3, 1e6)
SLOW = 5.0  # s, from which on an answer is listed
NAMES = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "tanh", "acosh")
OTHERS = ("exp", "log", "sqrt", "cbrt", "pi")
FUNCTIONS = {name: getattr(np, name) for name in (*NAMES, *OTHERS)}


class Answer(NamedTuple):
    """What is counted in an atlas: forms ``closed`` and ``open``, the numbers of
    half-branches of the ``bifurcations`` in order, ``cusps``, ``rank_drops``,
    ``isolated`` points, ``others`` (surfaces, points of another kind), the
    ``multiplicities`` of the forms in order, and of a diagram the ``folds``, ``hopf``
    points and ``events``."""

    closed: int
    open: int
    bifurcations: tuple[int, ...]
    cusps: int
    rank_drops: int
    isolated: int
    others: int = 0
    multiplicities: tuple[int, ...] = ()
    folds: int = 0
    hopf: int = 0
    events: int = 0

    @staticmethod
    def of(atlas: Atlas) -> Answer:
        """The answer of an atlas."""
        kinds = Counter(point.kind for point in atlas.points)
        closed = sum(form.branch.closed for form in atlas.forms)
        counted = (Kind.BIFURCATION, Kind.CUSP, Kind.RANK_DROP, Kind.ISOLATED)
        sizes = [len(point.point.half_branches) for point in atlas.bifurcations]
        diagram = atlas.diagram
        return Answer(
            closed=closed,
            open=len(atlas.forms) - closed,
            bifurcations=tuple(sorted(sizes)),
            cusps=kinds[Kind.CUSP],
            rank_drops=kinds[Kind.RANK_DROP],
            isolated=kinds[Kind.ISOLATED] + len(atlas.rigid),
            others=len(atlas.surfaces)
            + sum(kinds[kind] for kind in kinds if kind not in counted),
            multiplicities=tuple(sorted(form.multiplicity for form in atlas.forms)),
            folds=0 if diagram is None else len(diagram.folds),
            hopf=0 if diagram is None else len(diagram.hopf_points),
            events=0 if diagram is None else len(diagram.events()),
        )


@dataclass(frozen=True)
class Curve:
    """A curve with its ``equations`` in the ``unknowns``, ``bounds`` (n, 2) and
    ``periods`` (n,), its ``source`` and its right ``answer``; with a diagram along the
    ``parameter``, empty where there is none, and ``events`` where functions are zero.
    Where there is ``noise``, a standard deviation, the equations are plain values."""

    name: str
    source: str
    unknowns: tuple[str, ...]
    equations: tuple[str, ...]
    bounds: np.ndarray
    periods: np.ndarray
    answer: Answer
    parameter: str
    events: tuple[str, ...]
    noise: float

    def function(self) -> Callable[[np.ndarray], list[Any]]:
        """F (m,) of a point (n,)."""
        exact = self._values_of(self.equations)
        if not self.noise:
            return exact
        rng = np.random.default_rng(0)

        def noisy(point: np.ndarray) -> list[Any]:
            values = exact(np.array(np.real(point).tolist()))
            return [value + self.noise * rng.normal() for value in values]

        return noisy

    def event_functions(self) -> list[Callable[[np.ndarray], list[Any]]]:
        """What is zero at each event, as a list of one, of a point (n,)."""
        return [self._values_of((text,)) for text in self.events]

    def _values_of(self, texts: Sequence[str]) -> Callable[[np.ndarray], list[Any]]:
        codes = [compile(text, self.name, "eval") for text in texts]

        def values(point: np.ndarray) -> list[Any]:
            names = dict(zip(self.unknowns, point, strict=True))
            return [eval(code, FUNCTIONS, names) for code in codes]

        return values


def load_curves() -> list[Curve]:
    """The curves of the bank."""
    return [_curve(entry) for entry in json.loads(BANK.read_text())]


def _curve(entry: dict[str, Any]) -> Curve:
    n = len(entry["unknowns"])
    simple = [1] * (entry["closed"] + entry["open"])
    periods = entry.get("periods", [None] * n)
    ends = ((-np.inf, np.inf),) * n
    bounds = [
        [end if value is None else value for value, end in zip(row, limit, strict=True)]
        for row, limit in zip(entry["bounds"], ends, strict=True)
    ]
    return Curve(
        name=entry["name"],
        source=entry["source"],
        unknowns=tuple(entry["unknowns"]),
        equations=tuple(entry["equations"]),
        bounds=np.array(bounds, dtype=float),
        periods=np.array([np.inf if p is None else p for p in periods]),
        answer=Answer(
            closed=entry["closed"],
            open=entry["open"],
            bifurcations=tuple(entry["bifurcations"]),
            cusps=entry["cusps"],
            rank_drops=entry["rank_drops"],
            isolated=entry["isolated"],
            multiplicities=tuple(entry.get("multiplicities", simple)),
            folds=entry.get("folds", 0),
            hopf=entry.get("hopf", 0),
            events=entry.get("event_count", 0),
        ),
        parameter=entry.get("parameter", ""),
        events=tuple(entry.get("events", ())),
        noise=entry.get("noise", 0.0),
    )


# --- other units ----------------------------------------------------------------------


@dataclass(frozen=True)
class Change:
    """Unknowns u = ``matrix`` v + ``shift`` and equations ``mixing`` F, with a
    ``name``, of a ``kind``."""

    kind: str
    name: str
    matrix: np.ndarray
    shift: np.ndarray
    mixing: np.ndarray

    def events(self, curve: Curve) -> dict[str, Callable[[np.ndarray], Any]] | None:
        """The events of the curve in v, None where there are none."""

        def changed(event: Callable[[np.ndarray], list[Any]], point: np.ndarray) -> Any:
            return event(self.matrix @ point + self.shift)[0]

        functions = curve.event_functions()
        named = zip(curve.events, functions, strict=True)
        return {name: partial(changed, function) for name, function in named} or None

    def problem(self, curve: Curve) -> FunctionProblem:
        """The curve's equations so changed, in v."""
        function = curve.function()

        def changed(point: np.ndarray) -> np.ndarray:
            values = np.array(function(self.matrix @ point + self.shift))
            mixed: np.ndarray = self.mixing @ values
            return mixed

        inverse = np.linalg.inv(self.matrix)
        is_diagonal = np.array_equal(self.matrix, np.diag(np.diag(self.matrix)))
        bounds = curve.bounds - self.shift[:, None]
        if is_diagonal:
            bounds = np.diag(inverse)[:, None] * bounds
            periods = np.diag(inverse) * curve.periods
            names = curve.unknowns
            return FunctionProblem(changed, bounds, periods=periods, names=names)
        corners = np.array(list(product(*bounds))) @ inverse.T
        around = np.column_stack([corners.min(axis=0), corners.max(axis=0)])
        return FunctionProblem(changed, around.tolist())


def changes_of(curve: Curve) -> Iterator[Change]:
    """The curve as it stands, and its changes: five scales of the unknowns, the same for
    the last of them alone, five of the equations, mixed equations, a shift and two
    turns.

    Turns are for closed curves that leave no bounds, and not for angles or a parameter;
    mixed equations are for those that are no rates, of which there are Hopf points.
    """
    plain = _unchanged(curve)
    yield plain
    for scale in SCALES:
        yield from _scaled(curve, plain, scale)
    rng = np.random.default_rng(0)
    mixed = _mixed(plain, rng)
    if not curve.answer.hopf:
        yield mixed
    shift = rng.normal(size=len(curve.unknowns))
    yield replace(plain, kind="shift", name="shifted", shift=shift)
    if _can_be_turned(curve):
        yield from _turned(plain, rng)


def _unchanged(curve: Curve) -> Change:
    """The curve as it stands."""
    n, m = len(curve.unknowns), len(curve.equations)
    return Change("plain", "plain", np.eye(n), np.zeros(n), np.eye(m))


def _scaled(curve: Curve, plain: Change, scale: float) -> Iterator[Change]:
    """The unknowns, the last one and the first equation in other units."""
    n, m = len(curve.unknowns), len(curve.equations)
    unknowns = scale * plain.matrix
    last = np.diag([1.0] * (n - 1) + [scale])
    first = np.diag([scale] + [1.0] * (m - 1))
    text = f"{scale:g}"
    yield replace(plain, kind="unknowns", name=f"unknowns {text}", matrix=unknowns)
    yield replace(plain, kind="unknown", name=f"last unknown {text}", matrix=last)
    if not curve.answer.hopf:
        name = f"first equation {text}"
        yield replace(plain, kind="equations", name=name, mixing=first)


def _mixed(plain: Change, rng: np.random.Generator) -> Change:
    """Combinations of the equations, of sizes from 1 to 5."""
    m = len(plain.mixing)
    turn = np.linalg.qr(rng.normal(size=(m, m)))[0]
    mixing = turn @ np.diag(np.geomspace(1, 5, m))
    return replace(plain, kind="mixed", name="mixed equations", mixing=mixing)


def _can_be_turned(curve: Curve) -> bool:
    """Whether all forms are closed, and no unknown is an angle or a parameter."""
    has_angles = bool(np.any(np.isfinite(curve.periods)))
    is_bounded = bool(np.all(np.isfinite(curve.bounds)))
    is_closed = not curve.answer.open
    return is_closed and is_bounded and not has_angles and not curve.parameter


def _turned(plain: Change, rng: np.random.Generator) -> Iterator[Change]:
    """Two turns of the unknowns."""
    n = len(plain.shift)
    for number in (1, 2):
        turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
        yield replace(plain, kind="turned", name=f"turned {number}", matrix=turn)


# --- verdicts -------------------------------------------------------------------------


class Verdict(StrEnum):
    """What an answer is worth."""

    RIGHT = "right"
    # It is wrong, and says that it may be.
    IN_DOUBT = "in doubt"
    # It is wrong without a word.
    WRONG = "wrong"


def judge(curve: Curve, atlas: Atlas) -> Verdict:
    """Whether an atlas gives the curve's answer, or else says that it is in doubt."""
    if Answer.of(atlas) == curve.answer:
        return Verdict.RIGHT
    is_undecided = any(
        point.kind is Kind.UNDECIDED or point.note for point in atlas.points
    )
    is_in_doubt = atlas.completeness.is_in_doubt
    is_late = atlas.completeness.level is Level.OUT_OF_TIME
    is_open = is_undecided or is_in_doubt or is_late
    return Verdict.IN_DOUBT if is_open else Verdict.WRONG


class Run(NamedTuple):
    """One curve, or what else has a known answer, in one change from one seed."""

    name: str
    change: Change
    seed: int
    verdict: Verdict
    answer: object
    seconds: float


def run_curve(curve: Curve, change: Change, seed: int, budget: float) -> Run:
    """The verdict on one answer, found within a ``budget`` of seconds."""
    began = time.process_time()
    answer: Answer | str
    try:
        settings = SearchSettings(budget=budget)
        atlas = explore(
            change.problem(curve),
            settings=settings,
            seed=seed,
            parameter=curve.parameter or None,
            events=change.events(curve),
        )
        verdict, answer = judge(curve, atlas), Answer.of(atlas)
    except Exception as error:  # whatever it is, a user would see it
        verdict, answer = Verdict.WRONG, f"{type(error).__name__}: {error}"
    seconds = time.process_time() - began
    return Run(curve.name, change, seed, verdict, answer, seconds)


def _print_run(run: Run) -> None:
    """One line for an answer that is not right, or slow."""
    where = f"{run.name}, {run.change.name}, seed {run.seed}"
    if run.verdict is not Verdict.RIGHT:
        print(f"{run.verdict}: {where}: {run.answer}", flush=True)
    if run.seconds > SLOW:
        print(f"slow: {where}: {run.seconds:.1f} s", flush=True)


def print_table(runs: Sequence[Run]) -> None:
    """Counts by kind of change."""
    print("| change | answers | right | in doubt | wrong | median s | most s |")
    print("|---|---|---|---|---|---|---|")
    kinds = list(dict.fromkeys(run.change.kind for run in runs))
    for kind in [*kinds, "all"]:
        group = [run for run in runs if kind in (run.change.kind, "all")]
        counts = Counter(run.verdict for run in group)
        seconds = [run.seconds for run in group]
        cells = [kind, len(group), *(counts[verdict] for verdict in Verdict)]
        cells += [f"{np.median(seconds):.2g}", f"{max(seconds):.2g}"]
        print("| " + " | ".join(map(str, cells)) + " |")


@click.command(cls=Study, help=__doc__)
@click.option(
    "--changes", "kinds", multiple=True, help="Kind of change.  [default: all]"
)
@click.option("--names", multiple=True, help="A curve.  [default: all]")
@click.option("--seeds", default=1, show_default=True, help="Random seeds from 0 on.")
@click.option("--budget", default=60.0, show_default=True, help="Seconds for each.")
@click.option("--every", default=1, show_default=True, help="Only each k-th answer.")
def main(
    kinds: tuple[str, ...],
    names: tuple[str, ...],
    seeds: int,
    budget: float,
    every: int,
) -> None:
    """Run the bank and print what is not right, and the table."""
    curves = load_curves()
    require_known("--names", names, [curve.name for curve in curves])
    changes = [change.kind for curve in curves for change in changes_of(curve)]
    require_known("--changes", kinds, changes)
    runs: list[Run] = []
    count = 0
    for curve, change, seed in _questions(kinds, names, seeds):
        count += 1
        if count % every:
            continue
        run = run_curve(curve, change, seed, budget)
        _print_run(run)
        runs.append(run)
    print_table(runs)


def _questions(
    kinds: Sequence[str], names: Sequence[str], seeds: int
) -> Iterator[tuple[Curve, Change, int]]:
    """Every curve with every change and every seed, those that are named or all."""
    for curve in load_curves():
        if names and curve.name not in names:
            continue
        for change in changes_of(curve):
            if kinds and change.kind not in kinds:
                continue
            for seed in range(seeds):
                yield curve, change, seed


if __name__ == "__main__":
    main()
