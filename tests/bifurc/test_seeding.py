"""Random starts and the estimate of what they missed."""

import numpy as np
import pytest

from bifurc import SearchSettings, explore
from bifurc.function_problem import FunctionProblem
from bifurc.limits import Deadline
from bifurc.seeding import missed_probability, random_seeds


def circle(periods=None):
    return FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - 1.0]),
        [(-2, 2)] * 2,
        periods=periods,
    )


def test_seeds_solve_the_equations_and_the_same_generator_gives_the_same():
    one, other = (
        random_seeds(circle(), np.random.default_rng(3), 30) for _ in range(2)
    )
    assert np.array_equal(one.points, other.points)
    assert np.abs(np.linalg.norm(one.points, axis=1) - 1).max() < 1e-11
    assert one.random.all()
    assert len(one.points) + len(one.gaps) == 30


def test_seeds_outside_the_bounds_are_dropped():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - 1.0]), [(0, 2), (-2, 0.5)]
    )
    seeds = random_seeds(problem, np.random.default_rng(0), 100)
    assert len(seeds.points)
    assert seeds.points[:, 0].min() >= 0
    assert seeds.points[:, 1].max() <= 0.5


def test_starts_that_reach_nothing_keep_their_gaps():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 + 0.5]), [(-2, 2)] * 2
    )
    seeds = random_seeds(problem, np.random.default_rng(0), 10)
    assert len(seeds.points) == 0
    assert seeds.gaps * problem.magnitude == pytest.approx(0.5, abs=1e-8)
    assert seeds.missed.shape == (10, 2)


@pytest.mark.parametrize(
    ("hits", "expected"),
    [
        (
            [50, 50],
            2.9957 / 100,
        ),  # nothing seen just once: the rule of three, -ln 0.05 / N
        (
            [99, 1],
            4.7439 / 100,
        ),  # Garwood 1936: upper 95 % limit of a Poisson mean after one event
        ([98, 1, 1], 6.2958 / 100),  # and after two
        ([], 1.0),
        ([0], 1.0),
        ([1], 1.0),
    ],
)
def test_the_chance_of_something_unseen_has_its_upper_limit_after_good_and_garwood(
    hits, expected
):
    assert missed_probability(hits) == pytest.approx(expected, abs=1e-6)


def test_the_limit_holds_as_often_as_it_says():
    # 12 things of unequal share, 100 starts: the true unseen share exceeds the limit in
    # about 5 % of all draws
    rng = np.random.default_rng(1)
    share = rng.dirichlet(np.full(12, 0.3))
    failed = 0
    for _ in range(400):
        hits = np.bincount(rng.choice(12, 100, p=share), minlength=12)
        failed += share[hits == 0].sum() > missed_probability(hits)
    assert (
        failed / 400 < 0.1
    )  # 5 % and two standard errors, with room for Good-Turing being a mean


class Counting(FunctionProblem):
    """A circle that counts the starts that it projects."""

    starts = 0

    def project(self, starts):
        self.starts += len(starts)
        return super().project(starts)


def test_no_start_is_projected_after_the_deadline_but_for_a_few():
    problem = Counting(lambda u: np.array([u @ u - 1.0]), [(-2.0, 2.0)] * 2)
    rng = np.random.default_rng(0)
    late = problem.seeds(rng, 500, Deadline(1e-9))
    assert 0 < problem.starts < 50
    assert len(late.points) + len(late.missed) == problem.starts


def test_seeds_before_a_deadline_are_those_without_one():
    problem = Counting(lambda u: np.array([u @ u - 1.0]), [(-2.0, 2.0)] * 2)
    limited = problem.seeds(np.random.default_rng(0), 100, Deadline(1e3))
    free = problem.seeds(np.random.default_rng(0), 100)
    assert np.array_equal(limited.points, free.points)
    assert np.array_equal(limited.missed, free.missed)


def test_a_search_whose_budget_is_over_projects_few_starts():
    problem = Counting(
        lambda u: np.array([u @ u + 1.0]), [(-2.0, 2.0)] * 2, is_recorded=False
    )
    before = problem.starts
    atlas = explore(problem, settings=SearchSettings(budget=1e-9, starts=500))
    assert atlas.provenance.out_of_time
    assert problem.starts - before < 50
    assert atlas.closure_gap > 0.1
