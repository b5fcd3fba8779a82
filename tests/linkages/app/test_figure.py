"""The command `bifurc figure`, and the axes of the figures of `bifurc map`."""

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.source_figures.table import source_figures


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
        (("map", "bennett", "--axes", "0,1", "--out", "nowhere"), "'0,1'"),
        (("map", "bennett", "--axes", "1,two", "--out", "nowhere"), "'1,two'"),
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
