"""The commands `export` and `clearance`."""

import io
import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from linkages.app.cli import main
from linkages.app.commands.export_command import make_table
from linkages.app.exit_codes import ExitCode
from linkages.export.glb import make_glb
from linkages.export.model import model_of, motion_of_form
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Shape
from linkages.subject import subject_at
from tests.linkages.export.test_glb import poses_of
from tests.linkages.viewing.conftest import mapped

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


PLACES = [(0, 0, 0), (0, 1, 0), (1, 2, 0), (2, 1, 0), (2, 0, 0)]
BODIES = ["frame", "a", "b", "c", "d"]


@pytest.fixture
def five_bar(tmp_path):
    """The file of a five-bar, which has mobility 2."""
    blocks = ['name = "five-bar"']
    for k, place in enumerate(PLACES):
        ends = BODIES[k], BODIES[(k + 1) % 5]
        blocks.append(
            f'[[joints]]\nname = "J{k + 1}"\nkind = "revolute"\n'
            f"bodies = {json.dumps(ends)}\n"
            f"point = {list(place)}\ndirection = [0, 0, 1]"
        )
    path = tmp_path / "five_bar.toml"
    path.write_text("\n".join(blocks))
    return path


NET = ("four-bennett-network", "--lock", "2=40", "--lock", "6=-75")


def test_a_mechanism_with_locks_is_a_model_whose_bodies_move_as_in_python(tmp_path):
    pygltflib = pytest.importorskip("pygltflib", reason="it opens the model again")
    out = tmp_path / "net.glb"
    result = bifurc("export", *NET, "--to", out, "--count", 9)
    assert result.exit_code == ExitCode.DONE, result.stderr
    gltf = pygltflib.GLTF2.load(out)
    kinks = {"2": np.radians(40), "6": np.radians(-75)}
    atlas = map_linkage(load(NET[0]).held(kinks))
    readout = subject_at(atlas).readout
    forms = {form.name: form for form in atlas.forms}
    assert {one.name for one in gltf.animations} == set(forms)
    for animation in gltf.animations:
        branch = forms[animation.name].branch
        expected = readout.poses(branch(np.linspace(0.0, branch.length, 9)))
        found = poses_of(gltf, animation)
        assert len(found) == len(readout.mechanism.bodies) - 1
        for body, poses in found.items():
            number = readout.mechanism.bodies.index(body)
            assert np.abs(poses - expected[:, number]).max() < 1e-6


def test_all_symbols_of_joints_are_closed_solids():
    trimesh = pytest.importorskip("trimesh", reason="it opens the model again")
    atlas = mapped("platform")
    motions = [motion_of_form(form, 5) for form in atlas.forms]
    model = model_of(subject_at(atlas).parts, "platform", motions)
    shapes = {symbol.shape for body in model.bodies for symbol in body.symbols}
    assert shapes == {Shape.BOX, Shape.BALL}
    content = make_glb(model, "a test")
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    for mesh in scene.geometry.values():
        mesh.merge_vertices(merge_norm=True, merge_tex=True)
        assert mesh.is_watertight
        assert mesh.volume > 0


def test_a_table_of_a_mechanism_has_its_joints_by_name(five_bar, tmp_path):
    out = tmp_path / "five.csv"
    result = bifurc("export", five_bar, "--lock", "J1=40", "--to", out, "--count", 7)
    assert result.exit_code == ExitCode.DONE, result.stderr
    assert out.read_text().splitlines()[0] == "arclength,J1,J2,J3,J4,J5"
    rows = np.loadtxt(out, delimiter=",", skiprows=1)
    assert rows[:, 1] == pytest.approx(np.full(7, np.radians(40)))
    assert np.abs(rows[:, 1:].sum(axis=1) - rows[0, 1:].sum()).max() < 1e-9


def test_a_table_of_a_mechanism_has_the_rotations_of_spherical_joints():
    atlas = mapped("platform")
    readout = subject_at(atlas).readout
    motion = motion_of_form(atlas.forms[0], 60)
    head, *lines = make_table(atlas, motion).splitlines()
    names = head.split(",")
    rows = np.loadtxt(lines, delimiter=",")
    poses = readout.poses(motion.configurations)
    bodies = readout.mechanism.bodies
    for joint in readout.mechanism.joints:
        if joint.kind != "spherical":
            continue
        columns = [names.index(f"{joint.name}.q{part}") for part in "xyzw"]
        quaternions = rows[:, columns]
        assert np.linalg.norm(np.diff(quaternions, axis=0), axis=1).max() < 0.5
        base, moved = (poses[:, bodies.index(body), :3, :3] for body in joint.bodies)
        turned = Rotation.from_quat(quaternions).as_matrix()
        assert np.abs(base @ turned - moved).max() < 1e-9


def test_without_its_centre_a_network_is_printed_and_measured_as_a_loop(tmp_path):
    straight = ("four-bennett-network", "--lock", "2=0", "--lock", "6=0")
    out = tmp_path / "net.glb"
    result = bifurc("export", *straight, "--without-centre", "--to", out)
    assert result.exit_code == ExitCode.DONE
    names = [node["name"] for node in nodes(out)]
    assert "link 12" in names


def nodes(path):
    """The nodes of a binary glTF file."""
    content = path.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    return json.loads(content[20 : 20 + length])["nodes"]


GIVEN = {
    "--route": ("Form I", "Form II"),
    "--count": ("9",),
    "--diameter": ("3",),
    "--play": ("0.2",),
    "--wall": ("1",),
    "--size": ("90",),
    "--unit": ("mm",),
    "--offsets": ("1,2,3,4",),
}
MOTION, PRINT = ("--route", "--count"), tuple(GIVEN)[2:]
TAKEN = {
    "glb": MOTION,
    "csv": MOTION,
    "stl": PRINT,
    "step": PRINT,
    "mjcf": (),
    "xml": (),
    "sdf": (),
}


@pytest.mark.parametrize("ending", TAKEN)
def test_options_without_effect_on_a_file_are_refused_by_name(tmp_path, ending):
    out = tmp_path / f"bennett.{ending}"
    for option, values in GIVEN.items():
        if option in TAKEN[ending]:
            continue
        result = bifurc("export", "bennett", "--to", out, option, *values)
        assert result.exit_code == ExitCode.BAD_INPUT
        assert f"{option}: it has no effect on bennett.{ending}" in result.stderr
        assert not out.exists()


def test_a_simulator_gets_one_form(tmp_path):
    out = tmp_path / "kite.sdf"
    forms = ("--form", 1, "--form", 2)
    result = bifurc("export", "kite", "--to", out, *forms)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "--form 2: kite.sdf holds one configuration" in result.stderr


EMPTY = [
    ("export", "kite", "--to"),
    ("view", "kite", "--no-open", "--out"),
    ("map", "kite", "--out"),
    ("figure", "thesis-2.1.1", "--out"),
    ("convert", "four-bennett-network"),
    ("sweep", "bennett", "--param", "alpha=20:40:2", "--out"),
    ("sweep", "bennett", "--param", "alpha=20:40:2", "--atlases"),
    ("tolerance", "kite", "--out"),
    ("network", "four-bennett-network", "--locks", "--out"),
    ("solve", "reaction.toml", "--out"),
]


@pytest.mark.parametrize("command", EMPTY, ids=" ".join)
@pytest.mark.parametrize("path", ["", " "])
def test_a_path_without_a_name_is_refused(command, path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = bifurc(*command, path)
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "is no name of a" in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ("view", "--no-open", "--out", "x.html"),
        ("route", "Form 1", "Form 2"),
        ("export", "--to", "x.glb"),
        ("clearance",),
    ],
    ids=lambda arguments: arguments[0],
)
def test_locks_have_no_effect_on_a_saved_atlas(atlas_file, tmp_path, arguments):
    command, *others = arguments
    result = bifurc(command, atlas_file, *others, "--lock", "J1=40", "--drive", "J2")
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "--lock, --drive: it has no effect on a saved atlas" in result.stderr


def test_a_mechanism_is_viewed_with_locks(five_bar, tmp_path):
    out = tmp_path / "five.html"
    result = bifurc("view", five_bar, "--no-open", "--out", out, "--lock", "J1=40")
    assert result.exit_code == ExitCode.DONE
    document = out.read_text(encoding="utf-8").split('id="bifurc-document"')[1]
    assert '"title": "five-bar, locked: J1=40\\u00b0"' in document
    driven = bifurc("view", five_bar, "--no-open", "--out", out, "--drive", "J1")
    assert driven.exit_code == ExitCode.DONE
    assert (
        "also held where they are in the reference configuration: J2" in driven.stderr
    )


def test_a_mechanism_is_converted_with_locks(tmp_path):
    out = tmp_path / "net.xml"
    assert bifurc("convert", *NET[:1], out, *NET[1:]).exit_code == ExitCode.DONE
    document = json.loads(bifurc("map", out, "--json").stdout)
    assert document["mobility"] == 1
