"""Which maps are proved, and what is said to be open."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.limits import Deadline, until
from bifurc.singular.point import Kind
from linkages.linkage import load
from linkages.loop import Loop
from linkages.rigorous.check import Check
from tests.linkages.rigorous.certificates import (
    certificate_of,
    certificate_of_loop,
    failures,
    named_certificate,
)
from tests.maps import map_of


@pytest.mark.parametrize("name", ["bennett", "kite", "parallelogram"])
def test_a_map_of_the_catalogue_is_proved_and_leaves_nothing_open(name):
    certificate = json.loads(named_certificate(name))
    assert certificate["open"] == []
    assert failures(certificate) == []
    assert float.fromhex(certificate["claims"]["radius"]) < 1e-9


def test_the_loop_closes_exactly_where_no_equation_is_left():
    loop = Loop([1.0, 2.4, 2.0, 3.1], [0.0] * 4, [0.0] * 4)
    certificate = certificate_of_loop(loop)
    statements = {one.name: one for one in Check(certificate).statements()}
    assert statements["motion"].numbers.endswith("the loop closes")


def wrong_rank_drop(atlas):
    """A bifurcation called a rank drop, of which one form is left out."""
    point = replace(
        atlas.points[0], kind=Kind.RANK_DROP, passes=atlas.points[0].passes[:1]
    )
    return replace(atlas, points=(point, *atlas.points[1:]))


def without_a_form(atlas):
    """The last form left out."""
    last = len(atlas.forms) - 1
    points = [
        replace(point, passes=tuple(one for one in point.passes if one[0] != last))
        for point in atlas.points
    ]
    return replace(atlas, forms=atlas.forms[:-1], points=tuple(points))


def with_a_bent_piece(atlas):
    """A piece that is off in one joint."""
    form = atlas.forms[0]
    pieces = form.branch.pieces.copy()
    pieces[3, 0, 1] += 0.1
    branch = replace(form.branch, pieces=pieces)
    return replace(atlas, forms=(replace(form, branch=branch), *atlas.forms[1:]))


def with_a_form_that_ends(atlas):
    """A form that ends where it would close."""
    form = atlas.forms[0]
    branch = replace(form.branch, outcome=Outcome.ENDS_AT_A_POINT)
    return replace(atlas, forms=(replace(form, branch=branch), *atlas.forms[1:]))


def with_a_point_beside(atlas):
    """A point farther off than rounding."""
    meeting = atlas.points[0]
    point = replace(meeting.point, u=meeting.point.u + 1e-6)
    return replace(atlas, points=(replace(meeting, point=point), *atlas.points[1:]))


WRONG = [
    wrong_rank_drop,
    without_a_form,
    with_a_bent_piece,
    with_a_form_that_ends,
    with_a_point_beside,
]


@pytest.mark.parametrize("change", WRONG)
def test_a_wrong_map_is_not_proved(change):
    certificate = certificate_of(load("kite").loop, change(map_of("kite")))
    assert certificate["open"]
    # what is left of it does hold
    assert failures(certificate) == []


def test_nothing_is_proved_when_the_time_was_over_at_once():
    atlas = map_of("kite")
    with until(Deadline(0.0)):
        certificate = certificate_of(load("kite").loop, atlas)
    assert any("the time was over" in words for words in certificate["open"])
    assert failures(certificate) == ["does not hold: nothing is proved"]


def test_curves_that_pass_each_other_are_told_apart():
    # at d = 3.4 two forms meet; beside it they miss each other by the root of what is off
    loop = Loop([1.0, 2.4, 2.0, 3.4 + 1e-9], [0.0] * 4, [0.0] * 4)
    certificate = certificate_of_loop(loop)
    assert certificate["open"] == [] and certificate["points"] == []
    assert failures(certificate) == []
    reach = [
        float.fromhex(box[3]) for tube in certificate["tubes"] for box in tube["boxes"]
    ]
    assert np.min(reach) < 1e-5
