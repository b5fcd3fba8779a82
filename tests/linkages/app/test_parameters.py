"""The commands `bifurc follow` and `bifurc special`."""

import json
import math

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


BRICARD = ("reconfigurable-bricard-1", "--param", "alpha=20:40")


def test_follow_says_where_points_go_and_with_what_it_was_compared():
    result = run("follow", *BRICARD, "--point", "B1")
    assert result.exit_code == 0, result.output
    text = result.stdout
    assert "from alpha 20 deg to alpha 40 deg" in text
    assert "50 members built anew" in text
    assert "B2" not in text


def test_follow_writes_text_json_and_a_figure(tmp_path):
    result = run("follow", *BRICARD, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert [curve["point"] for curve in document["curves"]] == ["B1", "B2"]
    alphas = document["curves"][0]["parameters"]["alpha"]
    ends = [min(alphas), max(alphas)]
    assert ends == pytest.approx([math.radians(20), math.radians(40)])
    assert document["points"] == []
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["follow.json", "follow.png", "follow.txt"]
    assert json.loads((tmp_path / "out" / "follow.json").read_text()) == document


def test_follow_over_two_parameters_draws_their_plane(tmp_path):
    result = run(
        "follow",
        "spherical-four-bar",
        *("--param", "alpha12=50:90", "--param", "alpha23=50:90"),
        *("--out", tmp_path),
    )
    assert result.exit_code == 0, result.output
    assert (tmp_path / "follow.png").stat().st_size > 1000


def test_follow_says_why_a_point_is_not_followed():
    result = run("follow", "spherical-four-bar", "--param", "alpha12")
    assert result.exit_code == 0
    assert "not followed: the point is there for these values" in result.stdout


def test_special_lists_values_with_the_maps_beside_them():
    result = run("special", "four-bar", "--param", "d=3:4")
    assert result.exit_code == 0, result.output
    assert "d = 3.4: at this value alone there is a singular point" in result.stdout
    assert "below: 2 forms in 2 components, 0 bifurcations" in result.stdout
    assert "above: 1 form in 1 component, 0 bifurcations" in result.stdout


def test_special_as_json():
    result = run("special", "four-bar", "--param", "d=3:4", "--json")
    document = json.loads(result.stdout)
    (change,) = document["changes"]
    assert document["parameter"] == "d"
    assert document["is_whole"]
    assert change["value"] == pytest.approx(3.4, abs=1e-13)
    assert change["kind"] == "singular point"
    assert change["digits"] >= 12


def test_where_nothing_is_special_it_says_so():
    result = run("special", "bennett", "--param", "alpha=60:80")
    assert "No value was found" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("special", "four-bar"), "0 parameters are free, and one parameter is to be"),
        (
            ("special", "four-bar", "--param", "d", "--param", "c"),
            "2 parameters are free",
        ),
        (("special", "four-bar", "--param", "e"), "one of a, b, c, d"),
        (("special", "four-bar", "--param", "d=5:3"), "write low:high"),
        (("special", "four-bar", "--param", "d=1:x"), "a number"),
        (("special", "four-bar", "--param", "d=9:10"), "sum of the others"),
        (("special", "nothing", "--param", "d"), "no linkage is called"),
        (("follow", "four-bar", "--param", "d=1:2", "--param", "d"), "given twice"),
        (("follow", "bennett", "--param", "alpha"), "no singular point"),
        (("follow", *BRICARD, "--point", "B9"), "the points are B1, B2"),
        (("follow", "mine.toml", "--param", "d"), "a file holds one linkage"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments, message):
    result = run(*arguments)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
