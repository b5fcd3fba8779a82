"""Compiled kernels for the closure of a loop of revolute joints. Everything here is
data in, data out.

``geometry`` is a (6, n) array: length and offset over the characteristic length, cosine
and sine of the twist, cosine and sine of half the twist. All kernels live in one file
because numba's disk cache does not notice an edit in another one.

The closure residual of a configuration is (2 sign(q_0) q_v, p): the vector part of the
unit quaternion of the loop product and its translation over the characteristic length.
The vector part vanishes for the identity alone; the skew part of the rotation matrix,
used in the sources, also vanishes at half turns.

``coupling`` is None where the unknowns are the n angles themselves, or an (n, k + 1)
array [M c] where there are k of them: theta = M v + c. numba compiles one variant for
each, and a plain loop does not pay for the other.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (numba infers the types of compiled functions)

from __future__ import annotations

import numpy as np
from numba import njit
from numba.extending import register_jitable

__all__ = ["hessians", "jacobians", "march", "project", "residuals"]


@register_jitable
def _forward(theta, geometry, screws, quaternion, translation):
    """Fill joint screws (6, n), quaternion (4,) and translation (3,) of the loop
    product."""
    xx, xy, xz = 1.0, 0.0, 0.0  # columns of the rotation so far
    yx, yy, yz = 0.0, 1.0, 0.0
    zx, zy, zz = 0.0, 0.0, 1.0
    px, py, pz = 0.0, 0.0, 0.0
    q0, q1, q2, q3 = 1.0, 0.0, 0.0, 0.0
    for i in range(theta.shape[0]):
        screws[0, i], screws[1, i], screws[2, i] = zx, zy, zz
        screws[3, i] = py * zz - pz * zy
        screws[4, i] = pz * zx - px * zz
        screws[5, i] = px * zy - py * zx
        c, s = np.cos(theta[i]), np.sin(theta[i])
        length, offset, ca, sa = (
            geometry[0, i],
            geometry[1, i],
            geometry[2, i],
            geometry[3, i],
        )
        ux, uy, uz = c * xx + s * yx, c * xy + s * yy, c * xz + s * yz
        wx, wy, wz = c * yx - s * xx, c * yy - s * xy, c * yz - s * xz
        px += offset * zx + length * ux
        py += offset * zy + length * uy
        pz += offset * zz + length * uz
        xx, xy, xz = ux, uy, uz
        yx, yy, yz = ca * wx + sa * zx, ca * wy + sa * zy, ca * wz + sa * zz
        zx, zy, zz = ca * zx - sa * wx, ca * zy - sa * wy, ca * zz - sa * wz
        ch, sh = np.cos(0.5 * theta[i]), np.sin(0.5 * theta[i])
        r0, r1, r2, r3 = (
            q0 * ch - q3 * sh,
            q1 * ch + q2 * sh,
            q2 * ch - q1 * sh,
            q3 * ch + q0 * sh,
        )
        ch, sh = geometry[4, i], geometry[5, i]
        q0, q1, q2, q3 = (
            r0 * ch - r1 * sh,
            r1 * ch + r0 * sh,
            r2 * ch + r3 * sh,
            r3 * ch - r2 * sh,
        )
    sign = 1.0 if q0 >= 0.0 else -1.0  # both signs are the same rotation
    quaternion[0], quaternion[1], quaternion[2], quaternion[3] = (
        sign * q0,
        sign * q1,
        sign * q2,
        sign * q3,
    )
    translation[0], translation[1], translation[2] = px, py, pz


@register_jitable
def _residual_jacobian(theta, geometry, residual, jacobian):
    """Fill the residual (6,) and its exact derivative (6, n), also where the loop is
    not closed."""
    quaternion, p = np.empty(4), np.empty(3)
    _forward(theta, geometry, jacobian, quaternion, p)
    q0, q1, q2, q3 = quaternion
    residual[0], residual[1], residual[2] = 2.0 * q1, 2.0 * q2, 2.0 * q3
    residual[3], residual[4], residual[5] = p[0], p[1], p[2]
    for i in range(theta.shape[0]):
        wx, wy, wz = jacobian[0, i], jacobian[1, i], jacobian[2, i]
        jacobian[0, i] = q0 * wx + wy * q3 - wz * q2
        jacobian[1, i] = q0 * wy + wz * q1 - wx * q3
        jacobian[2, i] = q0 * wz + wx * q2 - wy * q1
        jacobian[3, i] += wy * p[2] - wz * p[1]
        jacobian[4, i] += wz * p[0] - wx * p[2]
        jacobian[5, i] += wx * p[1] - wy * p[0]


@njit(cache=True, nogil=True, error_model="numpy")
def residuals(thetas, geometry):
    """Closure residuals (k, 6) of configurations (k, n)."""
    k, n = thetas.shape
    out, screws, quaternion = np.empty((k, 6)), np.empty((6, n)), np.empty(4)
    for i in range(k):
        _forward(thetas[i], geometry, screws, quaternion, out[i, 3:])
        out[i, :3] = 2.0 * quaternion[1:]
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def jacobians(thetas, geometry):
    """Derivatives (k, 6, n) of the closure residual at configurations (k, n)."""
    k, n = thetas.shape
    out, residual = np.empty((k, 6, n)), np.empty(6)
    for i in range(k):
        _residual_jacobian(thetas[i], geometry, residual, out[i])
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def hessians(theta, geometry):
    """Second derivative (6, n, n) of the closure residual at one configuration (n,).

    For i <= j, with screws (w, v): d2q = w_i w_j q / 4 (quaternion products), d2p = w_i
    x (v_j + w_j x p). On a closed configuration this is the symmetric part of the Lie
    bracket of the joint screws.
    """
    n = theta.shape[0]
    out, screws, q, p = np.empty((6, n, n)), np.empty((6, n)), np.empty(4), np.empty(3)
    _forward(theta, geometry, screws, q, p)
    for j in range(n):
        w, v = screws[:3, j], screws[3:, j]
        # w_j q as a quaternion, and the velocity that joint j gives to the end point
        b0 = -(w[0] * q[1] + w[1] * q[2] + w[2] * q[3])
        bx = q[0] * w[0] + w[1] * q[3] - w[2] * q[2]
        by = q[0] * w[1] + w[2] * q[1] - w[0] * q[3]
        bz = q[0] * w[2] + w[0] * q[2] - w[1] * q[1]
        ex = v[0] + w[1] * p[2] - w[2] * p[1]
        ey = v[1] + w[2] * p[0] - w[0] * p[2]
        ez = v[2] + w[0] * p[1] - w[1] * p[0]
        for i in range(j + 1):
            u = screws[:3, i]
            out[0, i, j] = 0.5 * (b0 * u[0] + u[1] * bz - u[2] * by)
            out[1, i, j] = 0.5 * (b0 * u[1] + u[2] * bx - u[0] * bz)
            out[2, i, j] = 0.5 * (b0 * u[2] + u[0] * by - u[1] * bx)
            out[3, i, j] = u[1] * ez - u[2] * ey
            out[4, i, j] = u[2] * ex - u[0] * ez
            out[5, i, j] = u[0] * ey - u[1] * ex
            for row in range(6):
                out[row, j, i] = out[row, i, j]
    return out


# --- least squares with one factorisation and many right-hand sides -----------------------------------


@register_jitable
def _factor(matrix, scale):
    """Householder QR of ``matrix`` in place; the smallest |diagonal| of R comes
    back."""
    rows, columns = matrix.shape
    smallest = np.inf
    for k in range(min(rows, columns)):
        norm = 0.0
        for i in range(k, rows):
            norm += matrix[i, k] * matrix[i, k]
        norm = np.sqrt(norm)
        smallest = min(smallest, norm)
        if norm == 0.0:
            scale[k] = 0.0
            continue
        diagonal = -norm if matrix[k, k] > 0 else norm
        pivot = matrix[k, k] - diagonal
        scale[k] = -pivot / diagonal
        for i in range(k + 1, rows):
            matrix[i, k] /= pivot
        matrix[k, k] = diagonal
        for j in range(k + 1, columns):
            dot = matrix[k, j]
            for i in range(k + 1, rows):
                dot += matrix[i, k] * matrix[i, j]
            dot *= scale[k]
            matrix[k, j] -= dot
            for i in range(k + 1, rows):
                matrix[i, j] -= dot * matrix[i, k]
    return smallest


@register_jitable
def _solve(matrix, scale, right, solution):
    """Least-squares solution for one right-hand side (overwritten) from `_factor`; with
    more columns than rows the last unknowns are 0."""
    rows, columns = matrix.shape
    solution[:] = 0.0
    columns = min(rows, columns)
    for k in range(columns):
        dot = right[k]
        for i in range(k + 1, rows):
            dot += matrix[i, k] * right[i]
        dot *= scale[k]
        right[k] -= dot
        for i in range(k + 1, rows):
            right[i] -= dot * matrix[i, k]
    for k in range(columns - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, columns):
            total -= matrix[k, j] * solution[j]
        solution[k] = total / matrix[k, k] if matrix[k, k] != 0.0 else 0.0


@register_jitable
def _solve_by_rank(matrix, right, order, solution):
    """Least-squares solution of a system of any rank and shape, both overwritten, by QR
    with column pivoting.

    Pivots below 1e-13 of the first count as zero, and so do the unknowns (by ``order``)
    that they belong to.
    """
    rows, columns = matrix.shape
    solution[:] = 0.0
    for j in range(columns):
        order[j] = j
    rank, first = 0, 0.0
    for k in range(min(rows, columns)):
        best, largest = k, -1.0
        for j in range(k, columns):
            square = 0.0
            for i in range(k, rows):
                square += matrix[i, j] * matrix[i, j]
            if square > largest:
                best, largest = j, square
        norm = np.sqrt(largest)
        first = max(first, norm)
        if norm <= 1e-13 * first:
            break
        order[k], order[best] = order[best], order[k]
        for i in range(rows):
            matrix[i, k], matrix[i, best] = matrix[i, best], matrix[i, k]
        diagonal = -norm if matrix[k, k] > 0 else norm
        pivot = matrix[k, k] - diagonal
        for j in range(k + 1, columns + 1):  # the last one is the right-hand side
            dot = matrix[k, j] if j < columns else right[k]
            for i in range(k + 1, rows):
                dot += (
                    matrix[i, k] / pivot * (matrix[i, j] if j < columns else right[i])
                )
            dot *= -pivot / diagonal
            for i in range(k, rows):
                share = dot if i == k else dot * matrix[i, k] / pivot
                if j < columns:
                    matrix[i, j] -= share
                else:
                    right[i] -= share
        matrix[k, k] = diagonal
        rank = k + 1
    for k in range(rank - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, rank):
            total -= matrix[k, j] * solution[order[j]]
        solution[order[k]] = total / matrix[k, k]


# --- Taylor series of the motion ----------------------------------------------------------------------


@register_jitable
def _angles(unknowns, coupling):
    """Joint angles (n,) of the unknowns."""
    if coupling is None:
        return unknowns
    n, last = coupling.shape[0], coupling.shape[1] - 1
    theta = np.empty(n)
    for i in range(n):
        theta[i] = coupling[i, last]
        for j in range(last):
            theta[i] += coupling[i, j] * unknowns[j]
    return theta


@register_jitable
def _closure(unknowns, geometry, coupling, residual, jacobian):
    """Fill the residual (6,) and its derivative (6, k) by the unknowns."""
    if coupling is None:
        _residual_jacobian(unknowns, geometry, residual, jacobian)
    else:
        n = coupling.shape[0]
        full = np.empty((6, n))
        _residual_jacobian(_angles(unknowns, coupling), geometry, residual, full)
        for row in range(6):
            for j in range(unknowns.shape[0]):
                total = 0.0
                for i in range(n):
                    total += full[row, i] * coupling[i, j]
                jacobian[row, j] = total


@register_jitable
def _settle(theta, tangent, geometry, coupling, matrix, scale, noise):
    """Correct ``theta`` onto the curve across ``tangent`` and turn ``tangent`` into the
    curve's, in place.

    One Gauss-Newton iteration solves min |[J; t] d + [F; 0]| by QR. Below ``noise`` the
    residual is rounding, which a small singular value would only amplify: then nothing
    is moved. Leaves the factored [J; t] in ``matrix`` and returns the length of the
    correction, the residual norm at its end and the smallest diagonal entry of R, a
    free estimate of the smallest regular singular value.
    """
    n = theta.shape[0]
    residual, jacobian, right, step = (
        np.empty(6),
        np.empty((6, n)),
        np.empty(7),
        np.empty(n),
    )
    moved, norm = 0.0, np.inf
    for iteration in range(7):
        _closure(theta, geometry, coupling, residual, jacobian)
        previous, norm = norm, np.sqrt(np.sum(residual * residual))
        matrix[:6], matrix[6] = jacobian, tangent
        _factor(matrix, scale)
        if norm <= noise or norm > 0.5 * previous or iteration == 6:
            break
        right[:6], right[6] = -residual, 0.0
        _solve(matrix, scale, right, step)
        theta += step
        moved += np.sqrt(np.sum(step * step))
    right[:6], right[6] = 0.0, 1.0
    _solve(matrix, scale, right, step)
    tangent[:] = step / np.sqrt(np.sum(step * step))
    matrix[:6], matrix[6] = jacobian, tangent
    smallest = _factor(matrix, scale)
    return moved, norm, smallest


@register_jitable
def _bracket_accumulate(a, b, out):
    """Add the Lie bracket [a, b] of two screws to ``out``."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]
    out[3] += a[1] * b[5] - a[2] * b[4] + a[4] * b[2] - a[5] * b[1]
    out[4] += a[2] * b[3] - a[0] * b[5] + a[5] * b[0] - a[3] * b[2]
    out[5] += a[0] * b[4] - a[1] * b[3] + a[3] * b[1] - a[4] * b[0]


@register_jitable
def _series(unknowns, tangent, geometry, coupling, matrix, scale, order, coefficients):
    """Fill Taylor coefficients (order + 1, k) of v(s), s the arclength, from the
    factored [J; t].

    With S_i(s) the screw of joint i and V_i(s) the twist of the joints before it,
    dS_i/ds = [V_i, S_i] and sum_i S_i dtheta_i/ds = 0, |dv/ds| = 1: order by order one
    product of series and one solve. ``rates`` are those of the angles, ``own`` those of
    the unknowns.
    """
    theta = _angles(unknowns, coupling)
    n, count = theta.shape[0], unknowns.shape[0]
    screws, twists = np.zeros((order + 1, n, 6)), np.zeros((order + 1, n, 6))
    rates, right, step = np.zeros((order, n)), np.empty(7), np.empty(count)
    own = rates if coupling is None else np.zeros((order, count))
    start, quaternion, translation = np.empty((6, n)), np.empty(4), np.empty(3)
    _forward(theta, geometry, start, quaternion, translation)
    screws[0] = start.T
    coefficients[0] = unknowns
    for k in range(order):
        right[:] = 0.0
        for m in range(1, k + 1):
            for i in range(n):
                rate = rates[k - m, i]
                for row in range(6):
                    right[row] -= screws[m, i, row] * rate
        if k == 0:
            own[0] = tangent
        else:
            for m in range(1, k):
                for i in range(count):
                    right[6] -= 0.5 * own[m, i] * own[k - m, i]
            _solve(matrix, scale, right, step)
            own[k] = step
        if coupling is not None:
            for i in range(n):
                for j in range(count):
                    rates[k, i] += coupling[i, j] * own[k, j]
        coefficients[k + 1] = own[k] / (k + 1)
        if k == order - 1:
            break
        for i in range(1, n):
            twists[k, i] = twists[k, i - 1]
            for m in range(k + 1):
                rate = rates[k - m, i - 1]
                for row in range(6):
                    twists[k, i, row] += screws[m, i - 1, row] * rate
        for i in range(1, n):
            for m in range(k + 1):
                _bracket_accumulate(twists[m, i], screws[k - m, i], screws[k + 1, i])
            screws[k + 1, i] /= k + 1


@register_jitable
def _evaluate(coefficients, s, theta, tangent):
    """Value and derivative of the series at ``s``, into ``theta`` and ``tangent``."""
    order = coefficients.shape[0] - 1
    for i in range(theta.shape[0]):
        value, slope = coefficients[order, i], 0.0
        for k in range(order - 1, -1, -1):
            slope = slope * s + value
            value = value * s + coefficients[k, i]
        theta[i], tangent[i] = value, slope


@register_jitable
def _trusted_radius(coefficients, tolerance, longest):
    """Step at which the last two terms of the series fall to ``tolerance``."""
    order = coefficients.shape[0] - 1
    radius = longest
    for k in range(order - 1, order + 1):
        size = np.sqrt(np.sum(coefficients[k] * coefficients[k]))
        if size > 0.0:
            radius = min(radius, (tolerance / size) ** (1.0 / k))
    return radius


@register_jitable
def _largest_residual(
    coefficients,
    radius,
    geometry,
    coupling,
    place,
    heading,
    screws,
    quaternion,
    translation,
):
    """Largest closure residual of the piece over six points of its trusted interval."""
    worst = 0.0
    for fraction in (-1.0, -0.8, -0.45, 0.45, 0.8, 1.0):
        _evaluate(coefficients, fraction * radius, place, heading)
        _forward(_angles(place, coupling), geometry, screws, quaternion, translation)
        total = 0.0
        for row in range(3):
            total += 4.0 * quaternion[row + 1] ** 2 + translation[row] ** 2
        worst = max(worst, np.sqrt(total))
    return worst


@register_jitable
def _expand(
    theta,
    tangent,
    geometry,
    coupling,
    matrix,
    scale,
    order,
    tolerance,
    longest,
    misclosure,
    coefficients,
):
    """Fill the series at a settled point; its trusted radius (0 for none) and largest
    residual come back.

    What the loop misses closure by at the best points of the curve, ``misclosure``, is
    no fault of the series.
    """
    n = theta.shape[0]
    place, heading = np.empty(n), np.empty(n)
    screws, quaternion, translation = (
        np.empty((6, geometry.shape[1])),
        np.empty(4),
        np.empty(3),
    )
    _series(theta, tangent, geometry, coupling, matrix, scale, order, coefficients)
    radius = _trusted_radius(coefficients, tolerance, longest)
    for _ in range(20):
        worst = _largest_residual(
            coefficients,
            radius,
            geometry,
            coupling,
            place,
            heading,
            screws,
            quaternion,
            translation,
        )
        if worst <= 3.0 * tolerance + 4.0 * misclosure:
            return radius, worst
        radius *= 0.85
    return 0.0, worst


@register_jitable
def _meet(left, right, at, guess, place, heading, other, slope):
    """Where on the series ``right`` the point ``left(at)`` lies, near ``guess``; and
    the distance left over."""
    n = place.shape[0]
    _evaluate(left, at, place, heading)
    x, distance = guess, 0.0
    for _ in range(3):
        _evaluate(right, x, other, slope)
        along, square, distance = 0.0, 0.0, 0.0
        for i in range(n):
            gap = place[i] - other[i]
            along += gap * slope[i]
            square += slope[i] * slope[i]
            distance += gap * gap
        x += along / square
    return x, np.sqrt(distance)


RAN, STALLED, OPEN = 0, 1, 2


@njit(cache=True, nogil=True, error_model="numpy")
def march(
    theta,
    tangent,
    geometry,
    order,
    tolerance,
    shortest,
    longest,
    count,
    coupling=None,
    closing=1e-12,
    misclosure=0.0,
):
    """Up to ``count`` consecutive Taylor pieces of the motion from ``theta`` along
    ``tangent``.

    Returns (status, pieces (k, order + 1, n), steps (k,), radii (k,), residuals (k,),
    sigmas (k,)). Piece i is the series of theta(s) about a point of the curve that lies
    ``steps[i]`` of arclength beyond the centre of piece i - 1 (0 for the first), in the
    variable (s - centre) / radii[i], trusted from -1 to 1; neighbouring pieces overlap.
    ``sigmas`` estimate the smallest regular singular value at the centres. Status RAN:
    all pieces made; STALLED: no trusted step of ``shortest`` is left, or the loop
    misses closure by more than ``closing`` farther on; OPEN: it does so at the start,
    ``residuals[-1]`` is the gap. ``misclosure`` is what the curve is known to miss
    elsewhere. With a ``coupling`` all of this is in its unknowns: theta stands for v.

    A piece is trusted on both sides of its centre, so the next centre lies almost two
    radii on. Near a bifurcation at distance d the radius is about d and somewhat more:
    a centre on either side covers the crossing, and a centre that would land too near
    it is refused because its piece does not reach back.
    """
    n = theta.shape[0]
    pieces, steps, radii = (
        np.empty((count, order + 1, n)),
        np.zeros(count),
        np.empty(count),
    )
    residuals, sigmas = np.empty(count), np.empty(count)
    matrix, scale = np.empty((7, n)), np.empty(n)
    point, heading, other, slope = (
        theta.copy(),
        tangent.copy(),
        np.empty(n),
        np.empty(n),
    )
    place, direction = np.empty(n), np.empty(n)
    noise = 1e-15
    _, gap, sigmas[0] = _settle(
        point, heading, geometry, coupling, matrix, scale, noise
    )
    residuals[0] = gap
    if gap > closing:
        return OPEN, pieces[:0], steps[:0], radii[:0], residuals[:1], sigmas[:0]
    misclosure = max(misclosure, noise, gap)
    radii[0], residuals[0] = _expand(
        point,
        heading,
        geometry,
        coupling,
        matrix,
        scale,
        order,
        tolerance,
        longest,
        misclosure,
        pieces[0],
    )
    if radii[0] < shortest:
        return STALLED, pieces[:0], steps[:0], radii[:0], residuals[:0], sigmas[:0]
    status, made = RAN, 1
    while made < count and status == RAN:
        radius, status = radii[made - 1], STALLED
        for beyond in (0.9, 0.5, 0.2, 0.0):
            if radius < shortest:
                break
            hop = (1.0 + beyond) * radius
            _evaluate(pieces[made - 1], hop, point, heading)
            heading /= np.sqrt(np.sum(heading * heading))
            moved, gap, sigmas[made] = _settle(
                point, heading, geometry, coupling, matrix, scale, noise
            )
            if moved > 1e-2 * radius or gap > closing:
                continue
            misclosure = max(misclosure, gap)
            radii[made], residuals[made] = _expand(
                point,
                heading,
                geometry,
                coupling,
                matrix,
                scale,
                order,
                tolerance,
                longest,
                misclosure,
                pieces[made],
            )
            if radii[made] <= beyond * radius:
                continue
            back, apart = _meet(
                pieces[made - 1],
                pieces[made],
                radius,
                -beyond * radius,
                place,
                direction,
                other,
                slope,
            )
            # a point of the curve is known to rounding, or the misclosure, over the
            # smallest singular value, no better
            if apart <= 100.0 * tolerance + 4.0 * misclosure / sigmas[made]:
                steps[made] = radius - back
                status = RAN
                made += 1
                break
    for i in range(made):
        power = 1.0
        for k in range(order + 1):
            pieces[i, k] *= power
            power *= radii[i]
    return (
        status,
        pieces[:made],
        steps[:made],
        radii[:made],
        residuals[:made],
        sigmas[:made],
    )


# --- many starts at once ------------------------------------------------------------------------------


@register_jitable
def _damped_step(jacobian, residual, damping, step):
    """Solve (J^T J + damping) step = -J^T residual by Cholesky, in place."""
    rows, n = jacobian.shape
    normal = np.empty((n, n))
    for i in range(n):
        for j in range(i + 1):
            total = damping if i == j else 0.0
            for row in range(rows):
                total += jacobian[row, i] * jacobian[row, j]
            normal[i, j] = total
        total = 0.0
        for row in range(rows):
            total -= jacobian[row, i] * residual[row]
        step[i] = total
    for j in range(n):
        for k in range(j):
            for i in range(j, n):
                normal[i, j] -= normal[i, k] * normal[j, k]
        normal[j, j] = max(normal[j, j], 1e-300)
        pivot = np.sqrt(normal[j, j])
        for i in range(j, n):
            normal[i, j] /= pivot
    for i in range(n):
        for k in range(i):
            step[i] -= normal[i, k] * step[k]
        step[i] /= normal[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            step[i] -= normal[k, i] * step[k]
        step[i] /= normal[i, i]


@njit(cache=True, nogil=True, error_model="numpy")
def project(starts, geometry, noise, iterations):
    """Levenberg-Marquardt from every start (k, n) onto the closed configurations.

    The damping is the residual's norm, for which convergence is quadratic to solution
    sets that are not isolated points as well (Fan and Yuan 2005). Returns points (k, n)
    and residual norms (k,); a start that does not close keeps its gap.
    """
    k, n = starts.shape
    points, gaps = starts.copy(), np.empty(k)
    residual, jacobian, step = np.empty(6), np.empty((6, n)), np.empty(n)
    trial, trial_residual, trial_jacobian = np.empty(n), np.empty(6), np.empty((6, n))
    for start in range(k):
        theta = points[start]
        _residual_jacobian(theta, geometry, residual, jacobian)
        gap = np.sqrt(np.sum(residual * residual))
        factor, failures = 1e-2, 0
        for _ in range(iterations):
            if gap <= noise:
                break
            # without a floor the step along the null space would be rounding over
            # rounding, next to a solution
            _damped_step(jacobian, residual, max(factor * gap, 1e-14), step)
            for i in range(n):
                trial[i] = theta[i] + step[i]
            _residual_jacobian(trial, geometry, trial_residual, trial_jacobian)
            new = np.sqrt(np.sum(trial_residual * trial_residual))
            if new < gap:
                failures = 0
                factor = max(factor * (0.2 if new < 0.5 * gap else 1.0), 1e-8)
                theta[:] = trial
                jacobian[:], residual[:], gap = trial_jacobian, trial_residual, new
            else:
                factor *= 8.0
                failures += 1
                if (
                    failures > 12 or gap <= 10.0 * noise
                ):  # so near a solution it is rounding that does not fall
                    break
        gaps[start] = gap
    return points, gaps


@njit(cache=True, nogil=True, error_model="numpy")
def project_to_sphere(starts, center, radius, geometry, iterations):
    """Gauss-Newton from every start (k, n) onto closed configurations at distance
    ``radius`` from ``center``.

    Next to a singular point the equations differ in size by the radius; undamped
    Gauss-Newton does not see that, a merit function would. Steps are cut to a third of
    the radius. Returns points (k, n), residual norms (k,) and lengths of the last step
    (k,).
    """
    k, n = starts.shape
    points, gaps, last = starts.copy(), np.empty(k), np.empty(k)
    residual, matrix, order = np.empty(6), np.empty((7, n)), np.empty(n, dtype=np.int64)
    right, step, size = np.empty(7), np.empty(n), 0.0
    for start in range(k):
        theta = points[start]
        for _ in range(iterations):
            _residual_jacobian(theta, geometry, residual, matrix[:6])
            square = 0.0
            for i in range(n):
                matrix[6, i] = (theta[i] - center[i]) / radius
                square += matrix[6, i] * matrix[6, i]
            right[:6] = -residual
            right[6] = 0.5 * radius * (1.0 - square)
            _solve_by_rank(matrix, right, order, step)
            size = np.sqrt(np.sum(step * step))
            cut = min(1.0, radius / (3.0 * size + 1e-300))
            theta += cut * step
            if size < 1e-14:
                break
        _residual_jacobian(theta, geometry, residual, matrix[:6])
        gaps[start], last[start] = np.sqrt(np.sum(residual * residual)), size
    return points, gaps, last
