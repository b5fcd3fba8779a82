"""All that is within limits is a part of what is listed, but for whole turns."""

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.turns.turn_classes import passes_but_for_turns
from linkages.turns.turn_lattice import TurnLattice
from tests.linkages.turns.test_translates import (
    revolutes,
    screw_and_slide,
    screws,
)
from tests.maps import map_of

SETTINGS = SearchSettings(starts=100, certify=False, near_motions=False)
LIMITS_OF_SCREWS = [
    ((-6.6, 4.0), (-3.4, 0.5), (-0.3, 7.0), (-2.6, 7.8)),
    ((-7.5, 6.0), (-4.7, 5.2), (-7.9, 6.8), (-6.3, 0.1)),
    ((-3.6, 3.1), (-5.4, 8.0), (-7.1, 0.1), (-0.1, 7.7)),
]
CUT_OFF = [
    revolutes((-6.2, 0.4)),
    screw_and_slide((-6.2, 0.4)),
    *(screws(limits) for limits in LIMITS_OF_SCREWS),
]


@pytest.mark.parametrize("mechanism", CUT_OFF)
def test_all_that_is_within_limits_is_listed_but_for_whole_turns(mechanism):
    atlas = map_of(mechanism, settings=SETTINGS)
    problem = MechanismClosure(mechanism)
    rng = np.random.default_rng(1)
    reach = np.where(
        np.isfinite(problem.domain.bounds[:, 1]), problem.domain.bounds[:, 1], np.pi
    )
    starts = rng.uniform(-reach, reach, (1500, problem.n))
    points, gaps = problem.project(starts)
    inside = points[(gaps < 1e-11) & problem.domain.are_inside(points)]
    assert len(inside) > 100
    is_listed = np.zeros(len(inside), dtype=bool)
    for form in atlas.forms:
        is_listed |= passes_but_for_turns(form.branch, inside, problem.lattice)
    assert np.all(is_listed)


@pytest.mark.parametrize(("high", "place"), [(20.0, 4 * np.pi), (1.0, 3.0)])
def test_the_inmost_translate_is_the_farthest_from_all_limits(high, place):
    basis = np.array([[2 * np.pi, 0.0]])
    lattice = TurnLattice(basis, (0,), np.array([[0.0, high]] * 2))
    begin = np.array([place % (2 * np.pi), 3.0])
    assert lattice.inmost(begin) == pytest.approx([place, 3.0])


def test_a_place_beside_the_end_of_a_form_is_on_it_whichever_end_is_next():
    mechanism = revolutes((-6.2, 0.4))
    atlas = map_of(mechanism, settings=SETTINGS)
    problem = MechanismClosure(mechanism)
    for form in atlas.forms:
        length = form.branch.length
        beside = 10.0 ** np.arange(-6, -1)
        ends = form.branch(np.concatenate([beside, length - beside]))
        assert np.all(passes_but_for_turns(form.branch, ends, problem.lattice))
