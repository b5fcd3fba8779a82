"""The location of singular points whose place is known."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.singular.locate import (
    LocatedPoint,
    _augmented_step,
    locate_singular_point,
)
from bifurc.system import hessian_at, relative_jacobians, relative_residuals
from tests.bifurc.near_surfaces import CirclesBesideSphere


def plane(function) -> FunctionProblem:
    return FunctionProblem(lambda u: np.atleast_1d(function(*u)), [(-2, 2)] * 2)


def locate(problem: FunctionProblem, near, reach: float = 0.5) -> LocatedPoint:
    """The point of nullity 2 near one."""
    located = locate_singular_point(problem, np.asarray(near, dtype=float), 2, reach)
    assert located is not None
    return located


def test_the_error_estimate_bounds_the_error_in_random_crossings_of_known_place():
    rng = np.random.default_rng(5)
    for _ in range(40):
        place, mix = rng.uniform(-0.5, 0.5, 2), rng.normal(size=(2, 2))
        curvature = rng.uniform(-1, 1, 2)

        def function(x, y, place=place, mix=mix, curvature=curvature):
            p, q = mix @ np.array([x - place[0], y - place[1]])
            first = p - curvature[0] * q * q
            second = q - curvature[1] * p * p
            return first * second * np.exp(0.3 * p)

        located = locate(plane(function), place + rng.uniform(-0.01, 0.01, 2))
        off = np.linalg.norm(located.u - place)
        assert off <= located.error
        assert off < 1e-12


@pytest.mark.parametrize("nullity", [1, 2, 3])
def test_a_step_solves_the_whole_system_of_a_point_and_its_null_space(nullity):
    """Against the matrix with all vectors of the null space written out."""
    rng = np.random.default_rng(nullity)
    linear, squares = rng.normal(size=(6, 5)), rng.normal(size=(6, 5, 5))
    problem = FunctionProblem(
        lambda u: [
            sum(a * x for a, x in zip(row, u, strict=True))
            + sum(form[i][j] * u[i] * u[j] for i in range(5) for j in range(5))
            for row, form in zip(linear, squares, strict=True)
        ],
        [(-2, 2)] * 5,
    )
    u = rng.uniform(-0.5, 0.5, size=5)
    jacobian = relative_jacobians(problem, u[None])[0]
    basis = np.linalg.svd(jacobian)[2][5 - nullity :].T
    bends = hessian_at(problem, u) @ basis / problem.magnitude
    n, k = basis.shape
    rows, sides = [], []
    rows.append(np.hstack([jacobian, np.zeros((6, n * k))]))
    sides.append(relative_residuals(problem, u[None])[0])
    for j in range(k):
        place = np.eye(k)[j]
        rows.append(np.hstack([bends[:, :, j], np.kron(place, jacobian)]))
        rows.append(np.hstack([np.zeros((k, n)), np.kron(place, basis.T)]))
        sides += [jacobian @ basis[:, j], np.zeros(k)]
    whole = np.linalg.lstsq(np.vstack(rows), -np.concatenate(sides))[0]
    step = _augmented_step(problem, u, basis)
    assert step.du == pytest.approx(whole[:n], abs=1e-10)
    assert step.dv == pytest.approx(whole[n:].reshape(k, n).T, abs=1e-10)


def random_crossing(rng: np.random.Generator) -> tuple[FunctionProblem, np.ndarray]:
    """Two curved branches that cross at a known point of R^3, in three or four
    equations of very different size."""
    point = rng.uniform(-0.5, 0.5, 3)
    normals = rng.normal(size=(3, 3))
    bends = rng.normal(size=(3, 3, 3))
    mix = rng.normal(size=(rng.integers(2, 5), 2)) * 10.0 ** rng.uniform(-1, 1, (1, 2))

    def function(u):
        d = np.asarray(u) - point
        first, second, surface = normals @ d + bends @ d @ d
        return mix @ np.array([first * second, surface])

    return FunctionProblem(function, [[-1, 1]] * 3), point


def test_the_stated_error_bounds_the_true_error_in_99_of_100_random_crossings():
    rng = np.random.default_rng(2)
    count, worst = 0, 0.0
    for _ in range(100):
        problem, point = random_crossing(rng)
        located = locate(problem, point + 1e-3 * rng.normal(size=3), reach=0.2)
        true = float(np.linalg.norm(located.u - point))
        count += true <= located.error
        worst = max(worst, true)
    assert count >= 99
    # crossings of random branches are well conditioned but for a few: rounding times
    # some hundreds
    assert worst < 1e-12


def test_the_null_space_of_a_crossing_in_space_is_located_with_it():
    # the plane z = x y and two crossing lines in it, four equations of rank two
    def redundant(u):
        x, y, z = u
        return np.array([z - x * y, x * y, 1e3 * z, z + x * y])

    problem = FunctionProblem(redundant, [(-2, 2)] * 3)
    located = locate(problem, [0.02, -0.01, 0.01])
    assert np.linalg.norm(located.u) < 1e-12
    assert located.null_space.shape == (3, 2)
    assert np.abs(located.null_space[2]).max() < 1e-12
    products = located.null_space.T @ located.null_space
    assert np.abs(products - np.eye(2)).max() < 1e-12


def test_no_singular_point_is_located_where_there_is_none():
    for gap in (1e-1, 1e-3, 1e-5):
        problem = plane(lambda x, y, gap=gap: x * y - gap)
        nearest = np.full(2, np.sqrt(gap))
        assert locate_singular_point(problem, nearest, 2, 0.5) is None


def test_no_point_farther_than_the_reach_is_returned():
    problem = plane(lambda x, y: x * y)
    start = np.array([0.3, 0.3])
    assert locate_singular_point(problem, start, 2, 0.1) is None
    assert locate_singular_point(problem, start, 2, 0.5) is not None


def test_a_crossing_beside_a_surface_is_located_as_well_as_doubles_tell():
    for e in (1e-4, 1e-6, 1e-8):
        problem = CirclesBesideSphere(e)
        near = np.array([0.0, np.sin(0.02), np.cos(0.02)])
        located = locate_singular_point(problem, near, 2, 0.1)
        assert located is not None
        distance = np.linalg.norm(located.u - [0, 0, 1])
        assert distance <= located.error < 1e-12 / e


# Doubles see singular points all along a stretch of the curve, which leaves its tangent
# as the square of the distance.
@pytest.mark.parametrize(("bend", "start"), [(1.0, 1e-2), (1.0, 1e-4), (10.0, 1e-4)])
def test_the_error_at_a_cusp_of_high_order_on_a_bent_curve_holds_its_place(bend, start):
    def function(u):
        x, y, z = u
        return [z - bend * x**2, y**2 - x**5]

    problem = FunctionProblem(function, [(-1, 1)] * 3)
    located = locate(problem, [start, start**2.5, bend * start**2], reach=0.05)
    assert np.linalg.norm(located.u) <= located.error < 1e-2
