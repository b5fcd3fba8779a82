"""The bank of curves is sound, and a quick sample of it comes out right."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc import explore
from studies.curve_bank import (
    Verdict,
    changes_of,
    judge,
    load_curves,
    run_curve,
)
from tests.samples import one_in

CURVES = {curve.name: curve for curve in load_curves()}
SAMPLE = [
    ("folium of Descartes", "plain"),
    ("astroid", "unknowns 1e-06"),
    ("trifolium", "unknowns 1e+06"),
    ("lemniscate of Bernoulli", "last unknown 1000"),
    ("nodal cubic", "first equation 1e-06"),
    ("two equal cylinders", "first equation 1e+06"),
    ("twisted cubic by three quadrics", "mixed equations"),
    ("circle", "shifted"),
    ("lemniscate of Gerono", "turned 1"),
    ("two circles on a torus", "shifted"),
    ("knot curve", "unknowns 1e+06"),
    ("Trott curve", "turned 1"),
    ("three circles through a point of a torus", "plain"),
    ("three equal cylinders", "first equation 1e-06"),
    ("pendulum that just turns over", "shifted"),
    ("double lemniscate", "last unknown 10"),
    ("lines of multiplicity 1 to 3", "unknowns 1e-06"),
    ("double lemniscate, expanded", "turned 1"),
    ("a double circle and a tangent", "last unknown 1000"),
    ("double Viviani curve", "mixed equations"),
    ("a plane on a torus", "turned 2"),
    ("double curves on a torus", "first equation 1e-06"),
    ("rim and two rays outside it", "unknowns 1e-06"),
    ("rim of a power and a line that ends on it", "last unknown 10"),
    ("rim of an inverse cosine", "shifted"),
    ("rim in space", "unknowns 1000"),
    ("circle in noise of 1e-7", "first equation 1e-06"),
    ("sine in noise of 1e-8", "unknowns 1e+06"),
    ("space curve in noise of 1e-7", "last unknown 10"),
    ("two folds of a cubic", "mixed equations"),
    ("fold and three events at one place", "shifted"),
    ("two Hopf points at one place, in opposite directions", "unknowns 1e-06"),
    ("Hopf point and an event at one place", "last unknown 1000"),
    ("rim of a disc and a chord", "unknowns 1000"),
    ("cube roots of a cubic and a line", "last unknown 10"),
    ("rim in space and a line across it", "shifted"),
    ("ellipse in noise of 1e-6", "unknowns 1e-06"),
    ("three Hopf points at one place, one in the other direction", "unknowns 10"),
    ("a Hopf point beside a pair that rests on the axis", "last unknown 0.001"),
]


def test_every_curve_has_a_source_and_a_name_of_its_own():
    assert len(CURVES) == len(load_curves()) >= 290
    for curve in CURVES.values():
        assert curve.source
        assert len(curve.bounds) == len(curve.unknowns) == len(curve.periods)
        assert np.all(curve.bounds[:, 0] < curve.bounds[:, 1])


@pytest.mark.parametrize("case", one_in(3, SAMPLE, " ".join))
def test_a_curve_of_the_bank_comes_out_right_in_any_units(case):
    name, change = case
    curve = CURVES[name]
    (chosen,) = [c for c in changes_of(curve) if c.name == change]
    run = run_curve(curve, chosen, seed=0, budget=60.0)
    assert run.verdict is Verdict.RIGHT, run.answer


def test_a_wrong_answer_without_a_doubt_is_wrong():
    circle = CURVES["circle"]
    atlas = explore(next(changes_of(circle)).problem(circle))
    assert judge(circle, atlas) is Verdict.RIGHT
    two = replace(circle, answer=circle.answer._replace(closed=2))
    assert judge(two, atlas) is Verdict.WRONG


def test_an_exception_is_wrong():
    broken = replace(CURVES["circle"], equations=("f(x)",))
    run = run_curve(broken, next(changes_of(broken)), seed=0, budget=1.0)
    assert run.verdict is Verdict.WRONG
    assert "'f' is not defined" in run.answer


@pytest.mark.parametrize("name", ["unknowns 1e-06", "first equation 1000"])
def test_a_flat_rank_drop_is_found_or_said_to_be_missing(name):
    curve = CURVES["E12"]
    (change,) = [change for change in changes_of(curve) if change.name == name]
    atlas = explore(change.problem(curve), seed=0)
    is_missed = "no singular point was located" in atlas.completeness.statement
    assert len(atlas.rank_drops) == 1 or is_missed


@pytest.mark.parametrize("name", one_in(2, ["A4", "A3, isolated", "E7", "D6"]))
def test_the_milnor_number_is_the_index_of_the_type(name):
    curve = CURVES[name]
    (point,) = explore(next(changes_of(curve)).problem(curve)).points
    assert point.point.invariants.milnor_number == int(name[1])
