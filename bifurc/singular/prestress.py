"""Flexes and stresses of a solution, and whether they show that it is isolated.

At a solution of F = 0 a flex is a direction v with F' v = 0, and a stress a combination w
of the equations with w F' = 0. How F bends along flexes, w F''(v, v), is a quadratic form
for each stress. Where the form of one stress is positive for every flex, the solution is
isolated: w F + c |F|^2 has a strict minimum there for a large c (prestress stability;
Connelly and Whiteley 1996, SIAM J. Discrete Math. 9, for frameworks of bars). It is
isolated as well where the forms have no common zero (second-order rigidity; Connelly
1980, Adv. Math. 37), as the leading term of a curve through it would be one.

In a bound that term leads inside, if anywhere, as the rates of cables and struts do
(Roth and Whiteley 1981, Trans. AMS 265). By Farkas' lemma an unknown in a bound stands
still along all flexes that do, where forces of the bounds, its own among them, are in
balance along every flex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.checks import check_finite, floats_of
from bifurc.decisions import has_no_form, is_in_balance, is_null, leaves_loose
from bifurc.domain import Domain
from bifurc.errors import ProblemError
from bifurc.limits import is_time_over
from bifurc.numerics.singular_values import factors_of
from bifurc.singular.second_order import common_lines
from bifurc.system import System, hessian_at, relative_jacobians

MOST_FORCE = 1e3  # of a bound, over the least that counts
HEAVIEST = 10.0  # product of rates, and smallest eigenvalue, over the largest stress
MOST_CUTS = 200  # through the cone of stresses, each of a flex along which a form falls


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """What second order says of a solution: orthonormal ``flexes`` (k, n) and
    ``stresses`` (s, m); ``within`` (j, n), what the bounds of unknowns leave of the
    flexes; and ``holding``, the stress (m,) whose form is positive for every one of
    these, where there is one, by a ``margin``: its smallest eigenvalue over the size of
    the forms.

    ``is_rigid``: whether this shows that the solution is isolated; None where second
    order does not decide, as where flexes go on to it.
    """

    flexes: np.ndarray
    stresses: np.ndarray
    within: np.ndarray
    holding: np.ndarray | None
    margin: float
    is_rigid: bool | None

    @property
    def is_prestress_stable(self) -> bool:
        """Whether a stress holds the solution against all flexes, if bounds leave any."""
        return self.holding is not None or not len(self.within)


def second_order_at(problem: System, point: np.ndarray) -> SecondOrder:
    """What second order says of a solution at ``point`` (n,).

    Singular values below 1e-7 of the magnitude of F' count as zero, and so do eigenvalues
    of a form below 1e-6 of the largest form. Without flexes within the bounds the solution
    is isolated by first order. Raises `ProblemError` for a point of another
    shape or not finite.

    >>> import numpy as np
    >>> from bifurc import FunctionProblem, second_order_at
    >>> circles = lambda u: [u[0] ** 2 + u[1] ** 2 - 1.0, (u[0] - 2) ** 2 + u[1] ** 2 - 1]
    >>> touching = FunctionProblem(circles, [(-3, 3), (-3, 3)])
    >>> second = second_order_at(touching, np.array([1.0, 0.0]))
    >>> len(second.flexes), len(second.stresses), second.is_prestress_stable
    (1, 1, True)
    """
    point = floats_of("point", point)
    if point.shape != (problem.n,):
        raise ProblemError("shape of the point", point.shape, f"({problem.n},)")
    check_finite("point", point)
    flexes, stresses = _flexes_and_stresses(problem, point)
    within = _within_bounds(problem.domain, point, flexes)
    if not len(within):
        return SecondOrder(flexes, stresses, within, None, 0.0, True)
    hessian = hessian_at(problem, point) / problem.magnitude
    forms = np.tensordot(stresses, within @ (hessian @ within.T), axes=1)
    inside = _products_inside(problem.domain, point, hessian, within)
    weights, margin = positive_combination(forms, inside)
    holding = None if weights is None else weights @ stresses
    is_rigid = True if weights is not None else _have_no_common_zero(forms)
    return SecondOrder(flexes, stresses, within, holding, margin, is_rigid)


def _flexes_and_stresses(
    problem: System, point: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Orthonormal bases (k, n) and (s, m) of what F' takes to nothing at a point (n,), and
    of what takes F' to nothing."""
    factors = factors_of(relative_jacobians(problem, point[None])[0])
    rank = int(np.count_nonzero(~is_null(factors.sigma)))
    return factors.right[rank:], factors.left[:, rank:].T


def _within_bounds(domain: Domain, point: np.ndarray, flexes: np.ndarray) -> np.ndarray:
    """An orthonormal basis (j, n) of the flexes, of a basis (k, n), along which unknowns
    stand still that are in a bound at a point (n,) and in the way of all others.

    Forces of bounds (b,), none of which pulls, are found by a linear program: as many as
    can be are positive at once.
    """
    from scipy.optimize import linprog  # few searches need it

    to_low, to_high = np.abs(domain.bounds.T - point) <= domain.slack
    pushed = np.concatenate([flexes[:, to_low], -flexes[:, to_high]], axis=1)
    count = pushed.shape[1]
    if not count or not len(flexes):
        return flexes
    # forces are what counts as one, up to 1, and more of it
    balance = np.concatenate([pushed, pushed], axis=1)
    bounds = [(0.0, 1.0)] * count + [(0.0, MOST_FORCE)] * count
    goal = np.repeat([-1.0, 0.0], count)
    program = linprog(goal, A_eq=balance, b_eq=np.zeros(len(flexes)), bounds=bounds)
    if not program.success or not is_in_balance(np.abs(balance @ program.x).max()):
        return flexes
    is_pushed = program.x[:count] > 0.5
    held = pushed[:, is_pushed]
    left, sigma, _ = np.linalg.svd(held)
    rank = int(np.count_nonzero(~is_null(sigma)))
    within: np.ndarray = left[:, rank:].T @ flexes
    return within


def _products_inside(
    domain: Domain, point: np.ndarray, hessian: np.ndarray, within: np.ndarray
) -> np.ndarray:
    """The forms (p, j, j) of flexes, of a basis (j, n), that are products of rates into
    the region of two unknowns in a bound at a point (n,), which F'' (m, n, n) couples."""
    to_low, to_high = np.abs(domain.bounds.T - point) <= domain.slack
    rates = (to_low * 1.0 - to_high) * within
    moves = np.abs(rates).max(axis=0) > 0.0
    is_coupled = np.any(hessian != 0.0, axis=0) & np.outer(moves, moves)
    first, second = np.nonzero(np.triu(is_coupled))
    products = np.einsum("ap,bp->pab", rates[:, first], rates[:, second])
    symmetric: np.ndarray = 0.5 * (products + np.swapaxes(products, 1, 2))
    return symmetric


def positive_combination(
    forms: np.ndarray, inside: np.ndarray | None = None
) -> tuple[np.ndarray | None, float]:
    """Weights (s,) of the symmetric forms (s, k, k) whose sum is positive definite, and
    its smallest eigenvalue, both over the size of the forms; None where no sum is.

    Where flexes lead to where some forms ``inside`` (p, k, k) are not negative, the sum
    has to be positive there: it is the sum of a definite one and of such forms (Parrilo
    2000).
    """
    count, size = len(forms), float(np.abs(forms).max(initial=0.0))
    if not np.isfinite(size) or has_no_form(size):
        return None, 0.0
    if inside is None or not len(inside):
        inside = np.empty((0, *forms.shape[1:]))
    if count == 1 and not len(inside):
        return _sign_of_form(forms[0] / size)
    weights, margin = _by_cutting_planes(np.concatenate([forms / size, -inside]), count)
    return (None if weights is None else weights[:count]), margin


def _sign_of_form(form: np.ndarray) -> tuple[np.ndarray | None, float]:
    """The sign (1,) with which a symmetric form (k, k) is positive definite."""
    values = np.linalg.eigvalsh(form)
    sign = 1.0 if values[0] + values[-1] > 0.0 else -1.0
    smallest = float(min(sign * values[0], sign * values[-1]))
    return (None, 0.0) if leaves_loose(smallest) else (np.array([sign]), smallest)


def _by_cutting_planes(
    forms: np.ndarray, count: int
) -> tuple[np.ndarray | None, float]:
    """Weights (s,) as of `positive_combination`, none but the first ``count`` negative.

    The smallest eigenvalue is concave in them, and is maximised by linear programs over
    the directions along which the sum was smallest so far.
    """
    from scipy.optimize import linprog  # few searches need it

    cuts = np.eye(forms.shape[1])
    goal = np.append(np.zeros(len(forms)), -1.0)
    bounds = [(-1.0, 1.0)] * count + [(0.0, HEAVIEST)] * (len(goal) - count)
    for _ in range(MOST_CUTS):
        along = ((cuts @ forms) * cuts).sum(axis=2)  # (w, c)
        rows = np.column_stack([-along.T, np.ones(len(cuts))])
        program = linprog(goal, A_ub=rows, b_ub=np.zeros(len(cuts)), bounds=bounds)
        if not program.success or leaves_loose(program.x[-1]) or is_time_over():
            break
        weights = program.x[:-1]
        values, vectors = np.linalg.eigh(np.einsum("w,wab->ab", weights, forms))
        if values[0] > 0.5 * program.x[-1]:
            return weights, float(values[0])
        cuts = np.concatenate([cuts, vectors[:, :1].T])
    return None, 0.0


def _have_no_common_zero(forms: np.ndarray) -> bool | None:
    """Whether quadratic forms (s, k, k) of flexes vanish together for none but 0: True
    where that is known, else None."""
    if forms.shape[1] != 2:
        return None
    rows = np.stack([forms[:, 0, 0], 2 * forms[:, 0, 1], forms[:, 1, 1]], axis=1)
    lines = common_lines(rows)
    return True if lines is not None and not len(lines) else None
