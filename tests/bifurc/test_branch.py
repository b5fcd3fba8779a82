"""A traced curve as a function of its arclength."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from tests.bifurc.known_curves import WindingCurve


@pytest.fixture(scope="module")
def traced():
    problem = WindingCurve(1, 1, 0, -1, 1, 2)
    return problem, problem.trace()


@pytest.fixture(scope="module")
def circle():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - 1.0]), [(-2, 2)] * 2
    )
    return trace_branch(problem, np.array([1.0, 0.0]), np.array([0.0, 1.0]))


@pytest.fixture(scope="module")
def parabola():
    problem = FunctionProblem(
        lambda u: np.array([u[1] - u[0] ** 2]), [(-1, 2), (-5, 5)]
    )
    return trace_branch(problem, np.array([0.0, 0.0]), np.array([1.0, 0.0]))


def test_the_circle_is_cosine_and_sine_of_the_arclength_with_all_derivatives(circle):
    s = np.linspace(0.0, 2 * np.pi, 201)
    for derivative, bound in (
        (0, 1e-12),
        (1, 1e-11),
        (2, 1e-9),
    ):  # every derivative costs a factor order / radius
        phase = s + derivative * np.pi / 2
        assert circle(s, derivative) == pytest.approx(
            np.stack([np.cos(phase), np.sin(phase)], axis=1), abs=bound
        )
    assert circle.length == pytest.approx(2 * np.pi, abs=1e-12)


def test_derivatives_agree_with_differences_along_the_curve(traced):
    _, branch = traced
    s = np.linspace(0.0, branch.length, 50)
    for derivative, step, bound in ((1, 1e-3, 1e-4), (2, 1e-3, 1e-3)):
        slope = (
            branch(s + step, derivative - 1) - branch(s - step, derivative - 1)
        ) / (2 * step)
        assert branch(s, derivative) == pytest.approx(slope, abs=bound)


def test_the_parameter_is_the_arclength(traced):
    _, branch = traced
    assert np.linalg.norm(branch(branch.arclengths(5000), 1), axis=1) == pytest.approx(
        1.0, abs=1e-10
    )
    chords = np.linalg.norm(
        np.diff(branch(np.linspace(0, branch.length, 20001)), axis=0), axis=1
    )
    assert chords.sum() == pytest.approx(
        branch.length, rel=1e-7
    )  # a chord is short by h^2 kappa^2 / 24


def test_evaluation_agrees_with_solving_again(traced):
    problem, branch = traced
    theta = branch.sample(500)
    again, gaps = problem.project(theta)
    assert gaps.max() < 1e-14
    assert np.abs(again - theta).max() < 1e-12


def test_pieces_hand_over_without_a_step(traced):
    _, branch = traced
    inner = branch.breaks[1:-1]
    # two pieces of tolerance 1e-13, over the smallest singular value of this curve, 1
    assert branch(inner - 1e-12) == pytest.approx(branch(inner + 1e-12), abs=1e-11)


def test_a_closed_curve_goes_on_after_its_length_and_winds(traced):
    _, branch = traced
    s = np.linspace(0.0, branch.length, 20)
    turned = branch(s + 2 * branch.length) - branch(s)
    assert turned == pytest.approx(
        np.tile(4 * np.pi * branch.winding, (20, 1)), abs=1e-10
    )
    assert branch(s - branch.length) - branch(s) == pytest.approx(
        np.tile(-2 * np.pi * branch.winding, (20, 1)), abs=1e-10
    )


def test_an_angle_that_turns_twice_before_the_curve_closes_has_winding_two():
    problem = WindingCurve(1, 1, 0, 1, 1, 2)
    branch = problem.trace()
    assert branch.closed
    assert np.array_equal(np.abs(branch.winding), [1, 1, 0, 1, 1, 2])
    # counted independently: wrapped samples, solved again, unwrapped from neighbour to
    # neighbour
    wrapped = np.angle(np.exp(1j * problem.project(branch.sample(2000))[0]))
    turns = np.diff(
        np.unwrap(np.vstack([wrapped, wrapped[:1]]), axis=0)[[0, -1]], axis=0
    )[0] / (2 * np.pi)
    assert turns == pytest.approx(branch.winding, abs=1e-9)
    # half way, where the last angle has turned once, the others are not where they
    # began
    assert (
        np.linalg.norm(
            problem.domain.difference(branch(0.5 * branch.length), branch(0.0))
        )
        > 0.1
    )


def test_the_nearest_point_of_a_curve_is_its_foot(circle):
    points = np.array(
        [[2.0, 0.0], [0.0, 0.5], [-0.3, -0.4], [np.cos(3.0), np.sin(3.0)]]
    )
    distance, s = circle.nearest(points)
    assert distance == pytest.approx(
        [1.0, 0.5, 0.5, 0.0], abs=1e-2
    )  # far from the curve the nearest sample is enough
    assert distance[3] < 1e-13
    assert s[3] == pytest.approx(3.0, abs=1e-12)


def test_the_nearest_point_is_found_modulo_the_periods(traced):
    _, branch = traced
    s = np.linspace(0.0, branch.length, 200, endpoint=False)
    turns = 2 * np.pi * np.random.default_rng(0).integers(-2, 3, (200, branch.n))
    distance, found = branch.nearest(branch(s) + turns)
    assert distance.max() < 1e-11
    assert (
        np.abs(
            (found - s + 0.5 * branch.length) % branch.length - 0.5 * branch.length
        ).max()
        < 1e-9
    )


@pytest.mark.parametrize("within", [1e-6, 0.05, 0.5, 2.0])
def test_within_a_distance_the_nearest_point_is_the_same_and_beyond_it_said_to_be_beyond(
    traced, within
):
    _, branch = traced
    rng = np.random.default_rng(1)
    points = (
        branch(rng.uniform(0.0, branch.length, 300))
        + rng.normal(size=(300, branch.n)) * np.geomspace(1e-9, 1.0, 300)[:, None]
    )
    distance, s = branch.nearest(points)
    limited, at = branch.nearest(points, within=within)
    near = distance <= within
    assert 20 < near.sum() < 300
    assert np.array_equal(limited[near], distance[near])
    assert np.array_equal(at[near], s[near])
    assert limited[~near].min() > within


def test_a_point_beside_a_crossing_is_found_on_its_own_pass():
    # figure of eight: all the nearest samples of a point may lie on the other pass
    problem = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2) ** 2 - u[0] ** 2 + u[1] ** 2]),
        [(-2, 2)] * 2,
    )
    branch = trace_branch(problem, np.array([1.0, 0.0]))
    for s in np.concatenate(
        [
            branch.passes(np.zeros(2), 1e-6) + d
            for d in (-0.05, -0.01, -1e-3, 1e-3, 0.01, 0.05)
        ]
    ):
        assert branch.nearest(branch(s))[0][0] < 1e-12


def test_all_passes_through_a_crossing_are_found():
    problem = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2) ** 2 - u[0] ** 2 + u[1] ** 2]),
        [(-2, 2)] * 2,
    )
    branch = trace_branch(problem, np.array([1.0, 0.0]))
    passes = branch.passes(np.zeros(2), 1e-6)
    assert passes == pytest.approx([branch.length / 4, 3 * branch.length / 4], abs=1e-9)
    assert len(branch.passes(np.array([0.0, 0.5]), 1e-6)) == 0


def test_a_reversed_curve_is_the_same_curve(traced):
    _, branch = traced
    back = branch.reversed()
    s = np.linspace(0.0, branch.length, 100)
    assert back(s) == pytest.approx(branch(branch.length - s), abs=1e-12)
    assert back(s, 1) == pytest.approx(-branch(branch.length - s, 1), abs=1e-10)
    assert np.array_equal(back.winding, -branch.winding)
    assert (back.length, back.outcome, back.max_residual) == (
        branch.length,
        branch.outcome,
        branch.max_residual,
    )


def test_an_open_curve_ends_on_the_bounds(parabola):
    assert parabola.outcome is Outcome.LEFT_REGION
    assert not parabola.closed
    assert sorted(parabola(np.array([0.0, parabola.length]))[:, 0]) == pytest.approx(
        [-1.0, 2.0], abs=1e-12
    )
    exact = sum(
        0.5 * x * np.hypot(1, 2 * x) + 0.25 * np.arcsinh(2 * x) for x in (1.0, 2.0)
    )
    assert parabola.length == pytest.approx(exact, abs=1e-11)
    assert np.array_equal(parabola.winding, [0, 0])
    assert len(parabola.sample(11)) == 11
    assert parabola.arclengths(11)[-1] == parabola.length


def test_a_curve_is_trusted_beyond_the_bounds_that_cut_it_off():
    low, high = 0.3, 0.3001
    circle = FunctionProblem(
        lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(low, high), (0, 2)]
    )
    short = trace_branch(circle, np.array([low, np.sqrt(1 - low**2)]))
    assert short.length == pytest.approx(np.arcsin(high) - np.arcsin(low), abs=1e-13)
    assert short.trusted_length > 100 * short.length
    assert short.reversed().trusted_length == pytest.approx(short.trusted_length)


def test_what_no_piece_is_of_is_trusted_nowhere():
    circle = FunctionProblem(lambda u: [u[0] ** 2 + u[1] ** 2 - 1], [(-2, 2)] * 2)
    nothing = trace_branch(circle, np.zeros(2))
    assert len(nothing.pieces) == 0
    assert nothing.trusted_length == 0.0


def test_an_open_curve_is_cut_off_at_its_ends(parabola):
    distance, s = parabola.nearest(np.array([[2.1, 4.3]]))
    assert s[0] in (0.0, parabola.length)
    assert distance[0] == pytest.approx(np.hypot(0.1, 0.3), abs=1e-2)


def test_the_residual_bound_holds_at_samples(traced):
    problem, branch = traced
    dense = np.linalg.norm(problem.residuals(branch.sample(5000)), axis=1).max()
    assert dense < branch.max_residual + 1e-14
    assert branch.max_residual < 1e-12


def test_places_lie_at_the_same_fractions_of_every_piece(traced):
    _, branch = traced
    places = branch.places(np.array([0.0, 0.25, 1.0]))
    assert places.shape == (len(branch.pieces), 3)
    assert np.array_equal(places[:, 0], branch.breaks[:-1])
    assert places[:, 2] == pytest.approx(branch.breaks[1:], abs=1e-14)
    quarter = 0.75 * branch.breaks[:-1] + 0.25 * branch.breaks[1:]
    assert places[:, 1] == pytest.approx(quarter, abs=1e-14)


def test_a_branch_is_shown_in_a_few_lines(traced, parabola):
    _, branch = traced
    first, *others = repr(branch).splitlines()
    assert first == "<Branch in 6 unknowns, closed: the curve came back to its start"
    assert len(others) == 2
    assert f"{len(branch.pieces)} pieces" in others[1]
    assert "left the region" in repr(parabola)


def test_a_closed_curve_begun_elsewhere_is_the_same_curve(traced):
    _, branch = traced
    middle = 0.5 * (branch.breaks[3] + branch.breaks[4])
    beside_a_break = branch.breaks[5] + 1e-6 * branch.radii[5]
    for begin in (0.0, middle, branch.breaks[3], beside_a_break, branch.length - 1e-9):
        moved = branch.begun_at(begin)
        assert moved.length == branch.length
        assert moved.winding.tolist() == branch.winding.tolist()
        assert np.all(np.diff(moved.breaks) > 1e-6)
        s = np.linspace(0.0, branch.length, 301)
        gap = moved(s) - branch(begin + s)
        assert np.abs(gap).max() < 1e-12
        assert np.abs(moved(s, 1) - branch(begin + s, 1)).max() < 1e-10


def test_no_open_curve_is_begun_elsewhere(parabola):
    with pytest.raises(ProblemError, match="a closed curve"):
        parabola.begun_at(0.5)


def test_whole_periods_move_a_curve_of_angles(traced):
    _, branch = traced
    turns = np.array([1, 0, -2, 0, 0, 3])
    moved = branch.moved_by_periods(turns)
    s = np.linspace(0.0, branch.length, 31)
    assert moved(s) - branch(s) == pytest.approx(np.tile(2 * np.pi * turns, (31, 1)))
    assert np.abs(moved(s, 1) - branch(s, 1)).max() == 0.0


@pytest.mark.parametrize("beyond", [-1e-6, 1.000001, np.nan, np.inf, None, "one"])
def test_beyond_its_ends_an_open_curve_has_no_points(parabola, beyond):
    is_share = isinstance(beyond, float)
    s = beyond * parabola.length if is_share else beyond
    with pytest.raises(ProblemError, match=r"^arclength: .* from 0 to "):
        parabola(s)


def test_rounding_does_not_lead_beyond_the_ends(parabola):
    end = parabola.length * (1 + 4e-16)
    assert np.allclose(parabola(end), parabola(parabola.length), rtol=0, atol=1e-14)


def test_a_closed_curve_has_points_at_all_numbers(circle):
    assert np.all(np.isfinite(circle(-1e3 * circle.length)))
    with pytest.raises(ProblemError, match=r"^arclength: .* must be a number"):
        circle(np.nan)


# --- turning points -------------------------------------------------------------------


def graph_of(height, breaks, outcome=Outcome.LEFT_REGION):
    """The curve (s, height(s)) for a polynomial ``height``, in pieces between
    ``breaks``."""
    centers, radii = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
    pieces = np.zeros((len(centers), height.degree() + 1, 2))
    for piece, center, radius in zip(pieces, centers, radii, strict=True):
        moved = height(np.polynomial.Polynomial([center, radius]))
        piece[: len(moved.coef), 1] = moved.coef
        piece[:2, 0] = center, radius
    return Branch(
        pieces=pieces,
        centers=centers,
        radii=radii,
        breaks=breaks,
        residuals=np.zeros(len(centers)),
        periods=np.full(2, np.inf),
        outcome=outcome,
    )


def height_with_rate(*roots):
    return np.polynomial.Polynomial.fromroots(roots).integ()


@pytest.mark.parametrize("count", [1, 2, 3, 7])
@pytest.mark.parametrize("apart", [1e-2, 1e-3, 1e-5])
def test_two_turning_points_close_together_are_two(count, apart):
    breaks = np.linspace(0.0, 1.0, count + 1)
    for middle in np.random.default_rng(count).uniform(0.1, 0.9, 20):
        # between any two places of a piece, and across the end of one
        for place in (middle, breaks[np.argmin(np.abs(breaks - middle))]):
            turns = [place - 0.5 * apart, place + 0.5 * apart]
            inner = [s for s in turns if 0.0 < s < 1.0]
            curve = graph_of(height_with_rate(*turns, -0.5), breaks)
            found = curve.turning_points(1)
            assert found == pytest.approx(inner, abs=1e-3 * apart)


@pytest.mark.parametrize("place", [0.3, 0.5, 0.51])
@pytest.mark.parametrize("power", [2, 4, 6])
def test_a_rate_that_touches_zero_is_no_turning_point(place, power):
    breaks = np.array([0.0, 0.5, 1.0])
    touching = graph_of(height_with_rate(*[place] * power), breaks)
    assert not len(touching.turning_points(1))
    crossing = graph_of(height_with_rate(*[place] * (power + 1)), breaks)
    (turn,) = crossing.turnings(1)
    # rounding hides the rate until it is 1e-12 of the largest
    assert turn.low < place < turn.high
    assert turn.high - turn.low < 4 * 1e-12 ** (1 / (power + 1))


def test_a_touch_between_pieces_that_differ_by_their_error_is_no_turning_point():
    curve = graph_of(height_with_rate(0.5, 0.5), np.array([0.0, 0.5, 1.0]))
    for error in (1e-13, 1e-9, -1e-9):
        pieces = curve.pieces.copy()
        pieces[1, 1, 1] += error
        inexact = replace(curve, pieces=pieces)
        assert not len(inexact.turning_points(1))


def test_turnings_at_the_ends_of_an_open_curve_say_so():
    curve = graph_of(height_with_rate(0.0, 0.4, 1.0), np.array([0.0, 0.7, 1.0]))
    begin, middle, end = curve.turnings(1)
    assert (begin.s, begin.before, begin.after) == (0.0, 0.0, 1.0)
    assert (middle.before, middle.after) == (1.0, -1.0)
    assert (end.s, end.before, end.after) == (1.0, -1.0, 0.0)
    assert curve.turning_points(1) == pytest.approx([0.4], abs=1e-13)


@pytest.mark.parametrize("start", [0.0, np.pi / 2, 1.0])
def test_a_turning_point_where_a_closed_curve_begins_is_found_once(circle, start):
    begun = circle.begun_at(start)
    for unknown, places in ((0, [0.0, np.pi]), (1, [np.pi / 2, 3 * np.pi / 2])):
        turns = begun.turning_points(unknown)
        gaps = np.abs(
            np.exp(1j * (turns + start)[:, None]) - np.exp(1j * np.array(places))
        )
        assert len(turns) == 2
        assert gaps.min(axis=0) == pytest.approx([0.0, 0.0], abs=1e-10)
        assert np.all((turns >= 0.0) & (turns < begun.length))


def test_a_branch_that_is_no_number_has_no_turning_points(circle):
    for value in (np.nan, np.inf):
        pieces = circle.pieces.copy()
        pieces[0, 3, 0] = value
        replace(circle, pieces=pieces).turning_points(0)
