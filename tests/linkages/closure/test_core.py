"""The compiled kernels against 50-digit arithmetic on a closure written independently
of them."""

import mpmath
import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.numerics.null_spaces import null_vector
from bifurc.numerics.singular_values import singular_values
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import locate_singular_point
from linkages import _core
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.families.four_bar import four_bar
from linkages.linkage import load
from linkages.loop import Loop

DIGITS = 50
LOOPS = {
    "special double-subtractive Goldberg 6R": entry(
        "special-double-subtractive-goldberg"
    ).build(),
    "line-symmetric Bricard 6R": entry("bricard-line-symmetric").build(),
    "Bennett": entry("bennett").build(),
    "random 7R": Loop(
        (0.5, 0.9, 0.7, 0.6, 1.0, 0.8, 0.75),
        (0.3, -1.2, 2.1, 0.9, -2.5, 1.4, 0.6),
        (0.1, -0.4, 0.3, 0.2, -0.1, 0.5, 0.0),
    ),
    "planar 4R": Loop((1.0, 2.5, 2.0, 2.2), (0.0,) * 4, (0.0,) * 4),
}


@pytest.fixture(params=LOOPS)
def loop(request):
    return LOOPS[request.param]


def geometry(loop):
    return Closure(loop).compiled.geometry


def march(start, tangent, geometry, order, tolerance, shortest, longest, count):
    return _core.march(
        start,
        tangent,
        geometry,
        order,
        tolerance,
        shortest,
        longest,
        count,
        closing=1e-12,
        misclosure=0.0,
        anchor=np.empty((0, len(start))),
        within=0.0,
        periods=np.full(len(start), np.inf),
        bounds=np.full((len(start), 2), [-np.inf, np.inf]),
        length=np.inf,
    )


def product(loop, theta):
    """T_1 ... T_n, mpmath, from the Denavit-Hartenberg convention alone; theta in
    mpmath numbers."""
    out = mpmath.eye(4)
    for a, alpha, offset, angle in zip(*loop.arrays, theta, strict=True):
        c, s = mpmath.cos(angle), mpmath.sin(angle)
        alpha, size = mpmath.mpf(float(alpha)), mpmath.mpf(loop.characteristic_length)
        ca, sa = mpmath.cos(alpha), mpmath.sin(alpha)
        a, offset = mpmath.mpf(float(a)) / size, mpmath.mpf(float(offset)) / size
        out *= mpmath.matrix(
            [
                [c, -s * ca, s * sa, a * c],
                [s, c * ca, -c * sa, a * s],
                [0, sa, ca, offset],
                [0, 0, 0, 1],
            ]
        )
    return out


def residual(loop, theta):
    """(2 q_v with q_0 >= 0, p), the six closure residuals, from the rotation matrix."""
    t = product(loop, theta)
    q0 = mpmath.sqrt(1 + t[0, 0] + t[1, 1] + t[2, 2]) / 2
    skew = [t[2, 1] - t[1, 2], t[0, 2] - t[2, 0], t[1, 0] - t[0, 1]]
    return [x / (2 * q0) for x in skew] + [t[i, 3] for i in range(3)]


def exactly(theta):
    return [mpmath.mpf(float(x)) for x in theta]


def as_floats(values):
    return np.array([float(x) for x in values])


def shifted(loop, theta, shifts):
    """Residual at theta + shifts, as a column of mpmath numbers."""
    return mpmath.matrix(
        residual(loop, [x + d for x, d in zip(exactly(theta), shifts, strict=True)])
    )


def test_the_residual_agrees_with_50_digits(loop):
    thetas = np.random.default_rng(0).uniform(-np.pi, np.pi, (10, loop.n))
    found = _core.residuals(thetas, geometry(loop))
    with mpmath.workdps(DIGITS):
        for theta, row in zip(thetas, found, strict=True):
            # products of n rotations in double: a few n roundings
            assert (
                np.abs(row - as_floats(residual(loop, exactly(theta)))).max()
                < 2e-15 * loop.n
            )


def test_the_jacobian_agrees_with_50_digits_also_where_the_loop_is_open(loop):
    theta = np.random.default_rng(1).uniform(-np.pi, np.pi, loop.n)
    found = _core.jacobians(theta[None], geometry(loop))[0]
    with mpmath.workdps(DIGITS):
        step = mpmath.mpf(10) ** -20  # central differences: an error of 1e-40
        for j in range(loop.n):
            shift = [step if i == j else 0 for i in range(loop.n)]
            exact = (
                shifted(loop, theta, shift) - shifted(loop, theta, [-x for x in shift])
            ) / (2 * step)
            assert np.abs(found[:, j] - as_floats(exact)).max() < 1e-14 * loop.n


def test_the_hessian_agrees_with_50_digits_also_where_the_loop_is_open(loop):
    theta = np.random.default_rng(2).uniform(-np.pi, np.pi, loop.n)
    found = _core.hessians(theta[None], geometry(loop))[0]
    assert np.array_equal(found, np.swapaxes(found, 1, 2))
    with mpmath.workdps(DIGITS):
        step = mpmath.mpf(10) ** -12  # second differences: an error of 1e-24
        for i in range(loop.n):
            for j in range(i + 1):
                ends = [
                    [a * step * (k == i) + b * step * (k == j) for k in range(loop.n)]
                    for a in (1, -1)
                    for b in (1, -1)
                ]
                upper, left, right, lower = (shifted(loop, theta, end) for end in ends)
                exact = (upper - left - right + lower) / (4 * step**2)
                assert np.abs(found[:, i, j] - as_floats(exact)).max() < 1e-14 * loop.n


# --- Taylor series ------------------------------------------------------------------------------------


def times(a, b, order):
    """Product of two truncated series of 4 x 4 matrices."""
    return [
        sum((a[m] * b[k - m] for m in range(1, k + 1)), a[0] * b[k])
        for k in range(order + 1)
    ]


def turn_series(coefficients, order):
    """Series of Rz(theta(s)) by the recursion for cosine and sine."""
    c, s = [mpmath.cos(coefficients[0])], [mpmath.sin(coefficients[0])]
    for k in range(1, order + 1):
        c.append(-sum(m * coefficients[m] * s[k - m] for m in range(1, k + 1)) / k)
        s.append(sum(m * coefficients[m] * c[k - m] for m in range(1, k + 1)) / k)
    zero = [1] + [0] * order
    return [
        mpmath.matrix(
            [
                [c[k], -s[k], 0, 0],
                [s[k], c[k], 0, 0],
                [0, 0, zero[k], 0],
                [0, 0, 0, zero[k]],
            ]
        )
        for k in range(order + 1)
    ]


def exact_series(loop, center, tangent, order):
    """Taylor coefficients of the motion by arclength from 40-digit series of T_1 ...
    T_n, order by order."""
    links = []
    size = mpmath.mpf(loop.characteristic_length)
    for a, alpha, offset in zip(*loop.arrays, strict=True):
        ca, sa = (
            mpmath.cos(mpmath.mpf(float(alpha))),
            mpmath.sin(mpmath.mpf(float(alpha))),
        )
        a, offset = mpmath.mpf(float(a)) / size, mpmath.mpf(float(offset)) / size
        links.append(
            mpmath.matrix(
                [[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, offset], [0, 0, 0, 1]]
            )
        )

    def closure(u, k):
        total = [mpmath.eye(4)] + [mpmath.zeros(4)] * k
        for i, link in enumerate(links):
            turns = turn_series([row[i] for row in u], k)
            total = times(total, [turn * link for turn in turns], k)
        t = total[k]
        return [
            t[2, 1] - t[1, 2],
            t[0, 2] - t[2, 0],
            t[1, 0] - t[0, 1],
            t[0, 3],
            t[1, 3],
            t[2, 3],
        ]

    def jacobian(point):
        zero = [mpmath.mpf(0)] * loop.n
        columns = [
            closure([point, [mpmath.mpf(i == j) for i in range(loop.n)]], 1)
            for j in range(loop.n)
        ]
        return [[columns[j][row] for j in range(loop.n)] for row in range(6)], zero

    def solve(rows, right):
        matrix, b = mpmath.matrix(rows), mpmath.matrix(right)
        return list(mpmath.lu_solve(matrix.T * matrix, matrix.T * b))

    point, across = exactly(center), exactly(tangent)
    for _ in range(4):
        rows, _ = jacobian(point)
        step = solve([*rows, across], [-x for x in closure([point], 0)] + [0])
        point = [x + d for x, d in zip(point, step, strict=True)]
    rows, zero = jacobian(point)
    first = solve([*rows, across], [0] * 6 + [1])
    norm = mpmath.sqrt(sum(x * x for x in first))
    u = [point, [x / norm for x in first]]
    for k in range(2, order + 1):
        u.append(zero)
        inner = sum(
            i
            * (k + 1 - i)
            * sum(x * y for x, y in zip(u[i], u[k + 1 - i], strict=True))
            for i in range(2, k)
        )
        u[k] = solve([*rows, u[1]], [-x for x in closure(u, k)] + [-inner / (2 * k)])
    return np.array([as_floats(row) for row in u])


@pytest.mark.parametrize(
    "name",
    [
        "special double-subtractive Goldberg 6R",
        "line-symmetric Bricard 6R",
        "Bennett",
        "random 7R",
    ],
)
def test_taylor_coefficients_of_the_motion_agree_with_40_digits(name):
    loop, order = LOOPS[name], 9
    problem = Closure(loop)
    starts, gaps = problem.project(
        np.random.default_rng(3).uniform(-np.pi, np.pi, (60, loop.n))
    )
    values = np.linalg.svd(problem.jacobians(starts), compute_uv=False)[:, loop.n - 2]
    start = starts[np.argmax(np.where(gaps < 1e-14, values, 0.0))]
    tangent = np.linalg.svd(problem.jacobians(start[None])[0])[2][-1]
    _, pieces, _, radii, _, _ = march(
        start, tangent, geometry(loop), 16, 1e-13, 1e-9, 2.0, 1
    )
    with mpmath.workdps(40):
        exact = exact_series(loop, pieces[0][0], tangent, order)
    powers = radii[0] ** np.arange(order + 1)
    # the coefficients times the radius^k are terms of the piece; rounding of the centre
    # enters with 1 / sigma
    assert (
        np.abs(pieces[0][: order + 1] - exact * powers[:, None]).max()
        < 1e-14 / values.max()
    )


def test_pieces_overlap_and_follow_each_other_at_the_stated_arclengths():
    loop = LOOPS["special double-subtractive Goldberg 6R"]
    problem = Closure(loop)
    start = np.array(
        [
            -1.3705021688108496,
            1.5903232408988792,
            1.0070110748490153,
            1.551269412690914,
            -1.7710904847789435,
            -1.0070110748490149,
        ]
    )
    tangent = np.linalg.svd(problem.jacobians(start[None])[0])[2][-1]
    status, pieces, steps, radii, residuals, sigmas = march(
        start, tangent, geometry(loop), 16, 1e-13, 1e-9, 2.0, 12
    )
    assert status == 0
    assert residuals.max() < 3e-13
    assert sigmas.min() > 0
    for i in range(1, len(pieces)):
        assert steps[i] < radii[i - 1] + radii[i]
        s = (
            steps[i] * radii[i - 1] / (radii[i - 1] + radii[i])
        )  # from the centre of the piece before
        left = (s / radii[i - 1]) ** np.arange(17) @ pieces[i - 1]
        right = ((s - steps[i]) / radii[i]) ** np.arange(17) @ pieces[i]
        assert (
            np.abs(left - right).max() < 1e-12
        )  # two pieces of tolerance 1e-13 over singular values above 0.1


def test_a_march_from_an_open_loop_says_by_how_much_it_is_open():
    loop = LOOPS["planar 4R"]
    long = Loop((1.0, 1.0, 1.0, 5.0), loop.twists, loop.offsets)
    status, pieces, _, _, gaps, _ = march(
        np.zeros(4), np.ones(4) / 2, geometry(long), 16, 1e-13, 1e-9, 2.0, 5
    )
    assert status == 2
    assert not len(pieces)
    assert gaps[-1] > 0.1


def test_a_march_says_the_smallest_regular_singular_value():
    linkage = load("special-double-subtractive-goldberg", alpha=2, beta=1, delta=1.0001)
    problem = Closure(linkage.loop)
    points = problem.seeds(np.random.default_rng(0), 20).points
    point = points[np.argmin(singular_values(problem, points)[:, 4])]
    tangent = null_vector(problem, point)
    _, pieces, _, _, _, sigmas = march(
        point, tangent, problem.compiled.geometry, 16, 1e-13, 1e-9, 0.5, 40
    )
    expected = singular_values(problem, pieces[:, 0])[:, 4]
    is_small = expected < 0.05
    assert np.count_nonzero(is_small) > 5
    assert sigmas[is_small] == pytest.approx(expected[is_small], rel=0.5)
    assert np.all(sigmas[~is_small] > 0.05)


@pytest.mark.parametrize("decades", [5, 7])
def test_a_march_beside_a_surface_goes_through_a_bifurcation(decades):
    linkage = load(
        "special-double-subtractive-goldberg",
        alpha=2,
        beta=1,
        delta=1 + 10.0**-decades,
    )
    problem = Closure(linkage.loop)
    crossing = np.array([0, np.pi, np.pi, np.pi, 0, np.pi])
    located = locate_singular_point(problem, crossing, 2, 0.1)
    point = classify_singular_point(problem, located)
    assert len(point.half_branches) == 4
    for along in point.half_branches:
        branch = trace_branch(problem, point.u + point.radius * along, along)
        assert branch.closed
        assert len(branch.passes(point.u, 1e-3)) == 1


def test_a_march_through_a_narrow_near_miss_does_not_turn_back():
    # a rhombus but for 1e-11: the next centre lies beyond the reach of the series, on
    # the curve, with its tangent backwards
    problem = Closure(four_bar(1.0, 1.0 + 1e-11, 1.0, 1.0 - 5e-12))
    for seed in range(3):
        points = problem.seeds(np.random.default_rng(seed), 20).points
        values = singular_values(problem, points)[:, 2]
        branch = trace_branch(problem, points[np.argmax(values)])
        assert branch.closed
        assert branch.length == pytest.approx(30.337847503, abs=1e-6)
