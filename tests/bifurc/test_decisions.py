"""The table of decisions: what it compares, and what it notes."""

import numpy as np
import pytest

from bifurc import decisions
from bifurc.decisions import TABLE, Decision, record_margins


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


@pytest.mark.parametrize("name", sorted(TABLE))
def test_every_decision_of_the_module_stands_in_the_table(name: str) -> None:
    decision = TABLE[name]
    assert decision.name == name
    assert decision.threshold > 0
    assert decision in vars(decisions).values()
    for text in (decision.claim, decision.quantity, decision.reason):
        assert text
        assert text[0].islower() or text[0] in "WNV"
        assert not text.endswith(".")
