"""All isolated assemblies of a loop."""

import numpy as np
import pytest

from bifurc.limits import Deadline
from linkages import _core
from linkages.axes import loop_from_axes
from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.slices import assemblies
from linkages.slices.assemblies import (
    GenericLoop,
    PathEnd,
    follow_paths,
    isolated_assemblies,
)
from linkages.values import GeometryError

# The 6R of the CUIK suite (Porta, Ros and Thomas; `Serial6R.world`) with 16 real
# assemblies.
RIGHT = np.pi / 2
SIXTEEN = Loop(
    (0.3, 1, 0, 1.5, 0, 1.1353),
    (RIGHT, 0.0175, RIGHT, 0.0175, RIGHT, 1.4716),
    (0.1049, 0.0106, 0, 0.2, 0, 0),
)


def gap(one, other):
    turned = one - other
    return np.abs(turned - 2 * np.pi * np.round(turned.real / (2 * np.pi))).max()


def closure(loop, configurations):
    return np.abs(loop.frames(configurations)[:, -1] - np.eye(4)).max(initial=0.0)


def test_the_6r_with_sixteen_real_assemblies_has_sixteen():
    found = isolated_assemblies(SIXTEEN)
    assert found.complete
    assert len(found.configurations) == 16
    assert closure(SIXTEEN, found.configurations) < 1e-12


@pytest.mark.parametrize("n", (4, 5, 6))
def test_a_loop_from_axes_has_the_assembly_in_which_the_axes_were_given(n):
    rng = np.random.default_rng(n)
    for _ in range(5):
        axes = rng.normal(size=(2, n, 3))
        loop, theta = loop_from_axes(*axes)
        found = isolated_assemblies(loop)
        assert found.complete
        assert closure(loop, found.configurations) < 1e-9
        assert min(gap(theta, other) for other in found.configurations) < 1e-8


@pytest.mark.parametrize("n", (4, 5))
def test_axes_that_meet_one_line_at_right_angles_are_an_assembly(n):
    """All of them leave a force and a moment along the line alone."""
    rng = np.random.default_rng(n)
    points = rng.normal(size=(n, 1)) * [1.0, 0.0, 0.0]
    angles = rng.uniform(0.0, np.pi, n)
    directions = np.stack([0.0 * angles, np.cos(angles), np.sin(angles)], axis=1)
    loop, theta = loop_from_axes(points, directions)
    has_full_rank = n == 4
    found = isolated_assemblies(loop)
    assert found.complete
    gaps = [gap(theta, other) for other in found.configurations]
    assert (min(gaps, default=np.inf) < 1e-8) == has_full_rank


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("yu-baker-two-ratios", 6),  # beside a motion
        ("bricard-octahedral-plane-symmetric", 4),
        ("special-double-subtractive-goldberg", 0),
        ("bennett", 0),
    ],
)
def test_motions_do_not_hide_isolated_assemblies(name, count):
    found = isolated_assemblies(entry(name).build())
    assert found.complete
    assert len(found.configurations) == count


def test_two_assemblies_that_nearly_coincide_are_told_apart():
    rng = np.random.default_rng(0)
    for _ in range(32):  # of the last the smallest singular value is 3.6e-4
        loop, theta = loop_from_axes(rng.normal(size=(4, 3)), rng.normal(size=(4, 3)))
    found = isolated_assemblies(loop)
    assert found.complete
    assert min(gap(theta, other) for other in found.configurations) < 1e-8


def test_the_generic_loop_closes_in_sixteen_configurations():
    loop = assemblies._generic_loop(0)
    assert loop.configurations.shape == (16, 6)
    one_another = [
        gap(a, b)
        for i, a in enumerate(loop.configurations)
        for b in loop.configurations[:i]
    ]
    assert min(one_another) > 1e-3
    again = follow_paths(loop, loop.table)
    assert np.all(again.ends == PathEnd.ARRIVED)
    assert max(map(gap, again.angles, loop.configurations)) < 1e-10


def test_one_configuration_leads_to_all_sixteen_by_going_round_in_the_geometries():
    loop = assemblies._generic_loop(0)
    rng = np.random.default_rng(0)
    found = loop.configurations[:1]
    for _ in range(14):
        stops = [loop.table + _random_table(rng) for _ in range(2)]
        moved = GenericLoop(loop.table, found)
        for table in (*stops, loop.table):
            paths = follow_paths(moved, table)
            moved = GenericLoop(table, paths.angles[paths.ends == PathEnd.ARRIVED])
        for configuration in moved.configurations:
            if min(gap(configuration, other) for other in found) > 1e-6:
                found = np.vstack([found, configuration])
    assert len(found) == 16
    for configuration in found:
        assert min(gap(configuration, other) for other in loop.configurations) < 1e-6


def _random_table(rng):
    table = rng.normal(size=(3, 6)) + 1j * rng.normal(size=(3, 6))
    return table * np.array([[1.0], [0.5], [1.0]])


def test_a_loop_of_seven_joints_is_refused():
    with pytest.raises(GeometryError, match="number of joints: 7"):
        isolated_assemblies(Loop((1,) * 7, (1,) * 7, (0,) * 7))


def test_no_path_is_begun_after_the_time_is_over():
    found = isolated_assemblies(SIXTEEN, seconds=0.0)
    assert not found.complete
    assert not len(found.configurations)
    assert "16 stopped on the way" in found.statement


def test_paths_far_from_real_configurations_are_followed_by_quaternions():
    # three of its paths end at angles with imaginary parts of 4 to 9
    table = assemblies._with_six_joints(entry("yu-baker").build()).table
    paths = follow_paths(assemblies._generic_loop(0), table)
    ends = assemblies._Ends.of(paths, table)
    far = ends.regular[np.abs(ends.regular.imag).max(axis=1) > 4]
    assert len(far) == 4
    errors = _core.quaternion_closure(far, table.astype(complex))
    assert np.abs(errors).max() < 1e-9


def test_smallest_singular_values_of_complex_configurations_are_those_of_lapack():
    rng = np.random.default_rng(0)
    loop = Loop(rng.uniform(0.5, 1.5, 6), rng.uniform(0.5, 2.5, 6), rng.normal(size=6))
    table = assemblies._with_six_joints(loop).table.astype(complex)
    angles = follow_paths(assemblies._generic_loop(0), table).angles
    assert np.count_nonzero(np.abs(angles.imag).max(axis=1) > 0.1) > 8
    values = _core.smallest_singular_values(angles, table)
    for configuration, value in zip(angles, values, strict=True):
        screws, _ = _core.screws_and_error(loop.link_geometry, configuration)
        expected = np.linalg.svd(screws, compute_uv=False)
        assert abs(value - expected[-1]) < 1e-9 * expected[0]


def ends_at(regular, singular=0, nearly_singular=0, far_out=0, at_infinity=0):
    return assemblies._Ends(
        regular=regular,
        singular=singular,
        nearly_singular=nearly_singular,
        far_out=far_out,
        at_infinity=at_infinity,
        distant=0,
        lost=0,
    )


def test_a_path_that_goes_over_to_another_one_is_noticed():
    one, other = 0.3 + 0.1j, 0.5 - 0.2j
    pair = np.array([[one] * 6, [np.conj(one)] * 6])
    alone = np.array([[one] * 6, [other] * 6])
    twice = np.array([[one] * 6, [one] * 6])
    for regular, complete in ((pair, True), (alone, False), (twice, False)):
        ends = ends_at(regular, singular=14)
        assert ends.are_complete is complete


def test_an_odd_number_of_paths_to_infinity_leaves_the_assemblies_incomplete():
    # these paths go in conjugate pairs: one of an odd number has passed far away, and
    # would have come back
    angles = np.arange(1.0, 16.0)[:, None] * np.ones(6)
    assert ends_at(angles[:14] + 0j, at_infinity=2).are_complete
    assert not ends_at(angles + 0j, at_infinity=1).are_complete
    # the partner of one may be among those that end far out
    partner = ends_at(angles[:14] + 0j, at_infinity=1, singular=1, far_out=1)
    assert partner.are_complete


@pytest.mark.parametrize(
    ("short", "nearly_singular"), [(1e-5, 0), (1e-6, 2), (1e-7, 0)]
)
def test_ends_near_a_lower_rank_are_counted_and_leave_nothing_complete(
    short, nearly_singular
):
    # a Bennett linkage with one pair of links ``short``: the smallest singular value at
    # two of the ends is 0.4 times that
    twist = np.arcsin(short * np.sin(1.0))
    loop = Loop((1.0, short, 1.0, short), (1.0, twist, 1.0, twist), (0.0,) * 4)
    table = assemblies._with_six_joints(loop).table
    start = assemblies._generic_loop(0)
    paths = follow_paths(start, table)
    paths = assemblies._followed_on(paths, start, table, Deadline(np.inf))
    ends = assemblies._Ends.of(paths, table)
    assert ends.nearly_singular == nearly_singular
    assert ends.are_complete is (nearly_singular == 0)
    is_said = "where the rank is nearly low" in ends.statement(0)
    assert is_said is (nearly_singular > 0)


def test_a_path_that_passes_far_away_is_followed_again():
    lengths = (
        0.4652716524564463,
        0.9543936003333449,
        0.896826645459966,
        1.2455789699127817,
        0.5438285249870578,
        0.8736610827301063,
    )
    twists = (
        -2.513026474816172,
        0.5179732958118803,
        -0.9071647710994144,
        2.975443373410161,
        0.7225002386592525,
        1.334345830914014,
    )
    offsets = (
        0.19134519953158186,
        -0.08873116118146607,
        0.08868904588572446,
        0.09044329037367027,
        -0.25864022451848767,
        -0.25456799673336755,
    )
    counts = []
    for shift in range(6):
        columns = [row[shift:] + row[:shift] for row in (lengths, twists, offsets)]
        found = isolated_assemblies(Loop(*columns))
        assert found.complete
        counts.append(len(found.configurations))
    assert counts == [4] * 6


def test_two_assemblies_of_the_longer_loop_may_nearly_coincide():
    # a 5R with two parallel axes: with its last link cut, two of the 16 configurations
    # have a singular value of 1e-5
    loop = Loop(
        lengths=(
            0.003658668677516869,
            0.0017027847079167649,
            0.0009929134562091336,
            0.0018819322460218906,
            0.0004763679831448735,
        ),
        twists=(
            -1.9594251533023215,
            0.0,
            -0.42516387567863473,
            -0.7447023564946288,
            -1.8934330552438008,
        ),
        offsets=(
            -0.0022166005291136192,
            0.0,
            -0.0007002015078702471,
            0.0022569195858368105,
            -0.0022946853303091983,
        ),
    )
    known = [-2.77810447, -2.65674538, -1.6581603, 2.88854395, -1.62638396]
    assemblies = isolated_assemblies(loop)
    assert assemblies.complete
    assert assemblies.configurations == pytest.approx(np.array([known]), abs=1e-8)
