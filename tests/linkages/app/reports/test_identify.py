"""The command `bifurc identify`."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.files.mechanism_file import mechanism_toml
from linkages.mechanisms.of_loop import mechanism_of_loop

BENNETT = """
name = "mine"
angles = "deg"
lengths = [0.65270364, 1.0, {a34}, 1.0]
twists = [40, -100, 40, -100]
offsets = [0, 0, 0, 0]
"""


def identify(tmp_path, a34, *options):
    path = tmp_path / "mine.toml"
    path.write_text(BENNETT.format(a34=a34))
    return CliRunner().invoke(main, ["identify", str(path), *options])


def test_a_file_is_named_with_its_parameters_in_degrees(tmp_path):
    result = identify(tmp_path, 0.65270364, "--tolerance", "1e-7")
    assert result.exit_code == 0
    assert (
        "bennett: Bennett linkage, asymmetric set-up, 3 free parameters"
        in result.stdout
    )
    assert "40 deg" in result.stdout


def test_a_misprint_ends_with_its_own_code_and_is_named(tmp_path):
    result = identify(tmp_path, 0.66)
    assert result.exit_code == ExitCode.NOT_IN_CATALOGUE
    assert "No linkage of the catalogue" in result.stdout
    assert "suspicious: a34." in result.stdout
    assert "a34 would be 0.652704, not 0.66" in result.stdout


def test_the_exact_table_is_written_with_a_comment_at_each_number_that_changes(
    tmp_path,
):
    exact = tmp_path / "exact.toml"
    result = identify(tmp_path, 0.66, "--write", str(exact))
    assert result.exit_code == ExitCode.DONE
    text = exact.read_text()
    assert "# a34: 0.66 is printed (misprint)" in text
    assert "misprint" not in text.replace("a34: 0.66 is printed (misprint)", "")
    again = CliRunner().invoke(main, ["identify", str(exact)])
    assert again.exit_code == ExitCode.DONE
    assert "bennett: " in again.stdout


def test_what_is_far_from_everything_is_not_written(tmp_path):
    path, exact = tmp_path / "odd.toml", tmp_path / "exact.toml"
    path.write_text(
        'angles = "deg"\nlengths = [1, 1.7, 0.6, 2.1]\ntwists = [33, 71, 48, 97]\n'
        "offsets = [0.2, 0.5, -0.4, 0.9]\n"
    )
    arguments = ["identify", str(path), "--write", str(exact)]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == ExitCode.NOT_IN_CATALOGUE
    assert "--write: no linkage of the catalogue is near" in result.stderr
    assert not exact.exists()


def test_the_document_holds_parameters_that_build_the_table(tmp_path):
    document = json.loads(
        identify(tmp_path, 0.65270364, "--tolerance", "1e-7", "--json").stdout
    )
    (bennett,) = [match for match in document["matches"] if match["name"] == "bennett"]
    assert sorted(
        entry("bennett").build(**bennett["parameters"]).lengths
    ) == pytest.approx([0.65270364, 0.65270364, 1, 1], abs=1e-7)
    assert all(match["distance"] < 0.05 for match in document["nearest"])


def test_a_locked_joint_is_told():
    result = CliRunner().invoke(main, ["identify", "mixed-double-goldberg-type-iii"])
    assert result.exit_code == 0
    assert "With joint 3 locked at 0 deg: goldberg-5r" in result.stdout


def test_a_mechanism_of_one_loop_is_named_whatever_its_limits(tmp_path):
    loop = entry("goldberg-5r").build()
    seeds = Closure(loop).seeds(np.random.default_rng(0), 4)
    mechanism = mechanism_of_loop(loop, seeds.points[0])
    first, *others = mechanism.joints
    limited = (replace(first, limits=((-0.5, 0.5),)), *others)
    path = tmp_path / "mechanism.toml"
    text = mechanism_toml(replace(mechanism, joints=limited))
    path.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(main, ["identify", str(path)])
    assert result.exit_code == 0, result.output
    assert "goldberg-5r: " in result.stdout


def test_the_loop_that_a_network_leaves_is_named():
    locks = ["--lock", "2=40", "--lock", "6=-75", "--param", "beta=50"]
    arguments = ["identify", "four-bennett-network", *locks]
    result = CliRunner().invoke(main, [*arguments, "--without-centre"])
    assert result.exit_code == 0, result.output
    assert "generalized-double-goldberg: " in result.stdout
    refused = CliRunner().invoke(main, arguments)
    assert refused.exit_code == ExitCode.BAD_INPUT
    assert "--without-centre takes the single loop" in refused.stderr
