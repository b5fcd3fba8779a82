"""Mechanisms as tables of Denavit and Hartenberg that share joints."""

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from bifurc.system import jacobian_at
from linkages.axes import loop_from_axes
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.file import LinkageFileError
from tests.linkages.mechanisms.known_mechanisms import cases

# Song 2013, 5.4.2: the Bennett linkages of the network, by the joints of the case
BENNETTS = {
    "A": {"0": "c24", "2": "s2", "1": "p1", "8": "s8"},
    "B": {"0": "c24", "4": "s4", "3": "p3", "2": "s2"},
    "C": {"0": "c24", "6": "s6", "5": "p5", "4": "s4"},
    "D": {"0": "c24", "8": "s8", "7": "p7", "6": "s6"},
}


def network_loops():
    """The loops of the network of four Bennett linkages, with their configurations."""
    joints = {
        joint["name"]: joint
        for joint in cases()["network of four Bennett linkages"]["joints"]
    }
    tables = []
    for names in BENNETTS.values():
        points = [joints[name]["point"] for name in names.values()]
        directions = [joints[name]["direction"] for name in names.values()]
        loop, angles = loop_from_axes(points, directions)
        tables.append((list(names), loop, angles))
    return tables


def text_of(tables):
    rows = ['angles = "rad"']
    for names, loop, angles in tables:
        rows += [
            "[[loops]]",
            f"joints = {names}".replace("'", '"'),
            f"lengths = {[float(x) for x in loop.lengths]}",
            f"twists = {[float(x) for x in loop.twists]}",
            f"offsets = {[float(x) for x in loop.offsets]}",
            f"configuration = {[float(x) for x in angles]}",
        ]
    return "\n".join(rows) + "\n"


def read(tmp_path, text):
    path = tmp_path / "loops.toml"
    path.write_text(text, encoding="utf-8")
    return linkages.load(path)


def test_four_tables_of_bennett_linkages_are_the_network(tmp_path):
    mechanism = read(tmp_path, text_of(network_loops()))
    assert len(mechanism.bodies) == 12
    assert mechanism.independent_loops == 4
    assert mechanism.gruebler == -9
    assert set(mechanism.joint("0").bodies) == {"0-2", "0-4", "0-6", "8-0"}
    problem = MechanismClosure(mechanism)
    assert np.abs(problem.residuals(problem.reference[None])).max() < 1e-14
    values = np.linalg.svd(jacobian_at(problem, problem.reference), compute_uv=False)
    assert np.count_nonzero(values > 1e-9) == problem.n - 3  # mobility 3
    atlas = linkages.map_linkage(
        mechanism.with_locks({"1": 0.0, "3": 0.0}),
        settings=SearchSettings(starts=4, certify=False),
    )
    assert len(atlas.forms) >= 1


def test_a_loop_that_shares_one_joint_is_turned_and_shifted_about_it(tmp_path):
    _, loop, angles = network_loops()[0]
    tables = [(list("abcd"), loop, angles), (list("axyz"), loop, angles)]
    text = text_of(tables)
    same = read(tmp_path, text)
    assert np.allclose(same.joint("x").point, same.joint("b").point, atol=1e-13)
    moved = read(tmp_path, text + "turn = 0.7\nshift = 0.3\n")
    assert np.allclose(moved.joint("a").direction, [0, 0, 1])
    c, s = np.cos(0.7), np.sin(0.7)
    x, y, z = same.joint("b").point
    expected = [c * x - s * y, s * x + c * y, z + 0.3]
    assert np.allclose(moved.joint("x").point, expected, atol=1e-13)


def test_links_that_are_named_may_carry_more_joints_than_two(tmp_path):
    _, loop, angles = network_loops()[0]
    tables = [(list("abcd"), loop, angles), (list("axyz"), loop, angles)]
    text = text_of(tables)
    text += 'links = ["a-b", "x-y", "y-z", "last"]\nturn = 1.0\n'
    mechanism = read(tmp_path, text)
    assert mechanism.joint("a").bodies == ("d-a", "a-b", "last")
    assert [joint.name for joint in mechanism.joints if "a-b" in joint.bodies] == [
        "a",
        "b",
        "x",
    ]


def test_configurations_are_closed_first(tmp_path):
    (names, loop, angles), *_ = network_loops()
    other = [(names, loop, angles + np.array([1e-3, 0, 0, 0]))]
    text = text_of([*other, (["0", "x", "y", "z"], loop, angles)])
    problem = MechanismClosure(read(tmp_path, text))
    assert np.abs(problem.residuals(problem.reference[None])).max() < 1e-12


TEXT = text_of(network_loops()[:2])
JOINTS = 'joints = ["0", "4", "3", "2"]'
MALFORMED = {
    "loops = 3\n": "loops: 3",
    "loops = [3]\n": r"loops\[1\]: 3 .* a table",
    TEXT + "axis = 1\n": r"key of loops\[2\]: 'axis' .* one of joints, lengths",
    TEXT.replace(JOINTS, ""): r"joints of loops\[2\]: None .* list of names",
    TEXT.replace(JOINTS, 'joints = ["0", "4", "3"]'): r"lengths of loops\[2\]: 4",
    TEXT.replace(JOINTS, 'joints = ["0", "4", "3", "0"]'): (
        r'joints of loops\[2\]: "0" .* once'
    ),
    TEXT.replace(JOINTS, 'joints = ["0", 4, "3", "2"]'): r"joints of loops\[2\]: 4",
    TEXT.replace(JOINTS, 'joints = ["w", "x", "y", "z"]'): (
        r"joints of loops\[2\]: .* one is a joint of a loop before: 0, 2, 1, 8"
    ),
    TEXT.replace(JOINTS, 'joints = ["0", "4", "2", "3"]'): (
        r"axis of joint 2 in loops\[2\]: .* degrees beside"
    ),
    TEXT.replace("offsets", "offset", 1): r"key of loops\[1\]: 'offset'",
    TEXT + 'links = ["a"]\n': r"number of links of loops\[2\]: 1 .* 4",
    TEXT + 'turn = "x"\n': r'turn of loops\[2\]: "x"',
    TEXT + "shift = nan\n": r"shift of loops\[2\]: nan",
    TEXT.replace("configuration", "# configuration", 1): (
        r"configuration of loops\[1\]: a missing key"
    ),
}


@pytest.mark.parametrize("number", range(len(MALFORMED)))
def test_malformed_loops_are_refused_by_name_and_value(number, tmp_path):
    text, message = list(MALFORMED.items())[number]
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, text)


def test_a_loop_that_does_not_close_is_refused_with_its_gap(tmp_path):
    text = TEXT.replace("lengths = [", "lengths = [9", 1)
    with pytest.raises(LinkageFileError, match=r"configuration of loops\[1\]: .* gap"):
        read(tmp_path, text)


def test_links_of_different_joints_with_one_name_are_refused(tmp_path):
    # "0-2" to "1" and "0" to "2-1": two links that would be one body, 0-2-1
    tables = network_loops()[:2]
    first = {"0": "0-2", "2": "1", "1": "a", "8": "b"}
    second = {"0": "0-2", "4": "0", "3": "2-1", "2": "1"}
    called = [
        ([names[joint] for joint in joints], loop, angles)
        for names, (joints, loop, angles) in zip((first, second), tables, strict=True)
    ]
    with pytest.raises(LinkageFileError, match='"0-2" to "1" and "0" to "2-1"'):
        read(tmp_path, text_of(called))


def test_angles_far_from_closed_ones_are_refused_with_what_they_miss(tmp_path):
    text = TEXT
    start = text.rindex("configuration = [")
    end = text.index("]", start)
    text = f"{text[:start]}configuration = [0.2, 0.3, 0.5, 0.7{text[end:]}"
    message = (
        r"configuration of loops\[2\]: not closed, by a gap of .* is .* degrees off"
    )
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, text)


@pytest.mark.parametrize("line", ["turn = 0.7", "shift = 0.3"])
def test_a_turn_or_shift_of_a_loop_that_has_its_place_is_refused(tmp_path, line):
    key = line.split()[0]
    first, *others = TEXT.split("[[loops]]")[1:]
    head = TEXT.split("[[loops]]")[0]
    tables = [first + line + "\n", *others]
    with pytest.raises(LinkageFileError, match=rf"{key} of loops\[1\]: .* left out"):
        read(tmp_path, head + "".join("[[loops]]" + table for table in tables))
    with pytest.raises(LinkageFileError, match=rf"{key} of loops\[2\]: .* place"):
        read(tmp_path, TEXT + line + "\n")
