"""Denavit-Hartenberg tables as CSV."""

import logging

import numpy as np
import pytest

from linkages.file import read_file, read_linkage
from linkages.files.csv_table import from_modified, read_csv
from linkages.values import GeometryError

LENGTHS, OFFSETS = (1.0, 2.0, 3.0, 4.0), (0.1, 0.2, 0.3, 0.4)
TWISTS = np.radians([10, 20, 30, 40])


def text_of(headings, rows, separator=","):
    lines = [separator.join(headings)]
    lines += [separator.join(map(str, row)) for row in rows]
    return "\n".join(lines) + "\n"


ROWS = [(i + 1, LENGTHS[i], 10 * (i + 1), OFFSETS[i], "*") for i in range(4)]


@pytest.mark.parametrize(
    "headings",
    [
        ("joint", "a", "alpha (deg)", "d", "theta"),
        ("i", "a_i [mm]", "α [°]", "d_i [mm]", "θ_i"),
        ("", "length", "twist, degrees", "offset", "angle"),
        ("No.", "Link length", "Link twist (deg)", "Link offset", "Joint angle"),
        ("link", "a", "alpha/deg", "R", "q"),
    ],
)
@pytest.mark.parametrize("separator", [";", "\t"])
def test_columns_are_found_by_the_usual_headings(headings, separator, caplog):
    loop = read_csv(text_of(headings, ROWS, separator), "mine")
    assert loop.lengths == LENGTHS
    assert loop.offsets == OFFSETS
    assert loop.twists == pytest.approx(TWISTS)
    assert loop.name == "mine"
    assert not caplog.records


@pytest.mark.parametrize("factor", [1.0, 180 / np.pi])
def test_the_unit_of_twists_is_told_by_their_size_with_a_warning(factor, caplog):
    rows = [
        (a, factor * t, d) for a, t, d in zip(LENGTHS, TWISTS, OFFSETS, strict=True)
    ]
    with caplog.at_level(logging.WARNING):
        loop = read_csv(text_of(("a", "alpha", "d"), rows), "mine")
    assert loop.twists == pytest.approx(TWISTS)
    assert "write alpha (deg) or alpha (rad)" in caplog.text


def test_multiples_of_pi_degree_signs_and_decimal_commas_are_numbers():
    twists = ["pi/2", "-π/4", "0.5*pi", "3 pi / 4"]
    rows = [("1,5", twist, 0) for twist in twists]
    loop = read_csv(text_of(("a", "alpha (rad)", "d"), rows, ";"), "mine")
    assert loop.twists == pytest.approx(np.pi * np.array([0.5, -0.25, 0.5, 0.75]))
    assert set(loop.lengths) == {1.5}
    rows = [(1, "90°", 0)] * 4
    loop = read_csv(text_of(("a", "alpha (deg)", "d"), rows), "mine")
    assert loop.twists == pytest.approx([np.pi / 2] * 4)


def test_the_modified_convention_has_the_link_before_the_joint():
    headings = ("i", "a(i-1)", "alpha(i-1) (deg)", "d(i)", "theta(i)")
    shifted = [ROWS[i - 1][1:3] for i in range(4)]
    rows = [(i + 1, *shifted[i], OFFSETS[i], "*") for i in range(4)]
    loop = read_csv(text_of(headings, rows), "mine")
    plain = read_csv(text_of(("i", "a", "alpha (deg)", "d", "theta"), rows), "mine")
    assert loop == from_modified(plain)
    assert loop.lengths == LENGTHS
    assert loop.offsets == OFFSETS


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "an empty file"),
        (
            text_of(("a", "b", "d"), ROWS),
            "columns of twists: 0 under the headings a; b; d",
        ),
        (text_of(("a", "alpha", "d", "a"), ROWS), "columns of lengths: 2"),
        (text_of(("a", "alpha", "d"), [(1, 2, 3)] * 3), "number of rows: 3"),
        (text_of(("a", "alpha", "d"), [(1, 2)] * 4), "a missing cell"),
        (text_of(("a", "alpha", "d"), [("x", 2, 3)] * 4), "lengths[1]: 'x'"),
    ],
)
def test_what_is_no_table_is_refused_by_name(text, words):
    with pytest.raises(GeometryError) as error:
        read_csv(text, "mine")
    assert words in str(error.value)


def test_a_file_is_read_by_its_ending(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text(
        "# a comment\n" + text_of(("i", "a", "alpha (deg)", "d", "q"), ROWS)
    )
    assert read_file(path) == read_linkage(path)[0]
    assert read_linkage(path) == (read_file(path), None)
