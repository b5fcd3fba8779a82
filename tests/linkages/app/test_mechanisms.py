"""Mechanisms on the command line: maps, JSON, files, locks, and what is refused."""

import json
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

from bifurc.files.dataset import load_atlas
from linkages.app.cli import main
from linkages.app.commands.map_command import write_numbers
from linkages.app.texts import mechanism_text
from linkages.app.texts.mechanism_text import describe_joints
from linkages.files.mechanism_file import mechanism_toml
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import mechanism_of
from linkages.readout.readout import Readout
from tests.linkages.app.slider_cranks import slider_crank_text
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import platform

SLIDER_CRANK = slider_crank_text((60, 80), 120)
FIVE_BAR = """
fixed = ["A", "E"]
bars = [["A", "B"], ["B", "C"], ["C", "D"], ["D", "E"]]
[points]
A = [0, 0]
B = [0.3, 1.1]
C = [1.4, 1.9]
D = [2.6, 1.0]
E = [2.2, 0]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("slider_crank.toml").write_text(SLIDER_CRANK, encoding="utf-8")
    Path("five_bar.toml").write_text(FIVE_BAR, encoding="utf-8")
    return tmp_path


def run(*arguments, code=0):
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == code, result.output
    return result


def test_the_json_document_of_a_mechanism_has_variables_by_joint_name(folder):
    document = json.loads(run("map", "slider_crank.toml", "--json").stdout)
    assert document["linkage"] == {"name": "slider-crank"}
    assert (document["mobility"], document["gruebler"]) == (1, -2)
    first, second = document["bifurcations"]
    for bifurcation in (first, second):
        assert list(bifurcation["variables"]) == ["J1", "J2", "J3", "J4"]
        # at the crank's pivot, in the unit of the file
        assert bifurcation["variables"]["J4"] == pytest.approx(-120.0)
        assert bifurcation["theta"] == list(bifurcation["variables"].values())
    crank, turning = document["forms"]
    assert crank["ranges"]["J4"]["low"] == pytest.approx(-320.0)
    assert crank["ranges"]["J4"]["high"] == pytest.approx(80.0)
    assert crank["ranges"]["J1"]["turns"] == 1
    assert crank["still_joints"] == [] and crank["bodies_as_one"] == []
    assert turning["still_joints"] == ["J2", "J4"]
    assert turning["bodies_as_one"] == [["frame", "slider"], ["crank", "rod"]]
    mechanism = document["mechanism"]
    assert mechanism["bodies"] == ["frame", "crank", "rod", "slider"]
    assert mechanism["variables"][3]["unit"] == "length"
    assert mechanism["variables"][3]["limits"] == [-640.0, 640.0]
    (loop,) = mechanism["loops"]
    assert (loop["constraints"], loop["redundant"]) == (6, 3)
    assert {point["variable"] for point in document["dead_points"]} == {"J4"}


def test_a_loop_keeps_its_document_and_has_two_counts_more(folder):
    document = json.loads(run("map", "bennett", "--json").stdout)
    assert (document["mobility"], document["gruebler"]) == (1, -2)
    assert "mechanism" not in document
    assert "variables" not in document["forms"][0]


def test_the_summary_names_joints_limits_and_counts(folder):
    output = run("map", "slider_crank.toml", "--verbose").stdout
    assert "Followed within limits: J4 from -640 to 640." in output
    assert "Mobility 1; Grübler's count is -2, and 1 in a plane." in output
    assert "J1, J2, J3, J4 (deg, lengths)" in output
    assert "length (rad, lengths over " in output
    assert "Completeness (certified)" in output
    assert "frame = slider, crank = rod" in output


def test_a_route_over_slides_is_not_in_degrees(folder):
    output = run("route", "slider_crank.toml", "Form 1", "Form 2").stdout
    assert "(rad, lengths over " in output
    assert "deg in joint space" not in output
    # the slide stands still on the second leg: no 3.6e-15
    assert "e-1" not in output


def test_forms_of_platforms_have_certificates_on_screen_and_in_json(folder):
    one_free = platform((None, *(0.0,) * 5))
    Path("platform.toml").write_text(mechanism_toml(one_free), encoding="utf-8")
    output = run("map", "platform.toml", "--verbose").stdout
    table = output.split("Certificates (each form is one arc of solutions)")[1]
    assert "Form 1  certified" in table
    assert "not certified between (rad)" not in table
    assert "not certified between (lengths over 3.209)" in table
    document = json.loads(run("map", "platform.toml", "--json").stdout)
    certificates = [form["certificate"] for form in document["forms"]]
    assert {one["status"] for one in certificates} == {"certified"}
    assert not any(one["refused"] or one["blurred"] for one in certificates)


def test_counts_on_a_sphere_stand_beside_those_in_space(folder):
    text = mechanism_toml(
        mechanism_of_case(cases()["Miura-ori, one vertex (spherical 4R)"])
    )
    Path("vertex.toml").write_text(text, encoding="utf-8")
    output = run("map", "vertex.toml", "--verbose").stdout
    assert "Grübler's count is -2, and 1 on a sphere." in output


def test_locks_are_in_degrees_and_make_forms_of_a_surface(folder):
    document = json.loads(
        run("map", "five_bar.toml", "--lock", "A=20", "--json").stdout
    )
    assert document["mobility"] == 1
    assert document["gruebler"] == 1
    for form in document["forms"]:
        assert form["variables"]["A"] == pytest.approx(0.3490658503988659)
        assert "A" in form["still_joints"]


def test_a_driver_holds_as_many_joints_as_it_takes_and_says_which(folder):
    result = run("map", "five_bar.toml", "--drive", "A", "--json")
    assert "also held where they are in the reference configuration: B" in result.stderr
    document = json.loads(result.stdout)
    assert document["mobility"] == 1
    assert document["mechanism"]["variables"][1]["locked"] == 0.0


def test_dead_points_are_those_of_the_joint_that_drives(folder):
    Path("long_rod.toml").write_text(slider_crank_text((0.6, 0.8), 2.5))
    shown = {}
    for words in ((), ("--drive", "J3")):
        text = run("map", "long_rod.toml", *words).stdout
        table = text.partition("Dead points")[2].partition("\n\n")[0]
        shown[words] = {line.split()[0] for line in table.splitlines()[2:]}
    # the crank turns round; the slide has limits
    assert shown == {(): {"J4"}, ("--drive", "J3"): {"J3", "J4"}}


def test_files_of_a_mechanism_can_be_read_again(folder):
    Path("out").mkdir()
    written = write_numbers(map_linkage(load("slider_crank.toml")), Path("out"))
    assert [path.name for path in written] == [
        "atlas.nc",
        "graph.graphml",
        "mechanism.graphml",
        "summary.txt",
    ]
    atlas = load_atlas("out/atlas.nc")
    mechanism = mechanism_of(atlas)
    assert [joint.name for joint in mechanism.joints] == ["J1", "J2", "J3", "J4"]
    output = run("route", "out/atlas.nc", "Form 1", "Form 2").stdout
    assert "turn J1" in output and "2 legs" in output


def test_singular_points_are_confirmed_in_many_digits(folder):
    output = run("map", "slider_crank.toml", "--digits", "40").stdout
    assert "Confirmation at 40 digits" in output
    assert output.count("quadratic") >= 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("identify", "slider_crank.toml"), "a prismatic joint (J4)"),
        (("identify", "four-bennett-network"), "--without-centre"),
        (("export", "slider_crank.toml", "--to", "x.sdf"), "it is a mechanism"),
        (("verify", "slider_crank.toml"), "slider_crank.toml"),
        (("map", "slider_crank.toml", "--lock", "J9=1"), "one of J1, J2, J3, J4"),
        (("map", "slider_crank.toml", "--lock", "J1"), "of the form key=value"),
        (("map", "slider_crank.toml", "--lock", "J1=x"), "--lock J1"),
        (("map", "five_bar.toml", "--lock", "A=1", "--lock", "A=2"), "given twice"),
        (("map", "slider_crank.toml", "--drive", "J9"), "joint variables J1"),
        (("map", "bennett", "--lock", "1=40"), "takes a mechanism"),
        (("map", "slider_crank.toml", "--param", "a=1"), "one of J1.x, J1.y, J2.x"),
    ],
)
def test_what_a_mechanism_cannot_do_is_said_in_one_line(folder, arguments, message):
    before = set(Path().iterdir())
    result = run(*arguments, code=2)
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert set(Path().iterdir()) == before


def test_parts_of_a_saved_mechanism_in_space_are_refused_as_those_of_its_file(folder):
    of_cylinders = mechanism_of_case(cases()["Bennett geometry with joints CRCR"])
    Path("crcr.toml").write_text(mechanism_toml(of_cylinders), encoding="utf-8")
    run("map", "crcr.toml", "--out", "out")
    for source in ("crcr.toml", "out/atlas.nc"):
        told = run("export", source, "--to", "x.stl", code=2).stderr
        assert f"{source}: it is a mechanism, which" in told


def test_parts_of_a_planar_mechanism_lie_in_layers_or_what_meets_is_said(folder):
    pytest.importorskip("build123d", reason="solids need the extra 'cad'")
    Path("crank.toml").write_text(slider_crank_text((30, 40), 130), encoding="utf-8")
    run("map", "crank.toml", "--out", "out")
    output = run("export", "out/atlas.nc", "--to", "crank.step").stdout
    assert output.startswith("3 layers, no fewer will do\n")
    assert "parts that share one keep 0.3 mm apart" in output
    text = Path("crank.step").read_text(encoding="utf-8")
    assert all(f"'{name}'" in text for name in ("rod", "slider", "pin J2", "cap J4"))
    # the slider passes the pivot of its crank
    result = run("export", "slider_crank.toml", "--to", "x.stl", code=8)
    assert "pin J1 and pin J4" in result.stdout
    assert "no layers keep all parts apart" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not Path("x.stl").exists()
    told = run("export", "crank.toml", "--to", "x.stl", "--offsets", "1", code=2).stderr
    assert "--offsets: it has no effect on a planar mechanism" in told


def test_the_clearance_of_a_planar_mechanism_is_that_in_its_layers(folder):
    Path("crank.toml").write_text(slider_crank_text((30, 40), 130), encoding="utf-8")
    output = run("clearance", "crank.toml", "--diameter", "3", "--form", "1").stdout
    assert output.startswith("3 layers, no fewer will do\n")
    assert "bodies that share a joint are left out" in output
    text = run("clearance", "crank.toml", "--diameter", "3", "--json").stdout
    forms = json.loads(text)
    assert [form["form"] for form in forms] == ["Form 1", "Form 2"]
    bodies = {"frame", "crank", "rod", "slider"}
    assert forms[0]["layers"]["bodies"].keys() == bodies
    assert forms[0]["layers"]["pins"].keys() == {f"pin J{k}" for k in range(1, 5)}
    names = {name for one in forms[0]["approaches"] for name in one["links"]}
    assert names and names <= bodies
    assert all(one["clearance"] > 0 for one in forms[0]["approaches"])
    # what has no line of its own is in the way of nothing
    plate = '[[joints]]\nname = "W"\nkind = "rigid"\nbodies = ["rod", "plate"]\n'
    with_plate = slider_crank_text((30, 40), 130) + plate
    Path("crank.toml").write_text(with_plate, encoding="utf-8")
    assert "plate" in run("clearance", "crank.toml", "--form", "1").stdout
    if find_spec("build123d"):
        told = run("export", "crank.toml", "--to", "x.stl", code=2).stderr
        assert "kind of joint W: rigid is not allowed" in told


def test_layers_may_be_given_and_stay_in_the_atlas(folder):
    text = slider_crank_text((30, 40), 130)
    Path("given.toml").write_text(
        "layers = {frame = 2, rod = 1}\n" + text, encoding="utf-8"
    )
    output = run("clearance", "given.toml", "--diameter", "3").stdout
    assert "frame and pin J2" in output.split("What meets in the given layers")[1]
    run("map", "given.toml", "--out", "out")
    assert run("clearance", "out/atlas.nc", "--diameter", "3").stdout == output
    mechanism = mechanism_of(load_atlas("out/atlas.nc"))
    assert 'layers = {"frame" = 2, "rod" = 1}' in mechanism_toml(mechanism)
    for layers, told in (
        ("{rood = 1}", "body in layers"),
        ("{rod = 0.5}", "layer of rod"),
        ("{frame = 1, crank = 1}", "layer of frame and crank"),
        ("[1]", "a table, body = number"),
    ):
        Path("given.toml").write_text(f"layers = {layers}\n{text}", encoding="utf-8")
        error = run("clearance", "given.toml", code=2).stderr
        assert told in error
        assert len(error.strip().splitlines()) == 1


def test_a_mechanism_is_shown_in_motion_like_a_loop(folder):
    told = run("view", "slider_crank.toml", "--no-open").stderr
    assert "wrote slider_crank.html" in told
    run("map", "slider_crank.toml", "--out", "out")
    run("view", "out/atlas.nc", "--no-open")
    page = Path("out/map.html").read_text()
    assert Path("slider_crank.html").read_text() == page
    assert Path("atlas.html").read_text() == page


def test_all_joints_locked_leave_nothing_to_map(folder):
    locks = [word for joint in "ABCDE" for word in ("--lock", f"{joint}=0")]
    result = run("map", "five_bar.toml", *locks, code=2)
    assert "one is left to move" in result.stderr


def test_a_lock_is_in_degrees_also_where_the_file_counts_in_radians(folder):
    text = 'angles = "rad"\n' + SLIDER_CRANK
    text = text.replace('["frame", "crank"]', '["frame", "crank"]\nlimits = [-1, 1]')
    Path("in_radians.toml").write_text(text, encoding="utf-8")
    result = run("map", "in_radians.toml", "--lock", "J1=90", code=2)
    assert "90 deg" in result.stderr
    assert "-57.2958 to 57.2958 deg" in result.stderr


def test_a_command_on_names_says_that_it_takes_no_file(folder):
    result = run("verify", "slider_crank.toml", code=2)
    assert "a name of the catalogue is needed here, and no file" in result.stderr


def test_the_summary_says_which_variable_of_a_joint_is_locked():
    joints = [
        Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0, 1)),
        Joint("B", "cylindrical", ("a", "b"), (1, 0, 0), (0, 0.5, 1)),
        Joint("C", "cylindrical", ("b", "c"), (2, 2, 0.3), (0.3, 0.5, 1)),
        Joint("D", "cylindrical", ("c", "frame"), (0, 2, 1), (1, 0.2, 0.4)),
    ]
    locked = Mechanism(tuple(joints)).with_locks({"A": 0.0, "B.slide": 0.25})
    text = describe_joints(Readout(locked))
    assert re.search(r"A +revolute .* 0\.0000 deg\n", text)
    assert re.search(r"B +cylindrical .* slide 0\.25\n", text)


def rows_of(output, title):
    """The lines of a table of a summary, without its heads."""
    lines = output.split(f"{title}\n", 1)[1].split("\n\n", 1)[0].splitlines()
    return lines[1:]


def test_the_summary_lists_dead_points_by_variable_and_form(folder):
    output = run("map", "slider_crank.toml", "--verbose").stdout
    rows = rows_of(output, "Dead points (deg, lengths in the unit of the file)")
    document = json.loads(run("map", "slider_crank.toml", "--json").stdout)
    expected = {}
    # those of the joint that drives, which has none, and of the slide
    shown = {"J1", "J4"}
    assert {point["variable"] for point in document["dead_points"]} >= {"J4"}
    for point in document["dead_points"]:
        if point["variable"] not in shown:
            continue
        key = (point["variable"], point["form"])
        value = point["variables"][point["variable"]]
        expected.setdefault(key, []).append(value)
    assert len(rows) == len(expected) > 0
    for row in rows:
        label, shown, form = re.split("  +", row.strip())
        values = expected[label, form]
        factor = 1.0 if label == "J4" else np.degrees(1.0)
        assert np.allclose(
            [float(word) for word in shown.split(", ")],
            [factor * value for value in values],
            atol=1e-4,
        )


def test_many_dead_points_are_counted(folder, monkeypatch):
    monkeypatch.setattr(mechanism_text, "SHOWN", 1)
    output = run("map", "slider_crank.toml", "--verbose").stdout
    document = json.loads(run("map", "slider_crank.toml", "--json").stdout)
    shown = [one for one in document["dead_points"] if one["variable"] in ("J1", "J4")]
    assert f"Dead points: {len(shown)}, listed with --json, with those" in output


def test_the_configuration_of_the_file_is_named(folder):
    output = run("map", "slider_crank.toml").stdout
    assert re.search(r"^As drawn: Form \d at s = ", output, re.MULTILINE)
    assert "As drawn" not in run("map", "bennett").stdout


def test_a_slide_has_no_winding_and_limits_are_left(folder):
    rows = rows_of(run("map", "slider_crank.toml", "--verbose").stdout, "Forms")
    windings = [re.split("  +", row.strip())[3].split() for row in rows]
    assert {words[3] for words in windings} == {"-"}
    assert all(word != "-" for words in windings for word in words[:3])
    text = Path("slider_crank.toml").read_text()
    text = text.replace('name = "J1"', 'name = "J1"\nlimits = [-20, 30]', 1)
    Path("limited.toml").write_text(text)
    output = run("map", "limited.toml", "--verbose").stdout
    assert "leaves the limits" in output
    assert "left region" not in output


def test_rounding_noise_of_coordinates_is_shown_as_zero(folder):
    text = Path("slider_crank.toml").read_text()
    text = text.replace("[60, 80, 0]", "[60, 80, -4.6e-18]", 1)
    text = text.replace("direction = [1, 0, 0]", "direction = [1, 1e-31, 0]", 1)
    Path("noise.toml").write_text(text)
    rows = rows_of(run("map", "noise.toml", "--verbose").stdout, "Joints")
    cells = [re.split("  +", row.strip()) for row in rows]
    assert cells[1][3] == "60 80 0"
    assert cells[3][4] == "1 0 0"


def test_long_lists_of_motions_are_broken_into_lines():
    items = [f"J{number} turns once" for number in range(20)]
    lines = mechanism_text._lines(items)
    assert len(lines) > 1
    assert all(len(line) <= mechanism_text.WIDTH + 1 for line in lines)
    assert ", ".join(items) == " ".join(lines)


FLAP = """
[[joints]]
name = "F"
kind = "revolute"
bodies = ["slider", "flap"]
point = [9, 0, 0]
direction = [0, 0, 1]
"""


def test_what_hangs_is_said_in_text_json_and_dataset(folder):
    Path("flap.toml").write_text(SLIDER_CRANK + FLAP, encoding="utf-8")
    line = "body flap turns freely about F: mobility + 1; each form times a circle."
    assert line in run("map", "flap.toml").stdout
    text = run("map", "flap.toml", "--out", "out", "--verbose").stdout
    assert line in text
    assert "Mobility 1, 2 with what hangs; Grübler's count is -1" in text
    assert "F 0.00" not in text  # it has no range on a form
    document = json.loads(run("map", "flap.toml", "--json").stdout)["mechanism"]
    assert [one["bodies"] for one in document["hanging"]] == [["flap"]]
    assert document["holds_flaps"]
    with xarray.open_dataset("out/atlas.nc") as dataset:
        names = dataset.joint_variable_name.values.tolist()
        hangs = dataset.joint_variable_hangs.values.tolist()
    assert [name for name, one in zip(names, hangs, strict=True) if one] == ["F"]
    text = run("map", "flap.toml", "--with-flaps").stdout
    assert "moves with mobility 2" in text
    assert line not in text


def test_a_file_of_two_mechanisms_is_mapped_one_after_the_other(folder):
    second = SLIDER_CRANK[SLIDER_CRANK.index("[[joints]]") :]
    for name in ("frame", "crank", "rod", "slider"):
        second = second.replace(f'"{name}"', f'"{name}2"')
    second = re.sub(r'"(J\d)"', r'"\1b"', second)
    Path("two.toml").write_text(SLIDER_CRANK + second, encoding="utf-8")
    documents = json.loads(run("map", "two.toml", "--json").stdout)["parts"]
    alone = json.loads(run("map", "slider_crank.toml", "--json").stdout)
    for document in documents:
        lengths = [form["length"] for form in document["forms"]]
        assert lengths == pytest.approx([form["length"] for form in alone["forms"]])
    run("map", "two.toml", "--out", "out")
    assert Path("out/part-2/atlas.nc").is_file()
    assert "part 2" in run("map", "two.toml", "--part", "2").stdout
    result = run("view", "two.toml", "--out", "page.html", code=2)
    assert "2 mechanisms apart, of frame, frame2" in result.stderr
    assert "from 1 to 2" in run("map", "two.toml", "--part", "3", code=2).stderr
    names = [document["linkage"]["name"] for document in documents]
    confirmed = run("map", "two.toml", "--digits", "20").stdout
    assert [f"{name}\n\nConfirmation at 20" in confirmed for name in names] == [
        True
    ] * 2
