"""Complete slices: every real configuration of a closed 4R, 5R or 6R loop with one joint angle given.

The elimination. With joint k held, n - 1 joints remain, with fixed links G between their axes (one of them
is the pair of links at joint k). In unit dual quaternions the closure reads ``Z_1 G_1 ... Z_m G_m = +-1``,
Z = cos(theta/2) + k sin(theta/2), m = n - 1. Split it as

    Z_a G_a Z_b  =  +- conj(G_v) conj(Z_v) [conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b)]

Either side runs through a space of only four dimensions (of eight): with G = G' + G'', the parts that
commute and anticommute with k, ``Z_a G Z_b = exp(k (a + b)/2) G' + exp(k (a - b)/2) G''`` is
``x G' + y G''`` with complex x, y (k the imaginary unit) and |x| = |y|. Projecting the right side on what
the left one cannot reach leaves ``(cos(v/2) M_0 + sin(v/2) M_1) y = 0``, a 4 x 4 eigenvalue problem for the
joint v: at most four values, real or complex. Its null vectors with |x| = |y| on both sides are all
configurations of the slice. That is the dialytic elimination of Raghavan and Roth (1993) with the
linear spaces of 2R chains of Husty, Pfurner and Schrocker (2007) in place of the 14 equations. There are
five choices of v: a symmetric geometry makes some of them singular for every slice, so the most regular
one is taken. A 5R loop needs no v, a 4R loop has a single joint on the right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numba.extending import register_jitable

from linkages.loop import GeometryError, Loop

__all__ = ["Slice", "slice_configurations"]

CLOSURE = 1e-12  # a configuration closes: largest entry of T_1 ... T_n - I, lengths in characteristic lengths
SINGULAR = 1e-10  # below this the pencil of an elimination is singular
EQUAL = 1e-6  # rad: two configurations that agree to this are one
ROOM = 40  # configurations kept of one slice: four are possible, more only where a continuum is sampled
STARTS = 48  # starts of Gauss-Newton in a slice that the elimination cannot decide
COMPLETE, CONTINUUM, UNDECIDED = 0, 1, 2
REASONS = {
    CONTINUUM: "a whole motion lies in the slice; some of its configurations are returned",
    UNDECIDED: "every elimination is singular (axes all parallel, concurrent or coincident, or a whole "
    "motion in the slice); what Gauss-Newton found is returned",
}


@dataclass(frozen=True)
class Slice:
    """Configurations of a loop in which joint ``joint`` (from 1) has one of the ``angles`` (m,), rad.

    ``configurations`` (p, n) rad in (-pi, pi]; ``index`` (p,): the entry of ``angles`` each belongs to;
    ``closure`` (p,): largest entry of T_1 ... T_n - I, lengths in characteristic lengths; ``n_complex``
    (m,): number of finite configurations, real or complex, or -1 where ``degenerate`` (m,): there the
    list is not complete, and ``reason`` says why (empty if there is none).
    """

    joint: int
    angles: np.ndarray
    configurations: np.ndarray
    index: np.ndarray
    closure: np.ndarray
    n_complex: np.ndarray
    degenerate: np.ndarray
    reason: str

    @property
    def is_complete(self) -> bool:
        """True when no slice is degenerate: no configuration with these angles is missing."""
        return not np.any(self.degenerate)

    def at(self, i: int) -> np.ndarray:
        """Configurations (q, n), rad, of ``angles[i]``."""
        return self.configurations[self.index == i]


def slice_configurations(loop: Loop, joint: int, angles: np.ndarray) -> Slice:
    """All real configurations of ``loop`` with joint ``joint`` (from 1) at each of ``angles`` (m,), rad.

    Raises `GeometryError` for a loop of more than six joints, a joint that it does not have, and angles
    that are not a list of finite numbers.
    """
    angles = np.atleast_1d(np.asarray(angles, dtype=float))
    if not 4 <= loop.n <= 6:
        raise GeometryError("number of joints of a sliced loop", loop.n, "4, 5 or 6")
    if not 1 <= joint <= loop.n:
        raise GeometryError("joint", joint, f"from 1 to {loop.n}")
    if angles.ndim != 1 or not np.all(np.isfinite(angles)):
        raise GeometryError("angles", angles, "a list of finite numbers")
    lengths, twists, offsets = loop.arrays
    scale = loop.characteristic_length
    links = _link_quaternions(lengths / scale, twists, offsets / scale)
    found, count, n_complex, status = _solve_slices(links, joint - 1, angles)
    index = np.repeat(np.arange(len(angles)), count)
    configurations = np.concatenate([found[i, :c] for i, c in enumerate(count)] or [np.zeros((0, loop.n))])
    gap = loop.frames(configurations)[:, -1] - np.eye(4)
    gap[:, :3, 3] /= scale
    reasons = [
        f"{np.sum(status == s)} of {len(angles)} slices: {text}" for s, text in REASONS.items() if s in status
    ]
    return Slice(
        joint, angles, configurations, index, np.abs(gap).max(axis=(1, 2)), n_complex, status != COMPLETE,
        "; ".join(reasons),
    )  # fmt: skip


def _link_quaternions(lengths: np.ndarray, twists: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Unit dual quaternions (n, 8), real part first, of the links Tz(R) Tx(a) Rx(alpha)."""
    c, s = np.cos(twists / 2), np.sin(twists / 2)
    zero = np.zeros_like(c)
    dual = 0.5 * np.array([-lengths * s, lengths * c, offsets * s, offsets * c])
    return np.concatenate([[c, s, zero, zero], dual]).T.copy()


# --- dual quaternions (w, x, y, z, and the same of the dual part) -------------------------------------------


@register_jitable
def _quaternion_product(p, i, q, j):
    """Product of the quaternions that start at entry i of p and entry j of q."""
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    w, x, y, z = q[j], q[j + 1], q[j + 2], q[j + 3]
    first, second = a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y
    return first, second, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w


@register_jitable
def _product(p, q):
    out = np.empty(8)
    out[0], out[1], out[2], out[3] = _quaternion_product(p, 0, q, 0)
    a, b, c, d = _quaternion_product(p, 0, q, 4)
    w, x, y, z = _quaternion_product(p, 4, q, 0)
    out[4], out[5], out[6], out[7] = a + w, b + x, c + y, d + z
    return out


@register_jitable
def _conjugate(q):
    out = -q
    out[0], out[4] = q[0], q[4]
    return out


@register_jitable
def _turn(angle):
    out = np.zeros(8)
    out[0], out[3] = np.cos(angle / 2), np.sin(angle / 2)
    return out


@register_jitable
def _turn_by_left(q):
    """k q."""
    out = np.empty(8)
    for i in (0, 4):
        out[i], out[i + 1], out[i + 2], out[i + 3] = -q[i + 3], -q[i + 2], q[i + 1], q[i]
    return out


# --- the space of a 2R chain --------------------------------------------------------------------------------


@register_jitable
def _pair_space(link):
    """Orthonormal rows (4, 8) of span(G', k G', G'', k G''), (4, 8) of its complement, and the norms (2,) of
    G' and G''. A norm of zero (then with zero rows) means that the two axes are one line."""
    rows, complement, norms = np.zeros((4, 8)), np.zeros((4, 8)), np.zeros(2)
    for part in range(2):
        i, j = (0, 3) if part == 0 else (1, 2)  # w + z k commutes with k, (x + y k) i anticommutes
        g0, g1, h0, h1 = link[i], link[j], link[i + 4], link[j + 4]
        norm = np.sqrt(g0 * g0 + g1 * g1 + h0 * h0 + h1 * h1)
        norms[part] = norm
        if norm < 1e-12:
            continue
        g0, g1, h0, h1 = g0 / norm, g1 / norm, h0 / norm, h1 / norm
        r = 2 * part
        rows[r, i], rows[r, j], rows[r, i + 4], rows[r, j + 4] = g0, g1, h0, h1
        rows[r + 1, i], rows[r + 1, j], rows[r + 1, i + 4], rows[r + 1, j + 4] = -g1, g0, -h1, h0
        complement[r, i], complement[r, j], complement[r, i + 4], complement[r, j + 4] = -h0, h1, g0, -g1
        complement[r + 1, i], complement[r + 1, j] = -h1, -h0
        complement[r + 1, i + 4], complement[r + 1, j + 4] = g1, g0
    return rows, complement, norms


@register_jitable
def _modulus_defect(p, q, norms):
    """Bilinear form of |x|^2 - |y|^2 for coordinates p = q in the rows of `_pair_space`."""
    total = norms[0] ** 2 + norms[1] ** 2
    first, second = norms[1] ** 2 / total, norms[0] ** 2 / total
    return first * (p[0] * q[0] + p[1] * q[1]) - second * (p[2] * q[2] + p[3] * q[3])


@register_jitable
def _pair_turns(p, norms):
    """exp(i theta_a), exp(i theta_b) of Z_a G Z_b with coordinates p; zeros where tan(theta/2) = +-i."""
    x_plus, x_minus = (p[0] + 1j * p[1]) * norms[1], (p[0] - 1j * p[1]) * norms[1]
    y_plus, y_minus = (p[2] + 1j * p[3]) * norms[0], (p[2] - 1j * p[3]) * norms[0]
    size = np.sqrt(abs(x_plus) ** 2 + abs(x_minus) ** 2 + abs(y_plus) ** 2 + abs(y_minus) ** 2)
    if min(abs(x_minus), abs(x_plus), abs(y_plus), abs(y_minus)) < 1e-5 * size or size == 0:
        return 0j, 0j
    return y_plus / x_minus, y_minus / x_minus


@register_jitable
def _right_space(after_b, after_c, after_d):
    """Rows (4, 8) spanning conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b), and the norms (2,) of the pair."""
    rows, _, norms = _pair_space(_conjugate(after_c))
    left, right = _conjugate(after_d), _conjugate(after_b)
    for i in range(4):
        rows[i] = _product(_product(left, rows[i]), right)
    return rows, norms


@register_jitable
def _projected(complement, rows):
    """Matrix (4, q): the components of the q rows that the left side cannot reach."""
    out = np.zeros((4, len(rows)))
    for i in range(4):
        for j in range(len(rows)):
            for k in range(8):
                out[i, j] += complement[i, k] * rows[j, k]
    return out


# --- candidates: null vectors that satisfy the moduli -------------------------------------------------------


@register_jitable
def _record(y, rows, left, left_norms, right_norms, turns, defects, count):
    """Append the joints (a, b, c, d) of the null vector y to ``turns``; their number afterwards."""
    if count >= len(turns):
        return count
    reached, x = np.zeros(8, np.complex128), np.zeros(4, np.complex128)
    for j in range(len(rows)):
        reached += y[j] * rows[j]
    for i in range(4):
        for k in range(8):
            x[i] += left[i, k] * reached[k]
    size = np.sum(np.abs(x) ** 2) + 1e-300
    defects[count] = abs(_modulus_defect(x, x, left_norms)) / size
    turns[count, 0], turns[count, 1] = _pair_turns(x, left_norms)
    if len(rows) == 2:  # a single joint on the right: y is (cos, sin) of half its angle
        plus, minus = y[0] + 1j * y[1], y[0] - 1j * y[1]
        turns[count, 2] = plus / minus if min(abs(plus), abs(minus)) > 1e-5 else 0j
    else:
        size = np.sum(np.abs(y) ** 2) + 1e-300
        defects[count] = max(defects[count], abs(_modulus_defect(y, y, right_norms)) / size)
        minus_d, minus_c = _pair_turns(y, right_norms)
        turns[count, 2] = 1 / minus_c if minus_c != 0 else 0j
        turns[count, 3] = 1 / minus_d if minus_d != 0 else 0j
    return count + 1


@register_jitable
def _line_forms(p, q, rows, left, left_norms, right_norms):
    """Coefficients (2, 3) of the moduli defects of s p + t q, left and right, in s s, s t, t t."""
    out = np.zeros((2, 3), np.complex128)
    ends = np.zeros((2, 4), np.complex128)
    for j in range(len(rows)):
        for i in range(4):
            reach = 0j
            for k in range(8):
                reach += left[i, k] * rows[j, k]
            ends[0, i] += reach * p[j]
            ends[1, i] += reach * q[j]
    out[0, 0] = _modulus_defect(ends[0], ends[0], left_norms)
    out[0, 1] = 2 * _modulus_defect(ends[0], ends[1], left_norms)
    out[0, 2] = _modulus_defect(ends[1], ends[1], left_norms)
    if len(rows) == 4:
        out[1, 0] = _modulus_defect(p, p, right_norms)
        out[1, 1] = 2 * _modulus_defect(p, q, right_norms)
        out[1, 2] = _modulus_defect(q, q, right_norms)
    return out


@register_jitable
def _record_null_space(matrix, rows, left, left_norms, right_norms, turns, defects, count):
    """Append the candidates in the null space of ``matrix`` (4, q); the right side is spanned by ``rows`` (q, 8).

    Returns their number, the number of them that sample a continuum, and whether the null space has three
    dimensions or more, which is not resolved. A null space of two dimensions is a line that meets
    the two quadrics |x| = |y| in at most two points, unless it lies in both: a continuum.
    """
    _, sigma, vh = np.linalg.svd(matrix)
    q = matrix.shape[1]
    sigma = sigma / max(sigma[0], 1.0)
    p = np.conj(vh[q - 1])
    count = _record(p, rows, left, left_norms, right_norms, turns, defects, count)
    if sigma[q - 2] > 1e-3:
        return count, 0, False
    other = np.conj(vh[q - 2])
    forms = _line_forms(p, other, rows, left, left_norms, right_norms)
    sizes = np.abs(forms).sum(axis=1)
    a, b, c = forms[1] if sizes[1] > sizes[0] else forms[0]
    root = np.sqrt(b * b - 4 * a * c)
    lead = b + root if abs(b + root) > abs(b - root) else b - root
    for s, t in ((-lead, 2 * a), (2 * c, -lead)):
        size = np.sqrt(abs(s) ** 2 + abs(t) ** 2)
        if size > 1e-12:
            y = (s * p + t * other) / size
            count = _record(y, rows, left, left_norms, right_norms, turns, defects, count)
    sampled = 0
    if sigma[q - 2] < 1e-6 and sizes.max() < 1e-6:
        p, other = _real_line(p, other)
        for i in range(8):
            y = np.cos(0.2 + i * np.pi / 8) * p + np.sin(0.2 + i * np.pi / 8) * other
            count = _record(y, rows, left, left_norms, right_norms, turns, defects, count)
        sampled = 8
    return count, sampled, q > 2 and sigma[q - 3] < 1e-7


@register_jitable
def _real_line(p, q):
    """The same two vectors turned by phases that make them real where they can be."""
    return p * np.exp(-0.5j * np.angle(np.sum(p * p))), q * np.exp(-0.5j * np.angle(np.sum(q * q)))


# --- the three sizes of chain -------------------------------------------------------------------------------


@register_jitable
def _solve_three(fixed, turns, defects):
    """Candidates of a chain of three joints with links ``fixed`` (3, 8): (count, sampled, crowded)."""
    best, value = 0, -1.0
    for a in range(3):
        smallest = _pair_space(fixed[a])[2].min()
        if smallest > value:
            best, value = a, smallest
    after_b, after_c = _conjugate(fixed[(best + 1) % 3]), _conjugate(fixed[(best + 2) % 3])
    left, complement, norms = _pair_space(fixed[best])
    rows = np.empty((2, 8))
    rows[0], rows[1] = _product(after_c, after_b), -_product(after_c, _turn_by_left(after_b))
    matrix = _projected(complement, rows).astype(np.complex128)
    count, sampled, _ = _record_null_space(
        matrix, rows.astype(np.complex128), left, norms, norms, turns, defects, 0
    )
    _reorder(turns, count, 3, best)
    return count, sampled, value < 1e-10


@register_jitable
def _solve_four(fixed, turns, defects):
    """Candidates of a chain of four joints: (count, sampled, crowded)."""
    count, sampled, crowded = 0, 0, True
    for a in range(2):
        left, complement, left_norms = _pair_space(fixed[a])
        rows, right_norms = _right_space(fixed[a + 1], fixed[a + 2], fixed[(a + 3) % 4])
        matrix = _projected(complement, rows).astype(np.complex128)
        count, sampled, crowded = _record_null_space(
            matrix, rows.astype(np.complex128), left, left_norms, right_norms, turns, defects, 0
        )
        if not crowded:
            _reorder(turns, count, 4, a)
            break
    return count, sampled, crowded


@register_jitable
def _pencil(fixed, v):
    """M_0, M_1 (4, 4) of the elimination that keeps joint v, with the rows (4, 8) they project."""
    complement = _pair_space(fixed[(v + 1) % 5])[1]
    rows, _ = _right_space(fixed[(v + 2) % 5], fixed[(v + 3) % 5], fixed[(v + 4) % 5])
    cosine, sine = np.empty((4, 8)), np.empty((4, 8))
    for i in range(4):
        cosine[i] = _product(_conjugate(fixed[v]), rows[i])
        sine[i] = -_product(_conjugate(fixed[v]), _turn_by_left(rows[i]))
    return _projected(complement, cosine), _projected(complement, sine), cosine, sine


@register_jitable
def _inverse(matrix):
    """Inverse (4, 4) with complete pivoting, and 1 / its Frobenius norm, which is at most the smallest
    singular value; 0 for a singular matrix."""
    a, b = matrix.copy(), np.eye(4)
    used_row, column_of = np.zeros(4, np.bool_), np.full(4, -1)
    free = np.ones(4, np.bool_)
    for _ in range(4):
        best, r, c = 0.0, -1, -1
        for i in range(4):
            for j in range(4):
                if not used_row[i] and free[j] and abs(a[i, j]) > best:
                    best, r, c = abs(a[i, j]), i, j
        if best < 1e-14:
            return b, 0.0
        used_row[r], free[c], column_of[r] = True, False, c
        b[r] /= a[r, c]
        a[r] /= a[r, c]
        for i in range(4):
            if i != r:
                b[i] -= a[i, c] * b[r]
                a[i] -= a[i, c] * a[r]
    out = np.empty((4, 4))
    for i in range(4):
        out[column_of[i]] = b[i]
    return out, 1 / np.sqrt(np.sum(out * out))


@register_jitable
def _most_regular(fixed, excluded):
    """(kept joint v, half angle, regularity) of the elimination and origin with the best conditioned M."""
    best, kept, origin = 0.0, -1, 0.0
    for v in range(5):
        if excluded[v]:
            continue
        m0, m1, _, _ = _pencil(fixed, v)
        for i in range(3):
            half = 0.3 + i * np.pi / 3
            value = _inverse(np.cos(half) * m0 + np.sin(half) * m1)[1]
            if value > best:
                best, kept, origin = value, v, half
    return kept, origin, best


@register_jitable
def _solve_five(fixed, turns, defects):
    """Candidates of a chain of five joints: (count, sampled, crowded or singular)."""
    excluded = np.zeros(5, np.bool_)
    for _ in range(5):
        v, origin, regularity = _most_regular(fixed, excluded)
        if regularity < SINGULAR:
            break
        count, sampled, crowded = _solve_pencil(fixed, v, origin, turns, defects)
        if not crowded:
            return count, sampled, False
        excluded[v] = True
    return 0, 0, True


@register_jitable
def _solve_pencil(fixed, v, origin, turns, defects):
    """Candidates from the eigenvalues of one elimination: (count, sampled, crowded)."""
    m0, m1, cosine, sine = _pencil(fixed, v)
    left, _, left_norms = _pair_space(fixed[(v + 1) % 5])
    right_norms = _pair_space(_conjugate(fixed[(v + 3) % 5]))[2]
    c0, s0 = np.cos(origin), np.sin(origin)
    inverse, _ = _inverse(c0 * m0 + s0 * m1)
    values = np.linalg.eigvals((inverse @ (c0 * m1 - s0 * m0)).astype(np.complex128))
    count, sampled, crowded = 0, 0, False
    for value in values:
        # cos(half) M + sin(half) M' is singular for half = origin + arccot(-value)
        size = np.sqrt(1 + abs(value) ** 2)
        c, s = (-value * c0 - s0) / size, (-value * s0 + c0) / size
        if min(abs(c + 1j * s), abs(c - 1j * s)) < 1e-5:
            continue  # at infinity
        before = count
        count, more, full = _record_null_space(
            c * m0 + s * m1, c * cosine + s * sine, left, left_norms, right_norms, turns, defects, before
        )
        kept = (c + 1j * s) / (c - 1j * s)
        turns[before:count, 4] = kept
        sampled += more
        crowded = crowded or (full and abs(abs(kept) - 1) < 1e-3)
    _reorder(turns, count, 5, (v + 1) % 5)
    return count, sampled, crowded


@register_jitable
def _reorder(turns, count, m, first):
    """Columns 0, 1, ... of ``turns`` belong to joints first, first + 1, ... of a chain of m: sort them."""
    for i in range(count):
        row = turns[i].copy()
        for j in range(m):
            turns[i, (first + j) % m] = row[j]


# --- from candidates to configurations ----------------------------------------------------------------------


@register_jitable
def _closure(fixed, theta, jacobian):
    """Closure error (6,): rotation vector and translation, to first order; its derivative into (6, m).

    The vector part of a quaternion vanishes for the identity only, so half turns are no ghosts.
    """
    m = len(theta)
    after = np.zeros((m + 1, 8))
    after[m, 0] = 1.0
    for i in range(m - 1, -1, -1):
        after[i] = _product(_product(_turn(theta[i]), fixed[i]), after[i + 1])
    total, before = after[0], np.zeros(8)
    sign = 1.0 if total[0] >= 0 else -1.0
    before[0] = sign
    error = np.empty(6)
    for r in range(3):
        error[r], error[r + 3] = 2 * sign * total[r + 1], 2 * sign * total[r + 5]
    for i in range(m):
        derivative = _product(before, _turn_by_left(after[i]))
        for r in range(3):
            jacobian[r, i], jacobian[r + 3, i] = derivative[r + 1], derivative[r + 5]
        before = _product(_product(before, _turn(theta[i])), fixed[i])
    return error


@register_jitable
def _least_squares(matrix, right):
    """The x (m,) of least |matrix x - right|: Gram-Schmidt with pivots, directions below 1e-9 get no part."""
    a, b, m = matrix.copy(), right.copy(), matrix.shape[1]
    order, r, x = np.arange(m), np.zeros((m, m)), np.zeros(m)
    rank, first = m, 1.0
    for k in range(m):
        best = k
        for j in range(k, m):
            if np.sum(a[:, j] ** 2) > np.sum(a[:, best] ** 2):
                best = j
        for i in range(len(a)):
            a[i, k], a[i, best] = a[i, best], a[i, k]
        for i in range(k):
            r[i, k], r[i, best] = r[i, best], r[i, k]
        order[k], order[best] = order[best], order[k]
        norm = np.sqrt(np.sum(a[:, k] ** 2))
        first = norm if k == 0 else first
        if norm <= 1e-9 * first:
            rank = k
            break
        r[k, k] = norm
        a[:, k] /= norm
        for j in range(k + 1, m):
            r[k, j] = np.sum(a[:, k] * a[:, j])
            a[:, j] -= r[k, j] * a[:, k]
        x[k] = np.sum(a[:, k] * b)
        b -= x[k] * a[:, k]
    out = np.zeros(m)
    for k in range(rank - 1, -1, -1):
        for j in range(k + 1, rank):
            x[k] -= r[k, j] * x[j]
        x[k] /= r[k, k]
        out[order[k]] = x[k]
    return out


@register_jitable
def _polish(fixed, theta):
    """Gauss-Newton on ``theta`` (m,), in place; True when it closes."""
    jacobian = np.empty((6, len(theta)))
    previous = np.inf
    for i in range(60):
        error = _closure(fixed, theta, jacobian)
        size = np.abs(error).max()
        if size < 5e-16 or (size < 1e-13 and size > 0.5 * previous):
            break
        if i > 10 and (size > 1e-3 or size > 0.9 * previous):
            break
        previous = size
        step = _least_squares(jacobian, error)
        theta -= step * min(1.0, 0.5 / (np.abs(step).max() + 1e-300))
    return np.abs(_closure(fixed, theta, jacobian)).max() < 0.3 * CLOSURE


@register_jitable
def _wrapped(angle):
    """The angle in (-pi, pi]."""
    out = angle - 2 * np.pi * np.round(angle / (2 * np.pi))
    return np.pi if out <= -np.pi else out


@register_jitable
def _add_new(fixed, theta, found, count):
    """Number of configurations in ``found`` after adding ``theta``, unless it is among them.

    At a singular configuration Gauss-Newton stops at different points that all close: two points whose
    middle closes too are one.
    """
    jacobian = np.empty((6, len(theta)))
    for i in range(len(theta)):
        theta[i] = _wrapped(theta[i])
    for i in range(count):
        gap = theta - found[i]
        for j in range(len(gap)):
            gap[j] = _wrapped(gap[j])
        distance = np.abs(gap).max()
        if distance < EQUAL:
            return count
        if distance < 1e-2 and np.abs(_closure(fixed, theta - gap / 2, jacobian)).max() < 1e-14:
            return count
    if count < len(found):
        found[count] = theta
        count += 1
    return count


@register_jitable
def _add_complex(turn, others, count):
    """Number of rows of ``others`` (exp(i theta), complex) after adding ``turn`` unless it is among them."""
    for i in range(count):
        if np.abs(turn / others[i] - 1).max() < 1e-4:
            return count
    if count < len(others):
        others[count] = turn
        count += 1
    return count


@register_jitable
def _collect(fixed, turns, defects, candidates, found):
    """(real configurations, all finite ones, candidates that close where they were) from the candidates."""
    m = len(fixed)
    others = np.empty((len(turns), m), np.complex128)
    count, n_others, held = 0, 0, 0
    for i in range(candidates):
        turn = turns[i, :m]
        if np.abs(turn).min() < 1e-10 or defects[i] > 0.02:
            continue
        real = False
        if np.abs(np.log(np.abs(turn))).max() < 0.1:
            start = np.angle(turn)
            theta = start.copy()
            if _polish(fixed, theta):
                real = np.abs(np.exp(1j * theta) / turn - 1).max() < 1e-3
                held += real
                count = _add_new(fixed, theta, found, count)
        if not real and defects[i] < 1e-6:
            n_others = _add_complex(turn, others, n_others)
    return count, count + n_others, held


@register_jitable
def _sample(fixed, found, count):
    """Number of configurations in ``found`` after Gauss-Newton from fixed, well spread starts."""
    m = len(fixed)
    theta = np.empty(m)
    for i in range(STARTS):
        for j in range(m):  # the Weyl sequence of square roots of primes
            theta[j] = 2 * np.pi * ((i + 1) * np.sqrt((2.0, 3.0, 5.0, 7.0, 11.0)[j]) % 1.0)
        if _polish(fixed, theta):
            count = _add_new(fixed, theta, found, count)
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def _solve_slices(links, joint, angles):
    """Configurations (m, ROOM, n), their numbers (m,), numbers with complex ones (m,) and status (m,)."""
    n = len(links)
    found, count = np.zeros((len(angles), ROOM, n)), np.zeros(len(angles), np.int64)
    n_complex, status = np.zeros(len(angles), np.int64), np.zeros(len(angles), np.int64)
    fixed, chain = np.empty((n - 1, 8)), np.empty((ROOM, n - 1))
    turns, defects = np.ones((64, n - 1 if n > 4 else 4), np.complex128), np.zeros(64)
    for k in range(len(angles)):
        for i in range(n - 1):
            fixed[i] = links[(joint + 1 + i) % n]
        fixed[n - 2] = _product(_product(fixed[n - 2], _turn(angles[k])), links[joint])
        if n == 4:
            candidates, sampled, crowded = _solve_three(fixed, turns, defects)
        elif n == 5:
            candidates, sampled, crowded = _solve_four(fixed, turns, defects)
        else:
            candidates, sampled, crowded = _solve_five(fixed, turns, defects)
        count[k], n_complex[k], held = _collect(fixed, turns, defects, candidates, chain)
        if crowded:
            status[k] = UNDECIDED
            count[k] = _sample(fixed, chain, count[k])
        elif sampled and held > 4:
            status[k] = CONTINUUM
        if status[k] != COMPLETE:
            n_complex[k] = -1
        for i in range(count[k]):
            found[k, i, joint] = _wrapped(angles[k])
            for j in range(n - 1):
                found[k, i, (joint + 1 + j) % n] = chain[i, j]
    return found, count, n_complex, status
