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
        ({0: (0, 0), 1: (1, 0)}, [(0, 1), (1, 2)], "2"),
        ({0: (0, 0), 1: (1, 0)}, [], "bars"),
    ],
)
def test_a_framework_that_is_none_is_refused_by_name(points, bars, words):
    with pytest.raises(GeometryError, match=words):
        framework(points, bars)
