"""The tables of decisions: all say what they compare."""

from types import ModuleType

import pytest

import bifurc.decisions
import linkages.decisions
from bifurc.decisions import Decision, Role

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


@pytest.mark.parametrize("decision", [one for m in MODULES for one in m.TABLE.values()])
def test_a_third_answer_is_that_of_a_verdict(decision: Decision) -> None:
    if decision.third_answer:
        assert decision.role is Role.VERDICT
        assert not decision.third_answer.endswith(".")
