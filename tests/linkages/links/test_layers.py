"""Layers of planar linkages: no two that share one meet, and no fewer would do."""

from itertools import combinations, product

import numpy as np
import pytest

from linkages.app.reports.layers import parts_in_layers
from linkages.linkage import load
from linkages.links.layer_program import Separation, fewest_layers
from linkages.links.layers import Plan, Widths
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.subject import subject_at
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.maps import map_of

DIAMETER = 0.06  # of the mean length of a link
LINKAGES = {
    "four-bar": lambda: load("four-bar"),
    "parallelogram": lambda: load("parallelogram"),
    "slider-crank": lambda: mechanism_of_case(cases()["planar slider-crank RRRP"]),
    "three cranks": lambda: mechanism_of_case(
        cases()["three equal parallel cranks, pivots on a line"]
    ),
    "rhombus": lambda: load("rhombus"),
}
HOPELESS = ("rhombus",)  # opposite pins come to one place


def plan_of(name):
    atlas = map_of(LINKAGES[name]())
    parts = subject_at(atlas).flat_parts
    radius = DIAMETER * parts.size / 2
    return Plan(parts, atlas.forms[:1], Widths(radius, radius, 0.1 * radius))


def tracks(plan, form, count=120):
    """Points along the outlines (o, count, p, 2), placed by the poses of their bodies
    and seen along the normal, without what the layers are made with."""
    normal = plan.parts.normal
    across = np.linalg.svd(normal[None])[2][1:]
    poses = plan.parts.poses(form.branch.sample(count))
    shares = np.linspace(0, 1, 25)[:, None]
    placed = []
    for outline in plan.outlines:
        points = np.concatenate(
            [start + shares * (end - start) for start, end in outline.lines]
        )
        pose = poses[:, outline.holder]
        moved = np.einsum("kij,pj->kpi", pose[:, :3, :3], points)
        placed.append((moved + pose[:, None, :3, 3]) @ across.T)
    return placed


def left_between(plan, placed, pair):
    """The least that is left between the points of two outlines."""
    first, second = (placed[k][:, :: 1 if plan.outlines[k].is_pin else 2] for k in pair)
    ways = first[:, :, None] - second[:, None]
    radii = [plan.outlines[k].radii.max() for k in pair]
    return np.linalg.norm(ways, axis=-1).min() - sum(radii)


@pytest.mark.parametrize("name", LINKAGES)
def test_what_shares_a_layer_is_apart_in_the_plane(name):
    plan = plan_of(name)
    layers = plan.layers()
    assert bool(layers.meetings) == (name in HOPELESS)
    assert layers.is_proven
    placed = tracks(plan, plan.forms[0])
    known = {meeting.outlines for meeting in layers.meetings}
    for pair in combinations(range(len(plan.outlines)), 2):
        first, second = (plan.outlines[k] for k in pair)
        low, high = layers.span(first)
        other_low, other_high = layers.span(second)
        is_shared = low <= other_high and other_low <= high
        if first.bodies & second.bodies:
            assert first.is_pin or second.is_pin  # bodies of one joint are apart
            continue
        if is_shared and pair not in known:
            assert left_between(plan, placed, pair) > 0
    for pin in plan.pins:
        assert len({int(layers.numbers[body]) for body in pin.bodies}) == len(
            pin.bodies
        )


def test_no_fewer_layers_keep_all_apart():
    """All assignments of fewer layers break something that is seen in samples alone."""
    plan = plan_of("three cranks")
    count = plan.layers().count
    placed = tracks(plan, plan.forms[0], 60)
    joined = [pin.bodies for pin in plan.pins]
    close = [
        [plan.outlines[k].bodies for k in pair]
        for pair in combinations(range(len(plan.outlines)), 2)
        if not plan.outlines[pair[0]].bodies & plan.outlines[pair[1]].bodies
        and left_between(plan, placed, pair) < 0
    ]
    bodies = range(len(plan.parts.names))
    for numbers in product(range(1, count), repeat=len(bodies)):
        is_apart = all(
            len({numbers[body] for body in pin}) == len(pin) for pin in joined
        ) and all(are_apart(numbers, *sets) for sets in close)
        assert not is_apart


def are_apart(numbers, first, second):
    one, other = ([numbers[body] for body in bodies] for bodies in (first, second))
    return min(one) > max(other) or min(other) > max(one)


def test_the_program_agrees_with_all_assignments(seed=5):
    random = np.random.default_rng(seed)
    for _ in range(12):
        spans = [
            frozenset(random.choice(5, 2, replace=False).tolist()) for _ in range(4)
        ]
        separations = [
            Separation(frozenset({int(random.integers(5))}), span) for span in spans
        ]
        separations = [one for one in separations if not one.first & one.second]
        best = None
        for numbers in product(range(1, 6), repeat=5):
            if any(len({numbers[b] for b in span}) < 2 for span in spans):
                continue
            broken = sum(not are_apart(numbers, *one) for one in separations)
            cost = broken, max(numbers)
            best = cost if best is None else min(best, cost)
        solution = fewest_layers(5, separations, spans, {})
        assert (len(solution.broken), solution.layers.max()) == best
        assert solution.is_proven


def test_layers_that_are_given_are_kept_and_those_that_cannot_be_are_refused():
    case = cases()["planar slider-crank RRRP"]
    plan = plan_of("slider-crank")
    assert plan.layers({0: 4}).numbers[0] == 4
    with pytest.raises(GeometryError, match="as pin R1 joins them"):
        plan.layers({0: 1, 1: 1})
    joints = mechanism_of_case(case).joints
    with pytest.raises(GeometryError, match="body in layers"):
        Mechanism(joints, layers=(("nothing", 1),))
    with pytest.raises(GeometryError, match="layer of"):
        Mechanism(joints, layers=((joints[0].bodies[0], 0),))


def test_bodies_of_a_model_lie_in_their_layers_with_pins_between():
    atlas = map_of(LINKAGES["slider-crank"]())
    flat = subject_at(atlas).parts
    raised = parts_in_layers(atlas, atlas.forms[:1])
    points = atlas.forms[0].branch.sample(5)
    heights = []
    for body, own in enumerate(flat.lines(points)):
        lines = raised.lines(points)[body]
        moved = lines[: len(own)] - own
        assert moved == pytest.approx(np.broadcast_to(moved[:1, :1], moved.shape))
        heights.append(moved[0, 0, 2] if len(own) else None)
        assert len(lines) == len(own) + len(raised.symbols_on(body))
    pins = [
        (symbol, raised.lines(points)[body][len(own) + k])
        for body, own in enumerate(flat.lines(points))
        for k, symbol in enumerate(raised.symbols_on(body))
    ]
    for symbol, pin in pins:
        assert pin.mean(axis=0) == pytest.approx(symbol.place)
        joined = [heights[body] for body in symbol.bodies]
        assert pin[1, 2] > pin[0, 2]
        for height in joined:
            assert height is None or pin[0, 2] - 1e-9 <= height <= pin[1, 2] + 1e-9


def test_joints_of_one_axis_that_share_a_body_have_one_pin():
    """Three bars on a pin, given as two joints: as with one joint of three bodies."""
    case = cases()["K(2,3)"]
    joints = list(mechanism_of_case(case).joints)
    number = next(k for k, joint in enumerate(joints) if len(joint.bodies) == 3)
    shared = joints[number]
    first, second, third = shared.bodies
    apart = [
        Joint(f"{shared.name}.{k}", shared.kind, pair, shared.point, shared.direction)
        for k, pair in enumerate([(first, second), (first, third)])
    ]
    joints[number : number + 1] = apart
    counts = []
    for mechanism in (mechanism_of_case(case), Mechanism(tuple(joints))):
        atlas = map_of(mechanism)
        parts = subject_at(atlas).flat_parts
        radius = DIAMETER * parts.size / 2
        plan = Plan(parts, atlas.forms[:1], Widths(radius, radius))
        counts.append((len(plan.pins), plan.layers().count))
    assert counts[0] == counts[1]
