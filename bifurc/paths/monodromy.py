"""All solutions of a generic member of a family, from one of them.

While the parameters move on a closed way, solutions move to others. If the solutions
of all members together are one irreducible variety, as where the parameters are
functions of a solution, every solution is reached from every other one (Duff, Hill,
Jensen, Lee, Leykin and Sommars 2019).

Whether any is missing is asked of a curve: the solutions while the parameters move on a
line, with the place t on that line as a further unknown. A hyperplane a x + b t = s
that moves with s cuts it in points of which the sum is linear in s if they are all of
them, and of no part of them (the trace test: Sommese, Verschelde and Wampler 2002). It
is asked of a plane curve, too, of which fewer points are to be found: of t and one or
a few coordinates of x, if no two of the solutions agree in these.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Any

import numpy as np

from bifurc.decisions import is_linear_trace
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import distinct, follow_paths

# closed ways in a row that bring nothing new before something else is tried: before the
# trace test of a curve one is enough
QUIET, QUIET_ON_CURVE = 2, 1
MOST_LOOPS = 60
MOST_SOLUTIONS = 10_000
CORNERS = 3  # of a closed way
TESTS = 10  # trace tests, with further closed ways between them


@dataclass(frozen=True, eq=False)
class Fibre:
    """The ``solutions`` (k, n) that are known of the member with ``parameters``
    (q,)."""

    parameters: np.ndarray
    solutions: np.ndarray


@dataclass(frozen=True, eq=False)
class Projection:
    """What is enough to vary and to look at: the ``targets`` (q,), parameters such that
    the solutions of all members that differ in these alone are one irreducible variety;
    and ``blocks`` of coordinates, of which one that tells all solutions apart will
    do."""

    targets: np.ndarray
    blocks: tuple[slice, ...]

    def coordinates_of(self, solutions: np.ndarray) -> np.ndarray:
        """Which coordinates (n,) of the solutions (k, n) are looked at."""
        looked_at = np.zeros(solutions.shape[1], dtype=bool)
        for block in self.blocks:
            chosen = looked_at.copy()
            chosen[block] = True
            if self.tells_apart(solutions, chosen):
                return chosen
        return ~looked_at

    @staticmethod
    def tells_apart(solutions: np.ndarray, looked_at: np.ndarray) -> bool:
        """Whether no two of the solutions (k, n) agree in these coordinates (n,)."""
        return len(distinct(solutions[:, looked_at])) == len(solutions)


@dataclass(frozen=True, eq=False)
class GenericSolutions:
    """The solutions of a generic member, a ``fibre``.

    ``trace``: by how much the sum of the points in a moving hyperplane was not linear,
    over its change; None where there was no time for that. ``are_all``: whether that
    says that no solution is missing.
    """

    fibre: Fibre
    trace: float | None

    @property
    def count(self) -> int:
        """The number of solutions."""
        return len(self.fibre.solutions)

    @property
    def are_all(self) -> bool:
        """Whether the trace test says that no solution is missing."""
        return self.trace is not None and is_linear_trace(self.trace)


def solve_generic(
    family: Family,
    start: np.ndarray,
    parameters: np.ndarray,
    rng: np.random.Generator,
    deadline: Deadline | None = None,
    most: int = MOST_SOLUTIONS,
    linear_in: int | None = None,
    projection: Projection | None = None,
) -> GenericSolutions:
    """The solutions of the member with generic complex ``parameters`` (q,), of which
    ``start`` (n,) is one; where there are more than ``most``, some of them.

    ``linear_in``: a parameter, by number, while which moves alone the sum of all
    solutions is linear in it, and that of no part of them; without, it is asked of a
    curve that has further points, or of a ``projection`` of it. Raises `ValueError`
    where the start is no regular solution.
    """
    deadline = deadline or Deadline()
    fibre = Fibre(np.asarray(parameters, complex), np.asarray(start, complex)[None])
    _require_start(family, fibre)
    size = float(np.abs(fibre.parameters).mean()) if len(fibre.parameters) else 1.0
    projection = projection or Projection(np.ones(family.parameters, dtype=bool), ())
    sizes = np.where(projection.targets, size, 0.0)
    ways = _Ways(sizes, QUIET, most)
    fibre, _ = _enlarged(family, fibre, ways, rng, deadline)
    if deadline.passed or len(fibre.solutions) > most:
        return GenericSolutions(fibre, None)
    if linear_in is not None:
        return _tested(family, fibre, ways, linear_in, rng, deadline)
    return _tested_on_curve(family, fibre, ways, projection, rng, deadline)


def _tested_on_curve(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    projection: Projection,
    rng: np.random.Generator,
    deadline: Deadline,
) -> GenericSolutions:
    """A fibre with all solutions, told by points of the curve over a line."""
    looked_at = projection.coordinates_of(fibre.solutions)
    curve = _CurveOverLine(family, fibre, ways.sizes, looked_at, rng, deadline)
    trace = None
    for _ in range(TESTS):
        curve.find_points(rng, deadline)
        if deadline.passed:
            break
        trace = curve.trace(deadline)
        if trace is not None and is_linear_trace(trace):
            fibre = curve.solutions_in(fibre, deadline)
            # most of the paths there ran to infinity, and another one may be lost
            fibre, is_closed = _enlarged(family, fibre, ways, rng, deadline)
            trace = trace if is_closed else None
            break
    if not projection.tells_apart(fibre.solutions, looked_at):
        trace = None
    return GenericSolutions(fibre, trace)


def _tested(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    linear_in: int,
    rng: np.random.Generator,
    deadline: Deadline,
) -> GenericSolutions:
    """A fibre with all solutions, told by their sum while one parameter moves."""
    trace = None
    for _ in range(TESTS):
        trace = _trace(family, fibre, linear_in, ways.sizes[linear_in], deadline)
        has_all = trace is not None and is_linear_trace(trace)
        if has_all or deadline.passed or len(fibre.solutions) > ways.most:
            break
        fibre, _ = _enlarged(family, fibre, ways, rng, deadline)
    return GenericSolutions(fibre, trace)


def _require_start(family: Family, fibre: Fibre) -> None:
    paths = follow_paths(family, fibre.solutions, fibre.parameters, fibre.parameters)
    is_regular = family.is_regular(fibre.solutions[0], fibre.parameters)
    if not is_regular or not np.all(paths.is_regular):
        raise ValueError("start: it is not allowed; it must be a regular solution")


@dataclass(frozen=True, eq=False)
class _Ways:
    """Closed ways on which parameters move by about their ``sizes`` (q,), those of size
    0 not at all; ``quiet`` of them in a row that bring nothing new are the last, and none is tried once there are
    more than ``most`` solutions."""

    sizes: np.ndarray
    quiet: int
    most: float = np.inf

    def stops(self, home: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
        """The parameters (q,) at the corners of a way from ``home`` (q,)."""
        drawn = self.sizes * complex_normal(rng, (CORNERS - 1, len(home)))
        return [home, *np.where(self.sizes > 0.0, drawn, home), home]


def _enlarged(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    rng: np.random.Generator,
    deadline: Deadline,
) -> tuple[Fibre, bool]:
    """A fibre with the solutions to which closed ways lead; and whether the last of them
    only exchanged these, without losing one."""
    known = fibre.solutions
    quiet, closed = 0, 0
    for _ in range(MOST_LOOPS):
        if quiet == ways.quiet or deadline.passed or len(known) > ways.most:
            break
        points, is_whole = known, True
        for here, there in pairwise(ways.stops(fibre.parameters, rng)):
            paths = follow_paths(family, points, here, there, deadline)
            points, is_whole = (
                paths.regular,
                is_whole and bool(np.all(paths.is_regular)),
            )
        larger = distinct(np.concatenate([known, points]))
        is_quiet = len(larger) == len(known)
        quiet = quiet + 1 if is_quiet else 0
        closed = closed + 1 if is_quiet and is_whole else 0
        known = larger
    return Fibre(fibre.parameters, known), 0 < closed == quiet


def _trace(
    family: Family,
    fibre: Fibre,
    parameter: int,
    step: float,
    deadline: Deadline,
    coordinates: Any = slice(None),
) -> float | None:
    """How far the sum of the solutions, of some ``coordinates``, is from linear in a
    ``parameter``, by number, that moves by a ``step``, over its change; None where paths
    were lost, and where there are none."""
    if not len(fibre.solutions):
        return None
    sums = [fibre.solutions[:, coordinates].sum(axis=0)]
    for shift in (step, -step):
        moved = fibre.parameters.copy()
        moved[parameter] += shift
        paths = follow_paths(family, fibre.solutions, fibre.parameters, moved, deadline)
        if not np.all(paths.is_regular):
            return None
        sums.append(paths.points[:, coordinates].sum(axis=0))
    here, ahead, behind = sums
    change = max(np.abs(ahead - here).max(), np.abs(behind - here).max(), 1.0)
    return float(np.abs(ahead - 2.0 * here + behind).max() / change)


class _CurveOverLine:
    """The curve of the solutions (x, t) of a ``family`` at the parameters p + t v, p
    those of a ``fibre``, in the hyperplanes a x + b t = s.

    Its family has the unknowns x and t and the parameters p, v, a, b, s.
    """

    def __init__(
        self,
        family: Family,
        fibre: Fibre,
        sizes: np.ndarray,
        looked_at: np.ndarray,
        rng: np.random.Generator,
        deadline: Deadline,
    ):
        self.family = _sliced(family)
        self.n = family.n
        self.coordinates = np.append(np.flatnonzero(looked_at), family.n)
        direction = sizes * complex_normal(rng, family.parameters)
        line = np.concatenate([fibre.parameters, direction])
        is_free = np.append(looked_at, [True, True])
        hyperplane = np.where(is_free, complex_normal(rng, family.n + 2), 0.0)
        self.at_fibre = np.concatenate([line, np.zeros(family.n), [1.0, 0.0]])
        generic = np.concatenate([line, hyperplane])
        self.ways = _Ways(np.concatenate([sizes, sizes, is_free]), QUIET_ON_CURVE)
        starts = np.column_stack([fibre.solutions, np.zeros(len(fibre.solutions))])
        came = follow_paths(self.family, starts, self.at_fibre, generic, deadline)
        self.slice = Fibre(generic, came.regular)

    def find_points(self, rng: np.random.Generator, deadline: Deadline) -> None:
        """Find more of the points in a generic hyperplane: it moves, and so does the
        line."""
        self.slice, _ = _enlarged(self.family, self.slice, self.ways, rng, deadline)

    def trace(self, deadline: Deadline) -> float | None:
        """How far the sum of the points is from linear in s, over its change; None
        where paths were lost."""
        return _trace(self.family, self.slice, -1, 1.0, deadline, self.coordinates)

    def solutions_in(self, fibre: Fibre, deadline: Deadline) -> Fibre:
        """The fibre at t = 0 with the points of the curve there."""
        first, last = self.slice.parameters, self.at_fibre
        # most of them run to infinity
        paths = follow_paths(
            self.family, self.slice.solutions, first, last, deadline, again=0
        )
        back = paths.regular[:, : self.n]
        both = distinct(np.concatenate([fibre.solutions, back]))
        return Fibre(fibre.parameters, both)


def _sliced(family: Family) -> Family:
    """The family of the points of the curve over a line in a hyperplane."""
    n, q = family.n, family.parameters
    writer = TapeWriter(n + 1 + 2 * q + n + 2)
    numbers = map(writer.unknown, range(writer.n))
    x, (t,), start, direction, normal, (of_place, s) = (
        list(islice(numbers, count)) for count in (n, 1, q, q, n, 2)
    )
    parameters = [
        writer.add(one, writer.multiply(t, rate))
        for one, rate in zip(start, direction, strict=True)
    ]
    slots = family.tape.write_on(writer, [*x, *parameters])
    outputs = [slots[slot] for slot in family.tape.outputs.tolist()]
    height = writer.multiply(of_place, t)
    for factor, unknown in zip(normal, x, strict=True):
        height = writer.add(height, writer.multiply(factor, unknown))
    return Family(writer.tape([*outputs, writer.subtract(height, s)]), n + 1)
