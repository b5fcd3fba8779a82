"""The model is opened again, by two other programs: it moves as the linkage does."""

import io

import numpy as np
import pytest

from linkages.export.glb import make_glb
from linkages.export.model import Motion, model_of, motion_of_form
from linkages.linkage import load
from linkages.loop import Loop
from linkages.subject import as_subject
from linkages.values import GeometryError
from tests.linkages.placed_links import place_links
from tests.maps import map_of

DSG = "special-double-subtractive-goldberg"
FRAMES = 100


def model_of_loop(loop, motions):
    return model_of(as_subject(loop).parts, loop.name, motions)


@pytest.fixture(scope="module")
def atlas():
    return map_of(DSG)


@pytest.fixture(scope="module")
def content(atlas):
    motions = [motion_of_form(form, FRAMES) for form in atlas.forms]
    return make_glb(model_of_loop(load(DSG).loop, motions), "a test")


@pytest.fixture(scope="module")
def opened(content):
    pygltflib = pytest.importorskip("pygltflib", reason="it opens the model again")
    return pygltflib.GLTF2.load_from_bytes(content)


def array_of(gltf, index):
    """An array of the file."""
    accessor = gltf.accessors[index]
    view = gltf.bufferViews[accessor.bufferView]
    kind = {5126: "<f4", 5123: "<u2"}[accessor.componentType]
    start, end = view.byteOffset, view.byteOffset + view.byteLength
    values = np.frombuffer(gltf.binary_blob()[start:end], kind)
    return values.reshape(accessor.count, -1)


def matrices(translations, quaternions):
    """Transforms (k, 4, 4) of what animations hold."""
    x, y, z, w = np.moveaxis(quaternions.astype(float), -1, 0)
    turns = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    out = np.tile(np.eye(4), (len(translations), 1, 1))
    out[:, :3, :3] = np.moveaxis(np.array(turns), -1, 0)
    out[:, :3, 3] = translations
    return out


def poses_of(gltf, animation):
    """Transforms (k, 4, 4) of the nodes along an animation, by their names."""
    tracks = {}
    for channel in animation.channels:
        name = gltf.nodes[channel.target.node].name
        output = animation.samplers[channel.sampler].output
        tracks.setdefault(name, {})[channel.target.path] = array_of(gltf, output)
    return {
        name: matrices(track["translation"], track["rotation"])
        for name, track in tracks.items()
    }


def test_there_is_an_animation_for_every_form(opened, atlas):
    names = [animation.name for animation in opened.animations]
    assert names == [form.name for form in atlas.forms]
    for animation in opened.animations:
        times = array_of(opened, animation.samplers[0].input)[:, 0]
        assert len(times) == FRAMES
        assert times[0] == 0
        assert np.all(np.diff(times) > 0)


def test_neighbouring_links_share_their_joint_axis_in_every_frame(opened):
    """The axis of a joint is the z axis of the link before it; seen from the link
    behind it, it lies where the geometry puts it."""
    loop = load(DSG).loop
    lengths, twists, offsets = loop.arrays
    n = loop.n
    for animation in opened.animations:
        poses = poses_of(opened, animation)
        assert len(poses) == n - 1  # the last link stands still
        still = np.tile(np.eye(4), (FRAMES, 1, 1))
        chain = [still, *(poses[f"link {i}{i + 1}"] for i in range(1, n)), still]
        for i in range(n):  # joint i + 1 between link i and link i + 1
            before, behind = chain[i], chain[i + 1]
            direction = [0.0, np.sin(twists[i]), np.cos(twists[i])]
            point = np.array([-lengths[i], 0, 0]) - offsets[i] * np.array(direction)
            seen = behind[:, :3, :3] @ direction
            foot = behind[:, :3, :3] @ point + behind[:, :3, 3]
            assert np.abs(seen - before[:, :3, 2]).max() < 1e-6
            assert np.abs(foot - before[:, :3, 3]).max() < 1e-6


def test_turns_between_frames_are_the_short_ones_and_closed_forms_close(opened):
    for animation in opened.animations:
        for channel in animation.channels:
            values = array_of(opened, animation.samplers[channel.sampler].output)
            if channel.target.path == "rotation":
                assert np.all((values[1:] * values[:-1]).sum(axis=1) > 0)
                assert abs(values[0] @ values[-1]) == pytest.approx(1, abs=1e-6)
            else:
                assert values[0] == pytest.approx(values[-1], abs=1e-6)


def test_the_solids_stand_where_the_links_are(content, atlas):
    trimesh = pytest.importorskip("trimesh", reason="it opens the model again")
    loop = load(DSG).loop
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    corners = place_links(loop, atlas.forms[0].branch(0.0)).reshape(-1, 3)
    upright = corners[:, [0, 2, 1]] * [1, 1, -1]  # glTF has y upwards
    low, high = scene.bounds
    room = 0.2 * loop.characteristic_length
    assert np.all(low < upright.min(axis=0))
    assert np.all(high > upright.max(axis=0))
    assert np.all(low > upright.min(axis=0) - room)
    assert np.all(high < upright.max(axis=0) + room)
    assert all(geometry.is_watertight for geometry in map(merged, solids(scene)))


def solids(scene):
    return scene.geometry.values()


def merged(mesh):
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    return mesh


def test_lengths_beyond_the_floats_of_a_model_are_refused():
    loop = load("bennett").loop
    motion = motion_of_form(map_of(loop).forms[0], 5)
    with pytest.raises(GeometryError, match="characteristic length"):
        make_glb(model_of_loop(loop.scaled(1e30), [motion]), "a test")


def test_poses_are_those_of_the_frames():
    loop = Loop([1, 2, 1, 2], [0.3, 0.4, 0.5, 0.6], [0.1, 0.2, 0.3, 0.4])
    theta = np.random.default_rng(2).uniform(-3, 3, (7, 4))
    motion = Motion("any", theta, np.arange(7.0))
    ((_, poses),) = model_of_loop(loop, [motion]).motions
    frames = loop.frames(theta)
    for i in range(4):
        rebuilt = matrices(poses.translations[i], poses.rotations[i])
        assert rebuilt == pytest.approx(frames[:, i + 1], abs=1e-12)
