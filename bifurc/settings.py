"""How curves are followed, and how much a search looks at."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from bifurc.checks import check_number, check_type, check_whole
from bifurc.decisions import is_same_point
from bifurc.errors import ProblemError

# Radius, in scales, of pieces along an ordinary curve, at least: three times that which
# is taken for a sign of a crossing.
ORDINARY = 3e-4
HIGHEST_ORDER = 30
# Points and curves are told apart to `bifurc.decisions.is_same_point`: curves that are
# followed less closely than a tenth of that may be found twice.
LOOSEST = 0.1 * is_same_point.threshold


@dataclass(frozen=True)
class TraceSettings:
    """How a curve is followed. Lengths are in units of the problem's ``scale``, the
    ``longest`` radius in those of its ``stride`` and the ``max_length`` in those of its
    ``reach``.

    ``order`` of the pieces and the ``tolerance`` to which they meet the curve, the
    ``shortest`` and ``longest`` trusted radius, and the ``max_length`` after which
    tracing gives up. The order is at least `lowest_order` of the tolerance. Raises
    `ProblemError` outside the ranges.
    """

    order: int = 16
    tolerance: float = 1e-13
    shortest: float = 1e-9
    longest: float = 2.0
    max_length: float = 1000.0

    def __post_init__(self) -> None:
        check_whole("order", self.order)
        for name in ("tolerance", "shortest", "longest", "max_length"):
            check_number(name, getattr(self, name))
        if not 1e-14 <= self.tolerance <= 1e-2:
            raise ProblemError("tolerance", self.tolerance, "from 1e-14 to 1e-2")
        lowest = lowest_order(self.tolerance)
        if not lowest <= self.order <= HIGHEST_ORDER:
            allowed = (
                f"from {lowest} to {HIGHEST_ORDER} for a tolerance of "
                f"{self.tolerance:g}; pieces of a lower order are too short"
            )
            raise ProblemError("order", self.order, allowed)
        if not 0 < self.shortest < self.longest < self.max_length:
            raise ProblemError(
                "shortest, longest, max_length",
                (self.shortest, self.longest, self.max_length),
                "positive and increasing",
            )

    def to_tolerance(self, tolerance: float) -> TraceSettings:
        """The same to another tolerance, of a higher order where that needs one."""
        order = max(self.order, lowest_order(tolerance))
        return replace(self, order=order, tolerance=tolerance)


def lowest_order(tolerance: float) -> int:
    """The lowest order of pieces with which a curve can be followed to a ``tolerance``.

    Along a curve of curvature 1 a piece of order p is trusted within about the root of
    order p - 1 of the tolerance. At 1e-13 that is 0.1 of the scale for order 16, 6e-4
    for order 5 and 5e-5 for order 4: 40,000 pieces for a circle.
    """
    power = math.log(tolerance) / math.log(ORDINARY)
    return 1 + math.ceil(power)


# Along so many a search counts complex solutions; whoever allows more wants to know.
USUAL_PATHS = 200


@dataclass(frozen=True)
class SearchSettings:
    """How much a search looks at.

    ``starts``: random starts that are projected onto the solutions, and up to 16 times as
    many for problems that draw more (`Seeds.more`). ``budget`` (s): the
    search ends when it is used up, but for the step it is in. ``charts``: the most with
    which surfaces are covered. ``count``: whether the problem's audit, if it has one,
    takes the time to find out if a branch is missing. ``boxes``: into how many the bounds
    of exact equations of two to four unknowns are divided at most, to tell that nothing
    is missing; 0 for not at all. ``paths``: along how many all isolated solutions of
    as many polynomials as unknowns, up to eight, are followed at most, fewer of more;
    0 for none; so are the curves of polynomials where something is open, and with more
    than `USUAL_PATHS` also where nothing is. ``certify``: whether every branch gets a
    certificate, and is traced again, finer, where that is refused. ``near_motions``:
    whether curves along which the system is nearly solved are traced; without, points of
    them that solve it are isolated like any other. ``tracing``: how a curve is followed,
    to a tolerance of at most 1e-7. Raises `ProblemError` outside the ranges.
    """

    starts: int = 200
    budget: float = math.inf
    charts: int = 1500
    count: bool = True
    boxes: int = 20_000
    paths: int = USUAL_PATHS
    certify: bool = True
    near_motions: bool = True
    tracing: TraceSettings = field(default_factory=TraceSettings)

    def __post_init__(self) -> None:
        check_whole("starts", self.starts, 1)
        check_whole("charts", self.charts, 0)
        check_whole("boxes", self.boxes, 0)
        check_whole("paths", self.paths, 0)
        check_number("budget", self.budget)
        check_type("count", self.count, bool)
        check_type("certify", self.certify, bool)
        check_type("near_motions", self.near_motions, bool)
        check_type("tracing", self.tracing, TraceSettings)
        if not self.budget > 0:
            raise ProblemError("budget", self.budget, "a positive number of seconds")
        if self.tracing.tolerance > LOOSEST:
            allowed = f"at most {LOOSEST:.0e} in a search, which compares points"
            raise ProblemError("tolerance", self.tracing.tolerance, allowed)
