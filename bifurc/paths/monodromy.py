"""All solutions of a generic member of a family, from one of them.

While the parameters move on a closed way, solutions move to others. If the solutions
of all members together are one irreducible variety, as where the parameters are
functions of a solution, every solution is reached from every other one (Duff, Hill,
Jensen, Lee, Leykin and Sommars 2019).

Whether any is missing is asked of a curve: the solutions while the parameters move on a
line, with the place t on that line as a further unknown. With a linear function l of x
the sections l t = s of it have so many points as it has over a generic t and on a
generic l together, and at s = 0 they are just these: the solutions at t = 0, and those
at which l is 0. While s moves the sums of l and of t are linear in s if these are all
points, and of no part of them (the trace test: Sommese, Verschelde and Wampler 2002, and
for bilinear sections Leykin, Rodriguez and Sottile 2018). No point runs to infinity on
the way from the section to the solutions, as from other ones. One or a few coordinates
of x are enough for l, of which fewer points are to be found, if no two of the solutions
agree in these. Of solutions that are missing this is not known, and where all that are
known of a few agree with one of those that are not, no sum tells: so few solutions go
more closed ways, each of which leads to such a one or not.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from bifurc.decisions import is_linear_trace, is_same_path_end
from bifurc.equations.tape import TapeWriter
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import Paths, distinct, follow_paths
from bifurc.paths.homogeneous import write_linear

# closed ways in a row that bring nothing new before something else is tried: before the
# trace test of a curve one is enough
QUIET, QUIET_ON_CURVE = 2, 1
FEWEST_ENDS = 12  # of all solutions on such ways together
MOST_LOOPS = 60
MOST_SOLUTIONS = 10_000
PATHS_EACH = 500  # of the solutions that are looked for at most
CORNERS = 3  # of a closed way
TESTS = 10  # trace tests, with further closed ways between them


@dataclass(frozen=True, eq=False)
class Fibre:
    """The ``solutions`` (k, n) that are known of the member with ``parameters`` (q,),
    or of one with some (k, q) each."""

    parameters: np.ndarray
    solutions: np.ndarray


@dataclass(frozen=True, eq=False)
class Projection:
    """What is enough to vary and to look at: the ``targets`` (q,), parameters such that
    the solutions of all members that differ in these alone are one irreducible variety;
    and ``blocks`` of coordinates, slices or numbers, of which one that tells all
    solutions apart will do: also those that are not known, of which it is not asked."""

    targets: np.ndarray
    blocks: tuple[Any, ...]

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


@dataclass(eq=False)
class Effort:
    """How many paths were ``followed``; it is spent at a ``deadline``, and after ``most``
    of them."""

    deadline: Deadline
    most: float = np.inf
    followed: int = 0

    @staticmethod
    def for_solutions(most: int, deadline: Deadline) -> Effort:
        """What is usual where ``most`` solutions are looked for."""
        return Effort(deadline, PATHS_EACH * most)

    @property
    def is_spent(self) -> bool:
        """Whether no further paths are to be followed."""
        return self.followed > self.most or self.deadline.passed

    def follow(self, family: Family, fibre: Fibre, last: np.ndarray) -> Paths:
        """The paths of the solutions of a fibre to the parameters ``last`` (q,)."""
        self.followed += len(fibre.solutions)
        starts, first = fibre.solutions, fibre.parameters
        return follow_paths(family, starts, first, last, self.deadline)


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
    effort: Effort | None = None,
    most: int = MOST_SOLUTIONS,
    linear_in: int | None = None,
    projection: Projection | None = None,
) -> GenericSolutions:
    """The solutions of the member with generic complex ``parameters`` (q,), of which
    ``start`` (n,) is one; where there are more than ``most``, or the ``effort`` is spent,
    some of them.

    ``linear_in``: a parameter, by number, while which moves alone the sum of all
    solutions is linear in it, and that of no part of them; without, it is asked of a
    curve that has further points, or of a ``projection`` of it. Raises `ValueError`
    where the start is no regular solution.
    """
    effort = effort or Effort.for_solutions(most, Deadline())
    fibre = Fibre(np.asarray(parameters, complex), np.asarray(start, complex)[None])
    _require_start(family, fibre)
    projection = projection or Projection(np.ones(family.parameters, dtype=bool), ())
    moved = np.abs(fibre.parameters[projection.targets])
    size = float(np.sqrt(np.mean(moved**2))) if len(moved) else 1.0
    sizes = np.where(projection.targets, size, 0.0)
    ways = _Ways(sizes, QUIET, most)
    fibre = _enlarged(family, fibre, ways, rng, effort)
    if effort.is_spent or len(fibre.solutions) > most:
        return GenericSolutions(fibre, None)
    if linear_in is not None:
        return _tested(family, fibre, ways, linear_in, rng, effort)
    return _tested_on_curve(family, fibre, ways, projection, rng, effort)


def _tested_on_curve(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    projection: Projection,
    rng: np.random.Generator,
    effort: Effort,
) -> GenericSolutions:
    """A fibre with all solutions, told by points of the curve over a line."""
    looked_at = projection.coordinates_of(fibre.solutions)
    curve = CurveOverLine(family, fibre, ways.sizes, looked_at, rng)
    trace = None
    for _ in range(TESTS):
        curve.find_points(rng, effort)
        if effort.is_spent or len(curve.solutions) > ways.most:
            break
        trace = curve.trace(effort)
        if trace is not None and is_linear_trace(trace):
            break
    solutions = curve.solutions
    if not projection.tells_apart(solutions, looked_at):
        trace = None
    return GenericSolutions(Fibre(fibre.parameters, solutions), trace)


def _tested(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    linear_in: int,
    rng: np.random.Generator,
    effort: Effort,
) -> GenericSolutions:
    """A fibre with all solutions, told by their sum while one parameter moves."""
    trace = None
    for _ in range(TESTS):
        trace = _trace(family, fibre, linear_in, ways.sizes[linear_in], effort)
        has_all = trace is not None and is_linear_trace(trace)
        if has_all or effort.is_spent or len(fibre.solutions) > ways.most:
            break
        fibre = _enlarged(family, fibre, ways, rng, effort)
    return GenericSolutions(fibre, trace)


def _require_start(family: Family, fibre: Fibre) -> None:
    paths = follow_paths(family, fibre.solutions, fibre.parameters, fibre.parameters)
    is_regular = family.is_regular(fibre.solutions[0], fibre.parameters)
    if not is_regular or not np.all(paths.is_regular):
        raise ValueError("start: it is not allowed; it must be a regular solution")


@dataclass(frozen=True, eq=False)
class _Ways:
    """Closed ways on which parameters move by about their ``sizes`` (q,), those of size
    0 not at all; ``quiet`` of them in a row that bring nothing new are the last, and none
    is tried once there are more than ``most`` solutions."""

    sizes: np.ndarray
    quiet: int
    most: float = np.inf

    def stops(self, home: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
        """The parameters (q,) at the corners of a way from ``home`` (q,), without that
        itself; some ways are longer, as what they have to go round may be far away."""
        longer = np.exp(rng.normal())
        drawn = longer * self.sizes * complex_normal(rng, (CORNERS - 1, len(home)))
        return [*np.where(self.sizes > 0.0, drawn, home), home]


def _enlarged(
    family: Family,
    fibre: Fibre,
    ways: _Ways,
    rng: np.random.Generator,
    effort: Effort,
) -> Fibre:
    """A fibre with the solutions to which closed ways lead."""
    home, known = fibre.parameters, fibre.solutions
    quiet = 0
    for _ in range(MOST_LOOPS):
        is_quiet = quiet >= ways.quiet and quiet * len(known) >= FEWEST_ENDS
        if is_quiet or effort.is_spent or len(known) > ways.most:
            break
        here = Fibre(home, known)
        for there in ways.stops(home, rng):
            here = Fibre(there, effort.follow(family, here, there).regular)
        larger = distinct(np.concatenate([known, here.solutions]))
        quiet = quiet + 1 if len(larger) == len(known) else 0
        known = larger
    return Fibre(home, known)


def _trace(
    family: Family,
    fibre: Fibre,
    parameter: int,
    step: float,
    effort: Effort,
    coordinates: Any = slice(None),
) -> float | None:
    """How far the sum of the solutions, of some ``coordinates``, is from linear in a
    ``parameter``, by number, that moves by a ``step``, over its change; None where paths
    were lost, and where there are none."""
    if not len(fibre.solutions):
        return None
    sums = [family.affine(fibre.solutions)[:, coordinates].sum(axis=0)]
    for shift in (step, -step):
        moved = fibre.parameters.copy()
        moved[parameter] += shift
        paths = effort.follow(family, fibre, moved)
        if not np.all(paths.is_regular):
            return None
        sums.append(family.affine(paths.points)[:, coordinates].sum(axis=0))
    return trace_of(np.array(sums))


def trace_of(sums: np.ndarray) -> float:
    """How far sums (3, n) of solutions, here, ahead and behind, are from linear, over
    their change."""
    here, ahead, behind = sums
    change = max(np.abs(ahead - here).max(), np.abs(behind - here).max(), 1.0)
    return float(np.abs(ahead - 2.0 * here + behind).max() / change)


class CurveOverLine:
    """The curve of the solutions (x, t) of a ``family`` at the parameters p + t v, p
    those of a ``fibre``, with all of its points that are known in the ``section``
    (a x - b) t = s for s = 0. v is about of the ``sizes`` (q,), and of the coordinates
    some (n,) are ``looked_at``, where a is not 0.

    Its family has the unknowns x and t and the parameters p, v, a, b, s.
    """

    def __init__(
        self,
        family: Family,
        fibre: Fibre,
        sizes: np.ndarray,
        looked_at: np.ndarray,
        rng: np.random.Generator,
    ):
        self.family = _bilinear_sections(family)
        self.coordinates = np.append(np.flatnonzero(looked_at), family.n)
        direction = sizes * complex_normal(rng, family.parameters)
        of_section = np.append(looked_at, [True, True])
        section = np.where(of_section, complex_normal(rng, family.n + 2), 0.0)
        section[-1] = 0.0
        moving = np.concatenate([sizes, sizes, of_section])
        self.ways = _Ways(moving, QUIET_ON_CURVE)
        self.section = Fibre(
            np.concatenate([fibre.parameters, direction, section]),
            np.column_stack([fibre.solutions, np.zeros(len(fibre.solutions))]),
        )

    def find_points(self, rng: np.random.Generator, effort: Effort) -> None:
        """Find more of the points in the section: it moves, and so does the line."""
        self.section = _enlarged(self.family, self.section, self.ways, rng, effort)

    def trace(self, effort: Effort) -> float | None:
        """How far the sum of the points is from linear in s, over its change; None
        where paths were lost."""
        return _trace(self.family, self.section, -1, 1.0, effort, self.coordinates)

    @property
    def solutions(self) -> np.ndarray:
        """The points (k, n) at t = 0."""
        points = self.section.solutions
        are_there = is_same_path_end(np.abs(points[:, -1]))
        solutions: np.ndarray = points[are_there, :-1]
        return solutions


def _bilinear_sections(family: Family) -> Family:
    """The family of the points of the curve over a line in sections."""
    n, q = family.n, family.parameters
    writer = TapeWriter(n + 1 + 2 * q + n + 2)
    numbers = map(writer.unknown, range(writer.n))
    x, (t,), start, direction, normal, (offset, s) = (
        list(islice(numbers, count)) for count in (n, 1, q, q, n, 2)
    )
    parameters = [
        writer.add(one, writer.multiply(t, rate))
        for one, rate in zip(start, direction, strict=True)
    ]
    slots = family.tape.write_on(writer, [*x, *parameters])
    outputs = [slots[slot] for slot in family.tape.outputs.tolist()]
    height = writer.subtract(write_linear(writer, normal, x), offset)
    section = writer.subtract(writer.multiply(height, t), s)
    return Family(writer.tape([*outputs, section]), n + 1)
