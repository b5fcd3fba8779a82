"""The bank of curves: what is in it, and how answers are judged."""

from __future__ import annotations

import pytest

import bifurc
from studies.curve_bank import (
    Answer,
    BankCurve,
    Outcome,
    Scales,
    all_scales,
    judge,
    load_bank,
    run,
)

BANK = {curve.name: curve for curve in load_bank()}


def test_every_curve_of_the_bank_can_be_made_in_every_scale() -> None:
    assert len(BANK) == len(load_bank()) > 50
    for curve in BANK.values():
        assert curve.problem(Scales(1e3, 1e-3)).n == len(curve.unknowns)
    assert len(list(all_scales())) == 9


@pytest.mark.parametrize(
    "name", ["lemniscate of Bernoulli", "two cylinders of the same radius"]
)
@pytest.mark.parametrize(
    "scales", [Scales(1e6, 1.0), Scales(1e-6, 1.0), Scales(1, 1e3)]
)
def test_scales_do_not_change_the_answer(name, scales) -> None:
    result = run(BANK[name], scales, seed=1, budget=60.0)
    assert result.outcome is Outcome.RIGHT
    assert result.answer == BANK[name].expected


def test_a_wrong_answer_without_a_doubt_is_silent() -> None:
    circle = BANK["circle"]
    atlas = bifurc.explore(circle.problem(Scales()))
    assert judge(atlas, Answer(1, 0, 0, 0)) is Outcome.RIGHT
    assert judge(atlas, Answer(2, 0, 0, 0)) is Outcome.SILENT_WRONG


def test_an_exception_is_silently_wrong() -> None:
    broken = BankCurve("none", ["f(x)"], {"x": (0, 1)}, {}, Answer(1, 0, 0, 0))
    result = run(broken, Scales(), seed=0, budget=1.0)
    assert result.outcome is Outcome.SILENT_WRONG
    assert "no function" in str(result.answer)
