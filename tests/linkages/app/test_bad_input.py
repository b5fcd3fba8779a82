"""Bad input ends with one line on standard error and the exit code that it deserves:
never with a traceback, and nothing is written."""

import os
import resource
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import dask
import distributed  # noqa: F401  its settings stand before one of them is changed
import numpy as np
import pytest
from click.testing import CliRunner

import linkages.app.reports.verify
from bifurc.files.dataset import save_atlas
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.linkage import load
from linkages.mapping import map_linkage

TABLE = """
name = "mine"
angles = "deg"
lengths = [1.0, 2.0, 1.0, 2.0]
twists = [0, 0, 0, 0]
offsets = [0, 0, 0, 0]
"""
ONE_JOINT = 'angles = "deg"\nlengths = [1.0]\ntwists = [0]\noffsets = [0]\n'
RIGID = """
angles = "deg"
lengths = [1.5, 0.7, 1.2, 0.9, 1.1, 0.6]
twists = [50, 80, 30, 100, 60, 110]
offsets = [0.2, -0.3, 0.5, 0.1, -0.4, 0.6]
"""
TEXTS = {
    "mine.toml": TABLE,
    "empty.toml": "",
    "one_joint.toml": ONE_JOINT,
    "typo.toml": TABLE.replace("twists", "twist"),
    "radiants.toml": TABLE.replace('"deg"', '"radiants"'),
    "no_angles.toml": TABLE.replace('angles = "deg"', ""),
    "words.toml": TABLE.replace("[0, 0, 0, 0]", '["a", "b", "c", "d"]'),
    "infinite.toml": TABLE.replace("2.0", "inf"),
    "unequal.toml": TABLE.replace("[1.0, 2.0, 1.0, 2.0]", "[1.0, 2.0, 1.0, 2.0, 1.0]"),
    "number.toml": TABLE.replace("[1.0, 2.0, 1.0, 2.0]", "4"),
    "no_toml.toml": "lengths = [1.0, 2.0",
    "deep.toml": "lengths = " + 20_000 * "[",
    "digits.toml": TABLE.replace("2.0", "1" + 5000 * "0"),
    "tiny.toml": TABLE.replace("[1.0, 2.0, 1.0, 2.0]", "[1e-320, 0, 1e-320, 0]"),
    "huge.toml": TABLE.replace("2.0", "1" + 400 * "0"),
    "half.toml": 'angles = "deg"\nlengths = [1, 2, 1, 2]\n',
    "both.toml": TABLE + "points = [[0, 0, 0]]\n",
    "flat_axes.toml": "points = [[0, 0]]\ndirections = [[0, 0, 1]]\n",
    "rigid.toml": RIGID,
    "text.nc": "this is no NetCDF file",
    "empty.nc": "",
    "empty": "",
    "busy.zarr": "a file where a folder is to be",
}
BINARY = bytes(range(256))


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def messages(text):
    """The lines on standard error."""
    return text.splitlines()


@pytest.fixture(scope="module")
def atlas_bytes(tmp_path_factory):
    """A saved atlas of a linkage, and one of an equation, as bytes."""
    folder = tmp_path_factory.mktemp("atlases")
    save_atlas(map_linkage(load("kite")), folder / "kite.nc")
    circle = FunctionProblem(
        lambda u: np.array([u @ u - 1.0]), np.array([[-2.0, 2.0], [-2.0, 2.0]])
    )
    save_atlas(explore(circle), folder / "circle.nc")
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def folder(tmp_path, monkeypatch, atlas_bytes):
    """The current folder, with all sorts of files that are not what they should be."""
    for name, text in TEXTS.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "binary.toml").write_bytes(BINARY)
    (tmp_path / "binary.nc").write_bytes(BINARY)
    (tmp_path / "binary.zarr.journal").write_bytes(BINARY + b"\n")
    (tmp_path / "latin.toml").write_bytes(TABLE.replace("mine", "müller").encode("l1"))
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "folder.nc").mkdir()
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "file").write_text("in the way")
    (tmp_path / "other.zarr.journal").write_text('{"sweep": "another"}\n')
    kite = atlas_bytes["kite.nc"]
    (tmp_path / "kite.nc").write_bytes(kite)
    (tmp_path / "circle.nc").write_bytes(atlas_bytes["circle.nc"])
    (tmp_path / "truncated.nc").write_bytes(kite[: len(kite) // 2])
    (tmp_path / "damaged.nc").write_bytes(damaged(kite))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def damaged(content):
    """The same bytes, but for a stretch in the middle of the file."""
    middle = len(content) // 2
    return content[:middle] + bytes(2000) + content[middle + 2000 :]


def listing(folder):
    return {path: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


GRID = ("--param", "alpha=20:160:3")
BAD = {
    # commands and options
    "an unknown command": (("mpa", "bennett"), "the nearest is map"),
    "a command like no other": (("xyzzy",), "there is no command 'xyzzy'"),
    "an unknown option of bifurc": (("--nothing",), "No such option"),
    "an unknown option of a command": (("map", "kite", "--outt", "x"), "--out"),
    "no linkage": (("map",), "Missing argument"),
    "too many linkages": (("map", "kite", "kite"), "unexpected extra argument"),
    "no goal": (("route", "kite", "a"), "Missing argument 'TO'"),
    "an option without its value": (("map", "kite", "--seed"), "requires an argument"),
    # names
    "a name with a typo": (("map", "benett"), "the nearest names are bennett"),
    "a name with a typo to view": (("view", "benet"), "bennett"),
    "a name with a typo to show": (("show", "benet"), "bennett"),
    "a name with a typo to identify": (("identify", "benet"), "bennett"),
    "a name with a typo to verify": (("verify", "benet"), "bennett"),
    "a name with a typo to sweep": (("sweep", "benet", *GRID), "bennett"),
    "a name with a typo for tolerance": (("tolerance", "benet"), "bennett"),
    "a name with a typo for a route": (("route", "kitee", "a", "b"), "kite"),
    "an empty name": (("map", ""), "no linkage is called ''"),
    "a name that is very long": (("map", "x" * 5000), ""),
    # numbers of options
    "a seed below zero": (("map", "kite", "--seed", "-5"), "not in the range"),
    "a seed too large to store": (("map", "kite", "--seed", 2**63), "not in the range"),
    "a word for a seed": (("map", "kite", "--seed", "x"), "not a valid integer"),
    "no starts": (("map", "kite", "--starts", 0), "0 is not in the range"),
    "far too many starts": (("map", "kite", "--starts", 10**12), "not in the range"),
    "no budget": (("map", "kite", "--budget", 0), "0.0 is not in the range"),
    "a budget below zero": (("map", "kite", "--budget", -1), "not in the range"),
    "a budget that is no number": (("map", "kite", "--budget", "nan"), "nan"),
    "a tolerance that is no number": (("map", "kite", "--tolerance", "nan"), "nan"),
    "a tolerance of zero": (("map", "kite", "--tolerance", 0), "not in the range"),
    "a tolerance too small": (("map", "kite", "--tolerance", 1e-30), "1e-14<=x<=1e-07"),
    "a tolerance too large": (("map", "kite", "--tolerance", 1e-4), "1e-14<=x<=1e-07"),
    "an infinite tolerance": (("map", "kite", "--tolerance", "inf"), "1e-14<=x<=1e-07"),
    "too few digits": (("map", "kite", "--digits", 5), "5 is not in the range"),
    "digits with JSON": (("map", "kite", "--digits", 50, "--json"), "--digits"),
    "no tolerance to identify": (("identify", "kite", "--tolerance", "nan"), "nan"),
    "a tolerance to identify below zero": (
        ("identify", "kite", "--tolerance", -1),
        "not in the range",
    ),
    "an infinite tolerance to identify": (
        ("identify", "kite", "--tolerance", "inf"),
        "not in the range",
    ),
    "no members": (("verify", "bennett", "--members", 0), "not in the range"),
    "no points": (("verify", "bennett", "--points", 0), "not in the range"),
    "an error that is no number": (("tolerance", "kite", "--error", "nan"), "nan"),
    "an error below zero": (("tolerance", "kite", "--error", -1e-4), "not in the"),
    "an infinite error": (("tolerance", "kite", "--error", "inf"), "not in the range"),
    "no copies": (("tolerance", "kite", "--samples", 0), "not in the range"),
    # parameters
    "an unknown parameter": (("map", "bennett", "--param", "gamma=3"), "alpha, beta"),
    "a parameter without a value": (
        ("map", "bennett", "--param", "alpha"),
        "key=value",
    ),
    "a parameter that is no number": (
        ("map", "bennett", "--param", "alpha=x"),
        "--param alpha: 'x'",
    ),
    "a parameter that is not finite": (
        ("map", "bennett", "--param", "alpha=inf"),
        "--param alpha: inf",
    ),
    "a parameter given twice": (
        ("map", "bennett", "--param", "alpha=70", "--param", "alpha=80"),
        "--param alpha",
    ),
    "a parameter given twice for tolerance": (
        ("tolerance", "bennett", "--param", "alpha=70", "--param", "alpha=80"),
        "--param alpha",
    ),
    "parameters that make no linkage": (
        ("map", "bennett", "--param", "alpha=200"),
        "alpha",
    ),
    "lengths beyond the range of doubles": (
        ("map", "bennett", "--param", "a=1e308"),
        "choose a unit",
    ),
    "a twist beyond half a turn": (
        ("map", "bennett", "--param", "alpha=270"),
        "(270 deg) is not allowed; it must be between 0 and 3.14159 rad (0 and 180 deg)",
    ),
    "lengths that vanish": (("map", "tiny.toml"), "choose a unit"),
    "a number beyond all doubles": (("map", "huge.toml"), "huge.toml"),
    "a parameter that a file does not have": (
        ("map", "mine.toml", "--param", "a=1"),
        "one of a12, alpha12, R1",
    ),
    "parameters for an atlas": (
        ("route", "kite.nc", "kite", "folded", "--param", "a=1"),
        "--param",
    ),
    # linkage files
    "a missing file": (("map", "nowhere.toml"), "there is no such file"),
    "an empty file": (("map", "empty.toml"), "empty.toml"),
    "an empty file without an ending": (("map", "empty"), "empty"),
    "a file with one joint": (("map", "one_joint.toml"), "4 to 12 joints"),
    "a key with a typo": (("map", "typo.toml"), "the nearest is 'twists'"),
    "an unknown unit": (("map", "radiants.toml"), '"deg" or "rad"'),
    "a missing unit": (("map", "no_angles.toml"), '"deg" or "rad"'),
    "words for numbers": (("map", "words.toml"), "a number"),
    "an infinite length": (("map", "infinite.toml"), "a finite number"),
    "lists of unequal length": (("map", "unequal.toml"), "5, the number of lengths"),
    "a number for a list": (("map", "number.toml"), "a list of numbers"),
    "a file that is no TOML": (("map", "no_toml.toml"), "is not valid TOML"),
    "lists too deep inside each other": (("map", "deep.toml"), "too deep"),
    "a number of 5000 digits": (("map", "digits.toml"), "is not valid TOML"),
    "half a table": (("map", "half.toml"), "twists"),
    "a table and axes": (("map", "both.toml"), "not both"),
    "axes in a plane": (("map", "flat_axes.toml"), ""),
    "a binary file": (("map", "binary.toml"), "is not UTF-8 text"),
    "a file in Latin-1": (("map", "latin.toml"), "is not UTF-8 text"),
    "a folder for a file": (("map", "folder.toml"), "folder.toml"),
    "a folder for a linkage": (("map", "folder"), "folder"),
    "an empty file to identify": (("identify", "empty.toml"), "empty.toml"),
    "a binary file for tolerance": (("tolerance", "binary.toml"), "is not UTF-8"),
    "a NetCDF file to map": (("map", "kite.nc"), "is a map that is made already"),
    # atlases
    "a missing atlas": (("route", "nowhere.nc", "a", "b"), "there is no such file"),
    "an empty atlas": (("route", "empty.nc", "a", "b"), "empty.nc"),
    "a text for an atlas": (("route", "text.nc", "a", "b"), "text.nc"),
    "a binary file for an atlas": (("route", "binary.nc", "a", "b"), "binary.nc"),
    "a truncated atlas": (("route", "truncated.nc", "a", "b"), "truncated.nc"),
    "a damaged atlas": (("route", "damaged.nc", "a", "b"), "damaged.nc"),
    "a folder for an atlas": (("route", "folder.nc", "a", "b"), "is a folder"),
    "an atlas of no linkage": (("route", "circle.nc", "Form 1", "Form 1"), "circle.nc"),
    "an unknown form": (("route", "kite.nc", "kite", "nothing"), "it must be one of"),
    "a form with a typo": (("route", "kite.nc", "kit form", "folded"), "'kite form'"),
    "a missing atlas to view": (("view", "nowhere.nc"), "there is no such file"),
    "a damaged atlas to view": (("view", "damaged.nc"), "damaged.nc"),
    "an atlas of no linkage to view": (("view", "circle.nc"), "not of a linkage"),
    "parameters for an atlas to view": (
        ("view", "kite.nc", "--param", "a=1"),
        "--param",
    ),
    # models, tables, clearances
    "a name with a typo to export": (("export", "benet", "--to", "a.glb"), "bennett"),
    "an export to nowhere": (("export", "kite"), "Missing option '--to'"),
    "an export of an unknown kind": (
        ("export", "kite", "--to", "a.obj"),
        "it must end with .glb or .csv",
    ),
    "an export in no folder": (("export", "kite", "--to", "no/a.glb"), "no such"),
    "an export of an unknown form": (
        ("export", "kite.nc", "--to", "a.glb", "--form", "nothing"),
        "it must be one of",
    ),
    "an export of a form beyond the last": (
        ("export", "kite.nc", "--to", "a.glb", "--form", "7"),
        "a number from 1 to 2",
    ),
    "an export of a form without a name": (
        ("export", "kite.nc", "--to", "a.glb", "--form", ""),
        "form ''",
    ),
    "an export of the only form without a name": (
        ("export", "bennett", "--to", "a.glb", "--form", " "),
        "form ' '",
    ),
    "an export of a form of very many digits": (
        ("export", "kite.nc", "--to", "a.glb", "--form", "1" * 5000),
        "a number from 1 to 2",
    ),
    "an export of a form twice": (
        (*("export", "kite.nc", "--to", "a.glb"), "--form", 1, "--form", 1),
        "named already",
    ),
    "an export of a route twice": (
        (*("export", "kite.nc", "--to", "a.glb"), *2 * ("--route", "kite", "folded")),
        "named already",
    ),
    "an export of a route without names": (
        ("export", "kite.nc", "--to", "a.glb", "--route", "", ""),
        "--route '' '': form ''",
    ),
    "an export of a route without length as a table": (
        ("export", "kite.nc", "--to", "a.csv", "--route", "folded", "folded"),
        "--route 'folded' 'folded': it begins and ends in one configuration",
    ),
    "an export of a route without length as a model": (
        ("export", "kite.nc", "--to", "a.glb", "--route", "folded", "folded"),
        "--route 'folded' 'folded': it begins and ends in one configuration",
    ),
    "an export of endlessly many configurations": (
        ("export", "kite.nc", "--to", "a.glb", "--count", "inf"),
        "not a valid integer",
    ),
    "an export of an atlas with options of a search": (
        ("export", "kite.nc", "--to", "a.glb", "--seed", 3),
        "no effect on a saved atlas",
    ),
    "an export of one configuration": (
        ("export", "kite.nc", "--to", "a.glb", "--count", "1"),
        "not in the range",
    ),
    "an export of an atlas of no linkage": (
        ("export", "circle.nc", "--to", "a.glb"),
        "not of a linkage",
    ),
    "a clearance of links of no number": (
        ("clearance", "kite", "--diameter", "nan"),
        "nan",
    ),
    "a clearance of links of less than nothing": (
        ("clearance", "kite", "--diameter", -1),
        "not in the range",
    ),
    "a clearance of links without end": (
        ("clearance", "kite", "--diameter", "inf"),
        "inf is not in the range 0<=x<=1e+100",
    ),
    "a clearance of a form without a name": (
        ("clearance", "bennett", "--form", ""),
        "form ''",
    ),
    "a clearance of a form twice": (
        ("clearance", "kite.nc", "--form", 1, "--form", 1),
        "named already",
    ),
    "a clearance of an unknown form": (
        ("clearance", "kite.nc", "--form", "nothing"),
        "it must be one of",
    ),
    # pages
    "a page in no folder": (("view", "kite", "--out", "nowhere/a.html"), "no such"),
    "a folder for a page": (("view", "kite", "--out", "folder"), "is a directory"),
    "a page where none can be": (("view", "kite", "--out", "/proc/a.html"), "/proc/a"),
    "a device for a page": (("view", "kite", "--out", "/dev/full"), "/dev/full"),
    "a page that is no page": (
        ("view", "kite", "--out", "x.txt"),
        "--out x.txt: it must end with .html",
    ),
    "a page without a name": (("view", "kite", "--out", ""), "no name of a file"),
    "a page of an atlas with options of a search": (
        ("view", "kite.nc", "--budget", 3),
        "no effect on a saved atlas",
    ),
    # folders
    "a file for the folder of a map": (("map", "kite", "--out", "empty"), "empty"),
    "a full device for a folder": (("map", "kite", "--out", "/dev/full"), "/dev/full"),
    "a folder below a file": (("map", "kite", "--out", "empty/out"), "empty/out"),
    "a folder where none can be": (("map", "kite", "--out", "/proc/out"), "/proc/out"),
    "a file for the folder of tolerance": (
        ("tolerance", "kite", "--out", "empty"),
        "empty",
    ),
    "a folder where none can be for tolerance": (
        ("tolerance", "kite", "--out", "/proc/out"),
        "/proc/out",
    ),
    # sweeps
    "a sweep with no grid": (("sweep", "bennett"), "no grid"),
    "a sweep with a seed below zero": (
        ("sweep", "bennett", *GRID, "--seed", -5),
        "not in the range",
    ),
    "a sweep with no starts": (
        ("sweep", "bennett", *GRID, "--starts", 0),
        "0 is not in the range",
    ),
    "a sweep with no workers": (
        ("sweep", "bennett", *GRID, "--workers", 0),
        "not in the range",
    ),
    "a sweep of no members": (("sweep", "bennett", "--random", 0), "not in the range"),
    "a sweep over an unknown parameter": (
        ("sweep", "bennett", "--param", "gamma=1:2:3"),
        "a, alpha, beta",
    ),
    "a sweep over half a number": (
        ("sweep", "bennett", "--param", "alpha=1:2:2.5"),
        "a whole number",
    ),
    "a sweep over far too many": (
        ("sweep", "bennett", "--param", "alpha=1:2:1e18"),
        "a whole number",
    ),
    "a sweep over a range without --random": (
        ("sweep", "bennett", "--param", "alpha=1:2"),
        "first:last:count",
    ),
    "a parameter of a sweep given twice": (
        ("sweep", "bennett", *GRID, *GRID),
        "given only once",
    ),
    "a file for a dataset": (
        ("sweep", "bennett", *GRID, "--out", "busy.zarr"),
        "busy.zarr",
    ),
    "a folder of other things for a dataset": (
        ("sweep", "bennett", *GRID, "--out", "folder"),
        "not the dataset of a sweep",
    ),
    "the journal of another sweep": (
        ("sweep", "bennett", *GRID, "--out", "other.zarr"),
        "belongs to another sweep",
    ),
    "a binary file for a journal": (
        ("sweep", "bennett", *GRID, "--out", "binary.zarr"),
        "is no journal",
    ),
    "a dataset where no folder is": (
        ("sweep", "bennett", *GRID, "--out", "nowhere/out.zarr"),
        "nowhere/out.zarr",
    ),
    "a dataset where nothing can be written": (
        ("sweep", "bennett", *GRID, "--out", "/proc/out.zarr"),
        "/proc/out.zarr",
    ),
    "a scheduler that does not answer": (
        ("sweep", "bennett", *GRID, "--scheduler", "tcp://127.0.0.1:9"),
        "no scheduler answers",
    ),
    "a scheduler that is no address": (
        ("sweep", "bennett", *GRID, "--scheduler", "somewhere"),
        "--scheduler somewhere",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input_ends_with_one_line_and_exit_code_2(what, folder):
    arguments, message = BAD[what]
    before = listing(folder)
    with dask.config.set({"distributed.comm.timeouts.connect": "200ms"}):
        result = bifurc(*arguments)
    assert isinstance(result.exception, SystemExit), result.exc_info
    assert result.exit_code == ExitCode.BAD_INPUT
    assert result.stdout == ""
    assert len(messages(result.stderr)) == 1, result.stderr
    assert result.stderr.startswith("Error: ")
    assert message in result.stderr
    assert listing(folder) == before


# --- input that is good, and an answer that is not what was hoped for -----------------

ENDINGS = {
    "a search that could look at nothing": (
        ("map", "bennett", "--budget", "1e-9", "--json"),
        ExitCode.NOTHING_KNOWN,
        "is not known",
    ),
    "a route where nothing is known": (
        ("route", "bennett", "a", "b", "--budget", "1e-9"),
        ExitCode.NOTHING_KNOWN,
        "is not known",
    ),
    "a route of a linkage that does not move": (
        ("route", "rigid.toml", "a", "b"),
        ExitCode.DOES_NOT_MOVE,
        "is rigid",
    ),
    "the clearance of a linkage that does not move": (
        ("clearance", "rigid.toml"),
        ExitCode.DOES_NOT_MOVE,
        "is rigid",
    ),
    "the model of a linkage that does not move": (
        ("export", "rigid.toml", "--to", "a.glb"),
        ExitCode.DOES_NOT_MOVE,
        "is rigid",
    ),
    "the page of a linkage that does not move": (
        ("view", "rigid.toml", "--no-open"),
        ExitCode.DOES_NOT_MOVE,
        "is rigid",
    ),
    "a model of a route that there is not": (
        (
            *("export", "bricard-line-symmetric", "--to", "a.glb"),
            *("--route", "Form I (", "Form II ("),
        ),
        ExitCode.NO_ROUTE,
        "no route",
    ),
    "the tolerance of a linkage that does not move": (
        ("tolerance", "rigid.toml"),
        ExitCode.DOES_NOT_MOVE,
        "is rigid",
    ),
    "a route between forms that are not connected": (
        ("route", "bricard-line-symmetric", "Form I (", "Form II ("),
        ExitCode.NO_ROUTE,
        "no route",
    ),
}


@pytest.mark.parametrize("what", ENDINGS)
def test_an_answer_that_was_not_hoped_for_has_its_own_exit_code(what, folder):
    arguments, code, message = ENDINGS[what]
    result = bifurc(*arguments)
    assert isinstance(result.exception, SystemExit), result.exc_info
    assert result.exit_code == code
    told = [line for line in messages(result.stderr) if not line.startswith("wrote ")]
    assert len(told) == 1, result.stderr
    assert message in told[0]


def test_a_search_that_could_look_at_nothing_does_not_say_that_the_loop_stays_open():
    result = bifurc("map", "bennett", "--budget", "1e-9")
    assert result.exit_code == ExitCode.NOTHING_KNOWN
    assert "whether the linkage moves is not known" in result.stdout
    assert "no real configuration" not in result.stdout


# --- Ctrl-C ---------------------------------------------------------------------------


def interrupt(*arguments, **options):
    raise KeyboardInterrupt


STEPS = {
    ("list",): "linkages.catalogue.catalogue",
    ("show", "bennett"): "linkages.catalogue.entry",
    ("identify", "bennett"): "linkages.identification.identify.identify",
    ("verify", "bennett"): "linkages.app.reports.verify.verify",
    ("map", "bennett"): "linkages.app.atlas_source.explore_linkage",
    ("route", "bennett", "a", "b"): "linkages.app.atlas_source.explore_linkage",
    ("view", "kite"): "linkages.app.atlas_source.explore_linkage",
    ("export", "kite", "--to", "a.glb"): "linkages.app.atlas_source.explore_linkage",
    ("clearance", "kite"): "linkages.app.atlas_source.explore_linkage",
    ("tolerance", "kite"): "linkages.app.reports.tolerance.measure",
    ("sweep", "bennett", *GRID): "linkages.app.sweep.run.prepare_sweep",
}


@pytest.mark.parametrize("arguments", STEPS, ids=lambda arguments: arguments[0])
def test_ctrl_c_ends_every_command_with_one_line(arguments, folder, monkeypatch):
    monkeypatch.setattr(STEPS[arguments], interrupt)
    result = bifurc(*arguments)
    assert isinstance(result.exception, SystemExit), result.exc_info
    assert result.exit_code == ExitCode.INTERRUPTED
    assert result.stdout == ""
    assert len(messages(result.stderr)) == 1
    assert "interrupted" in result.stderr


@pytest.mark.parametrize(
    "command", [("route", "kite", "a", "b"), ("view", "kite"), ("tolerance", "kite")]
)
def test_half_a_map_is_no_map_for_other_commands(command, monkeypatch):
    monkeypatch.setattr("bifurc.search.tracing.trace_branch", interrupt)
    result = bifurc(*command)
    assert result.exit_code == ExitCode.INTERRUPTED
    assert "interrupted" in result.stderr.splitlines()[-1]


def test_what_was_verified_before_ctrl_c_is_in_the_document(monkeypatch):
    verify = linkages.app.reports.verify.verify
    names = iter(["bennett"])

    def one(*arguments):
        if next(names, None) is None:
            raise KeyboardInterrupt
        return verify("bennett")

    monkeypatch.setattr(linkages.app.reports.verify, "verify", one)
    result = bifurc("verify", "--json")
    assert result.exit_code == ExitCode.INTERRUPTED
    assert result.stdout.startswith('[{"name": "bennett"')


# --- places where nothing can be written ----------------------------------------------

PROGRAM = "from linkages.app.cli import main; main()"


def start(*arguments, **options):
    root = str(Path(__file__).parents[3])
    environment = {**os.environ, "PYTHONPATH": root}
    command = [sys.executable, "-c", PROGRAM, *map(str, arguments)]
    return subprocess.Popen(
        command, env=environment, stderr=subprocess.PIPE, text=True, **options
    )


def test_a_reader_who_goes_away_is_no_error():
    process = start("map", "kite", "--json", stdout=subprocess.PIPE)
    process.stdout.close()
    assert messages(process.stderr.read()) == []
    assert process.wait() == ExitCode.DONE


def test_standard_output_on_a_full_disk_ends_with_one_line():
    with open("/dev/full", "w") as full:
        process = start("list", stdout=full)
        message = process.stderr.read()
    assert process.wait() == ExitCode.BAD_INPUT
    assert len(messages(message)) == 1
    assert "No space left" in message


@contextmanager
def full_disk(monkeypatch):
    """Files of this process may grow to 4 kB and no further; it leaves no half of the
    byte code of a module."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    before, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (before, most))


def test_a_full_disk_keeps_what_is_on_the_screen(tmp_path, monkeypatch):
    with full_disk(monkeypatch):
        result = bifurc("map", "kite", "--out", tmp_path)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "The linkage moves with mobility 1" in result.stdout
    assert len(messages(result.stderr)) == 1, result.stderr
    assert f"--out {tmp_path}" in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("export", "bennett", "--to"), "old.glb"),
        (("export", "bennett", "--to"), "old.csv"),
        (("view", "bennett", "--no-open", "--out"), "old.html"),
        (("figure", "004-6", "--out"), "figures"),
    ],
)
def test_a_full_disk_names_the_option_and_leaves_older_files(
    arguments, name, tmp_path, monkeypatch
):
    out = tmp_path / name
    if out.suffix:
        out.write_text("old", encoding="utf-8")
    with full_disk(monkeypatch):
        result = bifurc(*arguments, out)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert len(messages(result.stderr)) == 1, result.stderr
    assert f"{arguments[-1]} {out}: nothing can be written there" in result.stderr
    if out.suffix:
        assert out.read_text(encoding="utf-8") == "old"
        assert list(tmp_path.iterdir()) == [out]
    else:
        assert list(tmp_path.iterdir()) == []


def test_the_dataset_of_another_sweep_is_left_alone(tmp_path):
    pytest.importorskip("zarr")
    from linkages.app.sweep.plan import read_plan
    from linkages.app.sweep.store import SweepStore

    out = tmp_path / "a.zarr"
    SweepStore(out, read_plan("bennett", ["alpha=20:160:5"]))
    before = listing(tmp_path)
    result = bifurc("sweep", "bennett", *GRID, "--out", out)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "belongs to another sweep" in result.stderr
    assert listing(tmp_path) == before


def test_a_sweep_with_a_failed_member_has_its_own_exit_code(tmp_path, monkeypatch):
    pytest.importorskip("zarr")
    counts = {"MAPPED": 2, "FAILED": 1}
    monkeypatch.setattr("linkages.app.sweep.store.count_status", lambda _: counts)
    monkeypatch.setattr("linkages.app.sweep.run.prepare_sweep", idle_sweep)
    result = bifurc("sweep", "bennett", *GRID, "--out", tmp_path / "a.zarr")
    assert result.exit_code == ExitCode.DOES_NOT_HOLD
    assert "2 mapped, 1 failed" in result.stdout


@contextmanager
def idle_sweep(*arguments, **options):
    """A sweep that maps nothing."""
    yield SimpleNamespace(run=lambda progress: None)


@pytest.mark.parametrize(
    "line",
    [
        "map typo.toml",
        "map bennett --lock 2=40",
        "map bennett --axes 1,9",
        "map four-bennett-network --lock x=1",
        "tolerance rigid.toml",
        "solve empty.toml",
    ],
)
def test_bad_input_leaves_no_folder(line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("typo.toml", "rigid.toml", "empty.toml"):
        Path(name).write_text(TEXTS[name], encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    result = CliRunner().invoke(main, [*line.split(), "--out", "new/deep"])
    assert result.exit_code
    assert sorted(tmp_path.iterdir()) == before


def test_a_folder_that_was_there_remains(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("out").mkdir()
    result = CliRunner().invoke(main, ["map", "nobody", "--out", "out"])
    assert result.exit_code
    assert Path("out").is_dir()
