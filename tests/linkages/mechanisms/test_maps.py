"""Maps of mechanisms whose forms and singular points are known."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.branch import Outcome
from bifurc.completeness import Level
from bifurc.search.records import APART
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.facts import form_facts
from linkages.readout.readout import Readout
from studies.known_mechanisms import WAYS
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import platform
from tests.maps import map_of
from tests.samples import one_in

FEW = SearchSettings(starts=60)
Z = (0, 0, 1)


def slider_crank(rod=1.0, height=0.0):
    """Crank 1 and a rod; the slider's line passes the crank's pivot at a height."""
    slider = np.sqrt(rod**2 - (0.8 - height) ** 2) + 0.6
    return Mechanism(
        (
            Joint("J1", "revolute", ("frame", "crank"), (0, 0, 0), Z),
            Joint("J2", "revolute", ("crank", "rod"), (0.6, 0.8, 0), Z),
            Joint("J3", "revolute", ("rod", "slider"), (slider, height, 0), Z),
            Joint("J4", "prismatic", ("frame", "slider"), direction=(1, 0, 0)),
        ),
        "slider-crank",
    )


def rccc():
    """Bennett's axes with one revolute and three cylindrical joints."""
    joints = cases()["Bennett geometry with joints CRCR"]["joints"]
    return [
        Joint(**{**joint, "kind": "cylindrical" if i else "revolute"})
        for i, joint in enumerate(joints)
    ]


def counts(atlas: Atlas):
    """Numbers of forms, of points by kind, dimensions of surfaces, assemblies."""
    kinds = sorted((point.kind for point in atlas.points), key=str)
    dimensions = sorted({surface.dimension for surface in atlas.surfaces})
    return len(atlas.forms), kinds, dimensions, len(atlas.rigid)


def lengths(atlas: Atlas):
    """Lengths of all forms, in order."""
    return sorted(form.branch.length for form in atlas.forms)


# Norton, Design of Machinery (2012): the change point of an in-line slider-crank
def test_an_in_line_slider_crank_with_equal_links_has_a_change_point():
    atlas = map_of(slider_crank(), settings=FEW)
    assert counts(atlas) == (2, [Kind.BIFURCATION] * 2, [], 0)
    readout = Readout(slider_crank())
    for point in atlas.bifurcations:
        assert readout.variables(point.point.u)["J4"] == pytest.approx(-1.2, abs=1e-12)


@pytest.mark.parametrize(
    ("rod", "height", "forms"), [(1.0, 0.05, 1), (1.1, 0.0, 2), (0.9, 0.0, 2)]
)
def test_beside_the_change_point_nothing_meets(rod, height, forms):
    atlas = map_of(slider_crank(rod, height), settings=FEW)
    assert counts(atlas) == (forms, [], [], 0)
    assert all(form.branch.closed for form in atlas.forms)
    assert all(form.certificate.status.value == "certified" for form in atlas.forms)


KNOWN = {
    "three equal parallel cranks, pivots on a line": (1, [Kind.RANK_DROP] * 2, [], 0),
    "K(2,3)": (2, [], [], 0),
    "Dixon I, K(3,3)": (8, [], [], 0),
    "Miura-ori, one vertex (spherical 4R)": (3, [Kind.BIFURCATION] * 3, [], 0),
    "spatial RPRP, unequal distances (control)": (0, [], [], 1),
    "planar slider-crank RRRP": (2, [], [], 0),
    "CCC loop, general axes": (0, [], [], 2),
    "Bennett geometry with joints CRRR": (1, [], [], 0),
    "Bennett geometry with joints CRCR": (2, [Kind.BIFURCATION] * 2, [], 0),
}


@pytest.mark.parametrize("name", KNOWN)
def test_the_map_of_a_known_mechanism(name):
    mechanism = mechanism_of_case(cases()[name])
    atlas = map_of(mechanism, settings=replace(FEW, starts=120))
    assert counts(atlas) == KNOWN[name]


MOBILE = [
    "network of four Bennett linkages",
    "L-shape network of three Bennett linkages",
    "two RRR chains in one plane (degenerate Sarrus)",
    "parallelogram lattice 2 x 2",
]


@pytest.mark.parametrize("name", MOBILE)
def test_more_freedoms_are_counted(name):
    case = cases()[name]
    settings = SearchSettings(starts=10, charts=0)
    atlas = map_of(mechanism_of_case(case), settings=settings)
    assert {surface.dimension for surface in atlas.surfaces} == {case["mobility"]}
    assert not atlas.forms


# Peaucellier 1864: where A and C coincide, D is free; and B and D may coincide instead
# Sarrus 1853: equal links fold flat, and then both chains turn freely
MEETING_A_SURFACE = {
    "Peaucellier-Lipkin inversor": (2, 0, 4),
    "Sarrus with a P joint between base and platform": (2, 2, 4),
}


@pytest.mark.parametrize("name", MEETING_A_SURFACE)
def test_forms_meet_a_surface_where_links_fold(name):
    mechanism = mechanism_of_case(cases()[name])
    settings = SearchSettings(starts=60, charts=0, certify=False)
    atlas = map_of(mechanism, settings=settings)
    kinds = [point.kind for point in atlas.points]
    forms, bifurcations, changes = MEETING_A_SURFACE[name]
    assert len(atlas.forms) == forms
    assert kinds.count(Kind.BIFURCATION) == bifurcations
    assert kinds.count(Kind.DIMENSION_CHANGE) == changes
    assert {surface.dimension for surface in atlas.surfaces} == {2}


def test_the_inversor_draws_a_straight_line():
    mechanism = mechanism_of_case(cases()["Peaucellier-Lipkin inversor"])
    settings = SearchSettings(starts=60, charts=0, certify=False)
    atlas = map_of(mechanism, settings=settings)
    readout = Readout(mechanism)
    end = np.append(mechanism.joint("D").point, 1.0)
    spreads = []
    for form in atlas.forms:
        poses = readout.poses(form.branch.sample(100))
        places = poses[:, mechanism.bodies.index("A-D")] @ end
        spreads.append(np.ptp(places[:, 0]))
    assert min(spreads) < 1e-12
    assert max(spreads) > 0.1


def test_a_form_that_reaches_the_limit_of_a_slide_ends_there():
    mechanism = mechanism_of_case(
        cases()["spatial RPRP, equal distances and opposite slopes"]
    )
    atlas = map_of(mechanism, settings=FEW)
    (form,) = atlas.forms
    assert form.branch.outcome is Outcome.LEFT_REGION
    ends = Readout(mechanism).values(form.branch(np.array([0.0, form.branch.length])))
    limits = Readout(mechanism).limits()["P2"]
    assert np.abs(ends[:, [1, 3]]).max(axis=1) == pytest.approx(limits[1], rel=1e-9)


def test_a_platform_has_assemblies_with_its_legs_locked_and_forms_with_one_free():
    locked = map_of(platform(), settings=FEW)
    assert not locked.forms
    assert len(locked.rigid) % 2 == 0
    assert len(locked.rigid)
    one_free = platform((None, *(0.0,) * 5))
    atlas = map_of(one_free, settings=FEW)
    assert {form.rank for form in atlas.forms} == {9}
    assert one_free.gruebler == 7  # of them 6 idle


def sarrus(first: float, second: float) -> Mechanism:
    """A plate on two chains of three parallel turns, the links of each of one length."""
    joints = []
    ways = (((1, 0, 0), (0, 1, 0), first), ((0, 1, 0), (1, 0, 0), second))
    for k, (place, axis, length) in enumerate(ways):
        foot = np.array(place, dtype=float)
        knee = foot + length * (0.6 * foot + np.array([0, 0, 0.8]))
        head = foot + np.array([0, 0, 1.6 * length])
        bodies = ("base", f"low{k}", f"up{k}", "plate")
        for letter, point, pair in zip(
            "abc", (foot, knee, head), pairwise(bodies), strict=True
        ):
            joints.append(Joint(f"{letter}{k}", "revolute", pair, tuple(point), axis))
    return Mechanism(tuple(joints))


@pytest.mark.parametrize("seed", one_in(2, range(2)))
@pytest.mark.parametrize("longer", [1e-2, 1e-3, 1e-5])
def test_bifurcations_next_to_each_other_are_all_located(longer, seed):
    """A folded chain turns by itself: four forms, which the two on which the plate moves
    meet where that chain folds. The other one folds next to it, as the chains are nearly
    alike, closer than the singular value is sampled."""
    atlas = map_of(sarrus(0.7, 0.7 + longer), seed=seed)
    assert len(atlas.forms) == 6
    assert len(atlas.bifurcations) == 8
    assert all(len(point.passes) == 2 for point in atlas.bifurcations)
    assert atlas.completeness.level is Level.COUNTED


@pytest.mark.parametrize("seed", [1, 2, 4, 6])
def test_what_a_platform_has_does_not_depend_on_the_seed(seed):
    """The first 20 random starts meet 4 to 6 of the six assemblies, 5 or 6 of the
    forms."""
    settings = SearchSettings(starts=20, certify=False)
    locked = map_of(platform(), settings=settings, seed=seed)
    assert len(locked.rigid) == 6
    one_free = platform((None, *(0.0,) * 5))
    atlas = map_of(one_free, settings=settings, seed=seed)
    assert len(atlas.forms) == 6


def test_the_smallest_reconfigurable_linkage_with_slides():
    """The Bennett form, another one, and two lines of pure sliding that meet both."""
    mechanism = Mechanism(tuple(rccc()))
    settings = SearchSettings(starts=60, certify=False)
    atlas = map_of(mechanism, settings=settings)
    assert len(atlas.forms) == 4
    closed = [form for form in atlas.forms if form.branch.closed]
    assert len(closed) == 2
    assert [len(point.passes) for point in atlas.bifurcations] == [3, 3]
    # nothing besides at the limits: the lines are known as double ones all along
    assert len(atlas.points) == 2
    assert sorted(form.rank for form in atlas.forms) == [5, 5, 6, 6]
    readout = Readout(mechanism)
    slides = [
        np.abs(readout.values(form.branch.sample(200))[:, [2, 4, 6]]).max()
        for form in closed
    ]
    assert min(slides) < 1e-12  # on the Bennett form nothing slides
    assert max(slides) == pytest.approx(2.17, abs=0.01)


# --- the same atlas, however the mechanism is given -----------------------------------


SAME = {
    "slider-crank": slider_crank(),
    "CRCR": mechanism_of_case(cases()["Bennett geometry with joints CRCR"]),
    "cranks": mechanism_of_case(
        cases()["three equal parallel cranks, pivots on a line"]
    ),
    "RPRP": mechanism_of_case(
        cases()["spatial RPRP, equal distances and opposite slopes"]
    ),
    "platform": platform((None, *(0.0,) * 5)),
}


@pytest.mark.parametrize("name", SAME)
@pytest.mark.parametrize("way", one_in(2, WAYS))
def test_the_atlas_is_the_same_however_the_mechanism_is_given(name, way):
    settings = SearchSettings(starts=60, certify=False)
    expected = map_of(SAME[name], settings=settings)
    atlas = map_of(WAYS[way](SAME[name]), settings=settings, seed=1)
    assert counts(atlas) == counts(expected)
    # a rotation that is embedded is measured in the frame, and angles of a joint of
    # several bodies from the first of these
    if name != "platform" and (name, way) != ("cranks", "re-based"):
        assert np.allclose(lengths(atlas), lengths(expected), rtol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_seed_does_not_matter(seed):
    atlas = map_of(SAME["CRCR"], settings=FEW, seed=seed)
    assert counts(atlas) == (2, [Kind.BIFURCATION] * 2, [], 0)
    assert np.allclose(lengths(atlas), [12.861517, 20.497342], atol=1e-5)


# A body that a spherical joint and one more joint hold on the frame, along z.
@pytest.mark.parametrize("kind", ["revolute", "spherical"])
def test_a_body_on_a_line_through_two_joints_turns_about_it(kind):
    of_kind = {"direction": Z} if kind == "revolute" else {}
    joints = (
        Joint("a", "spherical", ("frame", "s"), (0, 0, 0)),
        Joint("b", kind, ("s", "frame"), (0, 0, 1), **of_kind),
    )
    mechanism = Mechanism(joints)
    atlas = map_of(mechanism, settings=FEW)
    assert counts(atlas) == (1, [], [], 0)
    sample = atlas.forms[0].branch.sample(3)
    assert set(Readout(mechanism).variables(sample[1])) >= {"a", "b"}


@pytest.mark.parametrize("limits", [((0.0, 1.0),), ((-1.0, 0.0),)])
def test_a_leg_between_two_fixed_points_is_rigid_with_its_slide_at_a_limit(limits):
    joints = (
        Joint("a", "spherical", ("frame", "x"), (0, 0, 0)),
        Joint("b", "prismatic", ("x", "y"), direction=Z, limits=limits),
        Joint("c", "spherical", ("y", "frame"), (0, 0, 1)),
    )
    atlas = map_of(Mechanism(joints), settings=FEW)
    assert counts(atlas) == (0, [], [], 1)


def test_a_form_that_ends_at_limits_makes_no_turns():
    first = replace(slider_crank(2.0).joints[0], limits=((-3.0, 3.2),))
    mechanism = Mechanism((first, *slider_crank(2.0).joints[1:]))
    atlas = map_of(mechanism, settings=FEW)
    readout = Readout(mechanism)
    for index, form in enumerate(atlas.forms):
        assert not form.branch.closed
        ranges = form_facts(atlas, index, readout).ranges
        assert [one.turns for one in ranges] == [0] * len(ranges)


@pytest.mark.parametrize("beyond", [1e-2, 1e-6, -1e-6])
def test_a_slide_that_passes_its_limit_for_a_moment_ends_the_form(beyond):
    # crank 1 and rod 2: the slide goes from 1 to 3
    joints = slider_crank(2.0).joints
    begin = joints[2].point[0]
    last = replace(joints[3], limits=((0.5 - begin, 3.0 - beyond - begin),))
    atlas = map_of(Mechanism((*joints[:3], last)), settings=FEW)
    for form in atlas.forms:
        assert form.branch.closed == (beyond < 0)


# With slides at all four axes of a Bennett linkage the flat states of its turns let all
# slides move in two ways: planes on which F' has rank 5.
@pytest.mark.parametrize("seed", [0, 8])
def test_pure_slides_of_four_cylindrical_joints_are_a_surface(seed):
    mechanism = mechanism_of_case(cases()["Bennett geometry with joints CCCC"])
    settings = SearchSettings(starts=60, charts=0)
    atlas = map_of(mechanism, settings=settings, seed=seed)
    assert counts(atlas) == (0, [], [2], 0)
    notes = [surface.note for surface in atlas.surfaces]
    # the axes alone are a spherical four-bar with equal opposite sides, of two motions
    assert sorted(notes) == ["F' has a lower rank all over it", APART, APART]


def chains_of_sarrus(links):
    """A plate on chains of three parallel turns, each with two links (k, 2), whose axes
    point all ways in a plane."""
    height = 0.9
    joints = []
    for k, (low, up) in enumerate(links):
        angle = 2.0 + 2.0 * np.pi * k / len(links) + 0.1 * k
        outwards = np.array([np.cos(angle), np.sin(angle), 0.0])
        across = (-np.sin(angle), np.cos(angle), 0.0)
        rise = (low**2 - up**2 + height**2) / (2 * height)
        foot = outwards
        knee = foot + np.sqrt(low**2 - rise**2) * outwards + np.array([0.0, 0.0, rise])
        head = foot + np.array([0.0, 0.0, height])
        bodies = ("base", f"low{k}", f"up{k}", "plate")
        for letter, point, pair in zip(
            "abc", (foot, knee, head), pairwise(bodies), strict=True
        ):
            name = f"{letter}{k}"
            joints.append(Joint(name, "revolute", pair, tuple(point), across))
    return Mechanism(tuple(joints), f"Sarrus linkage of {len(links)} chains")


# Sarrus 1853: the plate stands between the heights at which a chain is straight or
# folded. The chains that are so at neither go on with their knees to one side: a form
# for each choice, above the base and below.
@pytest.mark.parametrize(
    ("links", "forms"),
    [
        ([(0.9, 0.6), (1.1, 0.5)], 2),  # straight the first, folded the second
        ([(0.9, 0.6), (1.1, 0.5), (1.0, 0.7)], 4),
        ([(0.9, 0.6), (1.1, 0.5), (1.0, 0.7), (1.2, 0.8)], 8),
        ([(0.9, 0.4), (1.0, 0.8)], 4),  # the first one both
    ],
)
def test_sarrus_linkages_of_two_three_and_four_chains(links, forms):
    mechanism = chains_of_sarrus(links)
    atlas = map_of(mechanism, settings=FEW)
    assert counts(atlas) == (forms, [], [], 0)
    assert all(form.branch.closed for form in atlas.forms)
    plate = mechanism.bodies.index("plate")
    highest = min(low + up for low, up in links)
    lowest = max(abs(low - up) for low, up in links)
    readout = Readout(mechanism)
    for form in atlas.forms:
        poses = readout.poses(form.branch.sample(400))[:, plate]
        # it moves straight up and down
        assert np.abs(poses[:, :3, :3] - np.eye(3)).max() < 1e-11
        heights = np.abs(poses[:, 2, 3] + 0.9)
        assert heights.max() == pytest.approx(highest, abs=1e-3)
        assert heights.min() == pytest.approx(lowest, abs=1e-3)


def planar_platform(base, top, pose):
    """A triangle on three legs that slide and are locked: points (3, 2) of the base, and
    of the triangle in its own frame, which stands at ``pose`` (x, y, angle)."""
    x, y, angle = pose
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    joints = []
    for k in range(3):
        foot = np.append(base[k], 0.0)
        head = np.append(turn @ top[k] + (x, y), 0.0)
        along = tuple(head - foot)
        pairs = (("base", f"low{k}"), (f"low{k}", f"up{k}"), (f"up{k}", "plate"))
        joints += [
            Joint(f"A{k}", "revolute", pairs[0], tuple(foot), Z),
            Joint(f"P{k}", "prismatic", pairs[1], direction=along, locked=(0.0,)),
            Joint(f"B{k}", "revolute", pairs[2], tuple(head), Z),
        ]
    return Mechanism(tuple(joints), "3-RPR")


def poses_of_platform(base, top, lengths):
    """How many poses of the triangle have legs of these ``lengths``: those of a sextic
    (Gosselin and Merlet 1994). Two circles less the first one are lines in x and y, and
    where these meet has to lie on the first circle."""
    angles = np.linspace(-np.pi, np.pi, 40_001)
    cos, sin = np.cos(angles), np.sin(angles)
    turned = (
        np.array([cos * p - sin * q for p, q in top]),
        np.array([sin * p + cos * q for p, q in top]),
    )
    # (x + a_k)^2 + (y + b_k)^2 = lengths_k^2
    a = turned[0] - base[:, :1]
    b = turned[1] - base[:, 1:]
    rest = (lengths**2)[:, None] - a**2 - b**2
    rows = [(2 * (a[k] - a[0]), 2 * (b[k] - b[0]), rest[k] - rest[0]) for k in (1, 2)]
    (p, q, r), (s, t, u) = rows
    over = p * t - q * s
    x, y = r * t - q * u, p * u - r * s
    missed = (x + a[0] * over) ** 2 + (y + b[0] * over) ** 2 - (lengths[0] * over) ** 2
    return int(np.count_nonzero(np.diff(np.sign(missed))))


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_planar_platform_has_the_assemblies_of_its_sextic(seed):
    rng = np.random.default_rng(seed)
    base = np.array([[0.0, 0.0], [2.5, 0.0], [1.0, 1.8]])
    top = np.array([[0.0, 0.0], [1.7, 0.0], [0.9, 1.5]]) + 0.3 * rng.normal(size=(3, 2))
    pose = np.append(rng.uniform(-0.5, 1.0, 2), rng.uniform(-3.0, 3.0))
    mechanism = planar_platform(base, top, pose)
    turn = np.array(
        [[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]]
    )
    legs = np.linalg.norm(top @ turn.T + pose[:2] - base, axis=1)
    atlas = map_of(mechanism, settings=FEW)
    assert not atlas.forms
    assert len(atlas.rigid) == poses_of_platform(base, top, legs) >= 2


# Wunderlich 1954: twelve bars as the edges of a cube, with 20 forms beside its surfaces,
# each met by few random starts
@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(3))
def test_every_form_of_the_cube_of_bars_is_met(seed):
    mechanism = mechanism_of_case(cases()["Wunderlich linkage, faces PPPPPP"])
    settings = SearchSettings(certify=False)
    atlas = map_of(mechanism, settings=settings, seed=seed)
    assert len(atlas.forms) == 20
    assert {surface.dimension for surface in atlas.surfaces} == {2}


def test_a_slide_alone_moves_along_its_line():
    slide = Joint("A", "prismatic", ("frame", "table"), (0, 0, 0), (0, 0, 1))
    atlas = map_of(Mechanism((slide,)))
    assert [len(atlas.forms), len(atlas.surfaces)] == [1, 0]
