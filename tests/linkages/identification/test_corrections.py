"""What a rounded or misprinted table is meant to be."""

import numpy as np
import pytest

from linkages.app.reports.corrections import best_corrections, describe_corrections
from linkages.catalogue import entry
from linkages.errata.misprints import printed_tables
from linkages.identification.corrections import (
    corrections_of,
    find_corrections,
    roundings_of,
)
from linkages.identification.equivalence import as_loop, table
from linkages.identification.identify import identify
from linkages.identification.recovery import Row
from linkages.loop import Loop
from tests.samples import one_in

NAME = "special-double-subtractive-goldberg"


def rounded(values, digits):
    lengths, twists, offsets = values
    twists = np.radians(np.round(np.degrees(twists), digits - 2))
    return np.array(
        [np.round(lengths, digits - 1), twists, np.round(offsets, digits - 1)]
    )


@pytest.mark.parametrize("digits", [3, 4, 6])
def test_of_a_rounded_table_the_parameters_with_the_fewest_decimals_are_found(digits):
    loop = as_loop(rounded(table(entry(NAME).build()), digits))
    first = roundings_of(identify(loop, locking=False))[0]
    assert first.match.entry.name == NAME
    # beta and delta are exchanged where the table is read backwards
    parameters = sorted(first.match.parameters.values())
    assert parameters == pytest.approx(sorted(entry(NAME).defaults.values()), abs=1e-12)
    assert first.changes == ()
    assert first.is_rounding


def places(correction):
    return {(change.row.value, change.column) for change in correction.changes}


@pytest.mark.parametrize(
    ("row", "column", "change"),
    [
        (0, 1, lambda x: 1.5 * x),
        (1, 2, lambda x: -x),
        (1, 0, lambda x: x + np.radians(30)),
        (1, 1, lambda x: np.pi - x),
    ],
)
def test_a_number_that_is_wrong_is_named_with_what_is_right(row, column, change):
    family = entry("bennett")
    values = table(family.build())
    printed = values.copy()
    printed[row, column] = change(printed[row, column])
    found = find_corrections(as_loop(printed)).found
    (first, *_) = [one for one in found if places(one) == {(row, column)}]
    assert len(found[0].changes) == 1
    assert first.changes[0].meant == pytest.approx(values[row, column])
    assert first.match.member == pytest.approx(values)
    moved = first.match.entry.build(**first.match.parameters)
    assert moved.n == 4


@pytest.mark.parametrize("spots", [((0, 3), (1, 0)), ((0, 0), (2, 1))])
def test_two_numbers_that_are_wrong_are_named(spots):
    printed = rounded(table(entry("bennett").build()), 5)
    true = printed.copy()
    for (row, column), more in zip(spots, (0.3, -0.4), strict=True):
        printed[row, column] += more
    best = best_corrections(find_corrections(as_loop(printed)).found)
    (right,) = [one for one in best if places(one) == set(spots)]
    assert right.match.entry.name.startswith("bennett")
    for change in right.changes:
        meant = true[change.row.value, change.column]
        assert change.meant == pytest.approx(meant, abs=2e-3)


def test_rows_that_are_exchanged_are_named():
    values = table(entry("goldberg-5r").build())
    printed = values[:, [1, 0, 2, 3, 4]]
    assert not identify(as_loop(printed), locking=False).matches
    found = find_corrections(as_loop(printed)).found
    assert "rows 1 and 2 are exchanged" in [one.mistake for one in found]


def test_twists_in_radians_that_are_read_as_degrees_are_named():
    values = table(entry("goldberg-5r").build())
    printed = values * [[1.0], [np.pi / 180], [1.0]]
    found = find_corrections(as_loop(printed), [entry("goldberg-5r")]).found
    assert found[0].mistake == "the twists are in radians"
    assert found[0].match.member == pytest.approx(values)


def test_a_column_that_is_shifted_is_named():
    values = table(entry("extended-myard-5r").build())
    printed = values.copy()
    printed[2] = np.roll(values[2], 1)
    found = find_corrections(as_loop(printed), [entry("extended-myard-5r")]).found
    assert found[0].mistake == "the offsets are shifted by one row down"


def test_a_length_that_occurs_twice_is_one_misprint():
    values = table(entry("bennett").build())
    printed = values.copy()
    printed[0, [0, 2]] = 0.9
    found = find_corrections(as_loop(printed), [entry("bennett")]).found
    assert places(found[0]) <= {(0, 0), (0, 2), (0, 1), (0, 3)}
    assert len(found[0].changes) == 2


SINGLE = [one for one in printed_tables() if len(one.numbers) == 1]


@pytest.mark.parametrize(
    "printed", one_in(2, SINGLE, lambda one: f"{one.equation} {one.numbers}")
)
def test_the_misprints_of_the_sources_are_found_from_their_tables(printed):
    family = entry(printed.linkage)
    found = find_corrections(printed.loop, [family]).found
    names = {change.name(printed.loop.n) for one in found for change in one.changes}
    assert len(found[0].changes) == 1
    assert printed.numbers[0] in names


def test_the_sources_have_five_tables_with_one_number_wrong():
    assert len(SINGLE) == 5


def test_what_is_far_from_everything_has_no_correction():
    odd = as_loop(
        np.array([[1, 1.7, 0.6, 2.1], [0.6, 1.2, 0.8, 1.7], [0.2, 0.5, -0.4, 0.9]])
    )
    assert corrections_of(identify(odd, locking=False)).found == ()


def test_a_sign_is_wrong_of_a_twist_rather_than_of_a_length():
    twists = np.radians([90, 30, -90, 30])
    loop = Loop((1.0, 0.5, 1.0, 0.5), tuple(twists), (0.0,) * 4)
    corrections = find_corrections(loop).found
    rows = [[one.row for one in correction.changes] for correction in corrections]
    assert rows[0] == [Row.TWISTS]
    assert corrections[0].match.entry.name == "bennett"


LINE_SYMMETRIC = "bricard-line-symmetric"


def two_wrong_of_a_line_symmetric_table(patience):
    true = rounded(table(entry(LINE_SYMMETRIC).build()), 5)
    printed = true.copy()
    printed[0, 0] *= 1.3
    printed[1, 2] += np.radians(20)
    families = [entry(LINE_SYMMETRIC)]
    return find_corrections(as_loop(printed), families, patience=patience), true


def test_two_numbers_of_six_joints_are_found_every_way_they_may_be_meant():
    corrections, true = two_wrong_of_a_line_symmetric_table(60.0)
    assert corrections.left == ()
    best = best_corrections(corrections.found)
    # opposite links are alike: each of the two numbers may be wrong where it is or there
    spots = [((0, a), (1, b)) for a in (0, 3) for b in (2, 5)]
    assert sorted(tuple(sorted(places(one))) for one in best) == spots
    (right,) = [one for one in best if places(one) == {(0, 0), (1, 2)}]
    assert right.match.member == pytest.approx(true, abs=1e-3)


def test_what_two_numbers_were_not_looked_for_in_is_said():
    corrections, _ = two_wrong_of_a_line_symmetric_table(0.0)
    assert corrections.found == ()
    assert corrections.left == (LINE_SYMMETRIC,)
    text = describe_corrections(corrections, 6)
    assert f"Two wrong numbers not looked for (5 s at most): {LINE_SYMMETRIC}." in text


def test_one_number_that_leaves_more_than_rounding_is_in_doubt():
    true = rounded(table(entry("bennett").build()), 5)
    printed = true.copy()
    printed[0, 0] *= 1.3
    printed[2, 1] += 0.004 * as_loop(true).characteristic_length
    corrections = find_corrections(as_loop(printed), [entry("bennett")])
    best = best_corrections(corrections.found)
    (one,) = [one for one in best if places(one) == {(0, 0)}]
    assert not one.is_rounding
    text = describe_corrections(corrections, 4)
    assert "in doubt which" in text
    assert "more than rounding makes: in doubt" in text
