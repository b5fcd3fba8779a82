"""How far joints reach, beside closed forms, and what ends that."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from bifurc.settings import SearchSettings
from linkages.app.cli import main
from linkages.app.reports.reach import EndKind, reach_along, variable_labels
from linkages.linkage import load
from linkages.mapping import map_linkage
from tests.linkages.app.slider_cranks import slider_crank_text

QUICK = SearchSettings(certify=False)


def mapped(name, **values):
    return map_linkage(load(name, **values), settings=QUICK)


def reaches(atlas, form=0, **limits):
    (stretch,) = reach_along(atlas, form, limits)
    return {one.label: one for one in stretch.reaches}


def angle(opposite, first, second):
    """The angle of a triangle across from a side."""
    return np.arccos((first**2 + second**2 - opposite**2) / (2 * first * second))


@pytest.mark.parametrize("seed", range(4))
def test_a_crank_turns_fully_and_its_rocker_between_two_triangles(seed):
    rng = np.random.default_rng(seed)
    a, b, c = 1.0, rng.uniform(2.2, 2.6), rng.uniform(1.8, 2.2)
    d = rng.uniform(2.0, b + c - a - 0.1)
    atlas = mapped("four-bar", a=a, b=b, c=c, d=d)
    found = reaches(atlas)
    assert found["1"].turns == found["2"].turns == 1
    # the angle at the frame where crank and coupler are stretched, and folded
    expected = np.sort([np.pi - angle(x, c, d) for x in (b + a, b - a)])
    rocker = found["4"]
    ends = np.sort(np.abs([rocker.low.value, rocker.high.value]))
    assert np.allclose(ends, expected, rtol=0, atol=1e-12)
    assert {rocker.low.kind, rocker.high.kind} == {EndKind.DEAD_POINT}
    # that of coupler and rocker where the crank is along the frame
    expected = np.sort([np.pi - angle(x, b, c) for x in (d + a, d - a)])
    ends = np.sort(np.abs([found["3"].low.value, found["3"].high.value]))
    assert np.allclose(ends, expected, rtol=0, atol=1e-12)


def test_all_joints_of_a_bennett_linkage_turn_fully():
    found = reaches(mapped("bennett"))
    assert [one.turns for one in found.values()] == [1] * 4
    assert all(one.low is None and one.high is None for one in found.values())


def test_within_limits_a_form_falls_into_stretches():
    atlas = mapped("four-bar")
    low, high = np.radians([-90, 90])
    (stretch,) = reach_along(atlas, 0, {"2": (low, high)})
    found = {one.label: one for one in stretch.reaches}
    two = found["2"]
    assert (two.low.value, two.high.value) == pytest.approx((low, high), abs=1e-12)
    assert two.low.kind is two.high.kind is EndKind.LIMIT
    assert (two.low.by, found["4"].high.by) == ("2", "2")
    # B, C and D in a triangle with the crank across the coupler
    a, b, c, d = 1.0, 2.4, 2.0, load("four-bar").loop.lengths[3]
    across = np.hypot(a, b)
    expected = np.pi - angle(across, c, d)
    assert abs(found["4"].high.value) == pytest.approx(expected, abs=1e-12)


def test_limits_that_no_part_keeps_leave_none_and_narrow_ones_leave_several():
    atlas = mapped("four-bar")
    assert not reach_along(atlas, 0, {"4": tuple(np.radians([0, 30]))})
    # the rocker goes to and fro, twice through the middle of its range
    assert len(reach_along(atlas, 0, {"4": tuple(np.radians([110, 120]))})) == 2


def test_a_slide_reaches_to_the_sum_and_the_difference_of_crank_and_rod(tmp_path):
    path = tmp_path / "slider.toml"
    path.write_text(slider_crank_text((1, 0), 4), encoding="utf-8")
    atlas = map_linkage(load(path), settings=QUICK)
    assert variable_labels(atlas)["J4"] is False
    slides = [reaches(atlas, form)["J4"] for form in range(len(atlas.forms))]
    # on x, where it is drawn at 4
    assert sorted(one.high.value for one in slides) == pytest.approx([-6, 0], abs=1e-12)
    assert sorted(one.low.value for one in slides) == pytest.approx([-8, -2], abs=1e-12)


def test_a_limit_of_the_file_and_a_bifurcation_end_a_range(tmp_path):
    path = tmp_path / "slider.toml"
    text = slider_crank_text((0.6, 0.8), 3.6) + "limits = [-1, 0.1]\n"
    path.write_text(text, encoding="utf-8")
    atlas = map_linkage(load(path), settings=QUICK)
    found = reaches(atlas)
    ends = [found["J4"].low, found["J4"].high]
    assert [one.kind for one in ends] == [EndKind.LIMIT] * 2
    assert [one.value for one in ends] == pytest.approx([-1, 0.1], abs=1e-12)
    assert found["J1"].low.by == "J4"


def run(*arguments):
    return CliRunner().invoke(main, list(arguments))


def test_the_command_prints_tables_and_json():
    text = run("limits", "four-bar", "--form", "1").stdout
    assert "turns fully, 1 turn" in text
    assert "dead point" in text
    document = json.loads(run("limits", "four-bar", "--json").stdout)
    joints = document["stretches"][0]["joints"]
    assert joints[0] == {
        "joint": "1",
        "unit": "rad",
        "turns": 1,
        "stands_still_at": None,
        "low": None,
        "high": None,
    }
    assert joints[3]["low"]["kind"] == "dead_point"


@pytest.mark.parametrize(
    ("within", "message"),
    [
        ("9=0:1", "one of 1, 2, 3, 4"),
        ("1=2:1", "write low:high"),
        ("1", "of the form key=value"),
        ("1=0:360", "less than 360 degrees"),
    ],
)
def test_limits_that_are_none_are_refused_in_one_line(within, message):
    result = run("limits", "four-bar", "--within", within)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
