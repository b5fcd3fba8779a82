"""Forms and assemblies that are one but for whole turns are told."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.turns.turn_classes import classes_of_assemblies, classes_of_forms
from tests.linkages.turns.test_turn_lattice import four_bar

TURN = 2 * np.pi
WIDE = np.deg2rad(1000.0)
# which joint has limits: one that swings, and one that goes round
SWINGING = (((0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0)), 3)
TURNING = (((0, 0, 0), (0.6, 0.8, 0), (0.6, 1.8, 0), (3, 0, 0)), 1)


@cache
def problem_of(case):
    places, joint = case
    return MechanismClosure(four_bar(places, {joint: (-WIDE, WIDE)}))


def moved(branch, shift):
    pieces = branch.pieces.copy()
    pieces[:, 0] += shift
    return replace(branch, pieces=pieces)


@pytest.mark.parametrize(("case", "is_closed"), [(SWINGING, True), (TURNING, False)])
def test_a_form_and_those_whole_turns_away_are_one(case, is_closed):
    problem = problem_of(case)
    branch = trace_branch(problem, problem.reference)
    assert branch.closed is is_closed
    (shift,) = problem.lattice.basis
    others = [branch.reversed(), moved(branch, -2 * shift), moved(branch, shift)]
    (all_of_them,) = classes_of_forms([branch, *others], problem.lattice)
    assert len(all_of_them) == 4


@pytest.mark.parametrize("share", [1e-3, 0.5])
def test_forms_that_are_a_part_of_a_turn_apart_are_two(share):
    problem = problem_of(SWINGING)
    branch = trace_branch(problem, problem.reference)
    (shift,) = problem.lattice.basis
    other = moved(branch, share * shift)
    assert len(classes_of_forms([branch, other], problem.lattice)) == 2


def test_assemblies_whole_turns_apart_are_one():
    problem = problem_of(SWINGING)
    (shift,) = problem.lattice.basis
    point = problem.reference
    periods = problem.domain.periods
    around = point + np.where(np.isfinite(periods), TURN, 0.0)
    points = [point, point + 2 * shift, point + 0.4 * shift, around]
    classes = classes_of_assemblies(points, periods, problem.lattice)
    assert [len(own) for own in classes] == [3, 1]
