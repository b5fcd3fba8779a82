"""Mechanisms as families: their numbers are parameters, and their equations are those of
each member."""

import numpy as np
import pytest
from scipy.optimize import brentq

from bifurc.limits import Deadline
from bifurc.settings import SearchSettings
from linkages.closure.system import ClosureSystem
from linkages.mapping import map_linkage
from linkages.parameters.file_family import family_of_file
from linkages.parameters.followed import follow_points
from linkages.parameters.joint_family import JointFamily
from linkages.parameters.members import Members
from linkages.parameters.relations import precise_changes
from linkages.parameters.special import ChangeKind, special_values
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import one_of_each, platform, rods
from tests.linkages.mechanisms.test_size import spatial_four_bar
from tests.samples import one_in

FOUR_BAR = """\
name = "four-bar"
fixed = ["A", "D"]
bars = [["A", "B", 1], ["B", "C", 2.4], ["C", "D", 2]]
[points]
A = [0, 0]
B = [0.5, 0.85]
C = [2.5, 1.9]
D = [3, 0]
"""
STEPHENSON = """\
name = "Stephenson III"
fixed = ["A", "D", "F"]
bars = [["A", "B", 1.0], ["B", "C", 2.4], ["C", "D", 2.0], ["P", "E", 1.6], ["E", "F", 1.5]]
[points]
A = [0, 0]
B = [0.5, 0.85]
C = [2.5, 1.9]
D = [3, 0]
E = [0.9, 3.4]
F = [-0.3, 2.4]
[points_on_bars]
P = ["B", "C", [0.4, 0.5]]
"""
SPHERICAL = """\
name = "spherical six-bar"
fixed = ["A", "D"]
arcs = [["A", "B", 25], ["B", "C"], ["C", "D"], ["E", "F"], ["F", "G"]]
[points]
A = [0, 0, 1]
B = [0.1, 0.4, 1]
C = [0.9, 0.8, 1]
D = [0.8, 0, 1]
F = [1.6, 1.4, 1]
[points_on_arcs]
E = ["B", "C", [20, 35]]
G = ["C", "D", [15, -20]]
"""
GEARED = """\
name = "geared five-bar"
[[joints]]
name = "J1"
kind = "revolute"
bodies = ["frame", "a"]
point = [0, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "J2"
kind = "revolute"
bodies = ["a", "b"]
point = [0.3, 1, 0]
direction = [0, 0, 1]
[[joints]]
name = "J3"
kind = "revolute"
bodies = ["b", "c"]
point = [1.5, 2.4, 0]
direction = [0, 0, 1]
[[joints]]
name = "J4"
kind = "revolute"
bodies = ["c", "d"]
point = [2.9, 0.8, 0]
direction = [0, 0, 1]
locked = {lock}
[[joints]]
name = "J5"
kind = "revolute"
bodies = ["frame", "d"]
point = [2.2, 0, 0]
direction = [0, 0, 1]
{coupled}
"""
COUPLED = 'coupled = {to = "J1", ratio = -1.5, offset = 0.1}'
FILES = {
    "bars": FOUR_BAR,
    "points on bars": STEPHENSON,
    "arcs": SPHERICAL,
    "gears": GEARED.replace("locked = {lock}", "").replace("{coupled}", COUPLED),
    "lock": GEARED.replace("{lock}", "0").replace("{coupled}", ""),
}


@pytest.fixture(autouse=True)
def _few_maps(monkeypatch):
    monkeypatch.setattr("linkages.parameters.special.MEMBERS", 6)
    monkeypatch.setattr("linkages.parameters.relations.CHECKED", 3)


def family(tmp_path, text):
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return family_of_file(path)


def largest_gap(of_family, size, seed=0):
    """How far closed configurations of a random member, built anew, are off in the
    equations of the family; how many there were."""
    rng = np.random.default_rng(seed)
    drawn = {
        name: value + size * rng.uniform(-1, 1) * (abs(value) or 1)
        for name, value in of_family.defaults.items()
    }
    closure = ClosureSystem(of_family.build(**drawn))
    spread = rng.uniform(-0.3, 0.3, (12, closure.n))
    points, gaps = closure.project(closure.reference + spread)
    points = of_family.in_equations(points[gaps < 1e-13], drawn)
    everything = np.column_stack([points, np.tile([*drawn.values()], (len(points), 1))])
    residuals = of_family.closure.tape.compiled.residuals(everything)
    return np.abs(residuals).max(initial=0.0), len(points)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("size", [0.0, 0.1])
def test_the_equations_of_a_file_are_those_of_each_member(tmp_path, name, size):
    gap, count = largest_gap(family(tmp_path, FILES[name]), size)
    assert gap < 1e-13
    assert count >= 6


@pytest.mark.parametrize("make", [one_of_each, rods, spatial_four_bar])
def test_joints_of_every_kind_can_be_elsewhere(make):
    gap, count = largest_gap(JointFamily(make()), 0.1)
    assert gap < 1e-13
    assert count


@pytest.mark.parametrize("name", one_in(6, sorted(cases())))
def test_joints_of_known_mechanisms_can_be_elsewhere(name):
    gap, count = largest_gap(JointFamily(mechanism_of_case(cases()[name])), 0.1)
    assert gap < 1e-13
    assert count


def test_a_member_with_other_unknowns_is_refused():
    legs = JointFamily(platform((None,) * 6))
    name = legs.parameters[0].name
    with pytest.raises(GeometryError, match="unknowns of platform"):
        legs.build(**{name: legs.defaults[name] + 0.1})


def test_a_length_that_cannot_be_assembled_is_refused(tmp_path):
    with pytest.raises(GeometryError, match=r"D\.x = 9 is not allowed"):
        family(tmp_path, FOUR_BAR).build(**{"D.x": 9.0})


# --- special --------------------------------------------------------------------------


def test_grashofs_rule_of_bars_is_exact_and_its_relation_is_found(tmp_path):
    bars = family(tmp_path, FOUR_BAR)
    members = Members(bars, bars.defaults, {"D.x": (0.3, 5.3)})
    changes = special_values(members).changes
    a, b, c = 1.0, 2.4, 2.0
    values = [change.value for change in changes]
    assert np.allclose(values, [a + c - b, a + b - c, b + c - a], rtol=0, atol=1e-13)
    for change in changes:
        assert change.kind is ChangeKind.SINGULAR
        assert change.at.bifurcations == 1
        assert {change.before.components, change.after.components} == {1, 2}
    (precise,) = precise_changes(members, changes[-1:], Deadline(float("inf")))
    assert precise.relation.text == "A-B + D.x = B-C + C-D"
    assert (precise.relation.held, precise.relation.digits) == (3, 50)


def coupler_point(t, side):
    """The point P of the six-bar at the crank angle t."""
    b = np.exp(1j * t)
    across = 3 - b
    r = abs(across)
    along = (2.4**2 - 2.0**2 + r * r) / (2 * r)
    c = b + across / r * (along + 1j * side * np.sqrt(2.4**2 - along**2))
    return b + (c - b) * (0.4 + 0.5j)


def test_a_six_bar_changes_where_its_dyad_just_reaches_the_coupler_curve(tmp_path):
    """The critical points of Stephenson III: distances from F to the curve of P that are
    extreme, reached by the dyad of 1.6 and E-F stretched or folded."""
    extremes = []
    grid = np.linspace(0.0, 2 * np.pi, 2001)
    for side in (1, -1):
        rates = np.gradient(abs(coupler_point(grid, side) - (-0.3 + 2.4j)), grid)

        def rate(t, side=side):
            h = 1e-5
            away = [abs(coupler_point(t + k * h, side) + 0.3 - 2.4j) for k in (1, -1)]
            return away[0] - away[1]

        for k in np.flatnonzero(rates[1:-2] * rates[2:-1] < 0) + 1:
            t = brentq(rate, grid[k - 1], grid[k + 2], xtol=1e-14)
            extremes.append(abs(coupler_point(t, side) + 0.3 - 2.4j))
    lengths = [x for d in extremes for x in (d - 1.6, 1.6 - d, d + 1.6)]
    expected = sorted(x for x in lengths if 1.2 < x < 2.3)
    six_bar = family(tmp_path, STEPHENSON)
    members = Members(six_bar, six_bar.defaults, {"E-F": (1.2, 2.3)})
    changes = special_values(members).changes
    assert len(expected) == 3
    assert [change.value for change in changes] == pytest.approx(expected, abs=1e-11)


def test_followed_over_two_lengths_a_bifurcation_keeps_grashofs_equality(tmp_path):
    bars = family(tmp_path, FOUR_BAR)
    values = {**bars.defaults, "D.x": 3.4}
    members = Members(bars, values, {"A-B": (0.5, 1.5), "D.x": (2.9, 3.9)})
    atlas = members_atlas(members)
    (followed,) = follow_points(members, members.points(atlas))
    s = np.linspace(0.0, followed.curve.branch.length, 40)
    first, last = followed.curve.parameters(s).T
    assert np.allclose(first + last, 2.4 + 2.0, rtol=0, atol=1e-12)
    assert followed.comparison.members == 50
    assert followed.comparison.gap < 1e-13
    assert followed.comparison.singular_value < 1e-12


def members_atlas(members):
    settings = SearchSettings(certify=False)
    return map_linkage(members.load(members.start), settings=settings)
