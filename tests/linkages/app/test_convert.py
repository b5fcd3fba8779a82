from dataclasses import replace

import pytest
from click.testing import CliRunner

from linkages import load
from linkages.app.cli import main
from linkages.files.mechanism_file import mechanism_toml
from tests.linkages.formats.examples import EXAMPLES
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def slider_crank(tmp_path):
    path = tmp_path / "slider_crank.toml"
    path.write_text(mechanism_toml(EXAMPLES["slider_crank"]), encoding="utf-8")
    return path


def test_toml_is_read_as_it_was_written(slider_crank):
    mechanism = load(slider_crank)
    assert mechanism == EXAMPLES["slider_crank"]


def test_a_planar_mechanism_stays_one(tmp_path):
    mechanism = mechanism_of_case(cases()["K(2,3)"])
    path = tmp_path / "bars.toml"
    path.write_text(mechanism_toml(mechanism), encoding="utf-8")
    again = load(path)
    assert again.is_planar
    assert again.gruebler == mechanism.gruebler == 1


@pytest.mark.parametrize("ending", ["xml", "mjcf", "sdf", "toml"])
def test_a_mechanism_goes_to_another_format_and_back(ending, slider_crank, tmp_path):
    out = tmp_path / f"other.{ending}"
    result = bifurc("convert", slider_crank, out)
    assert result.exit_code == 0, result.output
    back = tmp_path / "back.toml"
    assert bifurc("convert", out, back).exit_code == 0
    mechanism = load(back)
    assert len(mechanism.joints) == 4
    assert mechanism.joint("J4").limits == ((-5.0, 1.0),)


@pytest.mark.parametrize(
    ("source", "out", "message"),
    [
        ("slider_crank.toml", "a.step", "it must end with"),
        ("missing.world", "a.xml", "there is no such file"),
        ("bennett", "a.xml", "it is a single loop"),
        ("broken.sdf", "a.xml", "broken.sdf: line 1"),
        ("slider_crank.toml", "no/a.xml", "OUT {folder}/no/a.xml: nothing"),
    ],
)
def test_nothing_is_written_where_it_cannot_be(
    source, out, message, slider_crank, tmp_path
):
    (tmp_path / "broken.sdf").write_text("<sdf", encoding="utf-8")
    given = source if source == "bennett" else tmp_path / source
    result = bifurc("convert", given, tmp_path / out)
    assert result.exit_code == 2
    assert message.format(folder=tmp_path) in result.stderr
    assert not (tmp_path / out).exists()


@pytest.mark.parametrize(("ending", "is_said"), [("toml", False), ("sdf", True)])
def test_a_rounding_that_a_file_cannot_hold_is_said(ending, is_said, tmp_path):
    mechanism = replace(EXAMPLES["slider_crank"], rounding=2e-12)
    source = tmp_path / "rounded.toml"
    source.write_text(mechanism_toml(mechanism), encoding="utf-8")
    result = bifurc("convert", source, tmp_path / f"other.{ending}")
    assert result.exit_code == 0, result.output
    assert ("known to 2e-12 only" in result.output) == is_said


def test_panels_of_sheets_and_files_bend_by_an_option(tmp_path):
    pattern, bent = tmp_path / "pattern.cp", tmp_path / "bent.toml"
    pattern.write_text("1 0 0 4 0\n1 4 0 4 4\n1 4 4 0 4\n1 0 4 0 0\n2 2 0 2 4\n")
    # two squares with a crease between them; three rows and columns of inner vertices
    for source, creases in ((pattern, 3), ("miura-ori", 24 + 16)):
        result = bifurc("convert", source, bent, "--triangulated")
        assert result.exit_code == 0, result.output
        assert len(load(bent).joints) == creases
    result = bifurc("map", pattern, "--triangulated", "--param", "f0-f1.x=1")
    assert "it must be left out with --triangulated" in result.output
    assert bifurc("map", "bennett", "--triangulated").exit_code == 2
