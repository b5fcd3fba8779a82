"""The same atlas through rounding noise."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.noisy_problem import RoundingNoise, with_rounding_noise
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings

CURVES = {
    "circle": lambda x, y: x * x + y * y - 1,
    "pitchfork": lambda x, y: x * y - x**3,
    "two crossing lines": lambda x, y: (x - y) * (x + 2 * y - 0.3),
    "two circles": lambda x, y: (
        ((x - 1) ** 2 + y * y - 0.5) * ((x + 1) ** 2 + y * y - 0.25)
    ),
    "near miss": lambda x, y: x * y - 1e-4,
}
SEARCH = SearchSettings(starts=25)


def curve(name):
    function = CURVES[name]
    return FunctionProblem(lambda u: np.array([function(*u)]), [(-2, 2)] * 2)


def test_noise_is_of_a_few_units_in_the_last_place_and_other_at_every_call():
    problem = curve("circle")
    noisy = with_rounding_noise(problem, 0)
    points = np.random.default_rng(1).uniform(-1, 1, (200, 2))
    for method, size in (("residuals", problem.domain.scale), ("jacobians", 1.0)):
        exact = getattr(problem, method)(points)
        first = getattr(noisy, method)(points)
        error = np.abs(first - exact).max() / (size * problem.magnitude)
        assert 1e-16 < error < 1e-15  # F' gets its noise row by row and as a whole
        assert np.any(first != getattr(noisy, method)(points))
    assert isinstance(noisy, FunctionProblem)


def test_one_seed_makes_one_noise():
    values = np.ones(50)
    assert np.all(RoundingNoise(3)(values, 1.0) == RoundingNoise(3)(values, 1.0))
    assert np.any(RoundingNoise(3)(values, 1.0) != RoundingNoise(4)(values, 1.0))


@pytest.mark.parametrize("name", CURVES)
def test_a_search_through_noise_finds_the_same_atlas(name):
    problem = curve(name)
    exact = explore(problem, settings=SEARCH)
    for seed in range(2):
        noisy = explore(with_rounding_noise(problem, seed), settings=SEARCH)
        assert_same(exact, noisy)


def assert_same(one, other):
    """Forms with their course, points, events and rigid solutions."""
    assert len(one.forms) == len(other.forms)
    for left, right in zip(one.forms, other.forms, strict=True):
        assert left.branch.outcome is right.branch.outcome
        assert left.branch.length == pytest.approx(right.branch.length, abs=1e-9)
        s = np.linspace(0.0, 0.99 * left.branch.length, 20)
        assert np.abs(left.branch(s) - right.branch(s)).max() < 1e-8
    for left, right in zip(one.points, other.points, strict=True):
        assert (left.name, left.kind) == (right.name, right.kind)
        assert left.point.u == pytest.approx(right.point.u, abs=1e-9)
        passes = np.array([left.passes, right.passes])
        assert passes[0] == pytest.approx(passes[1], abs=1e-8)
    for left, right in zip(one.near_misses, other.near_misses, strict=True):
        assert left.value == pytest.approx(right.value, rel=1e-6)
    for left, right in zip(one.dead_points, other.dead_points, strict=True):
        assert (left.form, left.index) == (right.form, right.index)
        assert left.s == pytest.approx(right.s, abs=1e-8)
    assert one.rigid == pytest.approx(other.rigid, abs=1e-9)
