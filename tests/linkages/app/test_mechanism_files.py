"""What `bifurc map --out` writes of a mechanism besides its transition map."""

import json

import networkx as nx
import numpy as np
import xarray as xr

from bifurc.files.dataset import load_atlas
from linkages.app.files import write_data
from linkages.mapping import map_linkage
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.graphml import write_mechanism_graph
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.subject import subject_at
from tests.linkages.mechanisms.known_mechanisms import geared_five_bar
from tests.linkages.mechanisms.spatial_mechanisms import one_of_each, rods

LOCK = 0.25


def test_the_graph_of_a_mechanism_has_its_bodies_and_joints(tmp_path):
    joints = list(one_of_each().joints)
    joints[2] = Joint(
        "E",
        "planar",
        ("c", "d"),
        (1, 1, 0),
        (0, 0.6, 0.8),
        limits=((-1.0, 2.0), None, None),
        locked=(None, None, LOCK),
    )
    mechanism = Mechanism(tuple(joints), "one of each")
    path = write_mechanism_graph(mechanism, tmp_path / "mechanism.graphml")
    graph = nx.read_graphml(path, force_multigraph=True)
    assert graph.name == "one of each"
    assert set(graph.nodes) == set(mechanism.bodies)
    assert [body for body, is_frame in graph.nodes(data="is_frame") if is_frame] == [
        mechanism.frame
    ]
    edges = {data["joint"]: data for _, _, data in graph.edges(data=True)}
    for joint in mechanism.joints:
        data = edges[joint.name]
        assert data["kind"] == joint.kind.value
        assert (data["base"], data["moved"]) == joint.bodies
        assert json.loads(data["point"]) == list(joint.point)
    assert edges["H"]["pitch"] == 0.7
    assert json.loads(edges["U"]["second_direction"]) == [1, 0, 1]
    assert json.loads(edges["E"]["limits"]) == {"E.x": [-1, 2]}
    assert json.loads(edges["E"]["locked"]) == {"E.turn": LOCK}
    assert "direction" not in edges["S"]


def test_the_graph_says_what_a_coupled_joint_follows(tmp_path):
    mechanism = geared_five_bar(-2.0, 0.5)
    path = write_mechanism_graph(mechanism, tmp_path / "mechanism.graphml")
    graph = nx.read_graphml(path, force_multigraph=True)
    edges = {data["joint"]: data for _, _, data in graph.edges(data=True)}
    coupling = json.loads(edges["E"]["coupled"])
    assert coupling == {"E": {"to": "A", "ratio": -2.0, "offset": 0.5}}
    assert Coupling(**coupling["E"]) == mechanism.joint("E").coupled[0]


def test_datasets_have_variables_of_locked_and_spherical_joints(tmp_path):
    joints = list(rods().joints)
    joints[3:] = [
        Joint(
            "C",
            "cylindrical",
            ("slider", "base"),
            (0.2, 1, 1),
            (0.1, 0, 1),
            locked=(0.0, None),
        )
    ]
    mechanism = Mechanism(tuple(joints), "rods")
    atlas = map_linkage(mechanism)
    assert atlas.forms
    subject = subject_at(atlas)
    write_data(atlas, tmp_path, "", subject.dataset_variables(atlas), subject.files())
    data = xr.load_dataset(tmp_path / "atlas.nc")
    assert list(data.joint_variable_name.values) == ["R", "C.turn", "C.slide"]
    assert list(data.joint_variable_unit.values) == ["rad", "rad", "length"]
    assert list(data.rotation_name.values) == ["S1", "S2"]
    assert data.rotation_vector.attrs["units"] == "rad"
    readout = subject_at(atlas).readout
    for form in range(len(atlas.forms)):
        count = int(data.sample_count[form])
        points = data.configuration.values[form, :count]
        values = data.joint_variable.values[form, :count]
        assert np.isnan(data.joint_variable.values[form, count:]).all()
        assert (values[:, 1] == 0.0).all()
        assert np.ptp(values[:, 0]) > 0.1
        first = readout.variables(points[0])
        assert data.rotation_vector.values[form, 0, 0].tolist() == first["S1"]
        assert np.allclose(values, readout.values(points), rtol=0, atol=1e-14)
    read = load_atlas(tmp_path / "atlas.nc")
    assert [form.name for form in read.forms] == [form.name for form in atlas.forms]
