"""One member of a sweep."""

import gc
import tracemalloc
from contextlib import contextmanager

import numpy as np
import pytest

from linkages.app.sweep.member import Status, map_member
from linkages.app.sweep.plan import Plan
from linkages.app.sweep.subjects import Family


@contextmanager
def traced():
    """Bytes held, garbage collected, as a function to call."""

    def held():
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        yield held
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("family", ["bennett", "goldberg-5r"])
def test_a_worker_keeps_nothing_of_the_members_that_it_mapped(family):
    subject = Family(family)
    plan = Plan(subject, random=1000, ranges={"alpha": (0.5, 1.0)})
    held_after = []
    with traced() as held:
        for index in range(40):
            map_member(subject, plan.values(index), 10, 0)
            if index % 10 == 9:
                held_after.append(held())
    # What is kept of every member is kept of every ten; what is made once is not.
    growth = min(np.diff(held_after))
    assert growth < 10 * 1000  # a single traced form is more than 20 kB


def test_refused_parameters_are_recorded_as_such():
    record = map_member(
        Family("double-subtractive-goldberg"), {"alpha": 0.5, "gamma": 1.5}, 10, 0
    )
    assert record["status"] == Status.REFUSED
    assert "length" in record["message"]
