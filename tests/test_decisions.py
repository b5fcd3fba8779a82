"""The tables of decisions of both packages."""

from types import ModuleType

import pytest

import bifurc.decisions
import linkages.decisions
from bifurc.decisions import Decision, Role

MODULES = [bifurc.decisions, linkages.decisions]


@pytest.mark.parametrize("module", MODULES)
def test_no_two_decisions_share_a_name(module: ModuleType) -> None:
    decisions = [one for one in vars(module).values() if isinstance(one, Decision)]
    assert len(decisions) == len(module.TABLE)
    assert not bifurc.decisions.TABLE.keys() & linkages.decisions.TABLE.keys()


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
