"""Recognition: every reference case is named whichever way it is read, and refused when
it is a little off."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkages.catalogue import catalogue, entry
from linkages.identification.equivalence import (
    Reading,
    Signs,
    as_loop,
    compare,
    find_signs,
    normal_form,
    readings,
    table,
)
from linkages.identification.fitting import NEAR
from linkages.identification.identify import ALIKE, ToleranceError, identify
from linkages.identification.recovery import plain_parameters
from linkages.loop import Loop
from tests.samples import one_in

CASES = json.loads(
    (Path(__file__).parents[3] / "data" / "catalogue_cases.json").read_text()
)
NAMES = [case["case"] for case in CASES]


def table_of(case):
    return np.array([case["a"], case["alpha"], case["R"]])


def disguised(values, rng):
    """The same linkage, or its mirror image, read another way, with axes and links
    reversed, in another unit."""
    n = values.shape[1]
    reading = Reading(
        int(rng.integers(n)), bool(rng.integers(2)), bool(rng.integers(2))
    )
    signs = Signs(rng.choice([-1.0, 1.0], n), rng.choice([-1.0, 1.0], n))
    unit = np.exp(rng.uniform(-3, 3))
    return as_loop(signs.of(reading.of(values)) * [[unit], [1.0], [unit]])


def off_by_1e_4(values, is_one, rng):
    """The table with one number that is not zero, or all of them, a little off."""
    if not is_one:
        return values * (1 + 1e-4 * rng.uniform(-1, 1, values.shape))
    where = np.argwhere(values != 0)
    values[tuple(where[rng.integers(len(where))])] *= 1 + 1e-4
    return values


@pytest.mark.parametrize(
    "number", one_in(12, range(len(CASES)), lambda number: NAMES[number])
)
def test_a_disguised_case_is_named_and_refused_where_it_is_off_by_1e_4(number):
    case, rng = CASES[number], np.random.default_rng(number)
    found = identify(disguised(table_of(case), rng), locking=False)
    loop = found.loop
    assert case["entry"] in found.names
    for match in found.matches:
        member = match.entry.build(**match.parameters)
        again = compare(
            match.reading.of(table(loop)),
            table(member)[None],
            loop.characteristic_length,
        )
        assert (
            again.exact[0] < 1e-8
        )  # the tolerance; parameters that it reports make the table
    freedoms = [match.freedom for match in found.matches]
    assert freedoms == sorted(freedoms)

    rng = np.random.default_rng(100 + number)
    off = off_by_1e_4(table_of(case), is_one=number % 2 == 1, rng=rng)
    refused = identify(disguised(off, rng), locking=False)
    assert refused.names == ()
    near = [match for match in refused.nearest if match.distance < 10 * ALIKE * 1e-4]
    assert near[0].entry.name in found.names
    named = {match.entry.name for match in near}
    # the linkages of tori are the generalized Goldberg 5R in more parameters than it
    # has
    assert case["entry"] in named or case["entry"].startswith("torus-5r")


def test_a_special_linkage_is_named_before_the_general_ones():
    found = identify(
        entry("special-double-subtractive-goldberg").build(), locking=False
    )
    assert found.names[:2] == (
        "special-double-subtractive-goldberg",
        "double-subtractive-goldberg",
    )
    assert found.matches[0].parameters == pytest.approx(
        entry("special-double-subtractive-goldberg").defaults
    )


@pytest.mark.parametrize(
    "name",
    ["altmann", "mavroidis-roth-opposite", "dietmaier", "waldron-hybrid", "yu-baker"],
)
def test_a_table_as_built_gives_its_parameters_back(name):
    found = identify(entry(name).build(), locking=False, entries=[entry(name)])
    assert found.matches[0].parameters == pytest.approx(entry(name).defaults)


@pytest.mark.parametrize("kind", ["mixed-double", "double", "double-subtractive"])
def test_type_iii_is_a_5r_with_a_locked_joint(kind):
    type_iii = entry(f"{kind}-goldberg-type-iii")
    (locked,) = identify(type_iii.build(), entries=[type_iii]).locked
    assert (locked.joint, locked.angle) == (3, 0.0 if kind == "mixed-double" else np.pi)
    assert locked.matches[0].entry.name == (
        "goldberg-5r" if kind == "mixed-double" else "subtractive-goldberg-5r"
    )


def test_no_joint_of_a_wohlhart_double_goldberg_can_be_locked_to_a_5r():
    assert identify(entry("wohlhart-double-goldberg").build(), entries=[]).locked == ()


def test_residuals_stand_at_the_number_that_is_off():
    values = table(entry("bennett").build())
    values[0, 3] *= 1.001
    match = identify(
        as_loop(values), entries=[entry("bennett")], locking=False
    ).nearest[0]
    assert abs(match.residuals[0, 3]) == abs(match.residuals[0, 1:]).max() > 1e-4


def test_a_loop_of_seven_joints_is_nothing_of_the_catalogue():
    found = identify(as_loop(np.ones((3, 7))), locking=False)
    assert (found.matches, found.nearest) == ((), ())


@pytest.mark.parametrize("reading", readings(5), ids=str)
def test_a_reading_is_undone(reading):
    values = np.random.default_rng(1).normal(size=(3, 5))
    assert np.array_equal(reading.undone(reading.of(values)), values)
    loop = as_loop(values).reversed() if reading.is_reversed else as_loop(values)
    loop = loop.relabelled(reading.shift)
    assert np.array_equal(
        reading.of(values), table(loop.mirrored() if reading.is_mirrored else loop)
    )


def test_reversed_axes_and_links_leave_no_distance_and_are_found_again():
    rng = np.random.default_rng(2)
    values = rng.normal(size=(3, 6))
    signs = Signs(rng.choice([-1.0, 1.0], 6), rng.choice([-1.0, 1.0], 6))
    other = signs.of(values)
    assert compare(other, values[None], 1.0).exact[0] < 1e-12
    assert np.allclose(find_signs(other, values, 1.0).of(values), other)
    assert np.allclose(np.abs(normal_form(other)), np.abs(normal_form(values)))


def test_reversed_axes_and_links_turn_a_closed_loop_into_a_closed_loop():
    case = next(case for case in CASES if case["entry"] == "dietmaier")
    theta = np.array(case["theta"])
    links, axes = np.array([1, -1, -1, 1, 1, -1.0]), np.array([-1, 1, 1, -1, 1, 1.0])
    moved = as_loop(Signs(links, axes).of(table_of(case)))
    turned = theta + np.where(
        links * np.roll(links, 1) < 0, np.pi, 0
    )  # links before and after the joint
    gaps = [
        np.abs(moved.frames(sign * axes * turned)[-1] - np.eye(4)).max()
        for sign in (1, -1)
    ]  # a half turn about x changes all offsets and angles
    assert min(gaps) < 1e-12


def test_one_sign_of_an_offset_is_not_an_equivalence():
    values = table(entry("bricard-line-symmetric").build())
    other = values * np.array([[1.0] * 6, [1.0] * 6, [-1.0] + [1.0] * 5])
    found = compare(values, other[None], 1.0)
    assert found.blind[0] == 0
    assert found.exact[0] > 0.1


@pytest.mark.parametrize("name", list(catalogue()))
def test_parameters_stand_in_the_table_or_have_a_formula(name):
    found = entry(name)
    hidden = {p.name for p in found.parameters} - set(plain_parameters(found))
    if found.scan:
        assert hidden == set(found.scan)
    elif hidden:
        guesses = list(found.guesses(normal_form(table(found.build()))))
        assert not guesses or hidden <= set(guesses[0])


@pytest.mark.parametrize("kind", ["mixed-double", "double-subtractive"])
@pytest.mark.parametrize("order", ["ii", "iii", "iv"])
def test_a_difference_of_links_may_be_negative(kind, order):
    found = entry(f"{kind}-goldberg-type-{order}")
    loop = found.build(beta=0.4, gamma=0.9)
    assert min(loop.lengths) < 0
    assert identify(loop, entries=[found], locking=False).names == (found.name,)


@pytest.mark.parametrize("tolerance", [np.nan, np.inf, -1e-9])
def test_a_tolerance_that_is_no_distance_is_refused(tolerance):
    with pytest.raises(ToleranceError, match="finite number, 0 or greater"):
        identify(entry("bennett").build(), tolerance)


def test_a_tolerance_of_zero_is_a_tolerance():
    assert identify(entry("bennett").build(), 0.0, locking=False).tolerance == 0.0


def test_no_linkage_is_near_that_misses_by_more_than_the_scale():
    rng = np.random.default_rng(3)
    for _ in range(3):
        found = identify(as_loop(rng.uniform(0.3, 2.0, (3, 6))), locking=False)
        assert all(match.distance < NEAR for match in found.nearest)
        assert all(match.freedom > 0 for match in found.nearest)


def test_lengths_that_are_known_to_less_are_judged_by_that():
    loop = entry("bennett").build()
    bennett = [entry("bennett")]
    lengths = (loop.lengths[0] + 1e-6, *loop.lengths[1:])
    rounded = replace(loop, lengths=lengths, rounding=1e-6)
    assert identify(rounded, entries=bennett).names == ("bennett",)
    assert identify(rounded, entries=bennett).tolerance == pytest.approx(
        8**0.5 * 1e-6 / rounded.characteristic_length
    )
    assert not identify(replace(rounded, rounding=1e-8), entries=bennett).matches


def test_neighbours_that_miss_alike_stand_in_the_order_of_the_catalogue():
    twists = np.radians([90, 30, 90, 30])
    loop = Loop((1.0, 0.501, 1.0, 0.501), tuple(twists), (0.0,) * 4)
    names = [match.entry.name for match in identify(loop).nearest]
    known = [name for name in catalogue() if name in names and "bennett" in name]
    assert len(known) == 4
    assert [name for name in names if "bennett" in name] == known
