"""The commands `bifurc follow` and `bifurc special`."""

import json
import math

import numpy as np
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


OXIDATION = """\
name = "CO oxidation"  # Bykov, Yablonskii and Kim 1978
parameter = "k"
[unknowns]
x = [0, 1]
y = [0, 1]
s = [0, 1]
k = [0.1, 2]
[parameters]
q2 = 1.34
q4 = 0.07
[definitions]
z = "1 - x - y - s"
[equations]
x = "x' = 5*z^2 - 2*x^2 - 10*x*y"
y = "y' = q2*z - 0.1*y - 10*x*y"
s = "s' = q4*(z - k*s)"
"""
TABLE = """\
name = "my four-bar"
angles = "deg"
lengths = [1, 2.4, 2, 3.4]
twists = [0, 0, 0, 0]
offsets = [0, 0, 0, 0]
"""


def written(tmp_path, text):
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_folds_of_equations_in_a_file_are_followed_over_a_constant(tmp_path):
    path = written(tmp_path, OXIDATION)
    parameters = ("--param", "q2=0.5:2", "--param", "q4=0.0675")
    result = run("follow", path, "--point", "F1", *parameters, "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    (curve,) = document["curves"]
    assert (curve["point"], curve["kind"]) == ("F1", "fold")
    assert curve["closure_gap"] < 1e-14
    places = {}
    for place in document["points"]:
        row = (place["parameters"]["k"], place["parameters"]["q2"])
        places.setdefault(place["kind"], []).append(row)
    assert places["cusp"] == [pytest.approx((0.3559912732, 1.00640833), rel=1e-8)]
    first, second = sorted(places["bogdanov-takens"])
    assert first == pytest.approx((0.722339072522, 1.16119870882), abs=1e-11)
    assert second == pytest.approx((0.971397573485, 1.4176276376), abs=1e-10)


def test_unknowns_of_equations_stand_by_their_names(tmp_path):
    path = written(tmp_path, OXIDATION)
    result = run("follow", path, "--param", "q2=0.5:2", "--out", tmp_path / "out")
    assert "CO oxidation: k from 0.1 to 2 and q2 from 0.5 to 2" in result.stdout
    assert "cusp, at x = 0.0359" in result.stdout
    assert (tmp_path / "out" / "follow.png").stat().st_size > 1000


def test_entries_of_a_table_are_parameters(tmp_path):
    path = written(tmp_path, TABLE)
    free = ("--param", "a12=0.5:1.5", "--param", "a41=3:4")
    result = run("follow", path, *free, "--json")
    assert result.exit_code == 0, result.output
    (curve,) = json.loads(result.stdout)["curves"]
    first, last = (np.array(curve["parameters"][name]) for name in ("a12", "a41"))
    # the shortest and the longest link are together as long as the others
    assert first + last == pytest.approx(4.4, abs=1e-12)


@pytest.mark.parametrize(
    ("command", "text", "parameter", "message"),
    [
        ("follow", OXIDATION, "q3=1:2", "one of q2, q4"),
        ("follow", OXIDATION, "q2", "write low:high"),
        ("follow", OXIDATION, "q2=1.5", "0 parameters are free"),
        ("special", OXIDATION, "q2=1:2", "this takes a linkage"),
        ("follow", TABLE, "a13=1:2", "one of a12, alpha12, R1, a23"),
        ("follow", "joints = []", "a12=1:2", "joints"),
    ],
)
def test_parameters_that_a_file_does_not_have_are_refused(
    tmp_path, command, text, parameter, message
):
    result = run(command, written(tmp_path, text), "--param", parameter)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


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
        (("follow", *BRICARD, "--point", "B9"), "that are followed: B1, B2"),
        (("follow", "mine.toml", "--param", "d"), "there is no such file"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments, message):
    result = run(*arguments)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
