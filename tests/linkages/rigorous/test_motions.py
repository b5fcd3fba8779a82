"""Whether the motions of a map are all that there are."""

import json

import numpy as np
import pytest
from flint import arb, ctx

from linkages.axes import loop_from_axes
from linkages.loop import Loop
from linkages.rigorous import check
from linkages.rigorous.check import Check, Motions
from tests.linkages.rigorous.certificates import (
    certificate_of_loop,
    failures,
    named_certificate,
)
from tests.maps import map_of


@pytest.fixture(autouse=True)
def _precision():
    former, ctx.prec = ctx.prec, 128
    yield
    ctx.prec = former


def said_of_all_motions(certificate):
    (line,) = [
        str(one) for one in Check(certificate).statements() if one.name == "all motions"
    ]
    return line


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bennett", "every motion is on the map; "),
        ("spherical-four-bar", "of a singular point; "),
    ],
)
def test_a_map_has_all_motions(name, words):
    certificate = json.loads(named_certificate(name, with_motions=True))
    line = said_of_all_motions(certificate)
    assert line.startswith("all motions: holds; every motion is on the map")
    assert words in line


def test_a_loop_that_is_rigid_has_no_motion():
    loop = Loop([1.0, 2.0, 0.7, 1.3], [0.9, 1.3, 1.1, 1.4], [0.1, 0.0, 0.3, 0.0])
    certificate = certificate_of_loop(loop, with_motions=True)
    assert certificate["tubes"] == []
    assert "holds; there is no motion" in said_of_all_motions(certificate)
    assert failures(certificate) == []


def test_isolated_assemblies_are_no_motions():
    rng = np.random.default_rng(5)
    points, directions = rng.normal(size=(2, 4, 3))
    loop, _ = loop_from_axes(points, directions)  # it closes, and is rigid
    certificate = certificate_of_loop(loop, with_motions=True)
    assert "holds; there is no motion" in said_of_all_motions(certificate)
    motions = Motions(Check(certificate).loop, 0, [], [])
    cells = motions.cells(certificate["motions"]["held"])
    assert any(cell.widest[1] < 0.1 for cell in cells)


def without_a_form(certificate):
    """The last form left out, of a map without singular points."""
    certificate["curves"].pop()
    certificate["tubes"].pop()
    return certificate


def test_a_form_that_is_left_out_is_missed():
    certificate = without_a_form(json.loads(named_certificate("four-bar")))
    assert failures(certificate) == []
    certificate["motions"] = {"first": 0, "held": [0, 2]}
    (failure,) = failures(certificate)
    assert failure.startswith("all motions: does not hold: configurations may be left")


SHORT = [1.0, 1.0, 1.0, 2.9999]  # nearly stretched: its joints turn by a degree or so


def test_a_small_oval_is_missed():
    loop = Loop(SHORT, [0.0] * 4, [0.0] * 4)
    certificate = certificate_of_loop(loop)
    assert len(certificate["curves"]) == 1
    assert np.ptp(map_of(loop).forms[0].branch.sample(50), axis=0).max() < 0.1
    certificate = without_a_form(certificate)
    certificate["motions"] = {"first": 0, "held": [0, 2]}
    (failure,) = failures(certificate)
    assert failure.startswith("all motions: does not hold: configurations may be left")


def test_where_a_motion_may_leave_the_map_nothing_is_said_of_all():
    certificate = json.loads(named_certificate("bennett"))
    (tube,) = certificate["tubes"]
    del tube["winding"]
    tube["ends"] = [None, None]
    certificate["motions"] = {"first": 0, "held": [0, 2]}
    assert "rests on the others" in said_of_all_motions(certificate)


def test_both_chains_have_to_be_held():
    certificate = json.loads(named_certificate("bennett"))
    certificate["motions"] = {"first": 0, "held": [0, 1]}
    assert "a chain is not held" in said_of_all_motions(certificate)


@pytest.mark.parametrize("name", ["bennett", "goldberg-5r", "bricard-trihedral"])
def test_cells_hold_the_configurations_that_they_are_about(name):
    rng = np.random.default_rng(3)
    loop = Check(json.loads(named_certificate(name))).loop
    places = map_of(name).forms[0].branch.sample(40)
    count = 0
    for u in places:
        first = int(rng.integers(loop.n))
        motions = Motions(loop, first, [], [])
        half = 10 ** rng.uniform(-6, -1)
        joints = [int(rng.choice(chain.joints)) for chain in motions.chains]
        joints += rng.choice(loop.n, rng.integers(2), replace=False).tolist()
        held = [None] * loop.n
        for joint in joints:
            held[joint] = (float(u[joint] + half * rng.uniform(-1, 1)), float(half))
        try:
            place = motions.configuration(check.Cell(tuple(held), []))
        except check.DoesNotHold:
            continue
        count += 1
        assert place is not None
        for ball, value in zip(place, u, strict=True):
            near = check._near([arb(float(value), 1e-12)], [ball])[0]
            assert ball.overlaps(near)
    assert count > 10


@pytest.mark.parametrize("name", ["bennett", "goldberg-5r", "bricard-trihedral"])
def test_a_leaf_holds_the_configurations_of_its_ball(name):
    loop = Check(json.loads(named_certificate(name))).loop
    branch = map_of(name).forms[0].branch
    size = 1e-3
    for s in np.linspace(0, branch.length, 7)[:-1]:
        hull = [arb(float(x) + size / 3, size) for x in branch(s)]
        leaf = check.Leaf(loop, hull, [0, 2], arb(1e-9))
        *follows, rest = leaf.directions
        assert max(float(x.rad()) for x in rest) < size / 4
        for place in branch(s + np.linspace(-0.4, 0.4, 9) * size):
            step = [arb(float(x)) - h.mid() for x, h in zip(place, hull, strict=True)]
            for held, direction in zip((0, 2), follows, strict=True):
                step = [x - d * step_ for x, d, step_ in _along(step, direction, held)]
            assert all(ball.contains(x) for ball, x in zip(rest, step, strict=True))


def _along(step, direction, held):
    """A step, the direction that belongs to a held joint, and how far that one moves."""
    return zip(step, direction, [step[held]] * len(step), strict=True)


@pytest.mark.parametrize(
    ("parts", "is_covered"),
    [
        ([(-2, 0.5), (0.4, 2)], True),
        ([(0.4, 2), (-2, 0.5)], True),
        ([(-2, 0.3), (0.4, 2)], False),
        ([(-2, 0.5)], False),
        ([(-0.9, 2)], False),
        ([], False),
    ],
)
def test_what_is_covered(parts, is_covered):
    balls = [[arb(low), arb(high)] for low, high in parts]
    assert check._are_covered(arb(0, 1), balls) is is_covered
