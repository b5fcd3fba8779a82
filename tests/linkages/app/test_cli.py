"""The command line, in one process; what is written to disk, and signals, are in their
own files."""

import json
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import linkages.app
from linkages.app import start
from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.arrays.entries import MECHANISMS
from linkages.catalogue import catalogue
from linkages.closure.closure import Closure
from linkages.linkage import load
from linkages.loop import Loop
from linkages.networks.entries import NETWORKS
from tests.linkages.app.slider_cranks import slider_crank_text

MINE = """
name = "my linkage"
angles = "deg"
lengths = [1.0, 2.0, 1.0, 2.0]
twists = [0, 0, 0, 0]
offsets = [0, 0, 0, 0]
"""
KEYS = {
    "linkage": {"name", "lengths", "twists", "offsets"},
    "mobility": None,
    "gruebler": None,
    "forms": {
        "name",
        "dimension",
        "closed",
        "length",
        "winding",
        "inactive_joints",
        "symmetry",
        "sample",
        "max_residual",
        "misclosure",
        "min_singular_value",
        "component",
        "certificate",
    },
    "bifurcations": {"theta", "rank", "forms", "tangents", "error"},
    "rank_drops": {"theta", "rank", "form"},
    "other_singular_points": {"theta", "kind", "rank", "error", "forms"},
    "near_misses": {"theta", "singular_value", "error", "form"},
    "dead_points": {"theta", "joint", "form"},
    "rigid_assemblies": None,
    "near_motions": {"name", "misclosure", "length", "closed", "mobility", "sample"},
    "completeness": {
        "level",
        "certainty",
        "statement",
        "missed_probability",
        "claims",
        "doubts",
    },
    "seconds": None,
    "version": None,
    "seed": None,
    "tolerance": None,
}


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def write(tmp_path):
    def to_file(text, name="mine.toml"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return to_file


# --- list and show ------------------------------------------------------------------------------------


def test_list_names_every_linkage_network_sheet_and_array():
    result = bifurc("list")
    assert result.exit_code == 0
    listed = [line.split()[:2] for line in result.stdout.splitlines()[1:]]
    assert [name for name, _ in listed] == [*catalogue(), *NETWORKS, *MECHANISMS]
    assert ["special-double-subtractive-goldberg", "6"] in listed


def test_show_gives_source_parameters_and_geometry_in_degrees():
    result = bifurc("show", "bennett")
    assert result.exit_code == 0
    for expected in (
        "Bennett 1903",
        "100 deg",
        "sin(alpha)/a = sin(beta)/b",
        "Misprints",
    ):
        assert expected in result.stdout


@pytest.mark.parametrize("command", [(), ("list",), ("show",), ("map",), ("route",)])
def test_help_has_an_example(command):
    result = bifurc(*command, "--help")
    assert result.exit_code == 0
    assert f"bifurc {' '.join(command)}".strip() in result.stdout.split("Example")[1]


# --- map ----------------------------------------------------------------------------------------------


def test_map_shows_forms_and_bifurcations_in_degrees():
    result = bifurc("map", "special-double-subtractive-goldberg")
    assert result.exit_code == 0
    assert "4 forms in 1 component, 4 bifurcations" in result.stdout
    assert "3 at 180.0000, 6 at 180.0000" in result.stdout
    assert "Certainty (counted): no motion is missing" in result.stdout
    assert "rigid" not in result.stdout.lower()
    assert len(result.stdout.splitlines()) <= 25
    assert len(result.output.splitlines()) <= 25 + 3
    whole = bifurc("map", "special-double-subtractive-goldberg", "--verbose").stdout
    assert "Completeness (counted): " in whole
    assert "Certificates" in whole


def test_what_can_be_done_next_can_be_typed():
    result = bifurc("map", "special-double-subtractive-goldberg")
    steps = [line for line in result.stderr.splitlines() if line.startswith("next: ")]
    assert len(steps) == 3
    route = shlex.split(steps[0].removeprefix("next: bifurc "))
    assert route[0] == "route"
    assert bifurc(*route).exit_code == 0


def _next_steps(*arguments):
    lines = bifurc(*arguments).stderr.splitlines()
    steps = [line for line in lines if line.startswith("next: ")]
    return [shlex.split(step.removeprefix("next: bifurc ")) for step in steps]


def test_next_steps_are_about_what_was_mapped(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = "lengths = {}\ntwists = {}\noffsets = [0, 0, 0, 0]\nangles = 'deg'\n"
    rounded = table.format([1, 0.501, 1, 0.501], [90, 30, 90, 30])
    Path("rounded.toml").write_text(rounded)
    # in the modified convention the link stands before its joint
    modified = table.format([0.5, 1, 0.5, 1], [30, 90, 30, 70])
    Path("modified.toml").write_text(modified)
    identify, draw, view = _next_steps("map", "rounded.toml", "--nearest")
    assert bifurc(*identify).exit_code == 0
    assert bifurc(*draw[:-1], "exact").exit_code == 0
    assert bifurc(*view, "--no-open").exit_code == 0
    assert _next_steps("map", "rounded.toml", "--nearest", "--out", "out") == []
    source = load("special-double-subtractive-goldberg").loop
    Path("source.toml").write_text(
        f"lengths = {[round(x, 4) for x in source.lengths]}\nangles = 'deg'\n"
        f"twists = {[round(float(np.degrees(x)), 3) for x in source.twists]}\n"
        f"offsets = {list(source.offsets)}\n"
    )
    (route,) = _next_steps("map", "source.toml", "--nearest", "--out", "source")
    assert route[0] == "route"
    assert bifurc(*route).exit_code == 0
    for step in _next_steps("map", "modified.toml", "--modified-dh"):
        assert "--modified-dh" in step
    longer, *_ = _next_steps("map", "rounded.toml", "--budget", "1e-6")
    assert longer == ["map", "rounded.toml", "--budget", "1e-05"]


TABLE = """
lengths = [1, 0.501, 1, 0.501]
twists = [90, 30, 90, 30]
offsets = [0, 0, 0, 0]
angles = "deg"
"""
EQUATIONS = """
equations = ["x^2 + y^2 = 1"]
[unknowns]
x = [-2, 2]
y = [-2, 2]
"""
BRICARD = "bricard-line-symmetric-zero-offset"


@pytest.mark.parametrize(
    "command",
    [
        ("solve", "circle.toml"),
        ("identify", "bennett"),
        ("identify", "table.toml"),
        ("identify", "table.toml", "--write", "written.toml"),
        ("route", BRICARD, "Form I (original)", "Form I' (revised)"),
        ("export", "bennett", "--to", "bennett.mjcf"),
        ("export", "bennett", "--to", "bennett.csv"),
        ("convert", "two_bars.toml", "two_bars.xml"),
    ],
    ids=" ".join,
)
def test_every_answer_names_commands_that_can_be_typed(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("circle.toml").write_text(EQUATIONS)
    Path("table.toml").write_text(TABLE)
    Path("two_bars.toml").write_text(slider_crank_text((0.6, 0.8), 2.5))
    steps = _next_steps(*command)
    assert 1 <= len(steps) <= 3
    for step in steps:
        quiet = ["--no-open"] if step[0] == "view" else []
        fewer = ["--count", "2", "--size", "2x2"] if step[0] == "animate" else []
        done = (ExitCode.DONE, ExitCode.NOT_IN_CATALOGUE)
        assert bifurc(*step, *quiet, *fewer).exit_code in done


def test_what_is_given_to_another_command_is_said(tmp_path):
    equations, table = tmp_path / "circle.toml", tmp_path / "table.toml"
    equations.write_text(EQUATIONS)
    table.write_text(TABLE)
    for command in ("map", "identify"):
        assert f"`bifurc solve {equations}`" in bifurc(command, str(equations)).stderr
    for linkage in ("bennett", str(table)):
        assert f"`bifurc map {linkage}`" in bifurc("solve", linkage).stderr


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("bennett", "it takes a file with a table, and bennett is none"),
        ("axes.toml", "it takes a file with a table, and axes.toml is none"),
        ("craig.csv", "the headings of craig.csv say so themselves"),
    ],
)
def test_the_modified_convention_is_for_tables_that_do_not_say_so(
    source, message, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("axes.toml").write_text(
        "points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n"
        "directions = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]]\n"
    )
    rows = "1, 90, 0\n0.5, 30, 0\n" * 2
    Path("craig.csv").write_text(f"a(i-1), alpha(i-1) (deg), d(i)\n{rows}")
    assert bifurc("map", source).exit_code == 0
    result = bifurc("map", source, "--modified-dh")
    assert result.exit_code == 2
    assert message in result.stderr


def test_json_is_one_document_with_the_documented_keys_and_nothing_else():
    result = bifurc("map", "reconfigurable-bricard-1", "--json", "--seed", 7)
    assert result.exit_code == 0
    assert result.stderr == ""
    document = json.loads(result.stdout)
    assert set(document) == set(KEYS)
    for key, inner in KEYS.items():
        value = document[key]
        for item in value if isinstance(value, list) else [value]:
            assert inner is None or set(item) == inner, key
    assert document["seed"] == 7
    assert document["tolerance"] == 1e-13
    assert document["completeness"]["level"] == "complete slices"
    assert document["completeness"]["certainty"] == "counted"


HEAVY = ("matplotlib", "xarray", "sympy", "mpmath", "scipy")


def test_commands_load_nothing_that_they_do_not_need(tmp_path):
    system = tmp_path / "circle.toml"
    system.write_text(
        'equations = ["x^2 + y^2 = 1"]\n[unknowns]\nx = [-2, "sqrt(3)"]\ny = [-2, 2]\n'
    )
    for words in (["map", "bennett", "--json"], ["solve", str(system)]):
        script = (
            f"import sys, linkages.app.cli as c; c.main({words}, standalone_mode=False)\n"
            f"print([m for m in {HEAVY} if m in sys.modules], file=sys.stderr)"
        )
        command = [sys.executable, "-c", script]
        result = subprocess.run(command, capture_output=True, text=True, check=True)
        assert result.stderr.splitlines()[-1] == "[]"


@pytest.mark.parametrize("words", [[], ["solve", "--help"]])
def test_the_help_is_there_where_python_drops_texts(words):
    script = f"import linkages.app.cli as c; c.main({words})"
    texts = [
        subprocess.run(
            [sys.executable, *flags, "-c", script],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for flags in ([], ["-OO"])
    ]
    assert "solution curves" in texts[0]
    assert texts[0] == texts[1]


def test_files_and_figures_load_neither_xarray_nor_scipy_optimize(tmp_path):
    """Each takes longer to import than a map takes."""
    script = (
        "import sys, linkages.app.cli as c; c.main(['map', 'special-double-subtractive-goldberg', '--out', sys.argv[1]], standalone_mode=False)\n"
        "heavy = ('xarray', 'pandas', 'scipy.optimize', 'matplotlib.pyplot', 'sympy')\n"
        "print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    command = [sys.executable, "-c", script, str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert result.stderr.splitlines()[-1] == "[]"
    assert (tmp_path / "form_graph.png").exists()


def test_json_speaks_of_radians_joints_from_1_and_relative_residuals():
    document = json.loads(
        bifurc("map", "special-double-subtractive-goldberg", "--json").stdout
    )
    loop_angles = np.array([b["theta"] for b in document["bifurcations"]])
    assert np.abs(np.sin(loop_angles)).max() < 1e-11  # all joints at 0 or pi
    inactive = {form["name"]: form["inactive_joints"] for form in document["forms"]}
    assert inactive["Form II (Bennett 4R)"] == [3, 6]
    for bifurcation in document["bifurcations"]:
        assert set(bifurcation["forms"]) <= set(inactive)
        assert len(bifurcation["tangents"]) == len(bifurcation["forms"]) == 2
        assert bifurcation["rank"] == 4
    assert {d["joint"] for d in document["dead_points"]} <= set(range(1, 7))
    problem = closure_of(document)
    for form in document["forms"]:
        certificate = form["certificate"]
        assert certificate["status"] == "certified up to the singular points"
        assert certificate["refused"] == certificate["blurred"] == []
        assert 0 < form["max_residual"] < 1e-12
        assert form["min_singular_value"] == 0
        assert np.abs(problem.residuals(np.array([form["sample"]]))).max() < 1e-12
        assert np.abs(form["sample"]).max() <= np.pi + 1e-9


def test_a_map_without_certificates_has_none():
    result = bifurc("map", "bennett", "--json", "--no-certify")
    (form,) = json.loads(result.stdout)["forms"]
    assert form["certificate"] is None
    assert "Certificates" not in bifurc("map", "bennett", "--no-certify").stdout


def closure_of(document):
    geometry = document["linkage"]
    return Closure(Loop(geometry["lengths"], geometry["twists"], geometry["offsets"]))


def test_parameters_of_kind_angle_are_given_in_degrees():
    document = json.loads(
        bifurc(
            "map", "bennett", "--param", "alpha=70", "--param", "a=2", "--json"
        ).stdout
    )
    assert document["linkage"]["twists"][0] == pytest.approx(np.radians(70), abs=1e-15)
    assert document["linkage"]["lengths"][0] == 2.0


def test_a_linkage_file_is_mapped(write):
    result = bifurc("map", write(MINE))
    assert result.exit_code == 0
    assert result.stdout.startswith("my linkage\n")
    assert "antiparallelogram form" in result.stdout


def test_degrees_taken_for_radians_are_warned_of_on_standard_error(write):
    path = write(MINE.replace("deg", "rad").replace("twists = [0", "twists = [100"))
    result = bifurc("map", path, "--json")
    assert "warning: twists[1] is 100" in result.stderr
    json.loads(result.stdout)


@pytest.mark.parametrize(("twist", "is_warned"), [("1.5708", True), ("5", False)])
def test_radians_taken_for_degrees_are_warned_of_on_standard_error(
    write, twist, is_warned
):
    result = bifurc(
        "identify", write(MINE.replace("twists = [0", f"twists = [{twist}"))
    )
    assert ('write angles = "rad"' in result.stderr) == is_warned


def test_a_surface_is_a_form_of_dimension_2(write):
    text = 'angles = "deg"\nlengths = [1, 1, 1, 1, 1.2]\ntwists = [0, 0, 0, 0, 0]\noffsets = [0, 0, 0, 0, 0]'
    result = bifurc("map", write(text), "--json", "--starts", 30)
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert [form["dimension"] for form in document["forms"]] == [2]
    extra = {"note", "factors", "charts", "complete"}
    assert set(document["forms"][0]) == KEYS["forms"] | extra


DOES_NOT_MOVE = {
    "a linkage that nearly moves": (
        MINE.replace("[0, 0, 0, 0]\noffsets", "[0.1, 0, 0, 0]\noffsets"),
        "nearly moves",
    ),
    "no real configuration": (
        MINE.replace("1.0, 2.0, 1.0, 2.0", "10, 1, 1, 1"),
        "has no real configuration",
    ),
    "a rigid linkage": (
        'angles = "deg"\nlengths = [1.5, 0.7, 1.2, 0.9, 1.1, 0.6]\ntwists = [50, 80, 30, 100, 60, 110]\n'
        "offsets = [0.2, -0.3, 0.5, 0.1, -0.4, 0.6]",
        "is rigid",
    ),
}


@pytest.mark.parametrize("what", DOES_NOT_MOVE)
def test_a_linkage_that_does_not_move_is_said_to_be_what_it_is_with_exit_code_3(
    write, what
):
    text, expected = DOES_NOT_MOVE[what]
    path = write(text)
    result = bifurc("map", path)
    assert result.exit_code == 3
    assert expected in result.stdout
    as_json = bifurc("map", path, "--json")
    assert as_json.exit_code == 3
    assert json.loads(as_json.stdout)["forms"] == []
    assert expected in as_json.stderr


@pytest.mark.parametrize("relative", [1e-3, 1e-6, 1e-9])
def test_a_linkage_that_misses_its_condition_is_said_to_and_by_how_much(
    write, relative
):
    b = np.sin(np.radians(40)) / np.sin(np.radians(100))
    lengths = [1.0, float(b * (1 + relative)), 1.0, float(b)]
    text = f'angles = "deg"\nlengths = {lengths}\ntwists = [100, 40, 100, 40]\noffsets = [0, 0, 0, 0]'
    result = bifurc("map", write(text))
    assert result.exit_code == 3
    assert "misses closure by" in result.stdout
    gap = float(result.stdout.split("misses closure by ")[1].split()[0])
    assert 0.1 * relative < gap < 2 * relative
    assert "all along a closed path of 7" in result.stdout


# --- route --------------------------------------------------------------------------------------------


def test_route_lists_the_legs_and_how_far_each_joint_turns():
    result = bifurc(
        "route", "special-double-subtractive-goldberg", "Form I", "Bennett 4R"
    )
    assert result.exit_code == 0
    assert (
        "Route from Form I (constructive 6R) to Form II (Bennett 4R): 3 legs"
        in result.stdout
    )
    assert "turn 6" in result.stdout


def test_route_takes_a_saved_atlas(tmp_path):
    assert bifurc("map", "kite", "--out", tmp_path).exit_code == 0
    result = bifurc("route", tmp_path / "atlas.nc", "kite", "folded")
    assert result.exit_code == 0
    assert "Route from kite form to folded form (joints 1,3 inactive)" in result.stdout


def test_an_unknown_form_and_forms_that_are_not_connected_have_their_own_exit_codes():
    unknown = bifurc("route", "kite", "kite", "nothing")
    assert unknown.exit_code == 2
    assert "form 'nothing': it must be one of" in unknown.stderr
    apart = bifurc(
        "route", "bricard-line-symmetric", "Form I (original)", "Form II (original)"
    )
    assert apart.exit_code == 4
    assert "no route" in apart.stderr


def test_a_name_without_the_ending_of_a_file_leads_to_the_file(write, monkeypatch):
    monkeypatch.chdir(write(MINE).parent)
    result = bifurc("map", "mine")
    assert result.exit_code == 2
    assert "the nearest names are mine.toml" in result.stderr


def test_ctrl_c_during_the_imports_ends_in_one_line(monkeypatch, capsys):
    class Interrupted:
        @staticmethod
        def find_spec(name, path=None, target=None):
            if name == "linkages.app.cli":
                raise KeyboardInterrupt

    monkeypatch.delitem(sys.modules, "linkages.app.cli")
    monkeypatch.delattr(linkages.app, "cli")
    monkeypatch.setattr(sys, "meta_path", [Interrupted, *sys.meta_path])
    monkeypatch.setattr("bifurc.limits.hear_interrupts", lambda: None)
    with pytest.raises(SystemExit) as end:
        start.main()
    assert end.value.code == ExitCode.INTERRUPTED
    assert capsys.readouterr().err == "interrupted\n"


def test_ctrl_c_while_arguments_are_read_ends_in_one_line(monkeypatch):
    def interrupt(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("click.Group.parse_args", interrupt)
    result = bifurc("list")
    assert result.exit_code == ExitCode.INTERRUPTED
    assert result.stderr == "interrupted\n"
