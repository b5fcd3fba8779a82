"""The commands `export` and `clearance`."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode

DSG = "special-double-subtractive-goldberg"


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def atlas_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("map")
    assert bifurc("map", DSG, "--out", folder).exit_code == ExitCode.DONE
    return folder / "atlas.nc"


def animations(path):
    """Names of the animations of a binary glTF file."""
    content = path.read_bytes()
    assert content[:4] == b"glTF"
    assert int.from_bytes(content[8:12], "little") == len(content)
    length = int.from_bytes(content[12:16], "little")
    document = json.loads(content[20 : 20 + length])
    return [animation["name"] for animation in document["animations"]]


def test_a_model_holds_all_forms_or_those_that_are_named(atlas_file, tmp_path):
    out = tmp_path / "dsg.glb"
    result = bifurc("export", atlas_file, "--to", out)
    assert result.exit_code == ExitCode.DONE
    assert len(animations(out)) == 4
    assert f"wrote {out}: Form I (constructive 6R), Form II" in result.stderr
    bifurc("export", atlas_file, "--to", out, "--form", "Form II", "--form", 4)
    assert animations(out) == ["Form II (Bennett 4R)", "Form IV (non-constructive 6R)"]
    route = ("--route", "Form I", "Bennett 4R")
    bifurc("export", atlas_file, "--to", out, *route, "--count", 60)
    (name,) = animations(out)
    assert name == "Form I (constructive 6R) to Form II (Bennett 4R)"


def test_a_table_holds_one_form(atlas_file, tmp_path):
    out = tmp_path / "dsg.csv"
    result = bifurc("export", atlas_file, "--to", out, "--form", 1, "--count", 11)
    assert result.exit_code == ExitCode.DONE
    assert len(out.read_text().splitlines()) == 12
    result = bifurc("export", atlas_file, "--to", out)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "a table holds one form or route, and there are 4" in result.stderr


@pytest.mark.parametrize("count", [2, 5, 60])
def test_a_table_of_a_route_has_as_many_rows_at_even_arclengths(
    atlas_file, tmp_path, count
):
    out = tmp_path / "route.csv"
    route = ("--route", "Form I", "Bennett 4R")
    result = bifurc("export", atlas_file, "--to", out, *route, "--count", count)
    assert result.exit_code == ExitCode.DONE
    rows = np.loadtxt(out, delimiter=",", skiprows=1)
    assert rows.shape == (count, 7)
    assert rows[:, 0] == pytest.approx(np.linspace(0, rows[-1, 0], count), abs=1e-12)
    steps = np.linalg.norm(np.diff(rows[:, 1:], axis=0), axis=1)
    assert steps.max() <= np.diff(rows[:, 0]).max() * (1 + 1e-9)
    route = ("--route", "Form I", "Form II")
    again = bifurc("export", atlas_file, "--to", out, *route, "--count", count)
    assert again.exit_code == ExitCode.DONE


def test_the_clearance_names_links_and_where_they_are_nearest(tmp_path):
    result = bifurc("clearance", "bricard-trihedral", "--diameter", 0.05)
    assert result.exit_code == ExitCode.DONE
    assert "Form 1: the least clearance is 0.4715" in result.stdout
    assert len(result.stdout.splitlines()) == 13
    assert "Links overlap where the clearance is below 0." in result.stdout


def test_the_clearance_as_json_is_in_radians():
    result = bifurc("clearance", "bennett", "--json")
    (form,) = json.loads(result.stdout)
    first, second = form["approaches"]
    assert first["links"] == ["12", "34"]
    assert first["clearance"] == pytest.approx(0, abs=1e-9)
    assert second["clearance"] > 0.3
    assert np.abs(second["theta"]).max() <= np.pi
    shown = bifurc("clearance", "bennett").stdout
    assert "Bennett form: the least clearance is 0 (links 12 and 34)" in shown


@pytest.mark.parametrize("ending", ["mjcf", "xml", "sdf"])
def test_a_loop_is_written_for_simulators_and_read_again(tmp_path, ending):
    out = tmp_path / f"bennett.{ending}"
    result = bifurc("export", "bennett", "--to", out)
    assert result.exit_code == ExitCode.DONE, result.stderr
    result = bifurc("map", out, "--json")
    assert result.exit_code == ExitCode.DONE, result.stderr
    document = json.loads(result.stdout)
    assert [form["length"] for form in document["forms"]] == pytest.approx(
        [12.8615], 1e-4
    )


def test_a_simulator_gets_no_route(tmp_path):
    out = tmp_path / "bennett.sdf"
    route = ("--route", "Form I", "Bennett 4R")
    result = bifurc(
        "export", "special-double-subtractive-goldberg", *route, "--to", out
    )
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "--route: it has no effect on bennett.sdf" in result.stderr
    assert not out.exists()
