"""The command `bifurc figure`, and the axes of the figures of `bifurc map`."""

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.files import number_of
from linkages.files.mechanism_file import mechanism_toml
from linkages.source_figures.table import source_figures
from tests.linkages.viewing.conftest import slider_crank


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_the_list_names_every_figure():
    result = bifurc("figure", "--list")
    assert result.exit_code == 0
    names = [line.split()[0] for line in result.stdout.splitlines()[1:]]
    assert names == list(source_figures())


def test_figures_are_written_as_png_and_svg(tmp_path):
    result = bifurc("figure", "004-6", "thesis-2.1.1", "004-6", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["004-6.png", "004-6.svg", "thesis-2.1.1.png", "thesis-2.1.1.svg"]
    assert result.stderr.count("wrote ") == 4


def test_the_same_figure_has_the_same_bytes(tmp_path):
    for folder in ("one", "two"):
        assert bifurc("figure", "004-8", "--out", tmp_path / folder).exit_code == 0
    for ending in ("png", "svg"):
        one = (tmp_path / "one" / f"004-8.{ending}").read_bytes()
        assert one == (tmp_path / "two" / f"004-8.{ending}").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("figure",), "name figures, or give --list"),
        (("figure", "004-6"), "--out: give the folder"),
        (("figure", "--list", "004-6"), "--list: it goes without"),
        (("figure", "thesis-5.2.77", "--out", "nowhere"), "the nearest names are"),
        (("figure", "xyz", "--out", "nowhere"), "no name is like it; bifurc figure"),
        (("map", "bennett", "--axes", "1,2"), "--axes: figures are only drawn with"),
        (("map", "bennett", "--against", "1"), "--against: figures are only drawn"),
        (("map", "bennett", "--axes", "1,5", "--out", "nowhere"), "no joint 5"),
        (("map", "bennett", "--against", "5", "--out", "nowhere"), "no joint 5"),
        (("map", "bennett", "--axes", "1", "--out", "nowhere"), "2 to 3 joints"),
        (("map", "bennett", "--axes", "1,1", "--out", "nowhere"), "all different"),
        (("map", "bennett", "--axes", "0,1", "--out", "nowhere"), "no joint 0"),
        (("map", "bennett", "--axes", "1,two", "--out", "nowhere"), "no joint two"),
        (("map", "bennett", "--axes", "1,,2", "--out", "nowhere"), "'1,,2'"),
        (("map", "bennett", "--axes", "1,theta1", "--out", "nowhere"), "named twice"),
        (("map", "bennett", "--against", "1,2", "--out", "nowhere"), "one joint"),
    ],
)
def test_bad_input_ends_with_one_line_and_writes_nothing(
    arguments, message, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    result = bifurc(*arguments)
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert message in result.stderr
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


@pytest.mark.parametrize("axes", ["2,4", "1,2,4"])
def test_a_map_is_drawn_over_the_joints_that_are_named(axes, tmp_path):
    usual, other = tmp_path / "usual", tmp_path / "other"
    assert bifurc("map", "bennett", "--out", usual).exit_code == 0
    result = bifurc("map", "bennett", "--out", other, "--axes", axes, "--against", 3)
    assert result.exit_code == 0, result.output
    for name in ("singular_values.svg", "transition_map.svg"):
        assert (other / name).read_bytes() != (usual / name).read_bytes()
    same = "joint_angles.svg"
    assert (other / same).read_bytes() == (usual / same).read_bytes()


def test_joints_of_a_mechanism_go_by_their_names(tmp_path):
    path = tmp_path / "crank.toml"
    path.write_text(mechanism_toml(slider_crank()))
    runs = {"names": ("J4,J1", "J1"), "numbers": ("4,1", "1")}
    for folder, (axes, against) in runs.items():
        options = ("--axes", axes, "--against", against)
        run = bifurc("map", path, "--out", tmp_path / folder, *options)
        assert run.exit_code == 0, run.output
    for name in ("singular_values.svg", "transition_map.svg"):
        one, other = tmp_path / "names" / name, tmp_path / "numbers" / name
        assert one.read_bytes() == other.read_bytes()
    wrong = bifurc("map", path, "--out", tmp_path / "nowhere", "--axes", "J1,J5")
    assert wrong.exit_code == 2
    assert "no joint J5" in wrong.stderr
    assert "the names are J1, J2, J3, J4" in wrong.stderr


def test_a_joint_that_is_called_by_a_number_is_meant_by_its_name():
    names = ["5", "1", "2"]
    assert [number_of(word, names) for word in ("1", "5", "3", "4")] == [2, 1, 3, None]
