"""Non-real configurations followed from slice to slice, and the bounds that the proof
rests on."""

import numpy as np
import pytest

from bifurc.curves.monitor import dead_points
from linkages import _core
from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.slices.elimination import slice_configurations
from linkages.slices.nonreal_tracking import find_fold, follow_sheets
from linkages.values import GeometryError
from tests.maps import curves_of

FAMILIES = [
    "spherical-four-bar",
    "goldberg-5r",
    "special-double-subtractive-goldberg",
    "dietmaier",
    "bricard-trihedral",
]


def closure(loop, z, at):
    """The closure at ``z`` by its definition: 2 vec of the product of exponentials of
    the screws at ``at``."""
    screws = _core.screws_and_error(loop.link_geometry, at)[0].T
    total = [np.array([1, 0, 0, 0], dtype=complex), np.zeros(4, dtype=complex)]
    for i in range(loop.n):
        c, s = np.cos((z - at)[i] / 2), np.sin((z - at)[i] / 2)
        real = np.array([c, *(s * screws[:3, i])])
        dual = np.array([0, *(s * screws[3:, i])])
        total = [
            quaternion(total[0], real),
            quaternion(total[0], dual) + quaternion(total[1], real),
        ]
    return 2 * np.concatenate([total[0][1:], total[1][1:]])


def quaternion(p, q):
    scalar = p[0] * q[0] - p[1:] @ q[1:]
    return np.array([scalar, *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def non_real(name, joint=1):
    loop = entry(name).build()
    cut = slice_configurations(loop, joint + 1, np.linspace(0.1, 6.2, 12))
    return loop, cut.nonreal


@pytest.mark.parametrize("name", FAMILIES)
def test_configurations_that_are_not_real_close_and_come_in_conjugate_pairs(name):
    loop, found = non_real(name)
    for z in found:
        _, error = _core.screws_and_error(loop.link_geometry, z)
        assert np.abs(error).max() < 1e-12 * np.exp(np.abs(z.imag).sum())
        assert (
            np.abs(np.exp(1j * found.conj()) - np.exp(1j * z)).max(axis=1).min() < 1e-6
        )


@pytest.mark.parametrize("name", FAMILIES)
def test_second_derivatives_agree_with_differences_of_the_product_of_exponentials(name):
    loop, found = non_real(name)
    rng = np.random.default_rng(0)
    real = slice_configurations(loop, 1, np.array([0.7])).configurations.astype(complex)
    for at in np.concatenate([found[:3], real[:1]]):
        screws = _core.screws_and_error(loop.link_geometry, at)[0].T
        along = rng.normal(size=loop.n) + 1j * rng.normal(size=loop.n)
        inverse = np.linalg.pinv(np.concatenate([screws, along[None]]))
        second = _core.ball_around(loop.link_geometry, at, along)[-1]
        d, h = rng.normal(size=loop.n), 1e-4
        difference = (
            closure(loop, at + h * d, at)
            - 2 * closure(loop, at, at)
            + closure(loop, at - h * d, at)
        ) / h**2
        expected = inverse[:, :6] @ difference
        np.testing.assert_allclose(
            second @ d @ d, expected, atol=1e-5 * np.abs(expected).max()
        )
        slope = (closure(loop, at + h * d, at) - closure(loop, at - h * d, at)) / (
            2 * h
        )
        np.testing.assert_allclose(
            screws @ d, slope, atol=1e-5 * np.abs(screws).max() ** 3
        )


@pytest.mark.parametrize("name", FAMILIES)
def test_nowhere_in_the_ball_does_the_map_stray_from_its_tangent_by_more_than_the_bound(
    name,
):
    loop, found = non_real(name)
    rng = np.random.default_rng(1)
    for at in found[:6]:
        along = np.eye(loop.n)[1]
        weight, radius, bound, _ = _core.ball_around(loop.link_geometry, at, along)
        assert bound * radius <= 0.5
        screws = _core.screws_and_error(loop.link_geometry, at)[0].T
        p = np.linalg.pinv(np.concatenate([screws, along[None]]))[:, :6]
        for _ in range(40):
            d = rng.normal(size=loop.n) + 1j * rng.normal(size=loop.n)
            d *= radius * weight / np.linalg.norm(d)
            strayed = p @ (closure(loop, at + d, at) - screws @ d)
            assert np.linalg.norm(strayed / weight) <= 0.5 * bound * radius**2 * (
                1 + 1e-9
            )


@pytest.mark.parametrize(
    ("name", "joint", "angle"),
    [
        ("special-double-subtractive-goldberg", 2, 2.0),
        ("dietmaier", 2, 2.0),
        ("bricard-plane-symmetric", 0, 2.0),
    ],
)
def test_followed_sheets_arrive_where_elimination_finds_them(name, joint, angle):
    loop, angles = entry(name).build(), np.array([angle, angle + 0.04])
    cut = slice_configurations(loop, joint + 1, angles)
    starts, goals = (cut.nonreal[cut.nonreal_index == i] for i in (0, 1))
    assert len(starts) == len(goals) > 0
    cleared, last = follow_sheets(
        loop, joint, starts, np.full(len(starts), angles[1]), [[]] * len(starts)
    )
    assert cleared.all()
    apart = np.abs(np.exp(1j * last[:, None]) - np.exp(1j * goals)).max(axis=2)
    assert np.sort(apart.argmin(axis=1)).tolist() == list(range(len(goals)))
    assert apart.min(axis=1).max() < 1e-9


def test_a_sheet_that_becomes_real_halts_there_and_only_a_known_fold_lets_it_pass():
    # crank 1, coupler 2, rocker 2.5, frame 3: the rocker of the motion that is found
    # swings between dead points
    loop = entry("four-bar").build(a=1.0, b=2.0, c=2.5, d=3.0)
    branch = curves_of(loop).forms[0].branch
    joint = next(j for j, dead in enumerate(dead_points(branch)) if len(dead))
    turned = branch(dead_points(branch)[joint])
    fold = find_fold(loop, joint, turned[0])
    assert fold is not None
    angle = turned[0, joint]
    sides = [
        len(slice_configurations(loop, joint + 1, np.array([angle + step])).nonreal)
        for step in (-0.05, 0.05)
    ]
    outside = -1 if sides[0] else 1
    start = slice_configurations(
        loop, joint + 1, np.array([angle + 0.05 * outside])
    ).nonreal[:1]
    start[:, joint] = angle + 0.05 * outside
    goal = np.array([angle - 0.05 * outside])
    halted, last = follow_sheets(loop, joint, start, goal, [[]])
    assert not halted[0]
    assert (
        np.abs(
            last[0]
            - np.round((last[0].real - turned[0]) / (2 * np.pi)) * 2 * np.pi
            - turned[0]
        ).max()
        < 1e-3
    )
    assert follow_sheets(loop, joint, start, goal, [[fold]])[0].all()


def test_within_the_neighbourhood_of_a_fold_every_angle_has_one_pair():
    loop = entry("special-double-subtractive-goldberg").build()
    checked = 0
    for form in curves_of(loop).forms:
        for joint, dead in enumerate(dead_points(form.branch)):
            for turned in form.branch(dead):
                fold = find_fold(loop, joint, turned)
                if fold is None:
                    continue
                angles = turned[joint] + fold.across * np.array([-0.9, -0.3, 0.3, 0.9])
                cut = slice_configurations(loop, joint + 1, angles)
                everything = np.concatenate([cut.configurations, cut.nonreal])
                index = np.concatenate([cut.index, cut.nonreal_index])
                apart = everything - turned
                apart = apart - 2 * np.pi * np.round(apart.real / (2 * np.pi))
                near = np.linalg.norm(apart / fold.weight, axis=1) < fold.away
                assert np.bincount(index[near], minlength=4).tolist() == [2, 2, 2, 2]
                checked += 1
    assert checked > 8


def test_following_stops_when_the_time_is_over():
    loop, found = non_real("dietmaier")
    cleared, last = follow_sheets(
        loop, 1, found, found[:, 1].real + 0.2, [[]] * len(found), seconds=1e-9
    )
    assert not cleared.any()
    np.testing.assert_array_equal(last, found)


def test_a_step_along_the_curve_leads_to_where_steps_in_the_angle_do():
    loop, found = non_real("special-double-subtractive-goldberg", joint=3)
    joint = 3
    assert len(found)
    for start in found[:6]:
        end = start[joint].real + 0.3
        is_moved, along = _core.advance_along(loop.link_geometry, joint, start, end)
        assert is_moved
        reached = along[joint].real
        assert start[joint].real < reached <= end
        cleared, last = follow_sheets(
            loop, joint, start[None], np.array([reached]), [[]]
        )
        assert cleared[0]
        assert np.abs(last[0] - along).max() < 1e-9


def test_a_loop_or_a_joint_that_cannot_be_followed_is_refused():
    long = Loop((1.0,) * 7, (1.0,) * 7, (0.0,) * 7)
    with pytest.raises(GeometryError, match="number of joints of a followed loop: 7"):
        find_fold(long, 0, np.zeros(7))
    bennett = entry("bennett").build()
    for joint in (-1, 4):
        with pytest.raises(GeometryError, match=f"joint: {joint}"):
            follow_sheets(bennett, joint, np.empty((0, 4)), np.empty(0), [])
    with pytest.raises(ValueError, match="configuration: 3"):
        find_fold(bennett, 0, np.zeros(3))
