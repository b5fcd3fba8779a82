"""Singular points over their parameters, against closed forms and published places."""

import warnings

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

from bifurc.errors import ProblemError
from bifurc.following.follow import FollowError, follow_singular_point
from bifurc.following.places import PlaceKind
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.function_problem import FunctionProblem
from bifurc.parametrised import ParametrisedProblem


def recorded(function, unknowns, parameters, width=3.0):
    own = [(-width, width)]
    return ParametrisedProblem.recorded(function, own * unknowns, own * parameters)


def places(followed, kind):
    found = [place for place in followed.places if place.kind is kind]
    # by the last parameter: symmetric places have the same first one, but for rounding
    return sorted((place.p.tolist() for place in found), key=lambda p: p[-1])


# --- folds over two parameters --------------------------------------------------------


def cubic(u, p):
    return np.stack([u[0] ** 3 + p[0] * u[0] + p[1]])


def test_the_folds_of_a_cubic_lie_on_its_discriminant_and_end_in_a_cusp():
    problem = recorded(cubic, 1, 2)
    u = 0.5
    start = np.array([-3 * u**2, 2 * u**3])
    followed = follow_singular_point(problem, np.array([u]), start, nullity=1)
    s = np.linspace(0.0, followed.branch.length, 500)
    a, b = followed.parameters(s).T
    assert np.abs(4 * a**3 + 27 * b**2).max() < 1e-11
    (cusp,) = [one for one in followed.places if one.kind is PlaceKind.CUSP]
    assert np.abs([*cusp.p, *cusp.u]).max() < 1e-12
    assert cusp.error < 1e-11


@pytest.mark.parametrize("size", [1.9e-3, 1.0, 145.0])
@pytest.mark.parametrize("steepness", [1e-3, 1.0, 323.0])
def test_a_cusp_is_found_in_any_units(size, steepness):
    # u in ``size``, and equations in ``steepness``
    def function(u, p):
        x, a, b = u[0] / size, p[0] / (3 * size), p[1] * size
        return np.stack([steepness * (x**3 + a * x + b)])

    bounds = [(-9 * size, 9 * size), (-3 / size, 3 / size)]
    problem = ParametrisedProblem.recorded(function, [(-3 * size, 3 * size)], bounds)
    start = np.array([-0.75 * 3 * size, 0.25 / size])
    followed = follow_singular_point(problem, np.array([0.5 * size]), start, nullity=1)
    (cusp,) = [one for one in followed.places if one.kind is PlaceKind.CUSP]
    assert np.abs(cusp.p / (3 * size, 1 / size)).max() < 1e-10
    ends = [followed.parameters(s) for s in (0.0, followed.branch.length)]
    assert {np.sign(end[1]) for end in ends} == {-1.0, 1.0}
    assert [end[0] for end in ends] == pytest.approx([ends[0][0]] * 2, rel=1e-6)


# Catalytic oxidation of CO (Bykov, Yablonskii and Kim 1978), in q2 and k
Q1, Q3, Q4, Q5, Q6 = 2.5, 10.0, 0.0675, 1.0, 0.1


def oxidation(u, p):
    x, y, s = u
    k, q2 = p
    z = 1 - x - y - s
    return np.stack(
        [
            2 * Q1 * z**2 - 2 * Q5 * x**2 - Q3 * x * y,
            q2 * z - Q6 * y - Q3 * x * y,
            Q4 * (z - k * s),
        ]
    )


def fold_near(problem, u, p, fixed):
    """A fold near u (n,) and p (2,), with the parameter number ``fixed`` held."""
    free = 1 - fixed
    n = problem.n

    def equations(w):
        parameters = np.array(p)
        parameters[free] = w[n]
        v = w[n + 1 :]
        row = np.concatenate([w[:n], parameters])
        values = problem.tape.compiled.residuals(row[None])[0]
        slopes = problem.jacobian(w[:n], parameters) @ v
        return np.concatenate([values, slopes, [v @ v - 1.0]])

    v = np.linalg.svd(problem.jacobian(np.array(u), np.array(p)))[2][-1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of starts that lead nowhere
        solution = fsolve(equations, [*u, p[free], *v], xtol=1e-13)
    assert np.abs(equations(solution)).max() < 1e-10
    parameters = np.array(p)
    parameters[free] = solution[n]
    return solution[:n], parameters


def test_cusp_and_bogdanov_takens_points_of_co_oxidation():
    problem = ParametrisedProblem.recorded(
        oxidation, [(0, 1)] * 3, [(0.1, 2), (0.5, 2)]
    )
    start = fold_near(problem, [0.104, 0.307, 0.327], [0.8, 1.34], fixed=0)
    followed = follow_singular_point(problem, *start, nullity=1)
    (cusp,) = places(followed, PlaceKind.CUSP)
    # BifurcationKit's test has 0.35665351 for the first of these
    assert cusp == pytest.approx([0.3559912732, 1.00640833], rel=1e-8)
    # to the digits that are published
    assert np.allclose(
        places(followed, PlaceKind.BOGDANOV_TAKENS),
        [[0.722339072522, 1.16119870882], [0.971397573485, 1.4176276376]],
        rtol=0,
        atol=1e-11,
    )


def lorenz(u, p):
    """The extended Lorenz-84 model (Kuznetsov, Meijer and van Veen 2004)."""
    x, y, z, w = u
    force, t = p
    return np.stack(
        [
            -(y**2) - z**2 - 0.25 * x + 0.25 * force - 0.987 * w**2,
            x * y - x * z - y + 0.25,
            x * y + x * z - z,
            -1.04 * w + 0.987 * w * x + t,
        ]
    )


def test_zero_hopf_and_bogdanov_takens_points_of_the_extended_lorenz_model():
    problem = ParametrisedProblem.recorded(
        lorenz, [(-3, 3)] * 4, [(-1, 4), (-0.5, 0.5)]
    )
    start = None
    rng = np.random.default_rng(0)
    while start is None:
        guess = [*rng.uniform(-1.5, 1.5, 4)]
        try:
            start = fold_near(problem, guess, [rng.uniform(0.5, 3), 0.0005], fixed=1)
        except AssertionError:
            continue
    followed = follow_singular_point(problem, *start, nullity=1)
    assert np.allclose(
        places(followed, PlaceKind.ZERO_HOPF),
        [[1.283419296, -0.0001265408341], [1.283419296, 0.0001265408341]],
        rtol=0,
        atol=1e-9,
    )
    assert np.allclose(
        places(followed, PlaceKind.BOGDANOV_TAKENS),
        [[1.446716701, -0.02094016968], [1.446716701, 0.02094016968]],
        rtol=0,
        atol=1e-9,
    )


def test_any_unknowns_of_a_problem_can_be_its_parameters():
    problem = FunctionProblem(
        lambda u: [u[0] * u[1] - u[2], u[1] - u[3] ** 2],
        [(0, 1), (0, 2), (0, 3), (0, 4)],
        names=["a", "b", "c", "d"],
    )
    split = ParametrisedProblem.of(problem, ["c", "a"])
    assert split.domain.names == ("b", "d")
    assert split.parameters.names == ("c", "a")
    assert split.parameters.bounds.tolist() == [[0, 3], [0, 1]]
    a, b, c, d = 0.3, 0.7, 1.1, 1.7
    (own,) = problem.residuals(np.array([[a, b, c, d]]))
    (other,) = split.tape.compiled.residuals(np.array([[b, d, c, a]]))
    assert other.tolist() == own.tolist()


# --- crossings over one parameter -----------------------------------------------------


def test_two_crossings_of_a_line_and_a_curve_are_born_where_it_touches():
    # y = 0 and y = sin(x) - 0.3 x^2 - p
    def height(x):
        return np.sin(x) - 0.3 * x**2

    problem = recorded(
        lambda u, p: np.stack([u[1] * (u[1] - height(u[0]) + p[0])]), 2, 1
    )
    x = brentq(lambda x: height(x) - 0.2, 0.1, 0.4, xtol=1e-15)
    followed = follow_singular_point(
        problem, np.array([x, 0.0]), np.array([0.2]), nullity=2
    )
    (birth,) = followed.places
    top = brentq(lambda x: np.cos(x) - 0.6 * x, 0.5, 1.5, xtol=1e-15)
    assert birth.kind is PlaceKind.BIRTH
    assert not birth.is_minimum
    assert abs(birth.p[0] - height(top)) < 1e-12
    assert birth.u == pytest.approx([top, 0.0], abs=1e-6)
    s = np.linspace(0.0, followed.branch.length, 200)
    x, y = followed.unknowns(s).T
    assert np.abs(y).max() < 1e-10
    assert np.abs(followed.parameters(s)[:, 0] - height(x)).max() < 1e-10


@pytest.mark.parametrize("nullity", [1, 2, 3])
def test_equations_are_the_same_on_a_tape_of_their_own(nullity):
    problem = SingularPointProblem(
        recorded(lorenz, 4, 2), np.array([0.3, 0.4, 0.5, 0.6]), np.ones(2), nullity
    )
    shift = 0.1 * np.random.default_rng(0).normal(size=problem.n)
    points = np.array([problem.start, problem.start + shift])
    own = problem.compiled
    assert np.abs(problem.residuals(points) - own.residuals(points)).max() < 1e-14
    assert np.abs(problem.jacobians(points) - own.jacobians(points)).max() < 1e-14


def test_a_point_that_is_there_for_one_value_alone_needs_another_parameter():
    # a circle through the node of a cubic curve that is one for p = 0 alone
    problem = recorded(
        lambda u, p: np.stack([u[1] ** 2 - u[0] ** 2 * (u[0] + 1) + p[0]]), 2, 1
    )
    with pytest.raises(FollowError, match="free one more parameter"):
        follow_singular_point(problem, np.zeros(2), np.zeros(1), nullity=2)


def test_a_point_with_freedoms_to_spare_is_refused():
    problem = recorded(lambda u, p: np.stack([u[1] * (u[1] - u[0] + p[0])]), 2, 2)
    with pytest.raises(FollowError, match="2 freedoms"):
        follow_singular_point(problem, np.zeros(2), np.zeros(2), nullity=2)


def test_where_there_is_no_such_point_it_is_refused():
    problem = recorded(lambda u, p: np.stack([u[0] ** 2 + u[1] ** 2 - 4 - p[0]]), 2, 1)
    with pytest.raises(FollowError, match="no point with a null space"):
        follow_singular_point(problem, np.array([2.0, 0.0]), np.zeros(1), nullity=2)


@pytest.mark.parametrize("nullity", [0, 3])
def test_a_nullity_that_there_cannot_be_is_refused(nullity):
    problem = recorded(lambda u, p: np.stack([u[0] * u[1] + p[0]]), 2, 1)
    with pytest.raises(ProblemError, match="from 1 to 2"):
        follow_singular_point(problem, np.zeros(2), np.zeros(1), nullity)


def test_what_cannot_be_recorded_is_refused_with_the_reason():
    with pytest.raises(ProblemError, match="absolute value"):
        recorded(lambda u, p: np.stack([abs(u[0]) + p[0]]), 1, 1)
