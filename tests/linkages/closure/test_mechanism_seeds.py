"""Where a search of a mechanism begins."""

import numpy as np

from bifurc.limits import Deadline
from linkages.closure import mechanism_seeds
from linkages.closure.closure import Closure
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

PLACES = ((0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0))
BODIES = ("frame", "crank", "rod", "rocker", "frame")
BUDGET = 3.0  # seconds


def four_bar():
    joints = [
        Joint(f"R{k}", "revolute", BODIES[k : k + 2], place, (0, 0, 1))
        for k, place in enumerate(PLACES)
    ]
    return Mechanism(tuple(joints))


def test_a_source_that_does_not_end_loses_no_random_starts(monkeypatch):
    def never_ends(problem, structure, rng, count):
        while True:
            pass

    monkeypatch.setattr(mechanism_seeds, "SOURCES", (never_ends,))
    problem, rng = Closure(four_bar()), np.random.default_rng(0)
    deadline = Deadline(BUDGET)
    seeds = mechanism_seeds.mechanism_seeds(problem, rng, 20, deadline)
    assert np.count_nonzero(seeds.random) > 0
    assert seeds.audit is None
    assert deadline.left > 0.3 * BUDGET
