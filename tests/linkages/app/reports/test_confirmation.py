"""`bifurc map --digits`."""

import re

import mpmath
from click.testing import CliRunner

from linkages.app.choice import choose_precisely
from linkages.app.cli import main
from linkages.app.reports.confirmation import confirm_points
from linkages.catalogue import entry
from linkages.files.mechanism_file import mechanism_toml
from linkages.linkage import load
from linkages.mapping import map_linkage
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case

TABLE = 'angles = "deg"\nlengths = [1.0, 0.7, 1.0, 0.7]\ntwists = [0, 90, 0, 0.1]\noffsets = [0, 0, 0, 0]\n'


def test_every_error_that_a_map_states_holds():
    for name in ("kite", "serial-goldberg-6r"):
        found = list(confirm_points(map_linkage(load(name)), name))
        assert found
        for point, confirmation in found:
            assert confirmation.distance <= point.point.error < 1e-12
            assert confirmation.nullity == entry(name).build().n - point.point.rank


def test_the_digits_are_shown_for_every_singular_point():
    result = CliRunner().invoke(
        main, ["map", "kite", "--digits", "50", "--starts", "20"]
    )
    shown = result.output.split("Confirmation at 50 digits")[1]
    assert result.exit_code == 0
    assert "B1" in shown and "B2" in shown and "quadratic" in shown


def test_digits_do_not_go_with_json():
    result = CliRunner().invoke(main, ["map", "kite", "--digits", "50", "--json"])
    assert result.exit_code == 2 and "--digits" in result.output


def test_decimals_of_a_file_are_taken_as_written(tmp_path):
    path = tmp_path / "table.toml"
    path.write_text(TABLE)
    with mpmath.workdps(50):
        loop = choose_precisely(str(path))
        assert abs(loop.lengths[1] - mpmath.mpf(7) / 10) < mpmath.mpf(10) ** -49
        assert abs(loop.twists[1] - mpmath.pi / 2) < mpmath.mpf(10) ** -48


def test_rounded_numbers_of_a_file_are_no_contradiction(tmp_path):
    mechanism = mechanism_of_case(cases()["Miura-ori, one vertex (spherical 4R)"])
    path = tmp_path / "vertex.toml"
    path.write_text(mechanism_toml(mechanism), encoding="utf-8")
    result = CliRunner().invoke(main, ["map", str(path), "--digits", "40"])
    shown = result.output.split("Confirmation at 40 digits")[1]
    assert "rounded: the numbers of the linkage are rounded" in shown
    assert "contradict" not in shown
    gap = re.search(r"does not close there, by up to (\S+) ", shown)
    assert 0 < float(gap[1]) < 1e-12
