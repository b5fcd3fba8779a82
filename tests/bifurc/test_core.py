"""The compiled core against slower ways to the same numbers."""

import gc
import sys
import weakref
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from bifurc import _core
from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.kantorovich import CHEBYSHEV, NODE_COUNT, RHOS
from bifurc.function_problem import FunctionProblem
from bifurc.system import Anchor, MarchSettings
from tests.bifurc.known_curves import WindingCurve


@pytest.fixture(scope="module")
def branch():
    """A closed curve that winds."""
    return WindingCurve(1, -1, 0, 1, -2, 2).trace()


# --- small matrices -------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(6, 6), (6, 4), (4, 6), (7, 6), (1, 3), (3, 1)])
def test_singular_values_are_those_of_lapack(shape):
    matrices = np.random.default_rng(0).standard_normal((200, *shape))
    matrices[50:100, :, 0] = matrices[50:100, :, -1]
    matrices[100:150] *= 1e-200
    matrices[150] = 0.0
    expected = np.linalg.svd(matrices, compute_uv=False)
    largest = expected.max(axis=1, keepdims=True) + 1e-300
    found = _core.singular_values(matrices)
    count = expected.shape[1]
    assert np.all(np.abs(found[:, :count] - expected) <= 1e-14 * largest)
    assert not np.any(found[:, count:])


def test_small_singular_values_are_right_to_all_digits_where_columns_are_scaled():
    rng = np.random.default_rng(3)
    matrix = rng.standard_normal((6, 6)) * 10.0 ** np.array([0, -3, -6, -9, -12, -15])
    with mpmath.workdps(60):
        exact = mpmath.svd_r(mpmath.matrix(matrix.tolist()), compute_uv=False)
        expected = np.array([float(value) for value in exact])
    found = _core.singular_values(matrix[None])[0]
    assert found == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("entry", [np.nan, np.inf])
def test_singular_values_of_what_is_not_finite_are_infinite(entry):
    matrices = np.ones((1, 3, 4))
    matrices[0, 1, 2] = entry
    assert np.all(np.isposinf(_core.singular_values(matrices)))


@pytest.mark.parametrize("shape", [(6, 6), (6, 4), (4, 6), (7, 6), (1, 3)])
@pytest.mark.parametrize("scale", [1.0, 1e-200])
def test_the_null_vector_is_that_of_lapack(shape, scale):
    matrix = np.random.default_rng(6).standard_normal(shape)
    matrix[:, 0] = matrix[:, 1:3].sum(axis=1)  # one null vector at least
    _, sigma, right = np.linalg.svd(matrix)
    rank = np.count_nonzero(sigma > 1e-9 * sigma[0])
    along = np.random.default_rng(7).standard_normal(shape[1])
    expected = right[rank:].T @ (right[rank:] @ along)
    expected /= np.linalg.norm(expected)
    found = _core.null_vector(scale * matrix, along, negligible=1e-9, agreeing=1e-3)
    assert found == pytest.approx(expected, abs=1e-13)
    other = _core.null_vector(matrix, np.empty(0), negligible=1e-9, agreeing=1e-3)
    assert np.linalg.norm(other) == pytest.approx(1.0)
    assert np.abs(matrix @ other).max() < 1e-14 * sigma[0]


def test_a_direction_across_the_null_space_says_nothing():
    matrix = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    across = np.array([1.0, 0.0, 1e-4])
    found = _core.null_vector(matrix, across, negligible=1e-9, agreeing=1e-3)
    assert np.abs(found) == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)
    rotated = np.array([[1.0, 0.0, 0.0], [0.0, np.sin(1.0), -np.cos(1.0)]])
    rotated[1] = np.cross(rotated[0], [0.0, -np.cos(3.0), np.cos(2.0)])
    found = _core.null_vector(rotated, np.empty(0), negligible=1e-9, agreeing=1e-3)
    expected = [0.0, -np.cos(3.0), np.cos(2.0)] / np.hypot(np.cos(2.0), np.cos(3.0))
    assert np.abs(found) == pytest.approx(np.abs(expected), abs=1e-15)


# --- arcs -----------------------------------------------------------------------------


@pytest.fixture
def arcs():
    """What three arcs are at their nodes, of a curve in 5 unknowns."""
    rng = np.random.default_rng(2)
    jacobians = rng.standard_normal((3, NODE_COUNT, 6, 5))
    left, _, _ = np.linalg.svd(jacobians[:, 0], full_matrices=False)
    return {
        "slopes": rng.standard_normal((3, NODE_COUNT, 5)),
        "residuals": np.zeros((3, NODE_COUNT, 6)),
        "jacobians": jacobians,
        "left": np.ascontiguousarray(left[:, :, :4]),
        "images": np.zeros((3, 2, 6)),
        "travel": np.zeros((3, len(RHOS))),
        "curvature": np.zeros((3, len(RHOS))),
    }


def test_a_singular_frame_is_bounded_by_nothing(arcs):
    arcs["jacobians"][:] = arcs["jacobians"][:, :1]  # the same all along
    arcs["slopes"][:] = arcs["slopes"][:, :1]
    arcs["jacobians"][1] = 0.0
    sizes, _ = _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**arcs), 16)
    assert np.all(np.isfinite(sizes[[0, 2]]))
    assert np.all(np.isinf(sizes[1]))


@pytest.mark.parametrize("name", ["left", "images", "travel", "jacobians"])
def test_arrays_of_arcs_that_do_not_fit_are_refused(arcs, name):
    arcs[name] = arcs[name][:2]
    with pytest.raises(ValueError, match="do not fit"):
        _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**arcs), 16)


# --- places on curves -----------------------------------------------------------------


def test_the_ends_of_pieces_are_where_they_hand_over(branch):
    begins, ends = branch.compiled.ends_of_pieces(0)
    assert begins == pytest.approx(branch(branch.breaks[:-1]), abs=1e-14)
    assert ends[:-1] == pytest.approx(begins[1:], abs=1e-11)
    assert ends[-1] - begins[0] == pytest.approx(branch.travel, abs=1e-14)
    slopes, _ = branch.compiled.ends_of_pieces(derivative=1)
    assert slopes == pytest.approx(branch(branch.breaks[:-1], 1), abs=1e-12)


def test_a_height_is_level_where_its_rate_changes_sign(branch):
    rng = np.random.default_rng(4)
    weights, phases, linear = rng.uniform(0.5, 1.5, (3, branch.n))
    coefficients = np.array([weights, phases, np.ones(branch.n), linear])

    def height(s):
        points = branch(s)
        return (np.cos(points - phases) + linear * points) @ weights

    s = branch.arclengths(200)[1:-1]
    step = 1e-5
    rates = branch.compiled.rates_of_height(coefficients, s)
    assert rates == pytest.approx((height(s + step) - height(s - step)) / (2 * step))
    turns = np.flatnonzero(rates[:-1] * rates[1:] < 0)
    level = branch.compiled.level_places(coefficients, s[turns], s[turns + 1], 1e-15)
    assert len(level)
    assert np.all((s[turns] < level) & (level < s[turns + 1]))
    assert np.abs(branch.compiled.rates_of_height(coefficients, level)).max() < 1e-12


def test_coefficients_of_a_height_that_do_not_fit_are_refused(branch):
    with pytest.raises(ValueError, match="four rows"):
        branch.compiled.rates_of_height(np.ones((3, branch.n)), np.zeros(1))
    with pytest.raises(ValueError, match="another number of unknowns"):
        branch.compiled.level_places(np.ones((4, 2)), np.zeros(1), np.ones(1), 1e-15)


def test_roots_of_waves_are_those_of_the_sum():
    coefficients = np.array([0.2, 1.0 - 0.5j, 0.3j])
    low, high = np.array([0.0, 3.0]), np.array([3.0, 2 * np.pi])

    def values(angles):
        waves = np.exp(1j * np.outer(angles, np.arange(3)))
        return (waves @ coefficients).real

    assert np.all(values(low) * values(high) < 0)
    roots = _core.roots_of_waves(coefficients, low, high, 1e-15)
    assert np.all((low < roots) & (roots < high))
    assert np.abs(values(roots)).max() < 1e-14


# --- references -----------------------------------------------------------------------


def test_what_the_core_hands_over_is_given_back(branch):
    made = FunctionProblem(lambda u: [u[0] * u[0] + u[1] - 1.0], [(-2, 2)] * 2)
    kinds = (_core.Curve, _core.Tape, _core.Brackets)

    def counts():
        gc.collect()
        return [sys.getrefcount(kind) for kind in kinds]

    def use():
        low, high = np.zeros(3), np.ones(3)
        brackets = _core.Brackets(low, high, -high, high, 1e-15)
        brackets.narrow(np.zeros(3))
        made.recording.tape.__dict__.pop("compiled", None)
        made.recording.tape.compiled.residuals(np.zeros((2, 2)))
        other = replace(branch)
        return weakref.ref(other(np.linspace(0.0, 1.0, 5)))

    use()
    before = counts()
    for _ in range(50):
        values = use()
    assert values() is None
    assert counts() == before


# --- curves ---------------------------------------------------------------------------


def brute_distances(branch, points):
    """Distances to 20,000 points of the curve."""
    fine = branch.sample(20_000)
    gaps = points[:, None] - fine[None]
    gaps -= 2 * np.pi * np.round(gaps / (2 * np.pi))
    return np.linalg.norm(gaps, axis=2).min(axis=1)


def test_no_point_of_a_curve_is_nearer_than_the_foot(branch):
    points = np.random.default_rng(4).uniform(-6, 6, (60, 6))
    distances, s = branch.nearest(points)
    expected = brute_distances(branch, points)
    spacing = branch.length / 20_000
    assert np.all(distances <= expected + 1e-12)
    assert np.all(distances >= expected - spacing)
    gaps = branch(s) - points
    gaps -= 2 * np.pi * np.round(gaps / (2 * np.pi))
    assert np.linalg.norm(gaps, axis=1) == pytest.approx(distances, abs=1e-12)


def test_feet_of_points_on_a_curve_are_exact(branch):
    s = np.linspace(0.0, branch.length, 500, endpoint=False)
    distances, found = branch.nearest(branch(s))
    assert distances.max() < 1e-12
    assert branch(found) == pytest.approx(branch(s), abs=1e-12)


def test_what_is_not_within_reach_is_infinitely_far(branch):
    points = np.random.default_rng(5).uniform(-3, 3, (50, 6))
    exact, _ = branch.nearest(points)
    middle = float(np.median(exact))
    found, _ = branch.nearest(points, middle)
    assert np.array_equal(np.isinf(found), exact >= middle)
    assert found[exact < middle] == pytest.approx(exact[exact < middle])


def test_a_curve_returns_to_a_place_where_it_closes(branch):
    period = np.full(branch.n, 2 * np.pi)
    twice = [branch.pieces, branch.pieces]
    radii = np.tile(branch.radii, 2)
    centers = np.concatenate([branch.centers, branch.centers + branch.length])
    s = 0.3 * branch.length
    number = int(np.searchsorted(branch.breaks, s)) - 1
    returns = _core.returns(np.concatenate(twice), centers, radii, period, number, s, 0)
    place = branch(s)
    tangent = branch(s, 1)
    assert len(returns) >= 1
    for at, distance, forward, speed, offset in returns:
        foot = branch(at)
        gap = foot - place
        gap -= 2 * np.pi * np.round(gap / (2 * np.pi))
        assert offset == pytest.approx(gap, abs=1e-12)
        assert distance == pytest.approx(np.linalg.norm(offset))
        cosine = branch(at, 1) @ tangent / np.linalg.norm(tangent)
        assert forward / speed == pytest.approx(cosine, abs=1e-9)
    nearest = min(returns, key=lambda passing: passing[1])
    assert nearest[0] == pytest.approx(s + branch.length, abs=1e-11)
    assert nearest[1] < 1e-12


@pytest.mark.parametrize(("number", "first"), [(-1, 0), (10**6, 0), (0, -1)])
def test_returns_to_no_piece_are_refused(branch, number, first):
    arrays = (branch.pieces, branch.centers, branch.radii, branch.periods)
    with pytest.raises(IndexError, match="no such piece"):
        _core.returns(*arrays, number, 0.0, first)


@pytest.mark.parametrize("seed", range(20))
def test_a_curve_leaves_its_bounds_where_the_excess_is_first_above_zero(seed):
    rng = np.random.default_rng(seed)
    pieces = rng.normal(size=(4, 9, 3)) * 0.5 ** np.arange(9)[:, None]
    pieces[:, 0] *= 0.3
    radii = np.array([1.0, 0.5, 2.0, 1.0])
    centers = np.array([0.9, 2.3, 4.7, 7.5])
    inner = centers[:-1] + radii[:-1] / (radii[:-1] + radii[1:]) * np.diff(centers)
    bounds = np.array([[-2.0, 2.0], [-np.inf, 1.8], [-np.inf, np.inf]])
    curve = Branch(
        pieces=pieces,
        centers=centers,
        radii=radii,
        breaks=np.concatenate([[0.0], inner, [8.5]]),
        residuals=np.zeros(4),
        periods=np.full(3, np.inf),
        outcome=Outcome.OPEN,
    )
    arrays = (pieces, centers, radii, curve.periods)
    for first in range(4):
        end = _core.exit_of_bounds(*arrays, first, bounds, 1e-12)
        # between places, 32 on each piece; pieces do not meet each other here
        shares = np.arange(32) / 32
        places = curve.places(shares)[first:].ravel()
        points = curve(places)
        excess = np.maximum(bounds[:, 0] - points, points - bounds[:, 1]).max(axis=1)
        outside = np.flatnonzero(excess > 1e-12)
        if not len(outside):
            continue
        k = int(outside[0])
        assert places[max(k - 1, 0)] - 1e-12 <= end <= places[k] + 1e-12
        if k % 32:
            point = curve(end)
            there = np.maximum(bounds[:, 0] - point, point - bounds[:, 1]).max()
            assert abs(there) < 1e-13


def test_a_curve_inside_its_bounds_does_not_leave_them(branch):
    arrays = (branch.pieces, branch.centers, branch.radii, branch.periods)
    nowhere = np.full((branch.n, 2), [-np.inf, np.inf])
    assert _core.exit_of_bounds(*arrays, 0, nowhere, 1e-12) is None
    with pytest.raises(IndexError, match="no such piece"):
        _core.exit_of_bounds(*arrays, -1, nowhere, 1e-12)


def test_turning_points_are_where_the_derivative_changes_sign(branch):
    fine = np.linspace(0.0, branch.length, 100_001)
    for unknown in range(branch.n):
        turns = branch.turning_points(unknown)
        slopes = branch(fine, 1)[:, unknown]
        assert len(turns) == np.count_nonzero(slopes[:-1] * slopes[1:] < 0)
        assert np.all(np.abs(branch(turns, 1)[:, unknown]) < 1e-12)
        assert np.all(np.diff(turns) > 0)


def test_a_turning_point_between_two_pieces_is_found_once():
    # a parabola in two pieces that meet at its top
    pieces = np.array(
        [
            [[-0.5, -0.25], [0.5, 0.5], [0.0, -0.25]],
            [[0.5, -0.25], [0.5, -0.5], [0, -0.25]],
        ]
    )
    parabola = Branch(
        pieces=pieces,
        centers=np.array([0.5, 1.5]),
        radii=np.array([0.5, 0.5]),
        breaks=np.array([0.0, 1.0, 2.0]),
        residuals=np.zeros(2),
        periods=np.full(2, np.inf),
        outcome=Outcome.LEFT_REGION,
    )
    assert parabola.turning_points(1) == pytest.approx([1.0], abs=1e-14)
    assert not len(parabola.turning_points(0))


@pytest.mark.parametrize("s", [-10.0, -1.0, 3.0, 100.0])
def test_a_curve_may_begin_at_any_arclength(branch, s):
    begun = branch.begun_at(s)
    fractions = np.linspace(0.0, branch.length, 301)
    gaps = begun(fractions) - branch(fractions + s)
    gaps -= 2 * np.pi * np.round(gaps / (2 * np.pi))
    assert np.abs(gaps).max() < 1e-12


def test_arrays_that_do_not_fit_each_other_are_no_curve():
    with pytest.raises(ValueError, match="do not fit"):
        _core.Curve(
            breaks=np.zeros(2),
            centers=np.zeros(1),
            radii=np.ones(1),
            pieces=np.zeros((2, 3, 2)),
            periods=np.ones(2),
            travel=np.zeros(0),
        )


# --- marching -------------------------------------------------------------------------


def test_curves_of_any_length_close_at_their_start():
    # a search for the end after every 14 pieces, or after all of them: the same curve
    for count in (1, 3, 7):
        problem = FunctionProblem(
            lambda u, k=count: np.array(
                [u[0] ** 2 + u[1] ** 2 - 1.0, u[2] - np.cos(k * np.arctan2(u[1], u[0]))]
            ),
            np.full((3, 2), [-2.0, 2.0]),
        )
        branch = trace_branch(problem, np.array([1.0, 0.0, 1.0]))
        assert branch.closed
        phi = np.linspace(0.0, 2 * np.pi, 200_001)
        exact = np.trapezoid(np.sqrt(1 + (count * np.sin(count * phi)) ** 2), phi)
        assert branch.length == pytest.approx(exact, rel=1e-9)


def test_a_march_ends_where_its_curve_closes():
    problem = WindingCurve(1, -1, 0, 2)
    branch = problem.trace()
    settings = MarchSettings(
        order=16, tolerance=1e-13, shortest=1e-9, longest=2.0, count=500
    )
    place = (branch(0.0), branch(0.0, 1))
    free = problem.march(*place, settings)
    assert len(free.pieces) == 500
    bound = problem.march(
        *place,
        MarchSettings(**{**vars(settings), "anchor": Anchor(*place, within=1e-9)}),
    )
    reached = bound.steps.sum() + bound.radii[-1]
    before = reached - 2 * bound.radii[-1]
    assert before < branch.length < reached
    assert np.array_equal(bound.pieces, free.pieces[: len(bound.pieces)])


@pytest.mark.parametrize("shape", [(6, 6), (6, 4), (3, 5), (1, 2)])
def test_rates_of_singular_values_are_their_differences(shape):
    rng = np.random.default_rng(3)
    matrices = rng.normal(size=(20, *shape))
    changes = rng.normal(size=(20, *shape))
    step = 1e-6
    for number in range(min(shape)):
        values, rates = _core.singular_value_rates(matrices, changes, number)
        after = np.linalg.svd(matrices + step * changes, compute_uv=False)
        before = np.linalg.svd(matrices - step * changes, compute_uv=False)
        expected = np.linalg.svd(matrices, compute_uv=False)[:, number]
        slopes = (after - before)[:, number] / (2 * step)
        assert np.allclose(values, expected, rtol=1e-13)
        assert np.allclose(rates, slopes, atol=1e-7)


def test_a_singular_value_of_zero_has_no_rate():
    values, rates = _core.singular_value_rates(
        np.diag([2.0, 0.0])[None], np.ones((1, 2, 2)), 1
    )
    assert values[0] == rates[0] == 0.0


def test_arrays_of_another_size_are_refused():
    three, two = np.zeros(3), np.ones(2)
    with pytest.raises(ValueError, match="for each bracket"):
        _core.Brackets(three, three, three, two, 1e-15)
    brackets = _core.Brackets(three, three + 1, three - 1, three + 1, 1e-15)
    with pytest.raises(ValueError, match="for each bracket"):
        brackets.narrow(two)
    with pytest.raises(ValueError, match="do not fit"):
        _core.singular_value_rates(np.zeros((2, 3, 3)), np.zeros((2, 3, 4)), 0)
    with pytest.raises(ValueError, match="do not fit"):
        _core.singular_value_rates(np.zeros((2, 3, 3)), np.zeros((2, 3, 3)), 3)


def test_a_matrix_has_the_same_singular_values_alone_and_among_others():
    matrices = np.random.default_rng(4).normal(size=(11, 6, 5))
    matrices[3] = 0.0
    matrices[6, 0, 0] = np.nan
    together = _core.singular_values(matrices)
    alone = [_core.singular_values(matrix[None])[0] for matrix in matrices]
    assert np.array_equal(together, alone)
    assert np.isposinf(together[6]).all() and np.isfinite(together[5]).all()


@pytest.mark.parametrize("degree", [-1, NODE_COUNT])
def test_a_degree_that_does_not_fit_the_nodes_is_refused(arcs, degree):
    with pytest.raises(ValueError, match="do not fit"):
        _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**arcs), degree)


def test_a_frame_that_is_singular_at_one_node_is_bounded_elsewhere(arcs):
    arcs["jacobians"][:] = arcs["jacobians"][:, :1]
    arcs["slopes"][:] = arcs["slopes"][:, :1]
    along = np.cos(np.pi * (np.arange(NODE_COUNT)[::-1] + 0.5) / NODE_COUNT)
    arcs["jacobians"][1] *= (along - along[10])[:, None, None]
    sizes, _ = _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**arcs), 16)
    assert np.isfinite(sizes[1]).mean() > 0.8


def test_no_number_of_a_second_derivative_proves_nothing():
    """With two unknowns there are no strong components to see it."""
    slopes = np.zeros((1, NODE_COUNT, 2))
    slopes[..., 1] = 1.0
    jacobians = np.zeros((1, NODE_COUNT, 1, 2))
    jacobians[..., 0] = 1.0
    arcs = _core.Arcs(
        slopes=slopes,
        residuals=np.zeros((1, NODE_COUNT, 1)),
        jacobians=jacobians,
        left=np.ones((1, 1, 1)),
        images=np.zeros((1, 2, 1)),
        travel=np.zeros((1, len(RHOS))),
        curvature=np.zeros((1, len(RHOS))),
    )
    second = _core.SecondDerivative(
        bound=1.0, residual=1.0, growth=0.0, reach=1.0, error=0.0
    )
    hessians = np.zeros((NODE_COUNT, 2, 2))
    doubts, _, _ = _core.doubts_of_arcs(CHEBYSHEV, second, arcs, 1, hessians)
    assert np.all(np.isfinite(doubts))
    hessians[5] = np.nan
    doubts, _, _ = _core.doubts_of_arcs(CHEBYSHEV, second, arcs, 1, hessians)
    assert np.all(np.isinf(doubts))
