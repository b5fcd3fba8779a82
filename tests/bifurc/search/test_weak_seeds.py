"""Seeds beside a surface that is nearly a solution."""

import numpy as np

from bifurc.decisions import is_solution
from bifurc.numerics.singular_values import singular_values
from bifurc.search.solutions import sharpened, with_weak_solutions
from bifurc.seeds import Seeds
from tests.bifurc.near_surfaces import CirclesBesideSphere


def test_a_solution_by_its_residual_moves_onto_its_curve():
    problem = CirclesBesideSphere(1e-8)
    exact = problem.points(7)
    rough = exact + np.array([1e-5, 0, 0])
    rough /= np.linalg.norm(rough, axis=1)[:, None]
    assert problem.gaps(rough).max() < 1e-12
    sharp = sharpened(problem, rough, singular_values(problem, rough))
    assert np.abs(sharp.points[:, 0]).max() < 1e-6
    assert sharp.moved.tolist() == list(range(7))
    assert np.abs(rough[:, 0]).min() > 9e-6


def test_solutions_are_reached_from_starts_that_missed_by_little():
    problem = CirclesBesideSphere(1e-6)
    rng = np.random.default_rng(0)
    missed = rng.normal(size=(40, 3))
    missed /= np.linalg.norm(missed, axis=1)[:, None]
    gaps = problem.gaps(missed)
    nowhere = np.empty((0, 3))
    seeds = Seeds(nowhere, np.empty(0, dtype=bool), gaps, missed)
    reached = with_weak_solutions(problem, seeds)
    assert len(reached.points) > 30
    assert np.all(is_solution(problem.gaps(reached.points)))
    assert len(reached.points) + len(reached.missed) == 40
    assert len(reached.gaps) == len(reached.missed)
    assert reached.random.all()


def test_starts_that_missed_by_much_are_left_alone():
    problem = CirclesBesideSphere(1e-6)
    far = np.array([[1.5, 0.2, 0.1]])
    seeds = Seeds(far[:0], np.empty(0, dtype=bool), problem.gaps(far), far)
    assert with_weak_solutions(problem, seeds) is seeds
