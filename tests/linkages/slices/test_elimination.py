"""Slices against starts at random, closed forms, and the properties that any complete
list must have."""

import _thread
import signal
import threading

import numpy as np
import pytest

from linkages.axes import loop_from_axes
from linkages.loop import Loop
from linkages.slices.elimination import slice_configurations
from linkages.values import GeometryError
from tests.samples import one_in

DEGREE = np.pi / 180


def bennett(alpha=0.9, beta=1.3):
    return Loop((np.sin(alpha), np.sin(beta)) * 2, (alpha, beta) * 2, (0,) * 4)


# thesis of the catalogue, eq. 5.2.34 with b = 1.0572
DSG_LENGTHS = (0.7006862351794543, 0.8632179900134446, 1.057221806161922)
DSG = Loop(
    (*DSG_LENGTHS, DSG_LENGTHS[0], DSG_LENGTHS[2], DSG_LENGTHS[1]),
    np.array([110.80732278025233, 45, 60, 110.80732278025233, 60, 45]) * DEGREE,
    (0,) * 6,
    "special double-subtractive Goldberg 6R",
)
DSG_FORMS = np.array(
    [
        [
            -1.370502168810,
            1.590323240898,
            1.007011074849,
            1.551269412690,
            -1.771090484778,
            -1.007011074849,
        ],
        [
            -1.090293433401,
            2.596676221562,
            1.456603570217,
            -0.798905611299,
            2.888064043664,
            1.456603570217,
        ],
        [
            2.630223952232,
            -1.032173240761,
            1.383698921515,
            2.901155374489,
            -0.761241818504,
            1.383698921515,
        ],
        [
            -1.636469749097,
            1.325455779904,
            -3.141592653589,
            -1.505122904492,
            1.816136873685,
            -3.141592653589,
        ],
    ]
)
WOHLHART = Loop(
    (1.0,) * 6, (np.pi / 2, -np.pi / 2) * 3, (0,) * 6, "sixfold, right angles"
)


def trihedral():
    # alternating squares sum to 0
    last = np.sqrt(1.0 - 0.64 + 1.21 - 0.49 + 0.25)
    lengths = (1.0, 0.8, 1.1, 0.7, 0.5, last)
    return Loop(lengths, (np.pi / 2, -np.pi / 2) * 3, (0,) * 6, "Bricard trihedral")


def octahedral(twists=(0.7, 1.1, 1.4), offsets=(1.0, 0.6, -1.3)):
    return Loop((0,) * 6, twists * 2, offsets * 2, "line-symmetric octahedral Bricard")


def line_symmetric():
    return Loop(
        (0.8, 1.1, 0.5) * 2,
        (1.0, 0.6, 1.3) * 2,
        (0.3, -0.2, 0.4) * 2,
        "line-symmetric Bricard",
    )


def planar(*lengths):
    return Loop(lengths, (0,) * len(lengths), (0,) * len(lengths))


SIX = [DSG, trihedral(), octahedral(), line_symmetric(), WOHLHART]
FOUR = [
    bennett(),
    planar(1, 2.5, 2, 2.2),
    planar(1, 2, 1, 2),
    planar(1, 1, 1, 1),
    planar(1, 1, 2, 2),
    Loop((0,) * 4, (0.7, 1.1, 1.3, 1.0), (0,) * 4),
]


def distance(p, q):
    return np.abs((np.asarray(p) - q + np.pi) % (2 * np.pi) - np.pi).max(axis=-1)


def closure(loop, theta):
    gap = loop.frames(theta)[..., -1, :, :] - np.eye(4)
    gap[..., :3, 3] /= loop.characteristic_length
    return np.abs(gap).max(axis=(-1, -2))


def found_from_random_starts(loop, joint, angle, rng, starts=150):
    """Distinct configurations with the joint at ``angle`` that damped Gauss-Newton
    reaches."""
    theta = rng.uniform(-np.pi, np.pi, (starts, loop.n))
    theta[:, joint - 1] = angle
    free = np.delete(np.arange(loop.n), joint - 1)
    for _ in range(80):
        end = loop.frames(theta)[:, -1]
        rotation = end[:, :3, :3]
        skew = (rotation - np.swapaxes(rotation, 1, 2))[:, (2, 0, 1), (1, 2, 0)]
        cosine = np.sqrt(np.maximum(1 + np.trace(rotation, axis1=1, axis2=2), 0.04))
        error = np.concatenate([skew / cosine[:, None], end[:, :3, 3]], axis=1)
        screws = loop.joint_screws(theta)[:, :, free]
        screws[:, 3:] += np.cross(screws[:, :3], end[:, :3, 3, None], axis=1)
        normal = np.swapaxes(screws, 1, 2) @ screws
        damping = 1e-14 + 1e-2 * np.minimum(1, np.sum(error**2, axis=1))
        normal += damping[:, None, None] * np.eye(loop.n - 1)
        theta[:, free] -= np.linalg.solve(
            normal, np.swapaxes(screws, 1, 2) @ error[..., None]
        )[..., 0]
    distinct: list[np.ndarray] = []
    for t in theta[closure(loop, theta) < 1e-10]:
        if not distinct or distance(distinct, t).min() > 1e-4:
            distinct.append(t)
    return distinct


@pytest.mark.parametrize("loop", one_in(2, SIX, lambda loop: loop.name))
def test_random_starts_find_nothing_that_the_slice_of_a_6r_loop_lacks(loop):
    rng = np.random.default_rng(1)
    reached = 0
    for joint in range(1, 7):
        result = slice_configurations(loop, joint, rng.uniform(-np.pi, np.pi, 2))
        assert result.is_complete
        for i, angle in enumerate(result.angles):
            for theta in found_from_random_starts(loop, joint, angle, rng):
                reached += 1
                assert distance(result.at(i), theta).min() < 1e-5
    assert reached >= 4


@pytest.mark.parametrize("loop", FOUR)
def test_random_starts_find_nothing_that_the_slice_of_a_4r_loop_lacks(loop):
    rng = np.random.default_rng(2)
    for joint in range(1, 5):
        result = slice_configurations(loop, joint, rng.uniform(-np.pi, np.pi, 3))
        assert result.is_complete
        for i, angle in enumerate(result.angles):
            reached = found_from_random_starts(loop, joint, angle, rng, 40)
            assert len(reached) == len(result.at(i))
            for theta in reached:
                assert distance(result.at(i), theta).min() < 1e-5


@pytest.mark.parametrize("loop", SIX + FOUR)
def test_every_configuration_closes_and_has_the_angle_of_its_slice(loop):
    angles = np.linspace(-3.0, 3.1, 40)
    for joint in range(1, loop.n + 1):
        result = slice_configurations(loop, joint, angles)
        assert np.all(closure(loop, result.configurations) < 1e-12)
        # both are rounding of another order of the same products
        np.testing.assert_allclose(
            closure(loop, result.configurations), result.closure, atol=1e-14
        )
        np.testing.assert_array_equal(
            result.configurations[:, joint - 1], angles[result.index]
        )
        assert np.all(result.configurations > -np.pi)
        assert np.all(result.configurations <= np.pi)


@pytest.mark.parametrize("n", [4, 5, 6])
def test_a_rigid_loop_closed_at_a_random_configuration_gives_that_one_back(n):
    rng = np.random.default_rng(n)
    for _ in range(20):
        points, directions = rng.uniform(-1, 1, (n, 3)), rng.normal(size=(n, 3))
        loop, theta = loop_from_axes(points, directions)
        for joint in range(1, n + 1):
            result = slice_configurations(loop, joint, theta[joint - 1])
            assert len(result.configurations) == result.n_complex[0] == 1
            assert distance(result.configurations[0], theta) < 1e-9


def test_a_random_6r_loop_has_no_configuration():
    rng = np.random.default_rng(3)
    for _ in range(10):
        lengths, twists = rng.uniform(0.2, 2, 6), rng.uniform(-3, 3, 6)
        loop = Loop(lengths, twists, rng.uniform(-1, 1, 6))
        result = slice_configurations(loop, 2, rng.uniform(-3, 3, 10))
        assert result.is_complete
        assert len(result.configurations) == 0
        assert not np.any(result.n_complex)


def test_all_four_forms_of_the_special_double_subtractive_goldberg_are_in_every_slice_of_joint_one():
    result = slice_configurations(DSG, 1, np.linspace(-3, 3, 50))
    np.testing.assert_array_equal(np.bincount(result.index), 4)
    np.testing.assert_array_equal(result.n_complex, 4)


@pytest.mark.parametrize("joint", [1, 2, 4, 5])
def test_a_known_configuration_is_in_its_slice(joint):
    result = slice_configurations(DSG, joint, DSG_FORMS[:, joint - 1])
    for i, theta in enumerate(DSG_FORMS):
        assert distance(result.at(i), theta).min() < 1e-11


def test_a_slice_with_a_whole_motion_in_it_says_so():
    # joints 3 and 6 rest in its Bennett form
    result = slice_configurations(DSG, 3, [1.0, np.pi])
    np.testing.assert_array_equal(result.degenerate, [False, True])
    np.testing.assert_array_equal(result.n_complex, [4, -1])
    assert "whole motion" in result.reason
    assert np.sum(distance(result.at(1)[:, [2, 5]], [np.pi, np.pi]) < 1e-9) > 8


def test_the_folded_rhombus_turns_about_two_axes_in_one_line():
    result = slice_configurations(planar(1, 1, 1, 1), 1, [0.5, np.pi])
    np.testing.assert_array_equal(result.degenerate, [False, True])


@pytest.mark.parametrize(
    "loop", [planar(1, 1.2, 1.1, 0.9, 1.3), planar(1, 1.2, 1.1, 0.9, 1.3, 1.0)]
)
def test_a_planar_chain_of_mobility_two_or_more_is_never_called_complete(loop):
    result = slice_configurations(loop, 1, [0.3, 1.0])
    assert np.all(result.degenerate)
    assert "singular" in result.reason
    assert len(result.configurations) > 10


def test_a_tangential_slice_gives_the_dead_point_once():
    # the input angle of a rocker with its other links in line
    reach = np.arccos((1 + 4 - 1.5**2) / 4)
    loop = planar(1, 2, 0.7, 0.8)
    inner = np.pi - reach
    result = slice_configurations(loop, 2, [inner + 1e-3, inner, inner - 1e-3])
    assert [len(result.at(i)) for i in range(3)] == [2, 1, 0]


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_the_unit_of_length_does_not_matter(factor):
    loop, angles = line_symmetric(), np.linspace(-3, 3, 20)
    for joint in (1, 3):
        a = slice_configurations(loop, joint, angles)
        b = slice_configurations(loop.scaled(factor), joint, angles)
        np.testing.assert_array_equal(a.index, b.index)
        for i in range(len(angles)):
            assert all(distance(b.at(i), theta).min() < 1e-9 for theta in a.at(i))


@pytest.mark.parametrize(
    "loop", [DSG, trihedral(), line_symmetric()], ids=lambda loop: loop.name
)
def test_relabelled_reversed_and_mirrored_loops_have_the_same_slices(loop):
    angles = np.linspace(-2.9, 3, 9)
    original = slice_configurations(loop, 2, angles)
    for other, joint, back in (
        (loop.relabelled(1), 1, lambda q: np.roll(q, 1, axis=-1)),
        (loop.reversed(), 5, lambda q: q[:, ::-1]),
        (loop.mirrored(), 2, lambda q: q),
    ):
        result = slice_configurations(other, joint, angles)
        np.testing.assert_array_equal(result.index, original.index)
        np.testing.assert_array_equal(result.n_complex, original.n_complex)
        for i in range(len(angles)):
            for configuration in back(result.at(i)):
                assert distance(original.at(i), configuration).min() < 1e-9


def test_complex_configurations_complete_the_count_of_the_real_ones():
    result = slice_configurations(octahedral(), 1, np.linspace(-3, 3, 60))
    real = np.bincount(result.index, minlength=60)
    assert np.all(real <= result.n_complex)
    assert np.all((result.n_complex - real) % 2 == 0)  # they come in conjugate pairs
    assert len(set(result.n_complex)) == 1


def test_wrong_use_raises_with_the_name_of_the_thing():
    with pytest.raises(GeometryError, match="joint"):
        slice_configurations(DSG, 7, [0.0])
    with pytest.raises(GeometryError, match="angles"):
        slice_configurations(DSG, 1, [np.nan])
    with pytest.raises(GeometryError, match="number of joints"):
        slice_configurations(planar(1, 1, 1, 1, 1, 1, 1), 1, [0.0])


def test_no_angles_give_no_configurations():
    result = slice_configurations(DSG, 1, [])
    assert result.configurations.shape == (0, 6)
    assert result.is_complete


def test_ctrl_c_gets_through_many_slices():
    # a process that was started in the background ignores the signal
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.1, _thread.interrupt_main)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            slice_configurations(DSG, 1, np.linspace(-3, 3, 500_000))
        timer.join()
    finally:
        signal.signal(signal.SIGINT, handler)
