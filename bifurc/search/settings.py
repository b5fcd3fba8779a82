"""The settings of a search."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from bifurc.checks import check_number, check_type, check_whole
from bifurc.curves.continuation import TraceSettings
from bifurc.decisions import is_same_point
from bifurc.errors import ProblemError

# Points and curves are told apart to `bifurc.decisions.is_same_point`: curves that are
# followed less closely than a tenth of that may be found twice.
LOOSEST = 0.1 * is_same_point.threshold


@dataclass(frozen=True)
class SearchSettings:
    """How much a search looks at.

    ``starts``: random starts that are projected onto the solutions, and up to 16 times as
    many for problems that draw more (`Seeds.more`). ``budget`` (s): the
    search ends when it is used up, but for the step it is in. ``charts``: the most with
    which surfaces are covered. ``prove``: whether the problem's audit, if it has one,
    takes the time to find out if a branch is missing. ``boxes``: into how many the bounds
    of exact equations of two to four unknowns are divided at most, to prove that nothing
    is missing; 0 for not at all. ``certify``: whether every branch
    gets a certificate, and is traced again, finer, where that is refused.
    ``near_motions``: whether curves along which the system is nearly solved are traced;
    without, points of them that solve it are isolated like any other. ``tracing``:
    how a curve is followed, to a tolerance of at most 1e-7. Raises `ProblemError`
    outside the ranges.
    """

    starts: int = 200
    budget: float = math.inf
    charts: int = 1500
    prove: bool = True
    boxes: int = 20_000
    certify: bool = True
    near_motions: bool = True
    tracing: TraceSettings = field(default_factory=TraceSettings)

    def __post_init__(self) -> None:
        check_whole("starts", self.starts, 1)
        check_whole("charts", self.charts, 0)
        check_whole("boxes", self.boxes, 0)
        check_number("budget", self.budget)
        check_type("prove", self.prove, bool)
        check_type("certify", self.certify, bool)
        check_type("near_motions", self.near_motions, bool)
        check_type("tracing", self.tracing, TraceSettings)
        if not self.budget > 0:
            raise ProblemError("budget", self.budget, "a positive number of seconds")
        if self.tracing.tolerance > LOOSEST:
            allowed = f"at most {LOOSEST:.0e} in a search, which compares points"
            raise ProblemError("tolerance", self.tracing.tolerance, allowed)
