"""An atlas against the points that a source prints."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from bifurc import Atlas, Kind, Level, diagram_of
from studies.textbook.problems import PointKind, PrintedPoint, TextbookProblem

UNITS = 1.0  # of the last digit: some sources round, and some cut off


class Verdict(StrEnum):
    """What an answer is worth."""

    RIGHT = "right"
    # Points that the source prints are missing, or it is said that some may be.
    IN_DOUBT = "in doubt"
    # They are missing without a word.
    WRONG = "wrong"


@dataclass(frozen=True)
class Match:
    """The point of an atlas next to a ``printed`` one, and how many units of the last
    digit printed lie between them; infinite where there is none of its kind."""

    printed: PrintedPoint
    found: dict[str, float] | None
    units: float

    @property
    def is_met(self) -> bool:
        """Whether the point is there, to all digits."""
        return self.units <= UNITS


@dataclass(frozen=True)
class Comparison:
    """The ``matches`` of all printed points, and the numbers of forms, of limit points
    along the parameter, of bifurcations and of Hopf points. ``seconds`` are those of
    the processor."""

    problem: TextbookProblem
    matches: tuple[Match, ...]
    forms: int
    limits: int
    bifurcations: int
    hopf_points: int
    verdict: Verdict
    statement: str
    seconds: float


def compare(problem: TextbookProblem, atlas: Atlas, seconds: float) -> Comparison:
    """How an atlas answers a problem."""
    matches = tuple(_match(problem, atlas, point) for point in problem.points)
    assert atlas.diagram is not None
    is_open = (
        atlas.completeness.is_in_doubt
        or atlas.completeness.level is Level.OUT_OF_TIME
        or any(point.kind is Kind.UNDECIDED for point in atlas.points)
    )
    are_met = bool(atlas.forms) and all(match.is_met for match in matches)
    verdict = Verdict.RIGHT if are_met else Verdict.WRONG
    return Comparison(
        problem=problem,
        matches=matches,
        forms=len(atlas.forms),
        limits=len(atlas.diagram.folds),
        bifurcations=len(atlas.bifurcations),
        hopf_points=len(atlas.diagram.hopf_points),
        verdict=Verdict.IN_DOUBT if is_open else verdict,
        statement=atlas.completeness.statement,
        seconds=seconds,
    )


def _match(problem: TextbookProblem, atlas: Atlas, printed: PrintedPoint) -> Match:
    places = _places(problem, atlas, printed)
    found = [problem.named(place) for place in places]
    units = [printed.units_off(place, problem.accuracy) for place in found]
    if not units:
        return Match(printed, None, np.inf)
    best = int(np.argmin(units))
    return Match(printed, found[best], units[best])


def _places(
    problem: TextbookProblem, atlas: Atlas, printed: PrintedPoint
) -> list[np.ndarray]:
    """The points of an atlas that may be the printed one."""
    if printed.kind is PointKind.BIFURCATION:
        return [point.point.u for point in atlas.bifurcations]
    if printed.kind is PointKind.HOPF:
        assert atlas.diagram is not None
        return [point.u for point in atlas.diagram.hopf_points]
    if printed.kind is PointKind.START:
        names = problem.problem.domain.names
        start = np.array([float(printed.values[name]) for name in names])
        nearest = [form.branch.nearest(start)[1] for form in atlas.forms]
        pairs = zip(atlas.forms, nearest, strict=True)
        return [form.branch(places[0]) for form, places in pairs]
    along = printed.along
    if printed.kind is PointKind.LIMIT:
        seen = diagram_of(problem.problem, atlas, along, is_flow=False)
        return [point.u for point in seen.folds]
    value = float(printed.values[along])
    events = {"target": (along, value)}
    seen = diagram_of(problem.problem, atlas, problem.parameter, events, is_flow=False)
    return [point.u for point in seen.events("target")]
