"""Networks of Bennett loops on the command line."""

import csv
import json

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.networks.entries import NETWORKS

NETWORK = "four-bennett-network"
FEW = ("--starts", "20")


def run(*arguments):
    return CliRunner().invoke(main, list(arguments))


def test_list_and_show_know_networks():
    listed = run("list").output
    for name in NETWORKS:
        assert name in listed
    shown = run("show", NETWORK).output
    assert "Bars" in shown and "mobility: 3" in shown
    assert "it must be 1/3, 3/5, 5/7, 7/1" in shown
    assert run("network", NETWORK).output == shown


def test_map_locks_outer_joints_at_d_h_angles():
    locks = ("--lock", "2=40", "--lock", "6=-75")
    result = run("map", NETWORK, *locks, *FEW, "--verbose")
    assert result.exit_code == ExitCode.DONE
    assert "mobility 1: 2 forms in 2 components, 0 bifurcations" in result.output
    assert "Outer loop along the forms (D-H angles, deg)" in result.output
    assert "40.0000                        locked" in result.output


def test_json_gives_kinks_and_the_d_h_angles_of_every_configuration():
    result = run("map", NETWORK, "--lock", "2=40", "--lock", "4=-75", "--json", *FEW)
    document = json.loads(result.stdout)
    assert document["mobility"] == 1
    assert document["network"]["name"] == NETWORK
    kinks = document["network"]["kinks"]
    assert kinks == pytest.approx({"2": 0.6981317, "4": -1.3089969})
    (form,) = document["forms"]
    assert list(form["ring_angles"]) == list("12345678")
    assert form["ring_angles"]["2"] == pytest.approx(kinks["2"])
    assert form["variables"]["2"][0] == 0.0


def test_without_the_centre_the_single_loop_is_mapped_and_said_to_have_more():
    arguments = ("map", NETWORK, "--lock", "2=0", "--lock", "6=0", *FEW)
    result = run(*arguments, "--without-centre")
    assert "4 forms in 1 component, 4 bifurcations" in result.stdout
    assert "taking the middle away adds forms" in result.stderr
    assert "2 forms in 2 components, 0 bifurcations" in run(*arguments).stdout


def test_without_the_centre_joints_that_stand_still_are_replaced_as_well():
    locks = ("--lock", "1=40", "--lock", "2=-75", "--without-centre")
    result = run("map", NETWORK, *locks, *FEW, "--verbose")
    assert "for it does not move: 3" in result.stderr
    assert "five" not in result.stdout and "  5      51" in result.stdout


def test_one_joint_drives_a_network():
    result = run("map", NETWORK, "--drive", "1", *FEW)
    assert "also held where they are" in result.stderr
    assert "mobility 1" in result.stdout


def test_the_tables_of_locks_are_written(tmp_path, monkeypatch):
    from linkages.identification import locked_networks

    expected = ("generalized-goldberg-5r", "bennett")
    entries = tuple(e for e in locked_networks.distinct_entries() if e.name in expected)
    monkeypatch.setattr(locked_networks, "distinct_entries", lambda: entries)
    result = run("network", "serial-bennett-network", "--locks", "--out", str(tmp_path))
    assert result.exit_code == ExitCode.DONE
    page = (tmp_path / "locks.md").read_text(encoding="utf-8")
    assert "## 28 pairs of locks, 28 with a motion left" in page
    assert page.rstrip("\n") == result.stdout.rstrip("\n")
    with (tmp_path / "lock_pairs.csv").open(encoding="utf-8", newline="") as file:
        pairs = {row["locks"]: row for row in csv.DictReader(file)}
    assert len(pairs) == 28
    assert pairs["U0/U1"]["becomes"] == "4R"
    assert pairs["U0/U1"]["linkage"].startswith("bennett")
    assert pairs["U0/U2"]["stand still as well"] == "V0"
    assert pairs["U0/V0"]["mobility"] == "2"
    with (tmp_path / "lock_triples.csv").open(encoding="utf-8", newline="") as file:
        assert len(list(csv.DictReader(file))) == 56


def test_a_route_over_locks_is_shown():
    result = run(
        *("route", NETWORK, "--from", "2=40,6=-75@p4=90", "--to", "2=40,4=90"), *FEW
    )
    assert result.exit_code == ExitCode.DONE
    assert "1 exchange of locks, 0 deg" in result.output
    assert "lock 4=90, release 6=-75" in result.output
    assert "-2 turns" in result.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("map", NETWORK, "--lock", "9=40"), "one of the outer joints 1, 2"),
        (("map", NETWORK, "--lock", "2=x"), "it must be a number"),
        (("map", NETWORK, "--lock", "2=4", "--lock", "2=5"), "it is given twice"),
        (("map", NETWORK, "--param", "b=2"), "the Bennett ratio"),
        (("map", NETWORK, "--param", "epsilon=2"), "one of a, alpha"),
        (("map", NETWORK, "--param", "gamma=35"), "the twist of its neighbour"),
        (("map", "bennett", "--without-centre"), "bennett is none"),
        (("map", NETWORK, "--without-centre", "--digits", "30"), "--digits"),
        (("map", "four-benett-network"), "nearest names are four-bennett-network"),
        (("show", "four-benett-network"), "nearest names are four-bennett-network"),
        (("network", "bennett", "--locks"), "it is no network"),
        (("network", NETWORK, "--kinks", "1", "2"), "they go with --locks"),
        (("network", NETWORK, "--locks", "--kinks", "1", "inf"), "finite"),
        (("route", NETWORK, "--from", "2=40"), "both must be given"),
        (("route", "bennett", "--from", "2=4", "--to", "2=5"), "take a network"),
        (("route", NETWORK, "a", "--from", "2=4", "--to", "2=5"), "they replace"),
        (("route", NETWORK, "--from", "2=4,6=3@", "--to", "2=5,6=3"), "behind @"),
        (("route", NETWORK, "--from", "@4=3", "--to", "2=5,6=3"), "begin with locks"),
        (("route", NETWORK, "--from", "2=4", "--to", "2=5"), "they leave 2"),
        (("route", NETWORK), "Missing argument"),
        (("export", NETWORK, "--to", "x.stl"), "it is a mechanism"),
        (("export", NETWORK, "--to", "x.glb"), "held with --lock"),
    ],
)
def test_bad_input_is_refused(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert message in result.output
    assert not list(tmp_path.iterdir())
