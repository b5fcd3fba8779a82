"""The curves of the work-precision study: linkages of four to seven joints, and generic
problems."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeAlias

import mpmath
import numpy as np
from scipy.sparse import csc_array, diags_array, hstack, issparse

from bifurc import Branch, FunctionProblem, Problem, TraceSettings, trace_branch
from bifurc.curves.monitor import dead_points
from bifurc.numerics.null_spaces import null_vector
from bifurc.system import jacobian_at
from linkages import Loop, LoopClosure
from linkages.catalogue import entry

Numbers: TypeAlias = list[mpmath.mpf]

EXACT = TraceSettings(order=20, tolerance=1e-14)
DIGITS = 40
DENSE = 200  # unknowns up to which a Jacobian is a dense matrix


@dataclass(frozen=True)
class Case:
    """A curve to follow from ``start`` along ``tangent``, and the same system in mpmath
    numbers.

    ``exact_residual`` maps a list of unknowns to the list of residuals, in the order of
    the problem's. ``settings`` are those of the reference curve; methods are not asked
    for less than ``tightest``, and given ``patience`` times the usual time. ``fortran``
    has the equations for AUTO-07p, where its own file does not.
    """

    name: str
    title: str
    problem: Problem
    start: np.ndarray
    tangent: np.ndarray
    exact_residual: Callable[[Numbers], Numbers]
    settings: TraceSettings = EXACT
    tightest: float = 0.0
    patience: float = 1.0
    fortran: str = ""

    @cached_property
    def sparse(self) -> bool:
        """Whether the Jacobian is sparse, so that dense matrices of its size are out of
        the question."""
        return bool(issparse(jacobian_at(self.problem, self.start)))

    @cached_property
    def reference(self) -> Branch:
        """The whole curve by this project, mostly at order 20 and tolerance 1e-14, its
        error measured by `.exact`."""
        return trace_branch(self.problem, self.start, self.tangent, self.settings)

    @property
    def length(self) -> float:
        """Arclength to follow: once around, or from the start to the end."""
        return self.reference.length

    @cached_property
    def parameter(self) -> tuple[int | None, float]:
        """The unknown without dead points that travels farthest, and how far it goes;
        None where there is none."""
        branch = self.reference
        travel = branch.travel
        still = [
            i
            for i, roots in enumerate(dead_points(branch))
            if not len(roots) and abs(travel[i]) > 0.1
        ]
        if not still:
            return None, 0.0
        best = max(still, key=lambda i: abs(travel[i]))
        return best, float(travel[best])


def all_cases() -> list[Case]:
    """All curves, linkages first."""
    return [*linkage_cases(), circle(), pitchfork(), bratu(50), bratu(1000)]


# --- linkages -----------------------------------------------------------------------------------------


def linkage_cases() -> list[Case]:
    """Loops of 4 to 7 joints; two of them pass close to singular points, two through
    them."""
    return [
        _named("bennett", "Bennett 4R", "bennett"),
        _named("goldberg-5r", "Goldberg 5R", "goldberg-5r"),
        _named(
            "general-6r",
            "Double-subtractive-Goldberg 6R",
            "double-subtractive-goldberg",
        ),
        _named(
            "special-6r",
            "Special double-subtractive-Goldberg 6R",
            "special-double-subtractive-goldberg",
        ),
        _named("bricard", "Line-symmetric Bricard 6R", "bricard-line-symmetric"),
        _named(
            "near-parallelogram",
            "Four-bar, almost a parallelogram",
            "four-bar",
            a=2,
            b=1,
            c="2.001",
            d="1.0001",
        ),
        _named(
            "near-zero-offset",
            "Line-symmetric Bricard 6R, offsets 1e-3",
            "bricard-line-symmetric",
            R1="0.001",
            R2="0.001",
            R3="0.001",
        ),
        _seven(),
    ]


def _named(name: str, title: str, family: str, **changed: str | float) -> Case:
    """The longest closed form of a member of the catalogue, from a regular point of
    it."""
    source = entry(family)
    with mpmath.workdps(DIGITS):
        values = {
            key: mpmath.mpf(value)
            for key, value in {**source.defaults, **changed}.items()
        }
        exact = source.build(**values)
    return _loop_case(name, title, exact)


def _seven() -> Case:
    """A 7R loop without symmetry: mobility 1 by count alone."""
    rng = np.random.default_rng(11)
    with mpmath.workdps(DIGITS):
        lengths, twists, offsets = (
            tuple(mpmath.mpf(float(x)) for x in rng.uniform(low, high, 7))
            for low, high in ((0.5, 1.5), (0.6, 2.5), (0.0, 0.4))
        )
        return _loop_case(
            "general-7r", "General 7R", Loop(lengths, twists, offsets, "general 7R")
        )


def _loop_case(name: str, title: str, exact: Loop) -> Case:
    lengths, twists, offsets = (values.tolist() for values in exact.arrays)
    problem = LoopClosure(Loop(lengths, twists, offsets, exact.name))
    closed = [branch for branch in _branches(problem) if branch.closed]
    branch = max(closed, key=lambda branch: round(branch.length, 6))
    s = 0.1234 * branch.length  # not at a symmetric configuration
    return Case(
        name=name,
        title=title,
        problem=problem,
        start=branch(s),
        tangent=branch(s, 1),
        exact_residual=partial(loop_residual, exact),
    )


def _branches(problem: LoopClosure) -> list[Branch]:
    """The first four branches through the seeds of a linkage, or fewer."""
    branches: list[Branch] = []
    for seed in problem.seeds(np.random.default_rng(0), 30).points:
        if not any(branch.nearest(seed)[0][0] < 1e-6 for branch in branches):
            branches.append(trace_branch(problem, seed))
        if len(branches) == 4:
            break
    return branches


def loop_residual(loop: Loop, theta: Sequence[mpmath.mpf]) -> Numbers:
    """Closure of a loop in mpmath numbers, in the order of `LoopClosure`: exact to
    first order next to closure."""
    total = mpmath.eye(4)
    for angle, length, twist, offset in zip(
        theta, loop.lengths, loop.twists, loop.offsets, strict=True
    ):
        c, s, ca, sa = (
            mpmath.cos(angle),
            mpmath.sin(angle),
            mpmath.cos(twist),
            mpmath.sin(twist),
        )
        total *= mpmath.matrix(
            [
                [c, -s * ca, s * sa, length * c],
                [s, c * ca, -c * sa, length * s],
                [0, sa, ca, offset],
                [0, 0, 0, 1],
            ]
        )
    half = [
        (total[2, 1] - total[1, 2]) / 2,
        (total[0, 2] - total[2, 0]) / 2,
        (total[1, 0] - total[0, 1]) / 2,
    ]
    return half + [total[i, 3] / loop.characteristic_length for i in range(3)]


# --- generic problems ---------------------------------------------------------------------------------


def circle() -> Case:
    """The unit circle."""
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[0] + u[1] * u[1] - 1.0]),
        [(-2, 2), (-2, 2)],
        jacobian=lambda u: np.array([[2 * u[0], 2 * u[1]]]),
    )
    start = np.array([0.6, 0.8])
    return Case(
        "circle",
        "Circle",
        problem,
        start,
        np.array([-0.8, 0.6]),
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1],
    )


def pitchfork() -> Case:
    """The bent branch of the pitchfork x^3 = p x, through the bifurcation at the
    origin."""
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 3 - u[1] * u[0]]),
        [(-1.5, 1.5), (-1.0, 2.0)],
        jacobian=lambda u: np.array([[3 * u[0] ** 2 - u[1], -u[0]]]),
    )
    start = np.array([-np.sqrt(2.0), 2.0])
    tangent = np.array([1.0, 2 * start[0]])
    return Case(
        "pitchfork",
        "Pitchfork",
        problem,
        start,
        tangent / np.linalg.norm(tangent),
        lambda u: [u[0] ** 3 - u[1] * u[0]],
    )


def bratu(n: int) -> Case:
    """u'' + p exp(u) = 0 with n inner points: around the fold, from u = 0 up to p = 0.5
    on the upper branch.

    Beyond `DENSE` unknowns with a sparse Jacobian. Its least singular value is about
    (pi / n)^2: with 1000 unknowns rounding moves the curve by some 1e-9, and tolerances
    below 1e-7 are not asked for.
    """
    h2 = 1.0 / (n + 1) ** 2

    def residual(x: np.ndarray) -> np.ndarray:
        u = x[:-1]
        value = np.asarray(h2 * x[-1] * np.exp(u) - 2 * u)
        value[1:] += u[:-1]
        value[:-1] += u[1:]
        return value

    def exact(x: Numbers) -> Numbers:
        u = [mpmath.mpf(0), *x[:-1], mpmath.mpf(0)]
        step = mpmath.mpf(1) / (n + 1) ** 2
        return [
            u[i - 1] - 2 * u[i] + u[i + 1] + step * x[-1] * mpmath.exp(u[i])
            for i in range(1, n + 1)
        ]

    bounds = [(-1.0, 20.0)] * n + [(0.0, 5.0)]
    jacobian = _bratu_dense(n) if n <= DENSE else _bratu_sparse(n)
    problem = FunctionProblem(residual, bounds, jacobian=jacobian)
    start = np.zeros(n + 1)
    case = Case(
        name=f"bratu-{n}",
        title=f"Bratu, {n} unknowns",
        problem=problem,
        start=start,
        tangent=null_vector(problem, start, np.eye(n + 1)[-1]),
        exact_residual=exact,
    )
    if n <= DENSE:
        return case
    settings = TraceSettings(order=20, tolerance=1e-8)
    return replace(case, settings=settings, tightest=1e-7, patience=4.0)


def _bratu_dense(n: int) -> Callable[[np.ndarray], np.ndarray]:
    h2, rows = 1.0 / (n + 1) ** 2, np.arange(n)

    def jacobian(x: np.ndarray) -> np.ndarray:
        out = np.zeros((n, n + 1))
        grown = h2 * np.exp(x[:-1])
        out[rows, rows] = x[-1] * grown - 2.0
        out[rows[1:], rows[:-1]] = out[rows[:-1], rows[1:]] = 1.0
        out[:, -1] = grown
        return out

    return jacobian


def _bratu_sparse(n: int) -> Callable[[np.ndarray], csc_array]:
    h2 = 1.0 / (n + 1) ** 2
    ones = np.ones(n)
    pattern = csc_array(
        hstack(
            [
                diags_array([ones[1:], 5 * ones, ones[1:]], offsets=[-1, 0, 1]),
                7 * ones[:, None],
            ]
        )
    )
    diagonal, last = pattern.data == 5, pattern.data == 7

    def jacobian(x: np.ndarray) -> csc_array:
        out = pattern.copy()
        grown = h2 * np.exp(x[:-1])
        out.data[diagonal], out.data[last] = x[-1] * grown - 2.0, grown
        return out

    return jacobian
