"""How assemblies are held: frameworks whose flexes, stresses and stability are known.

The frustums, the prisms, the wheel and the eight points with symmetry are those of
PyRigi's collection (Grasegger and others 2024), whose answers are the same.
"""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.files.bars import framework
from linkages.mapping import map_linkage
from linkages.pictures.picture import Part
from linkages.pictures.plot_linkage import painter_of, place_of, plot_linkage
from linkages.readout.readout import Readout
from linkages.readout.rigidity import (
    bar_stresses,
    held_document,
    hold_at,
    points_at,
    velocities,
)
from linkages.values import GeometryError
from tests.linkages.mechanisms.spatial_mechanisms import platform

PRISM = ["01", "02", "03", "12", "14", "25", "34", "35", "45"]
PARALLEL = {
    "0": (0, 0),
    "1": (2, 0),
    "2": (1, 2),
    "3": (0, 6),
    "4": (2, 6),
    "5": (1, 4),
}
FLEXIBLE = PARALLEL | {"3": (0, 4), "4": (2, 4), "5": (1, 6)}
GENERIC = {"0": (0, 0), "1": (3, 0), "2": (2, 1), "3": (0, 4), "4": (2, 4), "5": (1, 3)}


def polygon(n, radius=1.0, first=0):
    angles = 2.0 * np.pi * np.arange(n) / n
    return {
        str(first + k): (radius * np.cos(t), radius * np.sin(t))
        for k, t in enumerate(angles)
    }


def frustum(n):
    bars = [(k, (k + 1) % n) for k in range(n)] + [(k, k + n) for k in range(n)]
    bars += [(n + k, n + (k + 1) % n) for k in range(n)]
    return bars, {**polygon(n), **polygon(n, 2.0, n)}


def octagon():
    """Eight points with a bar from each to the next and to the one across but one."""
    bars = [(k, (k + 1) % 8) for k in range(8)] + [(k, (k + 3) % 8) for k in range(8)]
    return bars, polygon(8)


WHEEL = (
    ([(5, k) for k in range(5)] + [(k, (k + 1) % 5) for k in range(5)]),
    {
        **polygon(5),
        "5": (0.0, 0.0),
    },
)
CASES = {
    "prism": (PRISM, GENERIC, 0, 0, "first order"),
    "prism with parallel legs": (PRISM, PARALLEL, 1, 1, "prestress"),
    "prism with equal legs": (PRISM, FLEXIBLE, 1, 1, "-"),
    "frustum of 3": (*frustum(3), 1, 1, "prestress"),
    "frustum of 4": (*frustum(4), 2, 1, "prestress"),
    "frustum of 5": (*frustum(5), 3, 1, "prestress"),
    "wheel": (*WHEEL, 0, 1, "first order"),
    "octagon": (*octagon(), 1, 4, "prestress"),
}


@pytest.mark.parametrize("name", CASES)
def test_flexes_and_stresses_of_frameworks_are_those_that_are_known(name):
    bars, points, flexes, stresses, words = CASES[name]
    readout = Readout(framework(points, bars))
    hold = hold_at(readout, np.zeros(readout.closure.n))
    assert (hold.flexes, hold.stresses, hold.words) == (flexes, stresses, words)


@pytest.mark.parametrize("name", CASES)
def test_stresses_are_in_balance_and_flexes_keep_bars_as_long_as_they_are(name):
    bars, points, *_ = CASES[name]
    mechanism = framework(points, bars)
    readout = Readout(mechanism)
    hold = hold_at(readout, np.zeros(readout.closure.n))
    names = [joint.name for joint in mechanism.joints]
    (places,) = points_at(readout, hold.point[None])
    assert places[:, :2] == pytest.approx(np.array([points[one] for one in names]))
    stresses = bar_stresses(readout, hold)
    assert stresses.densities.shape == (hold.stresses, len(bars) - 1)
    forces = np.zeros((hold.stresses, len(names), 2))
    for rates in velocities(readout, hold):
        assert np.linalg.norm(rates, axis=1).max() == pytest.approx(1.0)
    for number, bar in enumerate(stresses.bars):
        first, last = (names.index(end) for end in bar.split("-"))
        along = places[first, :2] - places[last, :2]
        forces[:, first] += stresses.densities[:, number, None] * along
        forces[:, last] -= stresses.densities[:, number, None] * along
        for rates in velocities(readout, hold):
            assert (rates[first, :2] - rates[last, :2]) @ along == pytest.approx(
                0.0, abs=1e-8
            )
    fixed = [names.index(str(end)) for end in bars[0]]
    assert np.delete(forces, fixed, axis=1) == pytest.approx(0.0, abs=1e-9)


COLLINEAR = """
fixed = ["1", "2"]
bars = [["1", "3"], ["3", "2"], ["1", "4"], ["4", "3"]]
[points]
1 = [0.0, 0.0]
2 = [1.0, 0.0]
3 = [0.4, 0.0]
4 = [0.2, 0.7]
"""


@pytest.fixture(scope="module")
def collinear(tmp_path_factory):
    path = tmp_path_factory.mktemp("rigid") / "collinear.toml"
    path.write_text(COLLINEAR)
    return path


def test_two_bars_on_one_line_are_held_by_their_tension(collinear):
    done = CliRunner().invoke(main, ["map", str(collinear), "--json"])
    document = json.loads(done.stdout)
    assert document["completeness"]["certainty"] == "certified"
    assemblies = document["rigid_assemblies"]
    assert len(assemblies) == 2
    for one in assemblies:
        assert (one["flexes"], one["stresses"]) == (1, 1)
        assert one["is_prestress_stable"] and one["is_rigid"]
        # equal forces in bars 0.4 and 0.6 long
        held = one["holding_stress"]
        assert held["1-3"] == pytest.approx(1.0)
        assert held["3-2"] == pytest.approx(2.0 / 3.0)
        assert [held["1-4"], held["4-3"]] == pytest.approx([0.0, 0.0], abs=1e-9)
        assert one["points"]["3"] == pytest.approx([0.4, 0.0], abs=1e-6)
    heights = sorted(one["points"]["4"][1] for one in assemblies)
    assert heights == pytest.approx([-0.7, 0.7])


@pytest.mark.parametrize("height", [2e-8, 5e-8, 1e-7, 3e-7])
@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_two_assemblies_that_doubles_do_not_tell_apart_are_in_doubt(height, scale):
    points = {"a": (0, 0), "b": (2 * scale, 0), "c": (scale, height * scale)}
    atlas = map_linkage(framework(points, ["ab", "ac", "bc"]))
    if len(atlas.rigid) != 2:
        assert atlas.completeness.is_in_doubt


def test_the_summary_says_what_holds_a_shaky_assembly(collinear):
    done = CliRunner().invoke(main, ["map", str(collinear)])
    assert done.stdout.count("isolated: 1 flex, 1 stress, rigid by prestress") == 2
    assert "Certainty (certified)" in done.stdout


def test_rigid_assemblies_of_bars_are_listed_by_their_points(tmp_path):
    path = tmp_path / "triangle.toml"
    path.write_text(
        'fixed = ["A", "B"]\nbars = [["A", "C", 5], ["B", "C", 4]]\n'
        "[points]\nA = [0, 0]\nB = [3, 0]\nC = [3, 4]\n"
    )
    text = CliRunner().invoke(main, ["map", str(path)]).stdout
    table = text[text.index("Rigid assemblies") :].splitlines()
    assert table[1].strip() == "C (x, y)"
    assert sorted(line.strip() for line in table[2:4]) == ["3, -4", "3, 4"]


def test_flexes_are_drawn_as_arrows():
    mechanism = framework(PARALLEL, PRISM)
    atlas = map_linkage(mechanism)
    readout = Readout(mechanism)
    document = held_document(readout, np.zeros(readout.closure.n))
    (rates,) = document["velocities"]
    ahead = np.array([rates[one] for one in "345"])
    assert np.abs(ahead) == pytest.approx(np.array([[1.0, 0.0]] * 3), abs=1e-8)
    drawn = plot_linkage(atlas)
    arrows = [patch for patch in drawn.axes[0].patches if patch.get_zorder() > 0]
    painter = painter_of(atlas, place_of(atlas, None, None))
    plain = painter.picture(place_of(atlas, None, None).point)
    assert not [stroke for stroke in plain.strokes if stroke.part is Part.FLEX]
    closed = [stroke for stroke in plain.strokes if stroke.closed]
    assert len(arrows) == len(closed) + 3


def test_rods_that_turn_about_themselves_are_no_stresses():
    readout = Readout(platform((0.0, 0.02, -0.03, 0.05, 0.01, -0.02)))
    hold = hold_at(readout, readout.structure.reference)
    assert (hold.flexes, hold.stresses) == (0, 0)


@pytest.mark.parametrize(
    ("points", "bars", "words"),
    [
        ({0: (0, 0), 1: (1, 0), 2: (0, 1, 1)}, [(0, 1), (1, 2), (2, 0)], "point 2"),
        ({k: (k, 0, k * k) for k in range(3)}, [(0, 1), (1, 2)], "triangle"),
        ({0: (0, 0), 1: (1, 0)}, [(0, 1), (1, 2)], "2"),
        ({0: (0, 0), 1: (1, 0)}, [], "bars"),
    ],
)
def test_a_framework_that_is_none_is_refused_by_name(points, bars, words):
    with pytest.raises(GeometryError, match=words):
        framework(points, bars)


# --- in space -------------------------------------------------------------------------

OCTAHEDRON = {
    "A": (1, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1),
    "D": (-1, 0, 0), "E": (0, -1, 0), "F": (0, 0, -1),
}  # fmt: skip
OF_OCTAHEDRON = ["AB", "BC", "CA", "AE", "AF", "BD", "BF", "CD", "CE", "DE", "EF", "FD"]


def test_an_octahedron_of_bars_is_rigid_as_drawn_and_has_other_assemblies_that_move():
    mechanism = framework(OCTAHEDRON, OF_OCTAHEDRON)
    atlas = map_linkage(mechanism)
    # folded flat onto itself a pair of opposite corners coincides, and turns freely
    assert len(atlas.rigid) == 2 and len(atlas.forms) == 6
    readout = Readout(mechanism)
    document = held_document(readout, atlas.rigid[0])
    assert (document["flexes"], document["stresses"]) == (0, 0)
    lengths = {
        np.linalg.norm(np.subtract(document["points"][a], document["points"][b]))
        for a, b in OF_OCTAHEDRON
    }
    assert [*lengths] == pytest.approx([np.sqrt(2.0)] * len(lengths))


def test_random_frameworks_in_space_have_the_flexes_and_stresses_of_their_rigidity_matrix():
    rng = np.random.default_rng(3)
    singular = 0
    for _ in range(60):
        n = int(rng.integers(4, 8))
        points = rng.choice(27, n, replace=False)
        places = np.stack(np.unravel_index(points, (3, 3, 3)), axis=1).astype(float)
        if np.linalg.matrix_rank(places[1:3] - places[0]) < 2:
            continue
        bars = [(0, 1), (0, 2), (1, 2)]
        for end in range(3, n):
            bars += [(int(k), end) for k in rng.choice(end, 3, replace=False)]
        matrix = np.zeros((len(bars), n, 3))
        for row, (first, last) in zip(matrix, bars, strict=True):
            row[first], row[last] = np.subtract(*places[[first, last]]), 0.0
            row[last] = -row[first]
        rank = np.linalg.matrix_rank(matrix.reshape(len(bars), -1))
        readout = Readout(framework(dict(enumerate(places)), bars))
        hold = hold_at(readout, readout.structure.reference)
        assert (hold.flexes, hold.stresses) == (3 * n - 6 - rank, len(bars) - rank)
        assert bar_stresses(readout, hold).densities.shape[0] == hold.stresses
        singular += hold.flexes > 0
    assert singular > 3


TRIPOD = """
fixed = ["A", "B", "C"]
bars = [["A", "T", 3], ["B", "T", 3], ["C", "T", 3], ["A", "S"], ["B", "S"], ["C", "S"]]
[points]
A = [2, 0, 0]
B = [-1, "sqrt(3)", 0]
C = [-1, "-sqrt(3)", 0]
T = [0.1, 0, 2]
S = [-1, 0, 1]
"""


def test_bars_of_a_file_in_space_take_lengths(tmp_path):
    path = tmp_path / "tripod.toml"
    path.write_text(TRIPOD)
    done = CliRunner().invoke(main, ["map", str(path), "--json"])
    assemblies = json.loads(done.stdout)["rigid_assemblies"]
    assert len(assemblies) == 4
    tips = np.array([one["points"]["T"] for one in assemblies])
    assert tips[:, :2] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(tips[:, 2]) == pytest.approx(np.sqrt(5.0))
    text = CliRunner().invoke(main, ["map", str(path)]).stdout
    assert "T (x, y, z)" in text


def test_what_is_held_on_the_frame_alone_is_listed_by_its_joints(tmp_path):
    pins = [
        f'[[joints]]\nname = "{name}"\nkind = "revolute"\nbodies = ["frame", "link"]\n'
        f"point = [{x}, 0, 0]\ndirection = [0, 0, 1]\n"
        for name, x in (("A", 0), ("B", 1))
    ]
    path = tmp_path / "two.toml"
    path.write_text("planar = true\n" + "".join(pins))
    text = CliRunner().invoke(main, ["map", str(path)]).stdout
    assert "A, B (deg)" in text


def test_points_on_bars_in_space_are_refused(tmp_path):
    path = tmp_path / "tripod.toml"
    path.write_text(f'{TRIPOD}[points_on_bars]\nM = ["A", "T", 0.5]\n')
    done = CliRunner().invoke(main, ["map", str(path)])
    assert done.exit_code == 2 and "points_on_bars" in done.stderr


def test_coordinates_of_another_number_are_refused_by_the_point():
    with pytest.raises(GeometryError, match=r"point 1: .*three numbers"):
        framework({0: (0, 0, 0), 1: (1, 0)}, [(0, 1)], fixed=[0])
