"""Curves beside a bifurcation stay on their arc, and the exact tests that say so can
say otherwise."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.linkage import load
from linkages.mapping import map_linkage
from studies.half_turn import SHIFT, HalfTurn
from studies.near_bifurcations import STEPS, describe, describe_certificates, follow
from studies.near_misses import FAMILIES, near_misses


@pytest.fixture(scope="module")
def cases():
    return list(near_misses(20, np.random.default_rng(1)))


def test_every_traced_curve_stays_on_its_arc(cases):
    traces = [follow(case, step) for case in cases for step in STEPS]
    assert [t for t in traces if t.verdict != "right"] == []
    assert {t.family for t in traces} == {case.family for case in cases} and len(
        {t.family for t in traces}
    ) == 4
    assert "40      40     0        0" in describe(traces)


def test_every_trace_is_certified_but_at_places_that_are_singular_to_rounding(cases):
    traces = [follow(case, 0.5, certify=True) for case in cases]
    assert {t.certificate for t in traces} == {
        "certified",
        "certified up to the singular points",
        "certified up to places singular to rounding",
    }
    # a four-bar has no other form to cross; both special double-Goldberg forms that are
    # traced do
    assert {t.certificate for t in traces if t.family == "parallelogram four-bar"} == {
        "certified"
    }
    assert {t.certificate for t in traces if t.family == "double-Goldberg 6R"} == {
        "certified up to the singular points"
    }
    assert "parallelogram four-bar  0.5   5 " in describe_certificates(traces)


def test_the_linkages_are_as_far_from_bifurcating_as_stated(cases):
    assert all(1e-8 <= case.size <= 1e-2 for case in cases)
    assert (
        max(abs(case.problem.residuals(case.start[None])).max() for case in cases)
        < 1e-13
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_four_bar_that_goes_straight_through_the_bifurcation_is_seen(seed):
    near, crossing = (
        FAMILIES[0](np.random.default_rng(seed), size) for size in (1e-6, 1e-18)
    )
    assert near.stays(trace_branch(near.problem, near.start))
    assert not near.stays(trace_branch(crossing.problem, near.start))


def test_a_double_goldberg_that_goes_straight_through_the_bifurcation_is_seen():
    family = FAMILIES[1]
    near, crossing = (family(np.random.default_rng(4), size) for size in (1e-6, 1e-9))
    special = entry("special-double-subtractive-goldberg")
    loop = special.build(**special.draw(np.random.default_rng(4)))
    straight = trace_branch(Closure(loop), crossing.start)
    assert near.stays(trace_branch(near.problem, near.start))
    assert not near.stays(straight)


@pytest.mark.parametrize(
    "name", ["reconfigurable-bricard-1", "bricard-line-symmetric-zero-offset"]
)
def test_only_the_line_symmetric_forms_pass_as_such(name):
    relation = HalfTurn(entry(name).build())
    for form in map_linkage(load(name)).forms:
        points = form.branch.sample(200)
        symmetric = np.abs(np.sin((points[:, 3:] - points[:, :3]) / 2)).max() < 1e-9
        assert relation.stays(form.branch) == symmetric == ("original" in form.name)


def test_the_sheet_squares_to_the_discriminant():
    name = "bricard-line-symmetric"
    relation = HalfTurn(entry(name).build())
    points = map_linkage(load(name)).forms[0].branch.sample(50)
    half = (points[:, 0] - SHIFT[0]) / 2
    powers = np.cos(half)[:, None] ** np.arange(4, -1, -1) * np.sin(half)[
        :, None
    ] ** np.arange(5)
    assert relation.sheet(points) ** 2 == pytest.approx(
        powers @ relation.quartic, abs=1e-11
    )
