"""What the benchmarks and the study of costs write is well formed. No time is
asserted."""

import json

import pytest

from linkages.catalogue import entry
from linkages.closure.closure import Closure
from studies.bench import machine, median_time
from studies.branch_cost import Cost, cost_of, exponent, line


def test_the_machine_is_described_in_plain_json():
    described = json.loads(json.dumps(machine()))
    assert {"processor", "cores", "python", "packages"} <= set(described)
    assert described["packages"]["numpy"]


def test_a_median_takes_one_run_to_warm_up_and_at_least_three_more():
    ticks = iter([0.0, 5.0, 0.0, 1.0, 0.0, 2.0])
    runs = []
    assert (
        median_time(lambda: runs.append(1), budget=0.0, clock=lambda: next(ticks))
        == 2.0
    )
    assert len(runs) == 4


def test_the_branch_of_a_bennett_linkage_is_costed_once():
    (cost,) = cost_of("loops", Closure(entry("bennett").build()))
    assert (cost.joints, cost.series) == (4, "loops")
    assert cost.pieces > 4
    assert cost.gap > 1e-3


def test_the_lines_through_the_costs_are_those_they_were_made_of():
    costs = [
        Cost("loops", n, 3.0 * n, 7, 0.1, 7 * (5.0 + 2.0 * n), 0.0)
        for n in range(4, 13)
    ]
    assert line(costs, lambda c: c.seconds) == pytest.approx([2.0, 5.0])
    cubes = [Cost("loops", 7, x, 7, 0.1, 2.0 * x**3, 0.0) for x in (1.0, 2.0, 5.0)]
    assert exponent(cubes) == pytest.approx(3.0)
