"""Reading a linkage from a file."""

import logging

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.file import LinkageFileError, read_linkage

TABLE = """
name = "my linkage"
angles = "deg"
lengths = [1.0, 0.65, 1.0, 0.65]
twists = [100, 40, 100, 40]
offsets = [0, 0, 0, 0]
"""
LISTS = TABLE.split('angles = "deg"')[1]


@pytest.fixture
def write(tmp_path):
    def to_file(text):
        path = tmp_path / "linkage.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return to_file


def test_a_table_in_degrees_becomes_a_loop_in_radians(write):
    loop, theta = read_linkage(write(TABLE))
    assert loop.name == "my linkage"
    assert loop.lengths == (1.0, 0.65, 1.0, 0.65)
    assert loop.twists == pytest.approx(np.radians([100, 40, 100, 40]), abs=0)
    assert theta is None


def test_a_loop_without_a_name_is_called_after_the_file(write):
    loop, _ = read_linkage(write(TABLE.replace('name = "my linkage"', "")))
    assert loop.name == "linkage"


def test_radians_stand_as_they_are_and_degrees_in_their_place_give_a_warning(
    write, caplog
):
    text = 'angles = "rad"' + LISTS
    with caplog.at_level(logging.WARNING, logger="linkages"):
        loop, _ = read_linkage(write(text))
    assert loop.twists == (100.0, 40.0, 100.0, 40.0)
    assert "twists[1] is 100" in caplog.text
    assert 'angles = "deg"' in caplog.text
    caplog.clear()
    read_linkage(write(text.replace("100", "1.7").replace("40", "0.7")))
    assert not caplog.records


def test_axes_in_one_configuration_give_the_loop_and_its_angles(write):
    known = entry("bennett").build()
    closed = np.array([1.0, 0.0, -1.0, 0.0])
    alpha, beta = known.arrays[1][:2]
    ratio = np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2)
    closed[1] = 2 * np.arctan(ratio / np.tan(closed[0] / 2))
    closed[3] = -closed[1]
    frames = known.frames(closed)[:-1]
    points = (25.4 * frames[:, :3, 3]).tolist()
    directions = frames[:, :3, 2].tolist()
    text = f"points = {points}\ndirections = {directions}"
    loop, theta = read_linkage(write(text))
    assert loop.lengths == pytest.approx([25.4 * a for a in known.lengths], rel=1e-12)
    assert np.abs(loop.frames(theta)[-1] - np.eye(4)).max() < 1e-12


def test_axes_that_meet_in_a_point_have_lengths_and_offsets_of_exactly_zero(write):
    axes = "[[1, 0, 1], [0, 1, 1], [-1, 0, 1.2], [0, -1, 1.5]]"
    loop, _ = read_linkage(write(f"points = {axes}\ndirections = {axes}"))
    assert loop.lengths == loop.offsets == (0.0, 0.0, 0.0, 0.0)


BAD = {
    "is missing": (
        "lengths = [1, 1, 1, 1]\noffsets = [0, 0, 0, 0]",
        "twists: a missing list",
    ),
    "is of another length": (
        TABLE.replace("[100, 40, 100, 40]", "[100, 40, 100, 40, 1]"),
        "number of twists: 5",
    ),
    "is nan": (TABLE.replace("0.65", "nan"), "lengths[2]: nan"),
    "is infinite": (
        TABLE.replace("[0, 0, 0, 0]", "[0, 0, -inf, 0]"),
        "offsets[3]: -inf",
    ),
    "has three joints": (
        'angles = "deg"\nlengths = [1, 1, 1]\ntwists = [1, 1, 1]\noffsets = [0, 0, 0]',
        "number of lengths: 3",
    ),
    "has thirteen joints": (
        f'angles = "deg"\nlengths = {[1] * 13}\ntwists = {[1] * 13}\noffsets = {[1] * 13}',
        "number of lengths: 13",
    ),
    "has an unknown key": (
        TABLE.replace("twists", "twist"),
        "'twist' (the nearest is 'twists')",
    ),
    "has text for a list": (TABLE.replace("[0, 0, 0, 0]", '"none"'), 'offsets: "none"'),
    "has text for a number": (
        TABLE.replace("[0, 0, 0, 0]", '[0, "0", 0, 0]'),
        'offsets[2]: "0"',
    ),
    "has a truth value for a number": (
        TABLE.replace("[0, 0, 0, 0]", "[0, true, 0, 0]"),
        "offsets[2]: True",
    ),
    "has a number for a name": (TABLE.replace('"my linkage"', "7"), "name: 7"),
    "has no unit of angle": (
        LISTS,
        'angles: a missing key is not allowed; it must be "deg" or "rad"',
    ),
    "has another unit of angle": (TABLE.replace('"deg"', '"grad"'), 'angles: "grad"'),
    "has both formats": (TABLE + "points = [[0, 0, 0]]", "keys: lengths with points"),
    "has points alone": (
        "points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]",
        "directions: a missing list",
    ),
    "has a flat point": (
        "points = [[0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\ndirections = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]]",
        "points[1]: [0, 0]",
    ),
    "has a direction too few": (
        "points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 2, 0]]\n"
        "directions = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]]",
        "number of directions: 4",
    ),
    "is not TOML": ('angles = "deg"\nlengths = [1, 2', "is not valid TOML"),
    "is not text": (b"name = '\xff'", "is not UTF-8 text: byte 8"),
}


@pytest.mark.parametrize("what", BAD)
def test_a_file_that_is_wrong_is_refused_with_what_is_wrong(write, what):
    text, message = BAD[what]
    with pytest.raises(LinkageFileError) as caught:
        read_linkage(write(text))
    assert message in str(caught.value)
    assert "linkage.toml: " in str(caught.value)


def test_malformed_toml_is_refused_with_the_line(write):
    with pytest.raises(LinkageFileError, match="line 3"):
        read_linkage(write('name = "x"\nangles = "deg"\nlengths = 1, 2\n'))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(LinkageFileError, match=r"nowhere\.toml: there is no such file"):
        read_linkage(tmp_path / "nowhere.toml")
