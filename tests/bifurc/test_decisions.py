"""The table of decisions: what it compares, and what it notes."""

from types import ModuleType

import numpy as np
import pytest

import bifurc.decisions
import linkages.decisions
from bifurc.curves.certificate import HANDOVER
from bifurc.decisions import Decision, Role, record_margins, unit_over_rounding


def test_a_decision_compares_with_its_threshold_in_the_unit_given() -> None:
    decision = Decision("test", "it is small", "size", 1e-3, "a round number")
    assert decision(0.9e-3) is True
    assert decision(1.1e-3) is False
    assert decision(1.1e-3, unit=2.0) is True
    verdicts = decision(np.array([0.5, 1.0, 2.0]), unit=np.array([1e3, 1e3, 1e3]))
    assert verdicts.tolist() == [True, False, False]


def test_quantities_are_noted_inside_the_block_only() -> None:
    decision = Decision("test", "it is small", "size", 1e-3, "a round number")
    decision(1.0)
    with record_margins() as margins:
        decision(6.0, unit=2.0)
        decision(np.array([[1.0, 2.0]]))
    decision(5.0)
    assert list(margins) == ["test"]
    assert np.concatenate(margins["test"]).tolist() == [3.0, 1.0, 2.0]


def test_blocks_may_be_nested() -> None:
    decision = Decision("test", "it is small", "size", 1e-3, "a round number")
    with record_margins() as outer:
        with record_margins() as inner:
            decision(1.0)
        decision(2.0)
    assert inner["test"][0].tolist() == [1.0]
    assert outer["test"][0].tolist() == [2.0]


MODULES = [bifurc.decisions, linkages.decisions]


def test_no_two_decisions_share_a_name() -> None:
    names = [one.name for module in MODULES for one in module.TABLE.values()]
    assert len(set(names)) == len(names)
    assert not bifurc.decisions.TABLE.keys() & linkages.decisions.TABLE.keys()


@pytest.mark.parametrize("module", MODULES)
def test_decisions_are_had_by_their_names_in_code(module: ModuleType) -> None:
    for name, decision in module.TABLE.items():
        assert getattr(module, name) is decision
    assert not hasattr(module, "is_nothing")


@pytest.mark.parametrize("decision", [one for m in MODULES for one in m.TABLE.values()])
def test_a_decision_says_what_it_compares_and_why(decision: Decision) -> None:
    assert decision.threshold > 0
    for text in (decision.claim, decision.quantity, decision.reason):
        assert text
        assert text[0].islower() or text[0] in "WNV"
        assert not text.endswith(".")


def test_what_rounding_may_have_made_is_below_a_threshold() -> None:
    decision = Decision("test", "it is small", "size", 1e-3, "a round number")
    assert unit_over_rounding(decision, 1e-6) == 1.0
    assert unit_over_rounding(decision, 1e-2) == 10.0
    assert decision(5e-3, unit_over_rounding(decision, 1e-2))


@pytest.mark.parametrize("decision", [one for m in MODULES for one in m.TABLE.values()])
def test_a_third_answer_is_that_of_a_verdict(decision: Decision) -> None:
    if decision.third_answer:
        assert decision.role is Role.VERDICT
        assert not decision.third_answer.endswith(".")


def test_a_point_is_passed_within_half_of_where_arcs_are_handed_over() -> None:
    assert bifurc.decisions.is_passed.threshold == HANDOVER / 2
