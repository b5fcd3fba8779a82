"""What the viewer reads: the pieces with all their digits, and everything on the map."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest

from bifurc.figures.planes import choose_plane
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from linkages.labels import NoLinkageError, loop_of
from linkages.loop import Loop
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import mechanism_subject
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import lock_network
from linkages.viewing.document import MOST_SAMPLES, make_view_document, title_of
from tests.linkages.mechanisms.spatial_mechanisms import platform
from tests.linkages.viewing.conftest import slider_crank

DSG = "special-double-subtractive-goldberg"


def unpacked(array):
    values = np.frombuffer(base64.b64decode(array["float64"]), "<f8")
    return values.reshape(array["shape"])


def test_the_pieces_keep_every_digit(atlas_of):
    atlas = atlas_of(DSG)
    document = json.loads(json.dumps(make_view_document(atlas), allow_nan=False))
    for form, shown in zip(atlas.forms, document["forms"], strict=True):
        assert np.array_equal(unpacked(shown["pieces"]), form.branch.pieces)
        assert shown["breaks"] == form.branch.breaks.tolist()
        assert shown["name"] == form.name
    assert document["plane"] == list(choose_plane(atlas))


def test_joints_of_a_loop_say_what_its_angles_are(atlas_of):
    atlas = atlas_of("DSG of joints")
    shown = make_view_document(atlas)["loop"]
    table = Loop(shown["lengths"], shown["twists"], shown["offsets"])
    u = atlas.forms[0].branch.sample(50)
    joints = shown["joints"]
    angles = [one["offset"] + one["sign"] * u[:, one["column"]] for one in joints]
    assert table.closure_error(np.transpose(angles)).max() < 1e-12
    by_column = sorted(joints, key=lambda one: one["column"])
    assert [one["name"] for one in by_column] == list(atlas.names)
    assert "joints" not in make_view_document(atlas_of(DSG))["loop"]


@pytest.mark.parametrize("name", ["rigid", "too long", "nearly Bennett", "generic 12R"])
def test_what_has_no_form_makes_a_document_as_well(atlas_of, name):
    atlas = atlas_of(name)
    document = make_view_document(atlas)
    json.dumps(document, allow_nan=False)
    assert document["forms"] == []
    assert len(document["assemblies"]) == len(atlas.rigid)
    assert len(document["near_motions"]) == len(atlas.near_motions)
    curves = [motion["curve"] for motion in document["near_motions"]]
    is_drawn = atlas.surfaces or any(curves) or len(atlas.rigid)
    assert bool(document["note"]) == (not is_drawn)


def test_near_motions_are_curves_that_the_page_runs_along(atlas_of):
    atlas = atlas_of("nearly Bennett")
    document = make_view_document(atlas)
    (motion,) = document["near_motions"]
    (near,) = atlas.near_motions
    assert motion["name"] == near.name == "near motion 1"
    assert motion["misclosure"] == near.misclosure > 1e-9
    assert motion["curve"]["length"] == near.length
    assert motion["curve"]["closed"] == near.is_closed
    gaps = np.linalg.norm(atlas.near_motions[0].branch(0.0) - near.sample)
    assert gaps < 1e-12
    assert motion["curve"]["dashes"]


def test_the_configurations_of_a_surface_are_a_walk(atlas_of):
    atlas = atlas_of("folded Sarrus")
    (surface,) = make_view_document(atlas)["surfaces"]
    samples = unpacked(surface["samples"])
    assert 100 < len(samples) <= MOST_SAMPLES
    assert loop_of(atlas).closure_error(samples).max() < 1e-9
    steps = np.abs(np.sin(np.diff(samples, axis=0) / 2)).max(axis=1)
    drawn = np.abs(np.sin((samples[::7][1:] - samples[::7][:-1]) / 2)).max(axis=1)
    assert np.median(steps) < np.median(drawn)


def test_the_principal_axes_are_orthonormal_and_have_a_sign(atlas_of):
    for name in (DSG, "rigid", "too long"):
        principal = make_view_document(atlas_of(name))["principal"]
        axes = np.array(principal["axes"])
        assert axes @ axes.T == pytest.approx(np.eye(2))
        assert np.all(axes[[0, 1], np.abs(axes).argmax(axis=1)] > 0)


def test_an_atlas_of_equations_is_refused():
    circle = FunctionProblem(
        lambda u: np.array([u @ u - 1.0]), np.array([[-2.0, 2.0], [-2.0, 2.0]])
    )
    with pytest.raises(NoLinkageError, match="not of a linkage"):
        make_view_document(explore(circle))


def test_the_title_says_what_is_locked(atlas_of):
    assert title_of(atlas_of("slider-crank")) == "slider-crank"
    assert title_of(atlas_of("RSRS")) == "mechanism, locked: R1=0°"
    driven = slider_crank().with_locks({"J1": np.radians(40), "J4": -1.25})
    subject = {"name": "slider-crank", **mechanism_subject(driven)}
    atlas = replace(atlas_of("slider-crank"), subject=subject)
    assert title_of(atlas) == "slider-crank, locked: J1=40°, J4=-1.25"
    network = NETWORKS["four-bennett-network"].build()
    locked = lock_network(network, {"2": np.radians(40.0), "6": np.radians(-75.0)})
    atlas = replace(atlas, subject=mechanism_subject(locked))
    assert title_of(atlas) == f"{network.name}, locked: 2=40°, 6=-75°"


def test_a_title_counts_locks_where_they_are_many(atlas_of):
    legs = platform((0.0, 0.02, -0.03, 0.05, 0.0, None))
    sixfold = Joint("U", "cylindrical", ("base", "plate"), (0, 0, 0), (0, 0, 1))
    labels = [*(one.label for one in legs.variables), *sixfold.labels][:-1]
    locked = Mechanism((*legs.joints, sixfold), "many legs")
    subject = mechanism_subject(locked.with_locks(dict.fromkeys(labels, 0.0)))
    atlas = replace(atlas_of("slider-crank"), subject=subject)
    assert title_of(atlas) == f"many legs, {len(labels)} variables locked"
