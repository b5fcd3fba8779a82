"""The plane of two parameters: regions, boundaries, and random members that check them."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from bifurc.limits import Deadline
from linkages.app.cli import main
from linkages.catalogue import entry
from linkages.parameters.chart import chart
from linkages.parameters.members import Members


@pytest.fixture(scope="module")
def four_bars():
    """Four-bars with b = 2.4 and c = 2 over the lengths a and d."""
    family = entry("four-bar")
    return Members(family, family.defaults, {"a": (0.5, 4.0), "d": (0.5, 5.0)})


@pytest.fixture(scope="module")
def charted(four_bars):
    return chart(four_bars, 30)


def sums(p):
    """What Grashof's rule compares, for lengths (..., 2) a and d."""
    a, d = p[..., 0], p[..., 1]
    return np.stack([a + d - 4.4, a - d + 0.4, a - d - 0.4])


def test_boundaries_are_where_two_links_are_as_long_as_the_others(charted):
    for curve in charted.boundaries:
        p = curve.parameters(np.linspace(0.0, curve.branch.length, 50))
        assert np.abs(sums(p)).max(axis=1).min() < 1e-11
    assert len(charted.boundaries) == 3


def test_regions_are_those_of_grashofs_rule(charted):
    assert len(charted.regions) == 6
    assert sum(region.share for region in charted.regions) == pytest.approx(1, abs=0.02)
    for region in charted.regions:
        lengths = np.sort([*region.p, 2.4, 2.0])
        is_grashof = lengths[0] + lengths[3] < lengths[1] + lengths[2]
        assert region.map.shape.components == (2 if is_grashof else 1)


def test_boundaries_cross_where_three_links_decide(charted):
    found = sorted(point.p.tolist() for point in charted.points)
    assert np.allclose(found, [(2.0, 2.4), (2.4, 2.0)], rtol=0, atol=1e-11)
    assert {point.kind for point in charted.points} == {"crossing"}


def test_random_members_have_the_map_of_their_region(charted):
    assert charted.is_whole
    assert len(charted.checked) == 30
    assert len(charted.disagreements) == charted.beside == 0


def test_a_region_with_a_missing_boundary_is_found_out(four_bars, monkeypatch):
    """With no boundaries the plane is one region, and members of other maps are said."""
    monkeypatch.setattr(
        "linkages.parameters.chart._ChartSearch.follow", lambda search, solved: None
    )
    wrong = chart(four_bars, 10)
    assert len(wrong.regions) == 1
    assert 0 < len(wrong.disagreements) < 10


def test_a_search_without_time_says_that_it_is_not_whole(four_bars):
    found = chart(four_bars, 5, deadline=Deadline(0.0))
    assert not found.is_whole
    assert found.regions == ()


def test_the_command_writes_text_json_and_a_figure(tmp_path, monkeypatch):
    monkeypatch.setattr("linkages.parameters.chart.GRID", 3)
    plane = ("--param", "a=0.5:1.5", "--param", "d=2.9:3.9", "--random", "4")
    arguments = ["chart", "four-bar", *plane, "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert "Of 4 random members 0 have another map than their region" in result.stdout
    document = json.loads((tmp_path / "out" / "chart.json").read_text())
    (boundary,) = document["boundaries"]
    total = np.array(boundary["a"]) + np.array(boundary["d"])
    assert np.allclose(total, 4.4, rtol=0, atol=1e-12)
    assert [one["map"]["components"] for one in document["regions"]] == [2, 1]
    assert (tmp_path / "out" / "chart.png").stat().st_size > 1000


def test_one_free_parameter_is_no_plane():
    result = CliRunner().invoke(main, ["chart", "four-bar", "--param", "d"])
    assert result.exit_code == 2
    assert "1 parameters are free, and 2 parameters are to be" in result.stderr


def test_boundaries_on_each_other_cross_nowhere_and_three_meet_in_one_point():
    """Of spherical four-bars two boundaries are one line of the plane, for two
    configurations."""
    family = entry("spherical-four-bar")
    ranges = dict.fromkeys(("alpha12", "alpha23"), tuple(np.radians([70.0, 110.0])))
    values = {**family.defaults, "alpha12": 1.6, "alpha23": 1.6}
    found = chart(Members(family, values, ranges), 0)
    angles = sorted(np.degrees(point.p).tolist() for point in found.points)
    # the others are 85 and 95 degrees
    assert np.allclose(angles, [(85, 95), (95, 85)], rtol=0, atol=1e-9)
