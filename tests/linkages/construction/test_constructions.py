"""Construction methods: closure is inherited, and the published linkages come out of
them."""

import itertools

import numpy as np
import pytest

from linkages.construction.conditions import bennett_length
from linkages.construction.constructions import (
    ending_with,
    lock,
    locked_angles,
    share_joint,
    superpose,
)
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.spatial_triangle import Kink, composite_link
from linkages.families.double_goldberg import generalized_double_goldberg
from linkages.families.goldberg_5r import (
    generalized_goldberg,
    goldberg,
    subtractive_goldberg,
    syncopated_goldberg,
)
from linkages.families.goldberg_6r import l_shape_goldberg, serial_goldberg
from linkages.families.mavroidis_roth import OffsetPattern, mavroidis_roth
from linkages.families.mixed_double_goldberg import (
    Kind,
    Order,
    double_goldberg_chain,
    double_goldberg_type,
)
from linkages.loop import Loop
from linkages.values import GeometryError
from tests.linkages.isomers import isomerize

A = 1.3
ALPHA, BETA, GAMMA, DELTA = np.radians([66.0, 50.0, 28.0, 83.0])
LINKS = bennett_links(A, ALPHA, b=(BETA, None), c=(GAMMA, None), d=(DELTA, None))
TIGHT = 1e-13  # closure is exact; a few dozen rounded products remain


def bennett_loop(one: Link, other: Link) -> Loop:
    return closed_chain(one, other, one, other)


def summate(first: Loop, second: Loop, kink: Kink = Kink.STRAIGHT) -> Loop:
    """Two loops on their common last link, the neighbours at joint n of ``first`` in
    line or folded upon each other."""
    return lock(superpose(first, second), first.n, kink)


def superpose_across_bennett(first: Loop, second: Loop) -> Loop:
    """The loop left when the last two links of both form a Bennett loop, removed: the
    common Bennett-linkage method of Song and Chen (2011)."""
    return superpose(first, isomerize(second, second.n), shared=2)


def superposed_angles(
    first: np.ndarray, second: np.ndarray, shared: int = 1
) -> np.ndarray:
    """Joint angles (..., n + m - 2 shared), rad, of the superposed loop from those of
    the two loops."""
    first = np.asarray(first, dtype=float)
    second = np.asarray(second, dtype=float)
    last = first.shape[-1] - shared
    other = second.shape[-1] - shared
    start = first[..., 0] - second[..., 0] + np.pi
    end = first[..., last] - second[..., other] + np.pi
    forth = first[..., 1:last]
    back = -second[..., other - 1 : 0 : -1]
    parts = [start[..., None], forth, end[..., None], back]
    return np.concatenate(parts, axis=-1)


def isomerized_angles(loop: Loop, joint: int, theta: np.ndarray) -> np.ndarray:
    """Joint angles (..., n), rad, of ``isomerize(loop, joint)`` for configurations
    ``theta`` (..., n).

    ``joint`` keeps its angle; its neighbours turn against each other.
    """
    i = joint - 1
    out = np.array(theta, dtype=float)
    first = float(loop.twists[i - 1])
    second = float(loop.twists[i])
    c1 = np.cos(first)
    s1 = np.sin(first)
    c2 = np.cos(second)
    s2 = np.sin(second)
    ck = np.cos(out[..., i])
    sk = np.sin(out[..., i])
    before = np.arctan2(s2 * sk, ck * s2 * c1 + c2 * s1)
    after = np.arctan2(s1 * sk, ck * s1 * c2 + c1 * s2)
    turn = before - after
    out[..., i - 1] += turn
    out[..., (i + 1) % loop.n] -= turn
    return out


def bennett_angles(one: Link, other: Link, theta: float) -> np.ndarray:
    """The closure equations of the asymmetric Bennett linkage (Bennett 1903)."""
    second = 2 * np.arctan(half_angle_ratio(other.twist, one.twist) / np.tan(theta / 2))
    return np.array([theta, second, -theta, -second])


def gap(loop: Loop, theta: np.ndarray) -> float:
    return float(np.abs(loop.frames(theta)[-1] - np.eye(4)).max())


def same(one: Loop, other: Loop) -> bool:
    """Whether the loops agree up to the first joint and the direction of reading."""
    reads = [loop.relabelled(k) for loop in (one, one.reversed()) for k in range(one.n)]
    return any(
        all(
            np.allclose(x, y, atol=1e-12)
            for x, y in zip(r.arrays, other.arrays, strict=True)
        )
        for r in reads
    )


def test_superposed_loops_close_in_every_pair_of_positions():
    a, b, c, _ = LINKS
    both = superpose(bennett_loop(a, b), bennett_loop(c, b))
    for t, u in ((1.1, 0.7), (-2.0, 2.5)):
        theta = superposed_angles(bennett_angles(a, b, t), bennett_angles(c, b, u))
        assert gap(both, theta) < TIGHT


def test_locking_a_joint_keeps_the_loop_closed():
    a, b, c, _ = LINKS
    both = superpose(bennett_loop(a, b), bennett_loop(c, b))
    theta = superposed_angles(bennett_angles(a, b, 1.1), bennett_angles(c, b, 0.7))
    for joint in range(1, 7):
        kink = theta[joint - 1]
        assert (
            gap(lock(both, joint, kink), locked_angles(both, joint, kink, theta))
            < TIGHT
        )


def test_collinear_kinks_are_the_limits_of_the_spatial_triangle():
    one, other = Link(1.2, 0.9), Link(0.7, 0.4)
    for kink, angle in ((Kink.STRAIGHT, 0.0), (Kink.FOLDED, np.pi)):
        exact, limit = (
            composite_link(one, other, kink),
            composite_link(one, other, angle),
        )
        assert limit.link.length == pytest.approx(exact.link.length, abs=1e-14)
        assert limit.link.twist == pytest.approx(exact.link.twist, abs=1e-14)
        assert limit.before[0] == pytest.approx(0, abs=1e-14)


def test_sum_and_difference_of_bennett_loops_are_the_goldberg_linkages():
    a, b, c, _ = LINKS
    first, second = bennett_loop(a, b), bennett_loop(c, b)
    assert same(summate(first, second), goldberg(A, ALPHA, BETA, GAMMA))
    assert same(
        summate(first, second, Kink.FOLDED),
        subtractive_goldberg(A, ALPHA, BETA, GAMMA),
    )


def test_kink_angle_gives_the_generalized_goldberg_linkage():
    a, b, c, _ = LINKS
    made = lock(superpose(bennett_loop(a, b), bennett_loop(c, b)), 4, 0.6)
    assert same(made, generalized_goldberg(A, ALPHA, BETA, GAMMA, 0.6))


def test_syncopation_is_subtraction_from_a_primary_bennett_loop():
    a, _, c, _ = LINKS
    product = half_angle_ratio(ALPHA, BETA) * half_angle_ratio(GAMMA, BETA)
    side = syncopated_link(a + c, product)
    primary = bennett_loop(side, a + c)  # last link a + c
    inner = goldberg(A, ALPHA, BETA, GAMMA).relabelled(2)  # b c a b, a + c last
    both = superpose(primary, inner)
    made = lock(lock(both, 4, Kink.FOLDED), 1, Kink.FOLDED)
    assert [float(x) for x in made.offsets] == [0.0] * 5
    wanted = syncopated_goldberg(A, ALPHA, BETA, GAMMA)
    assert np.allclose(
        sorted(np.abs(made.arrays[0])), sorted(np.abs(wanted.arrays[0])), atol=1e-12
    )


def test_three_bennett_loops_make_goldbergs_six_bars():
    a, b, c, d = LINKS
    row = summate(bennett_loop(a, b), bennett_loop(c, b)).relabelled(4)  # c a b a+c b
    assert same(
        summate(row, bennett_loop(d, b)), serial_goldberg(A, ALPHA, BETA, GAMMA, DELTA)
    )
    bent = (
        summate(bennett_loop(a, b), bennett_loop(c, b)).reversed().relabelled(4)
    )  # a last
    assert same(
        summate(bent, bennett_loop(d, a)),
        l_shape_goldberg(A, ALPHA, BETA, GAMMA, DELTA),
    )


def test_isomerized_loop_closes():
    a, b, c, _ = LINKS
    both = superpose(bennett_loop(a, b), bennett_loop(c, b))
    theta = superposed_angles(bennett_angles(a, b, 1.1), bennett_angles(c, b, 0.7))
    for joint in (2, 3, 5, 6):
        assert (
            gap(isomerize(both, joint), isomerized_angles(both, joint, theta)) < TIGHT
        )


def test_hybrid_on_a_common_axis_closes_where_the_kinks_allow():
    a, b, *_ = LINKS
    c, d = bennett_links(0.9, DELTA, d=(GAMMA, None))
    first, second = bennett_angles(a, b, 1.1), bennett_angles(d, c, 0.7)
    kink_1, shift = 0.4, 0.37
    kink_2 = first[0] + second[0] - kink_1
    hybrid = share_joint(bennett_loop(a, b), bennett_loop(d, c), kink_1, kink_2, shift)
    forth, back = (
        composite_link(b, d, kink_1, shift),
        composite_link(c, a, kink_2, -shift),
    )
    theta = np.concatenate([first[1:], second[1:]])
    theta += np.array(
        [back.after[1], 0, forth.before[1], forth.after[1], 0, back.before[1]]
    )
    assert gap(hybrid, theta) < TIGHT


def test_constructions_refuse_what_does_not_fit():
    a, b, c, d = LINKS
    with pytest.raises(GeometryError, match="length of shared link"):
        superpose(bennett_loop(a, b), bennett_loop(c, d))
    with pytest.raises(GeometryError, match="from 1 to 4"):
        lock(bennett_loop(a, b), 5)


def goldberg_angles(sides: float, turn: float) -> np.ndarray:
    """Configuration of the Goldberg 5R with links of twist ``sides`` whose joint 5 has
    the angle ``turn``."""
    m1, m2 = half_angle_ratio(ALPHA, sides), half_angle_ratio(GAMMA, sides)
    tangent = 1 / np.tan(turn / 2)  # theta2 + theta3 = pi - theta5
    x = max(np.roots([m2, -tangent * (1 - m1 * m2), m1]).real)
    first, second, third = (2 * np.arctan(v) for v in (x, m1 / x, m2 * x))
    return np.array([first, second, third, np.pi - first, turn])


def test_common_link_pair_closes_where_the_common_joint_agrees():
    one, other = goldberg(A, ALPHA, BETA, GAMMA), goldberg(A, ALPHA, DELTA, GAMMA)
    for turn in (0.5, -0.3):
        first, second = goldberg_angles(BETA, turn), goldberg_angles(DELTA, turn)
        assert max(gap(one, first), gap(other, second)) < TIGHT
        assert (
            gap(
                superpose(one, other, shared=2),
                superposed_angles(first, second, shared=2),
            )
            < TIGHT
        )
        bent = isomerize(other, 5)
        turned = isomerized_angles(other, 5, second)
        crossed = superpose_across_bennett(one, bent)
        assert gap(bent, turned) < TIGHT
        assert gap(crossed, superposed_angles(first, second, shared=2)) < TIGHT


def test_type_iii_is_a_goldberg_linkage_with_a_locked_joint():
    values = (A, ALPHA, BETA, GAMMA, DELTA)
    mixed = lock(double_goldberg_type(*values, order=Order.III, kind=Kind.MIXED), 3)
    assert same(mixed, goldberg(A * np.sin(BETA) / np.sin(ALPHA), BETA, ALPHA, DELTA))
    a, b, _, d = LINKS
    for kind in (Kind.GOLDBERG, Kind.SUBTRACTIVE):
        type_iii = double_goldberg_type(*values, order=Order.III, kind=kind)
        made = lock(type_iii, 3, Kink.FOLDED)
        assert same_up_to_link_direction(made, closed_chain(a, b - d, a, d, b))


# --- the eighteen combinations of table 2 in Song and Chen (2012)


def five_bars(sign: int, b: Link) -> tuple[Loop, ...]:
    """The three places of the link pair a, c in a Goldberg (+1) or subtractive (-1) 5R
    with the link b."""
    a, _, c, _ = LINKS

    def joined(x: Link, y: Link) -> Link:
        return x + y if sign > 0 else x - y

    common_a = closed_chain(b, a, joined(b, c), a, c)  # pair a, c last
    common_c = closed_chain(b, c, joined(b, a), c, a)  # pair c, a last
    apart = closed_chain(b, joined(a, c), b, c, a)
    return common_a, common_c, apart


def last_two(loop: Loop) -> list[Link]:
    return [Link(*x) for x in zip(loop.lengths[-2:], loop.twists[-2:], strict=True)]


def type_of(loop: Loop) -> str:
    """Which mixed Type the links of ``loop`` make, for some naming of the basic links
    and some sign of c."""
    found = {
        order.name
        for a, b, c, d in itertools.permutations(LINKS)
        for order in Order
        for signed in (c, -c)
        if same_up_to_link_direction(
            loop,
            double_goldberg_chain(
                {"a": a, "b": b, "c": signed, "d": d}, order, Kind.MIXED
            ),
        )
    }
    assert len(found) == 1, found
    return found.pop()


def test_eighteen_combinations_give_the_six_mixed_types():
    _, b, _, d = LINKS
    expected = {
        ("S3", "G3"): ("I", "I"),
        **dict.fromkeys(
            (("S3", "G1"), ("S3", "G2"), ("S1", "G3"), ("S2", "G3")), ("II", "II")
        ),
        **dict.fromkeys((("S1", "G1"), ("S2", "G2")), ("III", "IV")),
        **dict.fromkeys((("S1", "G2"), ("S2", "G1")), ("V", "VI")),
    }
    found = {}
    for (i, s), (j, g) in itertools.product(
        enumerate(five_bars(-1, b), 1), enumerate(five_bars(1, d), 1)
    ):
        pair = last_two(s)
        link_pair = superpose(s, ending_with(g, *pair), shared=2)
        across = superpose_across_bennett(s, ending_with(g, *pair[::-1]))
        found[f"S{i}", f"G{j}"] = (type_of(link_pair), type_of(across))
    assert found == expected


def test_two_equal_kinds_of_five_bars_give_the_twelve_counterparts():
    _, b, _, d = LINKS
    for kind in (Kind.GOLDBERG, Kind.SUBTRACTIVE):
        sign = kind.value.first
        first, second = five_bars(sign, b), five_bars(sign, d)
        pairs = {
            "I": (2, 2, False),
            "II": (0, 2, False),
            "III": (0, 0, False),
            "IV": (0, 0, True),
        }
        pairs |= {"V": (0, 1, False), "VI": (0, 1, True)}
        for order, (i, j, crossed) in pairs.items():
            s = first[i]
            pair = last_two(s)
            if crossed:
                made = superpose_across_bennett(s, ending_with(second[j], *pair[::-1]))
            else:
                made = superpose(s, ending_with(second[j], *pair), shared=2)
            wanted = double_goldberg_type(
                A, ALPHA, BETA, GAMMA, DELTA, order=Order[order], kind=kind
            )
            assert same_up_to_link_direction(made, wanted), (kind, order)


def same_up_to_link_direction(one: Loop, other: Loop) -> bool:
    """As `same`, where a link a/alpha may also be read as -a/-alpha (its common normal
    turned round)."""

    def folded(loop: Loop) -> np.ndarray:
        lengths, twists, _ = loop.arrays
        return np.sign(lengths) * np.stack([lengths, twists])

    turns = [
        np.roll(read, k, axis=1)
        for read in (folded(one), folded(one.reversed()))
        for k in range(one.n)
    ]
    is_near = np.isclose(turns, folded(other), atol=1e-12)
    return bool(is_near.all(axis=(1, 2)).any())


def test_kinked_pair_has_the_plain_linkages_as_limits():
    values = (A, ALPHA, BETA, GAMMA, DELTA)
    kinks = {
        Kind.MIXED: (Kink.FOLDED, Kink.STRAIGHT),
        Kind.GOLDBERG: (Kink.STRAIGHT, Kink.STRAIGHT),
        Kind.SUBTRACTIVE: (Kink.FOLDED, Kink.FOLDED),
    }
    for kind, pair in kinks.items():
        made = generalized_double_goldberg(*values, *pair)
        assert same_up_to_link_direction(made, double_goldberg_type(*values, kind=kind))


def test_equal_kinks_give_a_mavroidis_roth_linkage():
    made = generalized_double_goldberg(A, ALPHA, BETA, GAMMA, DELTA, 0.7, 0.7)
    free = composite_link(LINKS[0], LINKS[2], 0.7)
    b, d = LINKS[1], LINKS[3]
    wanted = mavroidis_roth(
        b.length,
        b.twist,
        d.twist,
        free.link.length,
        free.link.twist,
        free.before[0],
        free.after[0],
        OffsetPattern.NEGATIVE,
    )
    assert same(made, wanted)


@pytest.mark.parametrize("lengths", [(1.0, 1.0), (0.0, 0.0)])
def test_outer_axes_that_are_the_same_are_refused(lengths):
    first, second = (Link(length, 0.7) for length in lengths)
    with pytest.raises(GeometryError, match=r"kink: 180 deg .* not the same"):
        composite_link(first, second, np.pi)


def test_two_links_of_a_plane_are_one_link_between_parallel_axes():
    links = composite_link(Link(1.0, 0.0), Link(0.7, 0.0), -1.2, 0.3)
    end = 1.0 + 0.7 * np.exp(-1.2j)
    assert links.link.length == pytest.approx(abs(end), abs=1e-15)
    assert links.link.twist == 0.0
    assert links.before == pytest.approx((0.3, np.angle(end)), abs=1e-15)
    assert links.after == pytest.approx((0.0, -1.2 - np.angle(end)), abs=1e-15)


def test_twists_that_make_a_length_negative_are_named():
    message = r"twist of link b: 30 degrees beside 200 of the first link .* -"
    with pytest.raises(GeometryError, match=message):
        bennett_length("b", np.radians(30), None, 1.0, np.radians(200))
