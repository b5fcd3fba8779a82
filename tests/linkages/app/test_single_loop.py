"""The commands on a mechanism that is a single loop: one name and one zero for a joint
in texts, figures, datasets, graphs and pages; JSON has the angles of the loop as
well."""

import json

import networkx as nx
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from bifurc.system import jacobian_at, relative_gaps
from bifurc.torus import SEAM
from linkages.app.cli import main
from linkages.closure.loop_closure import LoopClosure
from linkages.formats.table import mechanism_text
from linkages.linkage import load
from linkages.loop import Loop
from linkages.readout.readout import Readout
from tests.linkages.mechanisms.single_loops import catalogue_loop

DSG = "special-double-subtractive-goldberg"
# residual where angles so near to half a turn are put there (`bifurc.torus.wrap`)
AT_HALF_A_TURN = 10 * 2 * np.pi * SEAM
SEARCH = ("--starts", "20", "--no-certify")


def run(*words):
    result = CliRunner().invoke(main, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A file of the mechanism."""
    path = tmp_path_factory.mktemp("mechanism") / "dsg.toml"
    path.write_text(mechanism_text(catalogue_loop(DSG), path))
    return path


@pytest.fixture(scope="module")
def readout(path):
    return Readout(load(str(path)))


@pytest.fixture(scope="module")
def folder(path):
    """What `bifurc map --out` writes."""
    folder = path.parent / "out"
    run("map", path, *SEARCH, "--out", folder, "--axes", "c,a", "--against", "f")
    return folder


@pytest.fixture(scope="module")
def document(path):
    """What `bifurc map --json` prints."""
    return json.loads(run("map", path, *SEARCH, "--json").stdout)


def names_of(readout):
    return [joint.name for joint in readout.mechanism.joints]


def test_dataset_graph_and_text_call_joints_by_their_names(folder, readout):
    names = names_of(readout)
    with xr.open_dataset(folder / "atlas.nc") as dataset:
        assert dataset["joint"].values.tolist() == names
        assert set(dataset["unit"].values.tolist()) == {"rad"}
        assert "linkage_lengths" not in dataset
    graph = nx.read_graphml(folder / "graph.graphml")
    keys = {key for _, _, data in graph.edges(data=True) for key in data}
    assert {f"travel_{name}" for name in names} <= keys
    summary = (folder / "summary.txt").read_text()
    assert f"{', '.join(names)} (deg)" in summary


def test_figures_and_page_call_joints_by_their_names(folder, readout):
    page = (folder / "map.html").read_text()
    assert all(f'"name": "{name}", "column"' in page for name in names_of(readout))
    for figure in ("transition_map", "singular_values"):
        svg = (folder / f"{figure}.svg").read_text()
        assert "theta" not in svg


def test_points_of_the_dataset_are_the_variables_of_the_text_and_json(
    folder, document, readout
):
    names = names_of(readout)
    with xr.open_dataset(folder / "atlas.nc") as dataset:
        bifurcations = dataset["point"].values.tolist()
        places = dataset["point_configuration"].values
    assert len(places) == len(document["bifurcations"]) == 4
    summary = (folder / "summary.txt").read_text()
    for name, place, shown in zip(
        bifurcations, places, document["bifurcations"], strict=True
    ):
        expected = [shown["variables"][joint] for joint in names]
        assert place == pytest.approx(expected, abs=1e-12)
        line = next(row for row in summary.splitlines() if row.startswith(f"  {name} "))
        numbers = [float(word) for word in line.split()[1:7]]
        assert numbers == pytest.approx(np.degrees(place), abs=1e-4)


def test_json_has_the_angles_of_the_loop(document, readout):
    table = document["linkage"]
    loop = Loop(table["lengths"], table["twists"], table["offsets"])
    problem = LoopClosure(loop)
    to_unknowns = readout.single_loop.to_unknowns(readout.structure)
    places = ("bifurcations", "near_misses", "dead_points")
    points = [one for key in places for one in document[key]]
    assert points
    for point in points:
        theta = np.array(point["theta"])
        assert relative_gaps(problem, theta[None])[0] < AT_HALF_A_TURN
        values = to_unknowns.points(theta)
        expected = [point["variables"][name] for name in names_of(readout)]
        assert np.abs(np.sin((values - expected) / 2)).max() < 1e-12
    for point in document["bifurcations"]:
        jacobian = jacobian_at(problem, np.array(point["theta"]))
        assert np.abs(jacobian @ np.array(point["tangents"]).T).max() < 1e-9
    for point in document["dead_points"]:
        joint = int(to_unknowns.columns[names_of(readout).index(point["variable"])])
        assert point["joint"] == joint + 1


def test_json_counts_the_joints_of_forms_round_the_loop(document, readout):
    to_unknowns = readout.single_loop.to_unknowns(readout.structure)
    names = names_of(readout)
    for form in document["forms"]:
        still = [
            int(to_unknowns.columns[names.index(name)]) + 1
            for name in form["still_joints"]
        ]
        assert form["inactive_joints"] == sorted(still)
        turns = to_unknowns.directions(np.array(form["winding"]))
        expected = [form["ranges"][name]["turns"] for name in names]
        assert turns.tolist() == expected
    (still,) = (f for f in document["forms"] if f["inactive_joints"])
    assert still["inactive_joints"] == [3, 6]
    assert "joints 3,6 inactive" in still["name"]


def test_the_saved_atlas_is_routed_shown_and_exported(folder, tmp_path):
    atlas = folder / "atlas.nc"
    route = run("route", atlas, "Form 1", "Form 2").stdout
    assert "turn a" in route
    run("view", atlas, "--no-open", "--out", tmp_path / "page.html")
    run("export", atlas, "--form", "Form 1", "--to", tmp_path / "a.csv", "--count", "9")
    head = (tmp_path / "a.csv").read_text().splitlines()[0]
    assert "a" in head
    assert "theta" not in head
    run("export", atlas, "--to", tmp_path / "a.glb", "--count", "9")
    run("export", atlas, "--form", "Form 1", "--to", tmp_path / "a.xml")
    written = Readout(load(str(tmp_path / "a.xml"))).single_loop
    assert written is not None


def test_clearance_is_that_of_the_links_of_the_loop(path, document):
    table = document["linkage"]
    problem = LoopClosure(Loop(table["lengths"], table["twists"], table["offsets"]))
    forms = json.loads(run("clearance", path, "--json").stdout)
    for form in forms:
        for approach in form["approaches"]:
            assert set("".join(approach["links"])) <= set("123456")
            assert (
                relative_gaps(problem, np.array([approach["theta"]]))[0]
                < AT_HALF_A_TURN
            )


def test_points_are_confirmed_in_the_equations_in_which_they_were_found(path):
    text = run("map", path, *SEARCH, "--digits", "30").stdout
    rows = text.partition("Confirmation at 30 digits")[2].splitlines()
    digits = [float(row.split()[2]) for row in rows if row.startswith("  B")]
    assert len(digits) == 4
    assert min(digits) > 12
