"""The reference cases: every entry reproduces its case, the case closes, and it has the
stated mobility."""

import json
from pathlib import Path

import numpy as np
import pytest

from linkages.catalogue import catalogue
from linkages.loop import Loop

CASES = json.loads(
    (Path(__file__).parents[2] / "data" / "catalogue_cases.json").read_text()
)


def build(case: dict) -> Loop:
    """The loop of a case; some are an entry read the other way round and from another
    joint."""
    loop = catalogue()[case["entry"]].build(**case["parameters"])
    loop = loop.reversed() if case.get("reversed") else loop
    return loop.relabelled(case.get("shift", 0))


def test_all_cases_are_there():
    assert len(CASES) == 87


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["case"])
def test_entry_reproduces_its_case(case):
    for array, key in zip(build(case).arrays, ("a", "alpha", "R"), strict=True):
        assert (
            np.abs(array - case[key]).max() <= 1e-12
        )  # the cases stand there as doubles


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["case"])
def test_case_closes_to_rounding(case):
    loop = build(case)
    gap = np.abs(loop.frames(case["theta"])[-1] - np.eye(4))
    gap[:3, 3] /= loop.characteristic_length
    assert gap.max() <= 1e-14  # some forty rounded products of numbers near one


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["case"])
def test_screws_have_the_rank_of_the_mobility(case):
    loop = build(case)
    screws = loop.joint_screws(case["theta"])
    screws[3:] /= loop.characteristic_length
    values = np.linalg.svd(screws, compute_uv=False)
    assert loop.n - np.sum(values > 1e-9 * values[0]) == case["mobility"]
