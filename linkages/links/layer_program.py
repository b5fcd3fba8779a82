"""The fewest layers in which bodies can lie: a mixed integer linear program, solved by
HiGHS (Huangfu and Hall 2018) through SciPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from scipy.optimize import Bounds
    from scipy.sparse import csr_array

SECONDS = 10.0  # after which the best layers that are known are taken
OPTIMAL, OUT_OF_TIME, INFEASIBLE = 0, 1, 2  # what `scipy.optimize.milp` ends with


class Separation(NamedTuple):
    """Two sets of bodies: all of the one are above all of the other, or below."""

    first: frozenset[int]
    second: frozenset[int]


@dataclass(frozen=True, eq=False)
class LayerSolution:
    """The layer (b,) of every body, the numbers of the separations that are ``broken``,
    and whether it ``is_proven`` that no layers are better: fewer, or with none broken."""

    layers: np.ndarray
    broken: tuple[int, ...]
    is_proven: bool


def fewest_layers(
    count: int,
    separations: Sequence[Separation],
    spans: Sequence[frozenset[int]],
    given: Mapping[int, int],
) -> LayerSolution:
    """The fewest layers for so many bodies that keep all separations, or else break the
    fewest of them; of these the one in which the sets of bodies in ``spans`` reach over
    the fewest layers. No two bodies of a span are in one layer. Some bodies may be
    ``given`` their layer, a number from 1."""
    strict = _Program(count, separations, spans, given, may_break=False)
    solution = strict.solve()
    if solution is not None:
        return solution
    relaxed = _Program(count, separations, spans, given, may_break=True)
    solution = relaxed.solve()
    if solution is not None:
        return replace(solution, is_proven=strict.is_infeasible)
    # without an answer in time: every body in its own layer
    layers = np.zeros(count, dtype=int)
    layers[list(given)] = list(given.values())
    free = [k for k in range(1, 2 * count + 1) if k not in given.values()]
    layers[layers == 0] = free[: count - len(given)]
    broken = [k for k, one in enumerate(separations) if not _is_kept(one, layers)]
    return LayerSolution(layers, tuple(broken), strict.is_infeasible)


def _within(spans: Sequence[frozenset[int]]) -> list[Separation]:
    """Those of every two bodies of a span."""
    pairs = {pair for span in spans for pair in combinations(sorted(span), 2)}
    return [Separation(frozenset({a}), frozenset({b})) for a, b in sorted(pairs)]


def _is_kept(separation: Separation, layers: np.ndarray) -> bool:
    first, second = (layers[list(bodies)] for bodies in separation)
    return bool(first.min() > second.max() or second.min() > first.max())


class _Program:
    """Columns: the layer of every body; the number of layers; the lowest and the highest
    layer of every span; which set of a separation is above, and whether it is broken."""

    def __init__(
        self,
        count: int,
        separations: Sequence[Separation],
        spans: Sequence[frozenset[int]],
        given: Mapping[int, int],
        may_break: bool,
    ):
        self.count = count
        self.may_be_broken = len(separations)
        separations = [*separations, *_within(spans)]
        self.most = max([count, *given.values()])
        self.given = given
        self.may_break = may_break
        self.top = count
        self.low = self.top + 1
        self.high = self.low + len(spans)
        self.above = self.high + len(spans)
        self.broken = self.above + len(separations)
        self.columns = self.broken + len(separations)
        self.is_infeasible = False  # known once it is solved
        self.rows: list[dict[int, float]] = []
        self.least: list[float] = []
        self._reach(spans)
        for k, separation in enumerate(separations):
            self._separate(k, separation)

    def _reach(self, spans: Sequence[frozenset[int]]) -> None:
        for body in range(self.count):
            self._add({self.top: 1, body: -1}, 0)
        for k, span in enumerate(spans):
            for body in span:
                self._add({self.high + k: 1, body: -1}, 0)
                self._add({body: 1, self.low + k: -1}, 0)

    def _add(self, row: dict[int, float], least: float) -> None:
        """A row whose value is at ``least`` so much."""
        self.rows.append(row)
        self.least.append(least)

    def _separate(self, k: int, separation: Separation) -> None:
        above, broken = self.above + k, self.broken + k
        for one in separation.first:
            for other in separation.second:
                most = float(self.most)
                self._add({one: 1, other: -1, above: -most, broken: most}, 1 - most)
                self._add({other: 1, one: -1, above: most, broken: most}, 1)

    def solve(self) -> LayerSolution | None:
        """The best layers; None where there are none, or no time for any."""
        # it takes longer to import than a map
        from scipy.optimize import LinearConstraint, milp

        found = milp(
            self._costs(),
            integrality=np.ones(self.columns),
            bounds=self._bounds(),
            constraints=LinearConstraint(self._matrix(), lb=np.array(self.least)),
            options={"time_limit": SECONDS, "mip_rel_gap": 0.0},
        )
        self.is_infeasible = found.status == INFEASIBLE
        if found.status not in (OPTIMAL, OUT_OF_TIME) or found.x is None:
            return None
        numbers = np.rint(found.x).astype(int)
        broken = np.flatnonzero(numbers[self.broken :])
        layers = numbers[: self.count]
        return LayerSolution(layers, tuple(broken.tolist()), found.status == OPTIMAL)

    def _matrix(self) -> csr_array:
        from scipy.sparse import coo_array

        entries = [(k, c, x) for k, row in enumerate(self.rows) for c, x in row.items()]
        rows, columns, values = zip(*entries, strict=True)
        shape = (len(self.rows), self.columns)
        return coo_array((values, (rows, columns)), shape=shape).tocsr()

    def _bounds(self) -> Bounds:
        from scipy.optimize import Bounds

        low, high = np.zeros(self.columns), np.ones(self.columns)
        low[: self.above], high[: self.above] = 1.0, self.most
        high[self.broken :] = 0.0
        if self.may_break:
            high[self.broken : self.broken + self.may_be_broken] = 1.0
        for body, layer in self.given.items():
            low[body] = high[body] = layer
        if not self.given:  # upside down they are as good
            high[self.above : self.above + 1] = 0.0
        return Bounds(low, high)

    def _costs(self) -> np.ndarray:
        """A broken separation costs more than all layers, and a layer more than all
        spans."""
        costs = np.zeros(self.columns)
        spans = self.above - self.high
        costs[self.low : self.high] = -1.0
        costs[self.high : self.above] = 1.0
        costs[self.top] = 1.0 + spans * self.most
        costs[self.broken :] = costs[self.top] * (self.most + 1)
        return costs
