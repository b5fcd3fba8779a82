"""What the runs of the work-precision study say."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from studies.work_precision_runs import Run

TOLERANCES = tuple(10.0**-k for k in range(3, 15))
TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
DEFAULT_ORDER = 16
ENOUGH = 1e-12  # error that the recommended tolerance reaches
NOISE = 0.05  # by how much mean ratios differ from run to run
POINT_BY_POINT = "pseudo-arclength, tangent"

RatioRow: TypeAlias = dict[str, str | float]


class Advice(NamedTuple):
    """What an order takes to reach an error: the geometric mean over the curves of its
    time over that of the fastest order, and the loosest tolerance that does it on the
    most curves."""

    ratio: float
    tolerance: float


def fastest(runs: Iterable[Run], error: float) -> float:
    """The least time of the runs within an error; nan where none is."""
    return min((run.seconds for run in runs if run.error <= error), default=np.nan)


def _cases(runs: Iterable[Run]) -> list[str]:
    return list(dict.fromkeys(run.case for run in runs))


def ratios(runs: Sequence[Run]) -> list[RatioRow]:
    """For each curve, comparison method and target error: how many times longer it
    takes than this project."""
    rows = []
    for case in _cases(runs):
        on_curve = [run for run in runs if run.case == case]
        ours = [run for run in on_curve if run.order == DEFAULT_ORDER]
        for method in dict.fromkeys(run.method for run in on_curve if not run.order):
            theirs = [run for run in on_curve if run.method == method]
            row: RatioRow = {"case": case, "method": method}
            for target in TARGETS:
                row[f"{target:.0e}"] = fastest(theirs, target) / fastest(ours, target)
            rows.append(row)
    return rows


def recommend(runs: Sequence[Run], error: float = ENOUGH) -> dict[int, Advice]:
    """What each order of this project takes to reach ``error``. Curves that no order
    brings there are left out."""
    ours = [run for run in runs if run.order]
    best = {}
    for case in _cases(runs):
        seconds = fastest((run for run in ours if run.case == case), error)
        if np.isfinite(seconds):
            best[case] = seconds
    advice = {}
    for order in sorted({run.order for run in ours}):
        reached = [run for run in ours if run.order == order and run.case in best]
        slower = []
        for case, seconds in best.items():
            on_curve = (run for run in reached if run.case == case)
            slower.append(fastest(on_curve, error) / seconds)
        mean = float(np.exp(np.mean(np.log(slower))))
        advice[order] = Advice(mean, _loosest_tolerance(reached, error))
    return advice


def _loosest_tolerance(runs: Sequence[Run], error: float) -> float:
    """The loosest of the tolerances at which the most runs are within an error."""
    counts = {}
    for tolerance in TOLERANCES:
        at_tolerance = [run for run in runs if run.tolerance == tolerance]
        counts[tolerance] = sum(run.error <= error for run in at_tolerance)
    return max(counts, key=lambda tolerance: (counts[tolerance], tolerance))


def points_in_our_time(runs: Sequence[Run], case: str, error: float) -> float:
    """Points a second that pseudo-arclength continuation with the tangent would have to
    make to be as fast: what it needs for an error on a curve, over the time of this
    project at the default order. nan where one does not get there.
    """
    within = [run for run in runs if run.case == case and run.error <= error]
    theirs = [run.points for run in within if run.method == POINT_BY_POINT]
    ours = [run for run in within if run.order == DEFAULT_ORDER]
    return min(theirs, default=np.nan) / fastest(ours, error)


def _best_order(advice: Mapping[int, Advice]) -> int:
    """The fastest order; the default one unless it is slower by more than runs
    differ."""
    finite = [order for order in advice if np.isfinite(advice[order].ratio)]
    best = min(finite, key=lambda order: advice[order].ratio, default=DEFAULT_ORDER)
    ours = advice[DEFAULT_ORDER].ratio if DEFAULT_ORDER in advice else np.inf
    return DEFAULT_ORDER if ours <= (1 + NOISE) * advice[best].ratio else best


def summarise(runs: Sequence[Run], floors: Mapping[str, float]) -> str:
    """The findings in words."""
    lines = ["Distance of the exact curve to the solution set, in 40 digits:"]
    lines += [f"  {case}: {floor:.1e}" for case, floor in floors.items()]
    lines += ["", *_order_lines(recommend(runs))]
    lines += ["", *_ratio_lines(ratios(runs))]
    lines += ["", *_rate_lines(runs)]
    return "\n".join(lines) + "\n"


def _order_lines(advice: Mapping[int, Advice]) -> list[str]:
    lines = [
        "Time to reach 1e-12, over the fastest order (geometric mean; nan: not reached "
        "on every curve):"
    ]
    for order, (ratio, tolerance) in advice.items():
        lines.append(f"  order {order}: {ratio:.2f}, with tolerance {tolerance:.0e}")
    best = _best_order(advice)
    tolerance = advice[best].tolerance
    lines.append(f"The default should be order {best} and tolerance {tolerance:.0e}.")
    return lines


def _ratio_lines(rows: Sequence[RatioRow]) -> list[str]:
    lines = [
        "Time over that of this project (order 16), median over the curves, and on how "
        "many it gets there:"
    ]
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        medians = [_median_ratio(own, f"{target:.0e}") for target in TARGETS]
        lines.append(f"  {method}: {', '.join(medians)}")
    return lines


def _median_ratio(rows: Sequence[RatioRow], target: str) -> str:
    values = [float(row[target]) for row in rows]
    finite = [value for value in values if np.isfinite(value)]
    if not finite:
        return f"{target}: -"
    return f"{target}: {statistics.median(finite):.1f} ({len(finite)})"


def _rate_lines(runs: Sequence[Run]) -> list[str]:
    lines = [
        "Points a second at which pseudo-arclength steps of the same error would be as "
        "fast:"
    ]
    for case in _cases(runs):
        rates = []
        for target in TARGETS:
            rate = points_in_our_time(runs, case, target)
            if np.isfinite(rate):
                rates.append(f"{target:.0e}: {rate:,.0f}")
        lines.append(f"  {case}: {', '.join(rates)}")
    return lines
