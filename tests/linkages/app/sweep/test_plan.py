"""What a sweep runs through."""

import numpy as np
import pytest

from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.subjects import Family
from linkages.values import GeometryError


def test_blocks_hold_every_member_once():
    plan = Plan(
        Family("bennett"),
        axes={
            "a": tuple(range(1, 6)),
            "alpha": tuple(range(1, 8)),
            "beta": (0.1, 0.2, 0.3),
        },
        block=8,
    )
    blocks = list(plan.blocks())
    indices = np.concatenate([block.indices for block in blocks])
    assert sorted(indices.tolist()) == list(range(plan.size))
    assert len(blocks) == plan.block_count
    assert all(
        plan.block_of(int(i)) == block.number for block in blocks for i in block.indices
    )
    assert max(len(block.indices) for block in blocks) <= 8


def test_degrees_are_read_as_radians_and_lengths_as_they_are():
    plan = read_plan("bennett", ["alpha=10:80:3", "a=2"])
    assert np.allclose(plan.axes["alpha"], np.radians([10, 45, 80]))
    assert plan.values(1) == {"a": 2.0, "alpha": pytest.approx(np.pi / 4)}


def test_a_random_member_does_not_depend_on_how_many_there_are():
    few, many = (
        read_plan("bennett", ["alpha=10:80"], random=n, seed=3) for n in (5, 50)
    )
    assert few.values(4) == many.values(4)
    assert few.values(4) != few.values(3)


@pytest.mark.parametrize(
    "text",
    [
        "alpha",
        "twist=3",
        "alpha=x",
        "alpha=1:2",
        "alpha=1:2:3:4",
        "alpha=1:2:0.5",
        "alpha=nan",
    ],
)
def test_a_parameter_that_cannot_be_read_is_refused(text):
    with pytest.raises(GeometryError):
        read_plan("bennett", [text])
