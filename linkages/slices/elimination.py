"""Complete slices: every real configuration of a closed 4R, 5R or 6R loop with one
joint angle given.

The elimination. With joint k held, n - 1 joints remain, with fixed links G between
their axes (one of them is the pair of links at joint k). In unit dual quaternions the
closure reads ``Z_1 G_1 ... Z_m G_m = +-1``, Z = cos(theta/2) + k sin(theta/2), m = n -
1. Split it as

    Z_a G_a Z_b  =  +- conj(G_v) conj(Z_v)
                       [conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b)]

Either side runs through a space of only four dimensions (of eight): with G = G' + G'',
the parts that commute and anticommute with k, ``Z_a G Z_b = exp(k (a + b)/2) G' + exp(k
(a - b)/2) G''`` is ``x G' + y G''`` with complex x, y (k the imaginary unit) and |x| =
|y|. Projecting the right side on what the left one cannot reach leaves ``(cos(v/2) M_0
+ sin(v/2) M_1) y = 0``, a 4 x 4 eigenvalue problem for the joint v: at most four
values, real or complex. Its null vectors with |x| = |y| on both sides are all
configurations of the slice. That is the dialytic elimination of Raghavan and Roth
(1993) with the linear spaces of 2R chains of Husty, Pfurner and Schrocker (2007) in
place of the 14 equations. There are five choices of v: a symmetric geometry makes some
of them singular for every slice, so the most regular one is taken. A 5R loop needs no
v, a 4R loop has a single joint on the right.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (numba infers the types of compiled functions)

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable

from linkages.loop import GeometryError, Loop

__all__ = ["Slice", "slice_configurations"]

# a configuration closes: largest entry of T_1 ... T_n - I, lengths in characteristic
# lengths
CLOSURE = 1e-13
SINGULAR = 1e-10  # below this the pencil of an elimination is singular
# exp(i theta) below this, or above its inverse: a complex solution at infinity
INFINITE = 1e-4
EQUAL = 1e-6  # rad: two configurations that agree to this are one
# configurations kept of one slice: four are possible, more only where a continuum is
# sampled
ROOM = 40
CANDIDATES = 64  # of one slice: twelve, more only where a continuum is sampled
STARTS = 48  # starts of Gauss-Newton in a slice that the elimination cannot decide
# what came of one slice, as the compiled functions write it
COMPLETE = 0
CONTINUUM = 1
UNDECIDED = 2
REASONS = {
    CONTINUUM: (
        "a whole motion lies in the slice; some of its configurations are returned"
    ),
    UNDECIDED: (
        "every elimination is singular (axes all parallel, concurrent or coincident, "
        "or a whole motion in the slice); what Gauss-Newton found is returned"
    ),
}
SHORTEST = 4  # joints of a loop that is sliced
LONGEST = 6


@dataclass(frozen=True)
class Slice:
    """Configurations of a loop in which joint ``joint`` (from 1) has one of the
    ``angles`` (m,), rad.

    ``configurations`` (p, n) rad in (-pi, pi]; ``index`` (p,): the entry of ``angles``
    each belongs to; ``closure`` (p,): largest entry of T_1 ... T_n - I, lengths in
    characteristic lengths; ``n_complex`` (m,): number of finite configurations, real or
    complex, or -1 where ``degenerate`` (m,): there the list is not complete, and
    ``reason`` says why (empty if there is none). ``nonreal`` (q, n), complex, are the
    finite configurations that are not real, conjugates included, ``nonreal_index`` (q,)
    their entries of ``angles``.
    """

    joint: int
    angles: np.ndarray
    configurations: np.ndarray
    index: np.ndarray
    closure: np.ndarray
    n_complex: np.ndarray
    degenerate: np.ndarray
    reason: str
    nonreal: np.ndarray
    nonreal_index: np.ndarray

    @property
    def is_complete(self) -> bool:
        """True when no slice is degenerate: no configuration with these angles is
        missing."""
        return not np.any(self.degenerate)

    def at(self, i: int) -> np.ndarray:
        """Configurations (q, n), rad, of ``angles[i]``."""
        of_angle: np.ndarray = self.configurations[self.index == i]
        return of_angle


class Solutions(NamedTuple):
    """What the compiled functions find at m angles: real configurations (m, ROOM, n)
    and their ``counts`` (m,), those that are not real, too, and ``statuses`` (m,),
    `COMPLETE` or one of `REASONS`."""

    configurations: np.ndarray
    counts: np.ndarray
    nonreal: np.ndarray
    nonreal_counts: np.ndarray
    statuses: np.ndarray


def slice_configurations(loop: Loop, joint: int, angles: np.ndarray) -> Slice:
    """All real configurations of ``loop`` with joint ``joint`` (from 1) at each of
    ``angles`` (m,), rad.

    Raises `GeometryError` for a loop of more than six joints, a joint that it does not
    have, and angles that are not a list of finite numbers.
    """
    angles = np.atleast_1d(np.asarray(angles, dtype=float))
    _check(loop, joint, angles)
    solutions = _solve_slices(_link_quaternions(loop), joint - 1, angles)
    counts, nonreal_counts = solutions.counts, solutions.nonreal_counts
    places = np.arange(ROOM)
    entries = np.arange(len(angles))
    configurations = solutions.configurations[places < counts[:, None]]
    is_complete = solutions.statuses == COMPLETE
    return Slice(
        joint=joint,
        angles=angles,
        configurations=configurations,
        index=np.repeat(entries, counts),
        closure=loop.closure_error(configurations),
        n_complex=np.where(is_complete, counts + nonreal_counts, -1),
        degenerate=~is_complete,
        reason=_reason(solutions.statuses),
        nonreal=solutions.nonreal[places < nonreal_counts[:, None]],
        nonreal_index=np.repeat(entries, nonreal_counts),
    )


def _check(loop: Loop, joint: int, angles: np.ndarray) -> None:
    if not SHORTEST <= loop.n <= LONGEST:
        raise GeometryError("number of joints of a sliced loop", loop.n, "4, 5 or 6")
    if not 1 <= joint <= loop.n:
        raise GeometryError("joint", joint, f"from 1 to {loop.n}")
    if angles.ndim != 1 or not np.all(np.isfinite(angles)):
        raise GeometryError("angles", angles, "a list of finite numbers")


def _reason(statuses: np.ndarray) -> str:
    """Why slices are not complete, and how many; empty where all are."""
    reasons = []
    for status, text in REASONS.items():
        count = np.sum(statuses == status)
        if count:
            reasons.append(f"{count} of {len(statuses)} slices: {text}")
    return "; ".join(reasons)


def _link_quaternions(loop: Loop) -> np.ndarray:
    """Unit dual quaternions (n, 8), real part first, of the links Tz(R) Tx(a)
    Rx(alpha), lengths in characteristic lengths."""
    lengths, offsets, _, _, c, s = loop.link_geometry
    zero = np.zeros_like(c)
    dual = 0.5 * np.array([-lengths * s, lengths * c, offsets * s, offsets * c])
    return np.concatenate([[c, s, zero, zero], dual]).T.copy()


def _solve_slices(links: np.ndarray, joint: int, angles: np.ndarray) -> Solutions:
    """The configurations with ``joint`` (from 0) at each of ``angles`` (m,)."""
    m, n = len(angles), len(links)
    turns = np.ones((m, CANDIDATES, max(n - 1, 4)), np.complex128)
    defects = np.zeros((m, CANDIDATES))
    # number of candidates, of those that sample a continuum, undecided
    outcome = np.zeros((m, 3), np.int64)
    fill_candidates = {4: _candidates_4r, 5: _candidates_5r, 6: _candidates_6r}[n]
    fill_candidates(links, joint, angles, turns, defects, outcome)
    solutions = _configurations(links, joint, angles, turns, defects, outcome)
    return Solutions(*solutions)


# --- dual quaternions (w, x, y, z, and the same of the dual part) ---------------------


@register_jitable
def _copy(target, source):
    """Fill ``target`` (k,); a loop, because numba takes a second to compile an
    assignment of rows."""
    for i in range(len(target)):
        target[i] = source[i]


@register_jitable
def _quaternion_product(p, i, q, j):
    """Product of the quaternions that start at entry i of p and entry j of q."""
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    w, x, y, z = q[j], q[j + 1], q[j + 2], q[j + 3]
    first, second = a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y
    return first, second, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w


@register_jitable
def _product(p, q):
    out = np.empty_like(p)
    out[0], out[1], out[2], out[3] = _quaternion_product(p, 0, q, 0)
    a, b, c, d = _quaternion_product(p, 0, q, 4)
    w, x, y, z = _quaternion_product(p, 4, q, 0)
    out[4], out[5], out[6], out[7] = a + w, b + x, c + y, d + z
    return out


@register_jitable
def _conjugate(q):
    out = np.empty(8)
    for i in range(8):
        out[i] = q[i] if i % 4 == 0 else -q[i]
    return out


@register_jitable
def _turned(angle, q):
    """(cos(angle/2) + k sin(angle/2)) q."""
    c, s, out, side = (
        np.cos(angle / 2),
        np.sin(angle / 2),
        np.empty_like(q),
        _turn_by_left(q),
    )
    for i in range(8):
        out[i] = c * q[i] + s * side[i]
    return out


@register_jitable
def _turn_by_left(q):
    """k q."""
    out = np.empty_like(q)
    for i in (0, 4):
        out[i], out[i + 1], out[i + 2], out[i + 3] = (
            -q[i + 3],
            -q[i + 2],
            q[i + 1],
            q[i],
        )
    return out


# --- the space of a 2R chain ----------------------------------------------------------


@register_jitable
def _pair_space(link):
    """Orthonormal rows (4, 8) of span(G', k G', G'', k G''), (4, 8) of its complement,
    and the norms (2,) of G' and G''. A norm of zero (then with zero rows) means that
    the two axes are one line."""
    rows, complement, norms = np.zeros((4, 8)), np.zeros((4, 8)), np.zeros(2)
    for part in range(2):
        i, j = (
            (0, 3) if part == 0 else (1, 2)
        )  # w + z k commutes with k, (x + y k) i anticommutes
        g0, g1, h0, h1 = link[i], link[j], link[i + 4], link[j + 4]
        norm = np.sqrt(g0 * g0 + g1 * g1 + h0 * h0 + h1 * h1)
        norms[part] = norm
        if norm < 1e-12:
            continue
        g0, g1, h0, h1 = g0 / norm, g1 / norm, h0 / norm, h1 / norm
        r = 2 * part
        rows[r, i], rows[r, j], rows[r, i + 4], rows[r, j + 4] = g0, g1, h0, h1
        rows[r + 1, i], rows[r + 1, j], rows[r + 1, i + 4], rows[r + 1, j + 4] = (
            -g1,
            g0,
            -h1,
            h0,
        )
        (
            complement[r, i],
            complement[r, j],
            complement[r, i + 4],
            complement[r, j + 4],
        ) = -h0, h1, g0, -g1
        complement[r + 1, i], complement[r + 1, j] = -h1, -h0
        complement[r + 1, i + 4], complement[r + 1, j + 4] = g1, g0
    return rows, complement, norms


@register_jitable
def _modulus_defect(p, q, norms):
    """Bilinear form of |x|^2 - |y|^2 for coordinates p = q in the rows of
    `_pair_space`."""
    total = norms[0] ** 2 + norms[1] ** 2
    first, second = norms[1] ** 2 / total, norms[0] ** 2 / total
    return first * (p[0] * q[0] + p[1] * q[1]) - second * (p[2] * q[2] + p[3] * q[3])


@register_jitable
def _pair_turns(p, norms):
    """exp(i theta_a), exp(i theta_b) of Z_a G Z_b with coordinates p; zeros where
    tan(theta/2) = +-i."""
    x_plus, x_minus = (p[0] + 1j * p[1]) * norms[1], (p[0] - 1j * p[1]) * norms[1]
    y_plus, y_minus = (p[2] + 1j * p[3]) * norms[0], (p[2] - 1j * p[3]) * norms[0]
    size = np.sqrt(
        abs(x_plus) ** 2 + abs(x_minus) ** 2 + abs(y_plus) ** 2 + abs(y_minus) ** 2
    )
    if min(abs(x_minus), abs(x_plus), abs(y_plus), abs(y_minus)) <= INFINITE * size:
        return 0j, 0j
    return y_plus / x_minus, y_minus / x_minus


@register_jitable
def _right_space(after_b, after_c, after_d):
    """Rows (4, 8) spanning conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b), and the
    norms of the pair."""
    rows, _, norms = _pair_space(_conjugate(after_c))
    left, right = _conjugate(after_d), _conjugate(after_b)
    for i in range(4):
        _copy(rows[i], _product(_product(left, rows[i]), right))
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


# --- candidates: null vectors that satisfy the moduli ---------------------------------


@register_jitable
def _size(p):
    """Euclidean norm of a complex vector."""
    total = 0.0
    for z in p:
        total += z.real * z.real + z.imag * z.imag
    return np.sqrt(total)


@register_jitable
def _left_coordinates(y, rows, left):
    """Coordinates (4,) on the left side of the element with coordinates y on the
    right."""
    x = np.zeros(4, np.complex128)
    for k in range(8):
        entry = 0j
        for j in range(len(rows)):
            entry += y[j] * rows[j, k]
        for i in range(4):
            x[i] += left[i, k] * entry
    return x


@register_jitable
def _record(y, rows, left, left_norms, right_norms, turns, defects, count):
    """Append the joints (a, b, c, d) of the null vector y to ``turns``; their number
    afterwards."""
    if count >= len(turns):
        return count
    x = _left_coordinates(y, rows, left)
    defects[count] = abs(_modulus_defect(x, x, left_norms)) / (_size(x) ** 2 + 1e-300)
    turns[count, 0], turns[count, 1] = _pair_turns(x, left_norms)
    if len(rows) == 2:  # a single joint on the right: y is (cos, sin) of half its angle
        plus, minus = y[0] + 1j * y[1], y[0] - 1j * y[1]
        turns[count, 2] = plus / minus if min(abs(plus), abs(minus)) > INFINITE else 0j
    else:
        defect = abs(_modulus_defect(y, y, right_norms)) / (_size(y) ** 2 + 1e-300)
        defects[count] = max(defects[count], defect)
        minus_d, minus_c = _pair_turns(y, right_norms)
        turns[count, 2] = 1 / minus_c if minus_c != 0 else 0j
        turns[count, 3] = 1 / minus_d if minus_d != 0 else 0j
    return count + 1


@register_jitable
def _line_forms(p, q, rows, left, left_norms, right_norms):
    """Coefficients (2, 3) of the modulus defects of s p + t q, left and right, in s s,
    s t, t t."""
    out = np.zeros((2, 3), np.complex128)
    x, z = _left_coordinates(p, rows, left), _left_coordinates(q, rows, left)
    for side in range(2 if len(rows) == 4 else 1):
        a, b, norms = (x, z, left_norms) if side == 0 else (p, q, right_norms)
        out[side, 0] = _modulus_defect(a, a, norms)
        out[side, 1] = 2 * _modulus_defect(a, b, norms)
        out[side, 2] = _modulus_defect(b, b, norms)
    return out


@register_jitable
def _record_line(p, q, rows, left, left_norms, right_norms, turns, defects, count):
    """Append the points of the line through p and q on the quadrics |x| = |y|; their
    number afterwards, and the largest coefficient of the quadrics: both contain the
    line when it vanishes."""
    forms = _line_forms(p, q, rows, left, left_norms, right_norms)
    sizes = _size(forms[0]), _size(forms[1])
    a, b, c = forms[1] if sizes[1] > sizes[0] else forms[0]
    root = np.sqrt(b * b - 4 * a * c)
    lead = b + root if abs(b + root) > abs(b - root) else b - root
    for i in range(2):
        s, t = (-lead, 2 * a) if i == 0 else (2 * c, -lead)
        size = np.sqrt(abs(s) ** 2 + abs(t) ** 2)
        if size > 1e-12:
            y = _combined(s / size, p, t / size, q)
            count = _record(
                y, rows, left, left_norms, right_norms, turns, defects, count
            )
    return count, max(sizes[0], sizes[1])


@register_jitable
def _mixed(s, p, t, q):
    """s p + t q of two real matrices."""
    out = np.empty(p.shape, np.complex128)
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            out[i, j] = s * p[i, j] + t * q[i, j]
    return out


@register_jitable
def _combined(s, p, t, q):
    """s p + t q."""
    out = np.empty(len(p), np.complex128)
    for i in range(len(p)):
        out[i] = s * p[i] + t * q[i]
    return out


@register_jitable
def _eliminate(matrix, reduced, order, steps):
    """Largest entry left after ``steps`` steps of Gauss-Jordan with complete pivoting
    on ``matrix`` (4, q).

    ``reduced`` takes the result, ``order`` its order of columns.
    """
    q = matrix.shape[1]
    for j in range(q):
        order[j] = j
        for i in range(4):
            reduced[i, j] = matrix[i, j]
    for k in range(steps + 1):
        best, r, c = 0.0, k, k
        for i in range(k, 4):
            for j in range(k, q):
                if abs(reduced[i, j]) > best:
                    best, r, c = abs(reduced[i, j]), i, j
        if k == steps or best < 1e-300:
            return best
        order[k], order[c] = order[c], order[k]
        for i in range(4):
            reduced[i, k], reduced[i, c] = reduced[i, c], reduced[i, k]
        for j in range(q):
            reduced[k, j], reduced[r, j] = reduced[r, j], reduced[k, j]
        for i in range(4):
            if i != k:
                factor = reduced[i, k] / reduced[k, k]
                for j in range(k, q):
                    reduced[i, j] -= factor * reduced[k, j]
    return 0.0


@register_jitable
def _null_vectors(matrix, dimension):
    """Orthonormal rows (dimension, q) of the null space that ``matrix`` (4, q) has but
    for what is left after q - dimension pivots, and the size of that rest."""
    q = matrix.shape[1]
    reduced, order = np.empty((4, q), np.complex128), np.empty(q, np.int64)
    rank = q - dimension
    rest = _eliminate(matrix, reduced, order, rank)
    out = np.zeros((dimension, q), np.complex128)
    for d in range(dimension):
        out[d, order[rank + d]] = 1.0
        for k in range(rank):
            if reduced[k, k] != 0:
                out[d, order[k]] = -reduced[k, rank + d] / reduced[k, k]
        for e in range(d):
            inner = 0j
            for j in range(q):
                inner += np.conj(out[e, j]) * out[d, j]
            for j in range(q):
                out[d, j] -= inner * out[e, j]
        size = _size(out[d])
        for j in range(q):
            out[d, j] /= size
    return out, rest


@register_jitable
def _record_null_space(
    matrix, rows, left, left_norms, right_norms, turns, defects, count
):
    """Append the candidates in the null space of ``matrix`` (4, q); ``rows`` (q, 8)
    span the right side.

    Returns their number, how many of them sample a continuum, and whether the null
    space has dimensions that are not resolved. One of dimension two is a line that
    meets the two quadrics |x| = |y| in at most two points, unless it lies in both: a
    continuum. In one of dimension three (a Bennett loop within the linkage) the
    quadrics may share a conic, a continuum too.
    """
    q = matrix.shape[1]
    single, _ = _null_vectors(matrix, 1)
    count = _record(
        single[0], rows, left, left_norms, right_norms, turns, defects, count
    )
    line, rest = _null_vectors(matrix, 2)
    if rest > 1e-3:
        return count, 0, False
    p, other = line[0], line[1]
    count, form = _record_line(
        p, other, rows, left, left_norms, right_norms, turns, defects, count
    )
    if rest > 1e-6:
        return count, 0, False
    if q > 2:
        plane, rest = _null_vectors(matrix, 3)
        if rest < 1e-6:
            before = count
            for i in range(8):
                angle = 0.2 + i * np.pi / 8
                y = _combined(
                    np.cos(angle) + 0j, plane[0], np.sin(angle) + 0j, plane[1]
                )
                count, _ = _record_line(
                    y,
                    plane[2],
                    rows,
                    left,
                    left_norms,
                    right_norms,
                    turns,
                    defects,
                    count,
                )
            shared = count > before
            for i in range(before, count):
                shared = shared and defects[i] < 1e-6
            return count, count - before if shared else 0, not shared
    if form > 1e-6:
        return count, 0, False
    for i in range(8):
        angle = 0.2 + i * np.pi / 8
        y = _combined(np.cos(angle) + 0j, p, np.sin(angle) + 0j, other)
        count = _record(y, rows, left, left_norms, right_norms, turns, defects, count)
    return count, 8, False


# --- the three sizes of chain ---------------------------------------------------------


@register_jitable
def _solve_three(fixed, turns, defects):
    """Candidates of a chain of three joints with links ``fixed`` (3, 8): (count,
    sampled, crowded)."""
    best, value = 0, -1.0
    for a in range(3):
        norms = _pair_space(fixed[a])[2]
        smallest = min(norms[0], norms[1])
        if smallest > value:
            best, value = a, smallest
    after_b, after_c = (
        _conjugate(fixed[(best + 1) % 3]),
        _conjugate(fixed[(best + 2) % 3]),
    )
    left, complement, norms = _pair_space(fixed[best])
    rows = np.empty((2, 8))
    _copy(rows[0], _product(after_c, after_b))
    _copy(rows[1], _product(_conjugate(_turn_by_left(fixed[(best + 2) % 3])), after_b))
    matrix, mixed = (
        _projected(complement, rows).astype(np.complex128),
        rows.astype(np.complex128),
    )
    count, sampled, _ = _record_null_space(
        matrix, mixed, left, norms, norms, turns, defects, 0
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
        matrix, mixed = (
            _projected(complement, rows).astype(np.complex128),
            rows.astype(np.complex128),
        )
        count, sampled, crowded = _record_null_space(
            matrix, mixed, left, left_norms, right_norms, turns, defects, 0
        )
        if not crowded:
            _reorder(turns, count, 4, a)
            break
    return count, sampled, crowded


@register_jitable
def _pencil(fixed, v):
    """M_0, M_1 (4, 4) of the elimination that keeps joint v, with the rows (4, 8) they
    project."""
    complement = _pair_space(fixed[(v + 1) % 5])[1]
    rows, _ = _right_space(fixed[(v + 2) % 5], fixed[(v + 3) % 5], fixed[(v + 4) % 5])
    cosine, sine = np.empty((4, 8)), np.empty((4, 8))
    back, back_turned = _conjugate(fixed[v]), _conjugate(_turn_by_left(fixed[v]))
    for i in range(4):
        _copy(cosine[i], _product(back, rows[i]))
        _copy(sine[i], _product(back_turned, rows[i]))
    return _projected(complement, cosine), _projected(complement, sine), cosine, sine


@register_jitable
def _inverse(c, m0, s, m1):
    """Inverse (4, 4) of c m0 + s m1, with complete pivoting, and 1 / its Frobenius
    norm, which is at most the smallest singular value; 0 for a singular matrix."""
    a = np.zeros((4, 8))
    order, out, total = np.empty(4, np.int64), np.empty((4, 4)), 0.0
    for i in range(4):
        a[i, 4 + i], order[i] = 1.0, i
        for j in range(4):
            a[i, j] = c * m0[i, j] + s * m1[i, j]
    for k in range(4):
        best, r, c = 0.0, k, k
        for i in range(k, 4):
            for j in range(k, 4):
                if abs(a[i, j]) > best:
                    best, r, c = abs(a[i, j]), i, j
        if best < 1e-14:
            return out, 0.0
        order[k], order[c] = order[c], order[k]
        for i in range(4):
            a[i, k], a[i, c] = a[i, c], a[i, k]
        for j in range(8):
            a[k, j], a[r, j] = a[r, j], a[k, j]
        for i in range(4):
            factor = a[i, k] / a[k, k]
            if i != k:
                for j in range(k, 8):
                    a[i, j] -= factor * a[k, j]
    for k in range(4):
        for j in range(4):
            out[order[k], j] = a[k, 4 + j] / a[k, k]
            total += out[order[k], j] ** 2
    return out, 1 / np.sqrt(total)


@register_jitable
def _most_regular(fixed, excluded):
    """(kept joint v, half angle, regularity) of the elimination and origin with the
    best conditioned M."""
    best, kept, origin = 0.0, -1, 0.0
    for v in range(5):
        if excluded[v]:
            continue
        m0, m1, _, _ = _pencil(fixed, v)
        for i in range(3):
            half = 0.3 + i * np.pi / 3
            value = _inverse(np.cos(half), m0, np.sin(half), m1)[1]
            if value > best:
                best, kept, origin = value, v, half
    return kept, origin, best


@register_jitable
def _solve_pencil(fixed, v, origin, turns, defects):
    """Candidates from the eigenvalues of one elimination: (count, sampled, crowded)."""
    m0, m1, cosine, sine = _pencil(fixed, v)
    left, _, left_norms = _pair_space(fixed[(v + 1) % 5])
    right_norms = _pair_space(_conjugate(fixed[(v + 3) % 5]))[2]
    c0, s0 = np.cos(origin), np.sin(origin)
    inverse, _ = _inverse(c0, m0, s0, m1)
    standard = np.zeros((4, 4), np.complex128)
    for i in range(4):
        for j in range(4):
            for k in range(4):
                standard[i, j] += inverse[i, k] * (c0 * m1[k, j] - s0 * m0[k, j])
    values = np.linalg.eigvals(standard)
    count, sampled, crowded = 0, 0, False
    for value in values:
        # cos(half) M + sin(half) M' is singular for half = origin + arccot(-value)
        size = np.sqrt(1 + abs(value) ** 2)
        c, s = (-value * c0 - s0) / size, (-value * s0 + c0) / size
        if min(abs(c + 1j * s), abs(c - 1j * s)) < INFINITE:
            continue
        before = count
        matrix, rows = _mixed(c, m0, s, m1), _mixed(c, cosine, s, sine)
        count, more, full = _record_null_space(
            matrix, rows, left, left_norms, right_norms, turns, defects, before
        )
        kept = (c + 1j * s) / (c - 1j * s)
        for i in range(before, count):
            turns[i, 4] = kept
        sampled += more
        crowded = crowded or (full and abs(abs(kept) - 1) < 1e-3)
    _reorder(turns, count, 5, (v + 1) % 5)
    return count, sampled, crowded


@register_jitable
def _reorder(turns, count, m, first):
    """Columns 0, 1, ... of ``turns`` belong to joints first, first + 1, ... of a chain
    of m: sort them."""
    row = np.empty(m, np.complex128)
    for i in range(count):
        for j in range(m):
            row[j] = turns[i, j]
        for j in range(m):
            turns[i, (first + j) % m] = row[j]


# --- from candidates to configurations ------------------------------------------------


@register_jitable
def _closure(links, theta, jacobian):
    """Closure error (6,): rotation vector and translation, to first order; its
    derivative into (6, m).

    The vector part of a quaternion vanishes for the identity only, so half turns are no
    ghosts.
    """
    m = len(theta)
    after = np.zeros((m + 1, 8), np.complex128)
    after[m, 0] = 1.0
    for i in range(m - 1, -1, -1):
        _copy(after[i], _turned(theta[i], _product(links[i], after[i + 1])))
    total, before = after[0], np.zeros(8, np.complex128)
    before[0] = 1.0 if total[0].real >= 0 else -1.0
    error = np.empty(6, np.complex128)
    for r in range(3):
        error[r], error[r + 3] = (
            2 * before[0] * total[r + 1],
            2 * before[0] * total[r + 5],
        )
    turn = np.zeros(8, np.complex128)
    for i in range(m):
        derivative = _product(before, _turn_by_left(after[i]))
        for r in range(3):
            jacobian[r, i], jacobian[r + 3, i] = derivative[r + 1], derivative[r + 5]
        turn[0], turn[3] = np.cos(theta[i] / 2), np.sin(theta[i] / 2)
        before = _product(_product(before, turn), links[i])
    return error


@register_jitable
def _largest(p):
    out = 0.0
    for z in p:
        out = max(out, abs(z))
    return out


@register_jitable
def _least_squares(a, b):
    """The x (m,) of least |a x - b|: Gram-Schmidt with pivots, directions below 1e-9
    get no part.

    Overwrites a and b.
    """
    rows, m = a.shape
    order, r, x = (
        np.empty(m, np.int64),
        np.zeros((m, m), np.complex128),
        np.zeros(m, np.complex128),
    )
    rank, first, out = m, 0.0, np.zeros(m, np.complex128)
    for k in range(m):
        order[k] = k
    for k in range(m):
        best, largest = k, -1.0
        for j in range(k, m):
            size = _size(a[:, j])
            if size > largest:
                best, largest = j, size
        first = max(first, largest)
        if largest <= 1e-9 * first:
            rank = k
            break
        for i in range(rows):
            a[i, k], a[i, best] = a[i, best], a[i, k]
        for i in range(k):
            r[i, k], r[i, best] = r[i, best], r[i, k]
        order[k], order[best] = order[best], order[k]
        r[k, k] = largest
        for i in range(rows):
            a[i, k] /= largest
            x[k] += np.conj(a[i, k]) * b[i]
        for i in range(rows):
            b[i] -= x[k] * a[i, k]
        for j in range(k + 1, m):
            for i in range(rows):
                r[k, j] += np.conj(a[i, k]) * a[i, j]
            for i in range(rows):
                a[i, j] -= r[k, j] * a[i, k]
    for k in range(rank - 1, -1, -1):
        for j in range(k + 1, rank):
            x[k] -= r[k, j] * x[j]
        x[k] /= r[k, k]
        out[order[k]] = x[k]
    return out


@register_jitable
def _polish(links, theta):
    """The closure error after Gauss-Newton on ``theta`` (m,), complex, in place."""
    jacobian = np.empty((6, len(theta)), np.complex128)
    previous = np.inf
    for i in range(60):
        error = _closure(links, theta, jacobian)
        size = _largest(error)
        if size < 5e-16 or (size < 1e-13 and size > 0.5 * previous):
            return size
        if i > 10 and (size > 1e-3 or size > 0.9 * previous):
            return size
        previous = size
        step = _least_squares(jacobian, error)
        factor = min(1.0, 0.5 / (_largest(step) + 1e-300))
        for j in range(len(theta)):
            theta[j] -= factor * step[j]
    return _largest(_closure(links, theta, jacobian))


@register_jitable
def _wrapped(angle):
    """The angle in (-pi, pi]."""
    out = angle - 2 * np.pi * np.round(angle / (2 * np.pi))
    return np.pi if out <= -np.pi else out


@register_jitable
def _distance(p, q):
    """Largest difference of the angles p and q, complex, modulo the period."""
    out = 0.0
    for i in range(len(p)):
        gap = p[i] - q[i]
        out = max(out, abs(_wrapped(gap.real)), abs(gap.imag))
    return out


@register_jitable
def _add_new(links, theta, found, count):
    """Number of configurations in ``found`` after adding ``theta``, unless it is among
    them.

    At a singular configuration Gauss-Newton stops at different points that all close:
    two points whose middle closes too are one.
    """
    jacobian, middle = np.empty((6, len(theta)), np.complex128), np.empty_like(theta)
    for i in range(count):
        distance = _distance(theta, found[i])
        if distance < EQUAL:
            return count
        if distance < 1e-2:
            for j in range(len(theta)):
                gap = theta[j] - found[i, j]
                middle[j] = theta[j] - (_wrapped(gap.real) + 1j * gap.imag) / 2
            if _largest(_closure(links, middle, jacobian)) < 1e-14:
                return count
    if count < len(found):
        for j in range(len(theta)):
            found[count, j] = _wrapped(theta[j].real) + 1j * theta[j].imag
        count += 1
    return count


@register_jitable
def _collect(links, turns, defects, candidates, found, others):
    """(real configurations, complex ones, number of real candidates that close where
    they are)."""
    m = len(links)
    start, theta = np.empty(m, np.complex128), np.empty(m, np.complex128)
    count, n_others, held = 0, 0, 0
    for i in range(candidates):
        smallest, away = 1.0, 0.0
        for j in range(m):
            smallest = min(smallest, abs(turns[i, j]))
            away = max(away, abs(abs(turns[i, j]) - 1))
        if smallest < INFINITE or defects[i] > 0.02:
            continue
        for j in range(m):
            start[j] = -1j * np.log(turns[i, j])
            theta[j] = start[j].real
        if away < 0.1 and _polish(links, theta) < CLOSURE / 2:
            count = _add_new(links, theta, found, count)
            if _distance(theta, start) < 1e-3:
                held += 1
                continue
        _copy(theta, start)
        error, imaginary, growth = _polish(links, theta), 0.0, 1.0
        for j in range(m):
            imaginary = max(imaginary, abs(theta[j].imag))
            growth *= np.exp(
                abs(theta[j].imag)
            )  # of the entries, and of the rounding with them
        if 1e-7 < imaginary < -np.log(INFINITE) and error < CLOSURE * growth:
            n_others = _add_new(links, theta, others, n_others)
    return count, n_others, held


@register_jitable
def _sample(links, found, count):
    """Number of configurations in ``found`` after Gauss-Newton from fixed, well spread
    starts."""
    m = len(links)
    theta = np.empty(m, np.complex128)
    for i in range(STARTS):
        for j in range(m):  # the Weyl sequence of square roots of primes
            theta[j] = (
                2 * np.pi * ((i + 1) * np.sqrt((2.0, 3.0, 5.0, 7.0, 11.0)[j]) % 1.0)
            )
        if _polish(links, theta) < CLOSURE / 2:
            count = _add_new(links, theta, found, count)
    return count


# --- compiled entries: one for each number of joints ----------------------------------
# only the one that is used is compiled


@register_jitable
def _chain(links, joint, angle):
    """Fixed links (n - 1, 8) between the other joints, in order after ``joint`` (from
    0), which is at ``angle``."""
    n = len(links)
    fixed = np.empty((n - 1, 8))
    for i in range(n - 1):
        _copy(fixed[i], links[(joint + 1 + i) % n])
    _copy(fixed[n - 2], _product(fixed[n - 2], _turned(angle, links[joint])))
    return fixed


@njit(cache=True, nogil=True, error_model="numpy")
def _candidates_4r(links, joint, angles, turns, defects, outcome):
    for k in range(len(angles)):
        fixed = _chain(links, joint, angles[k])
        outcome[k, 0], outcome[k, 1], outcome[k, 2] = _solve_three(
            fixed, turns[k], defects[k]
        )


@njit(cache=True, nogil=True, error_model="numpy")
def _candidates_5r(links, joint, angles, turns, defects, outcome):
    for k in range(len(angles)):
        fixed = _chain(links, joint, angles[k])
        outcome[k, 0], outcome[k, 1], outcome[k, 2] = _solve_four(
            fixed, turns[k], defects[k]
        )


@njit(cache=True, nogil=True, error_model="numpy")
def _candidates_6r(links, joint, angles, turns, defects, outcome):
    for k in range(len(angles)):
        fixed = _chain(links, joint, angles[k])
        excluded = np.zeros(5, np.bool_)
        outcome[k, 2] = 1
        for _ in range(5):
            v, origin, regularity = _most_regular(fixed, excluded)
            if regularity < SINGULAR:
                break
            count, sampled, crowded = _solve_pencil(
                fixed, v, origin, turns[k], defects[k]
            )
            if not crowded:
                outcome[k, 0], outcome[k, 1], outcome[k, 2] = count, sampled, 0
                break
            excluded[v] = True


@njit(cache=True, nogil=True, error_model="numpy")
def _configurations(links, joint, angles, turns, defects, outcome):
    """Configurations (m, ROOM, n) and their numbers (m,), those that are not real, too,
    and status (m,)."""
    m, n = len(angles), len(links)
    found, count = np.zeros((m, ROOM, n)), np.zeros(m, np.int64)
    others, n_others = np.zeros((m, ROOM, n), np.complex128), np.zeros(m, np.int64)
    status = np.zeros(m, np.int64)
    chain, hidden = (
        np.empty((ROOM, n - 1), np.complex128),
        np.empty((ROOM, n - 1), np.complex128),
    )
    for k in range(m):
        fixed = _chain(links, joint, angles[k]).astype(np.complex128)
        candidates, sampled, crowded = outcome[k, 0], outcome[k, 1], outcome[k, 2]
        count[k], n_others[k], held = _collect(
            fixed, turns[k], defects[k], candidates, chain, hidden
        )
        if crowded:
            status[k] = UNDECIDED
            count[k] = _sample(fixed, chain, count[k])
        elif sampled > 0 and held > 4:
            status[k] = CONTINUUM
        for i in range(count[k]):
            found[k, i, joint] = _wrapped(angles[k])
            for j in range(n - 1):
                found[k, i, (joint + 1 + j) % n] = chain[i, j].real
        for i in range(n_others[k]):
            others[k, i, joint] = _wrapped(angles[k])
            for j in range(n - 1):
                others[k, i, (joint + 1 + j) % n] = hidden[i, j]
    return found, count, others, n_others, status
