"""Branches cut into parts and joined."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.branches.branch_parts import followed_by, part_of, with_piece_between
from bifurc.settings import TraceSettings

CIRCLE = FunctionProblem(lambda u: [u @ u - 1], [(-2, 2)] * 2)
START = np.array([1.0, 0.0])
OPENING = 5e-4  # to either side: a quartic is within 1e-12 of the circle across it


def circle_of(order, tolerance=1e-13):
    settings = TraceSettings(order=order, tolerance=tolerance)
    return trace_branch(CIRCLE, START, settings=settings)


def stretch(branch, begin, end):
    return replace(part_of(branch, begin, end), outcome=Outcome.STALLED)


@pytest.mark.parametrize("order", [5, 16])
def test_a_piece_between_branches_goes_through_the_point(order):
    circle = circle_of(order)
    middle = float(circle.breaks[2])
    before = stretch(circle, 0.0, middle - OPENING)
    after = stretch(circle, middle + OPENING, circle.length)
    point = circle(middle)
    joined = with_piece_between(CIRCLE, point, before, after, Outcome.STALLED)
    assert joined is not None
    assert joined.length == pytest.approx(circle.length, abs=1e-10)
    distance, _ = joined.nearest(point)
    assert distance[0] < 1e-12
    radii = np.linalg.norm(joined.sample(4000), axis=1)
    assert radii == pytest.approx(1.0, abs=1e-11)


def test_a_piece_between_branches_of_a_low_order_has_the_order_that_it_needs():
    exact = circle_of(16)
    # cut off at the third power: exact to rounding beside the middle of a piece
    circle = replace(exact, pieces=exact.pieces[:, :4])
    middle = float(circle.centers[1])
    before = stretch(circle, 0.0, middle - OPENING)
    after = stretch(circle, middle + OPENING, circle.length)
    joined = with_piece_between(CIRCLE, exact(middle), before, after, Outcome.STALLED)
    assert joined is not None
    assert joined.pieces.shape[1] == 5
    assert joined(middle) == pytest.approx(exact(middle), abs=1e-12)


@pytest.mark.parametrize("orders", [(5, 16), (16, 5)])
def test_branches_of_two_orders_follow_each_other(orders):
    one, other = (circle_of(order) for order in orders)
    twice = followed_by(one, other, np.zeros(2))
    assert twice.length == pytest.approx(4 * np.pi, abs=1e-11)
    s = np.linspace(0.0, one.length, 50)[1:-1]
    assert twice(s) == pytest.approx(one(s), abs=1e-15)
    assert twice(one.length + s) == pytest.approx(other(s), abs=1e-13)


def test_no_piece_leads_through_what_is_no_solution():
    circle = circle_of(16)
    before, after = stretch(circle, 0.0, 1.0), stretch(circle, 1.2, circle.length)
    aside = 1.1 * circle(1.1)
    assert with_piece_between(CIRCLE, aside, before, after, Outcome.STALLED) is None
