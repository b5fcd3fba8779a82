"""Non-real configurations followed from slice to slice, with a proof at every step that
they stay non-real.

In: configurations of a loop with one joint angle given, that are not real, and the
angles to follow them to. Out: which of them get there without becoming real, and where
the others come to a halt.

At a closed configuration z the closure is ``F(z + d) = 2 vec(exp(d_1 s_1 / 2) ...
exp(d_n s_n / 2))`` with the joint screws s_i at z as dual quaternions, for complex
angles as for real ones. Its first derivatives are the screws, its second ones half
their brackets, and at a distance of at most r its second derivatives differ from those
at z by at most ``2 m_i m_j (exp(m r) - 1)``, where m_i bounds the multiplication by s_i
/ 2 and m is the norm of the m_i. Let a be a row that singles out one solution for every
value t of a.d, and P what the first six columns of the pseudo-inverse of [F'; a] are.
All that bounds the second derivative of P F by a number w. In the ball of radius rho, w
rho <= 1/2, there is at most one solution for every t, and it stays within ``w |d|^2 /
2`` of the tangent, in a norm that weighs the joints (the theorem of Newton and
Kantorovich for an implicit function: Ortega and Rheinboldt 1970, 12.6; Deuflhard 2004,
4.4). With the angle of the given joint as t, no configuration on the way is real where
the imaginary part of one joint is larger than that.

A pair of conjugate configurations becomes real at a fold, where the joint has a dead
point. Around a fold that is known the complex solutions in a ball are one curve, t
along its tangent, on which one pair meets: a sheet that comes so close is of that pair.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (numba infers the types of compiled functions)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numba.extending import register_jitable

from bifurc.limits import Deadline
from linkages.loop import Loop

__all__ = ["Fold", "find_fold", "follow_sheets"]

# rad: a sheet that advances by less than this in a step has come to a halt
SHORTEST = 1e-9
# rad: where steps in the angle of the joint are shorter, the sheet is followed along
# its curve
SLOW = 1e-5
MOST_STEPS = 10_000  # in the angle of the joint
MOST_ALONG = 500  # along the curve
# rad: what is proved around a fold must reach farther than the rounding of its angle
SMALLEST = 1e-9
COEFFICIENTS = 32  # of the angle as a power series about a fold
CIRCLES = 60  # on which the terms of that series are compared


@dataclass(frozen=True)
class Fold:
    """A dead point of a joint on a known motion, and the neighbourhood in which only
    its own pair of sheets meets.

    A configuration that is less than ``along`` from it in the direction of ``tangent``
    (n,), less than ``away`` in all, each joint divided by its ``weight`` (n,), and less
    than ``across`` in the angle of the joint is one of the pair.
    """

    configuration: np.ndarray
    tangent: np.ndarray
    weight: np.ndarray
    away: float
    along: float
    across: float


def follow_sheets(
    loop: Loop,
    joint: int,
    starts: np.ndarray,
    ends: np.ndarray,
    folds: Sequence[Sequence[Fold]],
    seconds: float = np.inf,
) -> tuple[np.ndarray, np.ndarray]:
    """Follow the closed configurations ``starts`` (k, n), complex, as joint ``joint``
    (from 0) turns to ``ends`` (k,).

    The joint's own angle is real. A sheet ends well where it gets to its end without
    becoming real or joins one of its ``folds``. Returns which do (k,), and where each
    one stopped (k, n): all do when the ``seconds`` are over.
    """
    deadline = Deadline(seconds)
    tracker = SheetTracker(loop.link_geometry[:4], joint)
    sheets = np.array(starts, dtype=complex)
    cleared = np.zeros(len(starts), dtype=bool)
    for i, near in enumerate(folds):
        cleared[i] = tracker.follow(sheets[i], float(ends[i]), near, deadline)
    return cleared, sheets


def find_fold(loop: Loop, joint: int, configuration: np.ndarray) -> Fold | None:
    """The neighbourhood of a dead point (n,) of joint ``joint`` (from 0); None where
    none can be proved.

    Where the second term of the series of the angle exceeds the rest by m on a circle,
    every angle nearer than m to that of the dead point is taken twice within (Rouche).
    """
    at = np.array(configuration, dtype=complex)
    curve = _curve_through(loop.link_geometry[:4], joint, at)
    if curve is None:
        return None
    radii, margins = curve.margins(2)
    best = int(np.argmax(margins))
    if not margins[best] > SMALLEST:
        return None
    return Fold(
        configuration=curve.at.real,
        tangent=curve.tangent.real,
        weight=curve.weight,
        away=curve.radius,
        along=float(radii[best]),
        across=float(margins[best]),
    )


@dataclass(frozen=True)
class SheetTracker:
    """Follows sheets of the loop with this ``geometry`` (4, n) as ``joint`` (from 0)
    turns."""

    geometry: np.ndarray
    joint: int

    def follow(
        self, z: np.ndarray, end: float, folds: Sequence[Fold], deadline: Deadline
    ) -> bool:
        """Whether a sheet ``z`` (n,), moved in place, gets to ``end`` without becoming
        real, or joins one of the ``folds``."""
        shapes, limits = _fold_arrays(folds, len(z))
        for _ in range(MOST_ALONG):
            if deadline.passed:
                return False
            if _follow(self.geometry, self.joint, z, end, shapes, limits):
                return True
            if not self.advance_along(z, end):
                return False
        return False

    def advance_along(self, z: np.ndarray, end: float) -> bool:
        """Move a sheet ``z`` (n,) towards ``end`` in place by one step along its curve;
        False where none can be proved.

        Near a fold the steps in the angle of the joint get short. The coordinate along
        the tangent does not mind: where the first term of the series exceeds the rest
        by m on a circle, every angle nearer than m is taken once within.
        """
        curve = _curve_through(self.geometry, self.joint, z)
        if curve is None:
            return False
        radii, margins = curve.margins(1)
        margins = np.where(curve.stays_nonreal(radii), margins, -np.inf)
        best = int(np.argmax(margins))
        left = end - z[self.joint].real
        size = min(0.9 * float(margins[best]), abs(left))
        if not size >= min(SHORTEST, abs(left)):
            return False
        step = np.copysign(size, left)
        after = z + step / curve.slope * curve.tangent
        after[self.joint] = z[self.joint].real + step
        of_joint = np.eye(len(z), dtype=complex)[self.joint]
        if not _correct(self.geometry, after, of_joint):
            return False
        if abs(np.conj(curve.tangent) @ (after - z)) >= radii[best]:
            return False
        z[:] = after
        return True


def _fold_arrays(folds: Sequence[Fold], n: int) -> tuple[np.ndarray, np.ndarray]:
    """What the kernel reads of folds: configuration, tangent and weight (k, 3, n), and
    the three limits (k, 3)."""
    shapes = [[fold.configuration, fold.tangent, fold.weight] for fold in folds]
    limits = [[fold.away, fold.along, fold.across] for fold in folds]
    return np.array(shapes).reshape(-1, 3, n), np.array(limits).reshape(-1, 3)


@dataclass(frozen=True)
class Curve:
    """The complex curve of solutions through ``at`` (n,), t the coordinate along its
    unit ``tangent`` (n,).

    It is the only one in a ball of the ``radius``, each joint divided by its ``weight``
    (n,), in which ``bound`` bounds the second derivative; |t| < ``reach`` lies in it.
    The joint turns by g_1 t + g_2 t^2 + ..., ``terms``
    |g_k| (q,), at most ``largest`` in all; ``slope`` is g_1.
    """

    at: np.ndarray
    tangent: np.ndarray
    weight: np.ndarray
    radius: float
    bound: float
    reach: float
    terms: np.ndarray
    slope: complex
    largest: float

    def margins(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Radii t of circles, and by how much term k exceeds the rest on each: Cauchy
        bounds what follows the last."""
        t = self.reach * np.geomspace(1e-3, 0.5, CIRCLES)
        powers = np.arange(len(self.terms))
        sizes = self.terms[:, None] * t ** powers[:, None]
        ratio = t / self.reach
        beyond = self.largest * ratio ** len(powers) / (1.0 - ratio)
        # the terms themselves are off by as little as what comes after the last
        return t, 2.0 * sizes[k] - sizes.sum(axis=0) - 2.0 * beyond

    def stays_nonreal(self, t: np.ndarray) -> np.ndarray:
        """Whether the imaginary part of some joint keeps its sign where the coordinate
        is at most ``t`` (k,)."""
        speed = np.linalg.norm(self.tangent / self.weight)
        strayed = 0.5 * self.bound * (4.0 / 3.0 * t * speed) ** 2
        imaginary = np.abs(self.at.imag)[:, None]
        along = np.abs(self.tangent)[:, None] * t
        least = imaginary - along - self.weight[:, None] * strayed
        is_kept: np.ndarray = np.any(least > 0, axis=0)
        return is_kept


def _curve_through(geometry: np.ndarray, joint: int, at: np.ndarray) -> Curve | None:
    """The curve through a configuration (n,), its series from values on a circle; None
    where no ball is proved."""
    tangent = _tangent(geometry, at)
    weight, radius, bound = _ball_around(geometry, at, tangent.conj())
    if not radius > 0:
        return None
    reach = 0.75 * radius / float(np.linalg.norm(tangent / weight))
    powers = np.arange(COEFFICIENTS)
    circle = 0.5 * reach * np.exp(2j * np.pi * powers / COEFFICIENTS)
    around = at + circle[:, None] * tangent
    converged = [_correct(geometry, point, tangent.conj()) for point in around]
    if not all(converged):
        return None
    distance = np.linalg.norm((around - at) / weight, axis=1)
    if not distance.max() <= radius:
        return None
    turned = around[:, joint] - at[joint]
    terms = np.fft.fft(turned) / COEFFICIENTS / (0.5 * reach) ** powers
    largest = reach * abs(tangent[joint]) + weight[joint] * 0.5 * bound * radius**2
    return Curve(
        at=at.copy(),
        tangent=tangent,
        weight=weight,
        radius=float(radius),
        bound=float(bound),
        reach=reach,
        terms=np.abs(terms),
        slope=complex(terms[1]),
        largest=float(largest),
    )


def _tangent(geometry: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The unit tangent (n,), complex, of the solutions through a configuration (n,);
    real where the configuration is."""
    screws = np.zeros((6, len(at)), dtype=complex)
    error = np.zeros(6, dtype=complex)
    _screws_and_error(at, geometry, screws, error)
    if np.all(at.imag == 0):
        null_vectors = np.linalg.svd(screws.real)[2].astype(complex)
    else:
        null_vectors = np.linalg.svd(screws)[2].conj()
    tangent: np.ndarray = null_vectors[-1]
    return tangent


# --- kernels: complex configurations --------------------------------------------------


@njit(cache=True, error_model="numpy")
def _screws_and_error(z, geometry, screws, error):
    """Fill joint screws (6, n) in the base frame, direction over moment, and the
    closure error (6,) of ``z`` (n,)."""
    frame = np.zeros((3, 4), np.complex128)  # columns: three axes, origin
    for r in range(3):
        frame[r, r] = 1.0
    for i in range(len(z)):
        for r in range(3):
            u, v = (r + 1) % 3, (r + 2) % 3
            screws[r, i] = frame[r, 2]
            screws[r + 3, i] = frame[u, 3] * frame[v, 2] - frame[v, 3] * frame[u, 2]
        c, s = np.cos(z[i]), np.sin(z[i])
        length, offset, ca, sa = (
            geometry[0, i],
            geometry[1, i],
            geometry[2, i],
            geometry[3, i],
        )
        for r in range(3):
            x, y = c * frame[r, 0] + s * frame[r, 1], c * frame[r, 1] - s * frame[r, 0]
            frame[r, 3] += offset * frame[r, 2] + length * x
            frame[r, 0], frame[r, 1], frame[r, 2] = (
                x,
                ca * y + sa * frame[r, 2],
                ca * frame[r, 2] - sa * y,
            )
    for r in range(3):
        u, v = (r + 1) % 3, (r + 2) % 3
        error[r], error[r + 3] = 0.5 * (frame[v, u] - frame[u, v]), frame[r, 3]


@register_jitable
def _pseudo_inverse(screws, along, inverse):
    """Fill the pseudo-inverse (n, 7) of the screws (6, n) over the row ``along`` (n,):
    Gram-Schmidt, twice."""
    n = screws.shape[1]
    q, r = np.empty((7, n), np.complex128), np.zeros((n, n), np.complex128)
    for j in range(n):
        for k in range(6):
            q[k, j] = screws[k, j]
        q[6, j] = along[j]
        for _ in range(2):
            for i in range(j):
                inner = 0j
                for k in range(7):
                    inner += np.conj(q[k, i]) * q[k, j]
                r[i, j] += inner
                for k in range(7):
                    q[k, j] -= inner * q[k, i]
        size = 0.0
        for k in range(7):
            size += q[k, j].real ** 2 + q[k, j].imag ** 2
        size = np.sqrt(size)
        r[j, j] = size
        for k in range(7):
            q[k, j] /= size
    for k in range(7):
        for i in range(n - 1, -1, -1):
            value = np.conj(q[k, i])
            for j in range(i + 1, n):
                value -= r[i, j] * inverse[j, k]
            inverse[i, k] = value / r[i, i]


@register_jitable
def _second(screws, inverse, second):
    """Fill the second derivatives (n, n, n) of P F: P of half the brackets of earlier
    joints with later ones."""
    n = screws.shape[1]
    bracket = np.empty(6, np.complex128)
    for i in range(n):
        for j in range(i + 1, n):
            for r in range(3):
                u, v = (r + 1) % 3, (r + 2) % 3
                bracket[r] = 0.5 * (
                    screws[u, i] * screws[v, j] - screws[v, i] * screws[u, j]
                )
                bracket[r + 3] = 0.5 * (
                    screws[u, i] * screws[v + 3, j]
                    - screws[v, i] * screws[u + 3, j]
                    + screws[u + 3, i] * screws[v, j]
                    - screws[v + 3, i] * screws[u, j]
                )
            for a in range(n):
                value = 0j
                for k in range(6):
                    value += inverse[a, k] * bracket[k]
                second[a, i, j] = second[a, j, i] = value


@register_jitable
def _ball(screws, inverse, second, weight):
    """Fill the weights (n,) of the joints in the norm; the radius rho and the bound w
    of the ball around."""
    n = screws.shape[1]
    total = 0.0
    for i in range(n):
        m = 0.0
        for part in range(2):
            real, imaginary = 0.0, 0.0
            for r in range(3):
                entry = screws[3 * part + r, i]
                real += entry.real**2
                imaginary += entry.imag**2
            m += 0.5 * (np.sqrt(real) + np.sqrt(imaginary))
        weight[i] = 1.0 / np.sqrt(
            m
        )  # a joint with a large screw may move less; the root takes the fewest steps
        total += m
    size = 0.0
    for i in range(n):
        for k in range(6):
            size += (inverse[i, k].real ** 2 + inverse[i, k].imag ** 2) / weight[i] ** 2
    gram = np.zeros((n, n), np.complex128)
    for a in range(n):
        for b in range(n):
            for i in range(n):
                for j in range(n):
                    gram[a, b] += (
                        second[a, i, j]
                        * np.conj(second[b, i, j])
                        * (weight[i] * weight[j]) ** 2
                    )
            gram[a, b] /= weight[a] * weight[b]
    trace, rows = 0.0, 0.0  # either bounds the largest eigenvalue
    for a in range(n):
        row = 0.0
        for b in range(n):
            row += abs(gram[a, b])
        trace, rows = trace + gram[a, a].real, max(rows, row)
    center, growth, rate = (
        np.sqrt(min(trace, rows)),
        2.0 * np.sqrt(size) * total,
        np.sqrt(total),
    )
    radius = min(0.5 / center, 1.0)
    bound = center + growth * np.expm1(rate * radius)
    while bound * radius > 0.5:  # w grows with the radius
        radius *= 0.8
        bound = center + growth * np.expm1(rate * radius)
    return radius, bound


@njit(cache=True, error_model="numpy")
def _ball_around(geometry, z, along):
    """Weights (n,), radius and bound of the ball around ``z`` (n,) for the coordinate
    ``along`` (n,)."""
    n = len(z)
    screws, error = np.empty((6, n), np.complex128), np.empty(6, np.complex128)
    inverse = np.empty((n, 7), np.complex128)
    second, weight = np.zeros((n, n, n), np.complex128), np.empty(n)
    _screws_and_error(z, geometry, screws, error)
    _pseudo_inverse(screws, along, inverse)
    _second(screws, inverse, second)
    radius, bound = _ball(screws, inverse, second, weight)
    return weight, radius, bound


@njit(cache=True, error_model="numpy")
def _correct(geometry, z, along):
    """Newton's method on ``z`` (n,) in place, at right angles to ``along`` (n,); False
    where it does not converge."""
    n = len(z)
    screws, error = np.empty((6, n), np.complex128), np.empty(6, np.complex128)
    inverse = np.empty((n, 7), np.complex128)
    for _ in range(8):
        _screws_and_error(z, geometry, screws, error)
        _pseudo_inverse(screws, along, inverse)
        largest = 0.0
        for i in range(n):
            step = 0j
            for k in range(6):
                step += inverse[i, k] * error[k]
            if not abs(step) < np.inf:
                return False
            z[i] -= step
            largest = max(largest, abs(step))
        if largest < 1e-9:  # the error after it is of the order of its square
            return True
    return False


@njit(cache=True, error_model="numpy")
def _follow(geometry, joint, z, end, folds, limits):
    """Whether a sheet ``z`` (n,), moved in place, gets to ``end`` or into the
    neighbourhood of a fold without short steps."""
    n = len(z)
    along = np.zeros(n, np.complex128)
    along[joint] = 1.0
    screws, error = np.empty((6, n), np.complex128), np.empty(6, np.complex128)
    inverse = np.empty((n, 7), np.complex128)
    second, weight = np.zeros((n, n, n), np.complex128), np.empty(n)
    bend, after = np.empty(n, np.complex128), np.empty(n, np.complex128)
    for _ in range(MOST_STEPS):
        for f in range(len(folds)):
            if _has_joined(z, joint, folds[f], limits[f]):
                return True
        left = end - z[joint].real
        if abs(left) < 1e-12:
            return True
        _screws_and_error(z, geometry, screws, error)
        _pseudo_inverse(screws, along, inverse)
        _second(screws, inverse, second)
        radius, bound = _ball(screws, inverse, second, weight)
        slope = inverse[:, 6]
        speed = 0.0
        for a in range(n):
            speed += (abs(slope[a]) / weight[a]) ** 2
            bend[a] = 0j
            for i in range(n):
                for j in range(n):
                    bend[a] -= second[a, i, j] * slope[i] * slope[j]
        speed = np.sqrt(speed)
        step = min(0.75 * radius / speed, abs(left)) * np.sign(left)
        while not _stays_away(
            z, slope, weight, step, 0.5 * bound * (4.0 / 3.0 * speed * step) ** 2
        ):
            step *= 0.5
            if not abs(step) >= SLOW:  # nor not a number
                return False
        if not abs(step) >= min(SLOW, abs(left)):
            return False
        for i in range(n):
            after[i] = z[i] + step * (slope[i] + 0.5 * step * bend[i])
        after[joint] = z[joint] + step
        moved = 0.0
        converged = _correct(geometry, after, along)
        for i in range(n):
            moved += (abs(after[i] - z[i]) / weight[i]) ** 2
        if not (converged and np.sqrt(moved) < radius):  # in the ball there is only one
            return False
        for i in range(n):
            z[i] = after[i]
        z[joint] = z[joint].real
    return False


@register_jitable
def _stays_away(z, slope, weight, step, strayed):
    """Whether the imaginary part of some joint keeps its sign on a step that strays
    from its tangent by ``strayed``."""
    for i in range(len(z)):
        here, there = z[i].imag / weight[i], (z[i] + slope[i] * step).imag / weight[i]
        if here * there > 0 and min(abs(here), abs(there)) > strayed:
            return True
    return False


@register_jitable
def _has_joined(z, joint, fold, limits):
    """Whether a sheet is so near a fold, (3, n) for configuration, tangent and weight,
    that it is one of its pair."""
    away, along = 0.0, 0j
    for i in range(len(z)):
        apart = z[i] - fold[0, i]
        apart -= 2 * np.pi * np.round(apart.real / (2 * np.pi))
        if i == joint and abs(apart) >= limits[2]:
            return False
        away += (abs(apart) / fold[2, i]) ** 2
        along += fold[1, i] * apart
    return np.sqrt(away) < limits[0] and abs(along) < limits[1]
