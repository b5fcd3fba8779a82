"""The problems and the points that their sources print, as data.

`data/textbook_problems.json` names a file of `data/problems` or a discretised problem
for each, and the points: numbers as they are printed, in texts, so that their digits
are known.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from bifurc import (
    Atlas,
    EquationSystem,
    FunctionProblem,
    SearchSettings,
    Seeds,
    explore,
    read_equations,
)
from studies.textbook.discretised import DISCRETISED

DATA = Path(__file__).parents[2] / "data"


class PointKind(StrEnum):
    """What a source says of a point."""

    # An unknown turns back there.
    LIMIT = "limit"
    # An unknown has a value that is looked for.
    TARGET = "target"
    BIFURCATION = "bifurcation"
    HOPF = "hopf"
    # A curve begins there.
    START = "start"


@dataclass(frozen=True)
class PrintedPoint:
    """A point as a source prints it: ``at``, numbers by the names of unknowns.

    ``along`` is the unknown that turns back, or has the value that is looked for.
    ``misprints`` are the numbers that are right where the printed ones are not, and
    ``remark`` says why.
    """

    kind: PointKind
    along: str
    at: Mapping[str, Decimal]
    misprints: Mapping[str, Decimal]
    remark: str

    @property
    def values(self) -> Mapping[str, Decimal]:
        """The right numbers, misprints put right."""
        return {**self.at, **self.misprints}

    def units_off(self, found: Mapping[str, float], accuracy: float) -> float:
        """How many units of the last digit printed a point is off, at most; a unit is
        no less than the ``accuracy`` of the source, times 1 + |x|."""
        off = [0.0]
        for name, value in self.values.items():
            exponent = value.as_tuple().exponent
            assert isinstance(exponent, int)
            rounding = accuracy * (1.0 + abs(float(value)))
            unit = max(10.0**exponent if exponent < 0 else 1e-7, rounding)
            off.append(abs(found[name] - float(value)) / unit)
        return max(off)


@dataclass(frozen=True)
class TextbookProblem:
    """A problem of a ``collection``, its ``source`` and the ``points`` printed there.

    It stands in a ``file`` with ``values`` of its constants, or is ``discretised``.
    ``accuracy`` is that which the source claims, 0 where all digits are meant. Where
    ``is_from_start``, random starts reach nothing or cost too much, and the search
    begins at the source's start alone.
    """

    name: str
    collection: str
    source: str
    file: str
    values: Mapping[str, float]
    discretised: str
    accuracy: float
    is_from_start: bool
    points: tuple[PrintedPoint, ...]
    remark: str

    @cached_property
    def system(self) -> EquationSystem | None:
        """What its file says; None for a discretised problem."""
        if not self.file:
            return None
        return read_equations(DATA / "problems" / self.file, self.values)

    @cached_property
    def problem(self) -> FunctionProblem:
        """Its equations."""
        if self.system is not None:
            return self.system.problem
        return DISCRETISED[self.discretised]()

    @property
    def parameter(self) -> str:
        """The unknown along which it is looked at."""
        named = None if self.system is None else self.system.parameter
        return named or self.problem.domain.names[-1]

    def explore(self, seed: int, budget: float) -> Atlas:
        """Its atlas, found from a random ``seed`` within a ``budget`` of seconds."""
        settings = SearchSettings(budget=budget)
        is_flow = self.system is not None and self.system.is_flow
        return explore(
            self.problem,
            settings=settings,
            seed=seed,
            seeds=self._seeds(),
            parameter=self.parameter,
            is_flow=is_flow,
        )

    def _seeds(self) -> Seeds | None:
        """The source's start, where the search begins there alone."""
        if not self.is_from_start:
            return None
        (start,) = [point for point in self.points if point.kind is PointKind.START]
        values = [float(start.values[name]) for name in self.problem.domain.names]
        return Seeds(
            points=np.array([values]),
            random=np.zeros(1, dtype=bool),
            gaps=np.empty(0),
            missed=np.empty((0, self.problem.n)),
        )

    def named(self, point: np.ndarray) -> dict[str, float]:
        """The unknowns (n,) of a point by their names."""
        return dict(zip(self.problem.domain.names, point.tolist(), strict=True))


def load_problems() -> list[TextbookProblem]:
    """All of them, in the order of the collections."""
    text = (DATA / "textbook_problems.json").read_text(encoding="utf-8")
    return [_problem(entry) for entry in json.loads(text)]


def _problem(entry: Mapping[str, Any]) -> TextbookProblem:
    return TextbookProblem(
        name=entry["name"],
        collection=entry["collection"],
        source=entry["source"],
        file=entry.get("file", ""),
        values=entry.get("values", {}),
        discretised=entry.get("discretised", ""),
        accuracy=entry.get("accuracy", 0.0),
        is_from_start=entry.get("from_start", False),
        points=tuple(_point(point) for point in entry["points"]),
        remark=entry.get("remark", ""),
    )


def _point(entry: Mapping[str, Any]) -> PrintedPoint:
    return PrintedPoint(
        kind=PointKind(entry["kind"]),
        along=entry.get("along", ""),
        at={name: Decimal(text) for name, text in entry["at"].items()},
        misprints={k: Decimal(v) for k, v in entry.get("misprints", {}).items()},
        remark=entry.get("remark", ""),
    )
