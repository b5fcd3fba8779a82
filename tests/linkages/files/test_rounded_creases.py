"""Rounded crease patterns that are made exact, beside the patterns that were rounded."""

import numpy as np
import pytest

import linkages
from linkages.app.texts.mechanism_text import describe_joints
from linkages.mechanisms.subject import mechanism_from, mechanism_subject
from linkages.readout.readout import Readout
from tests.linkages.files.test_fold import read
from tests.samples import one_in


def turned(content, angle):
    """The pattern of a content, turned by an angle (rad)."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = np.array(content["vertices_coords"]) @ turn.T
    return {**content, "vertices_coords": points.tolist()}


def rounded(content, digits):
    points = np.round(content["vertices_coords"], digits)
    return {**content, "vertices_coords": points.tolist()}


def meshed(places):
    """The content of a sheet of quadrangles between places (m, n, 2)."""
    rows, columns = places.shape[:2]
    number = np.arange(rows * columns).reshape(rows, columns)
    edges, letters, faces = [], [], []
    for i, j in np.ndindex(rows, columns):
        if i + 1 < rows:
            edges.append(number[i : i + 2, j].tolist())
            letters.append("B" if j in (0, columns - 1) else "U")
        if j + 1 < columns:
            edges.append(number[i, j : j + 2].tolist())
            letters.append("B" if i in (0, rows - 1) else "U")
        if i + 1 < rows and j + 1 < columns:
            (a, b), (d, c) = number[i : i + 2, j : j + 2].tolist()
            faces.append([a, d, c, b])
    return {
        "vertices_coords": places.reshape(-1, 2).tolist(),
        "edges_vertices": edges,
        "edges_assignment": letters,
        "faces_vertices": faces,
    }


def zigzags(rng, rows, columns):
    """Parallel lines and mirrored zigzags of any slopes between them: every vertex folds
    flat, and the ratios along a zigzag are all the same."""
    heights = np.cumsum([0.0, *rng.uniform(0.5, 1.5, size=rows)])
    slopes = rng.uniform(0.1, 0.45, size=columns + 1)
    way = np.cumsum([0.0, *np.diff(heights) * (-1.0) ** np.arange(rows)])
    starts = np.cumsum([0.0, *rng.uniform(0.8, 1.6, size=columns)])
    x = starts + way[:, None] * slopes
    y = np.broadcast_to(heights[:, None], x.shape)
    return turned(meshed(np.stack([x, y], axis=2)), rng.uniform(0.0, 6.0))


def vertex(rng, degree):
    """A vertex of so many creases that folds flat."""
    halves = rng.dirichlet(np.full(degree // 2, 4.0), size=2) * np.pi
    turns = np.cumsum(halves.T.ravel()) + rng.uniform(0.0, 6.0)
    radii = rng.uniform(0.7, 1.3, size=degree)
    rim = radii[:, None] * np.transpose([np.cos(turns), np.sin(turns)])
    spokes = [[0, k + 1] for k in range(degree)]
    sides = [[k + 1, (k + 1) % degree + 1] for k in range(degree)]
    return {
        "vertices_coords": [[0.0, 0.0], *rim.tolist()],
        "edges_vertices": spokes + sides,
        "edges_assignment": ["U"] * degree + ["B"] * degree,
        "faces_vertices": [[0, *side] for side in sides],
    }


def twist(rng):
    """A square whose corners have two parallel creases of the pleats each."""
    angle = rng.uniform(0.3, 1.2)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    ends = []
    for k in range(4):
        along = (k - 1) * np.pi / 2 + angle
        step = 1.3 * np.array([np.cos(along), np.sin(along)])
        ends += [square[k] + step, square[(k + 1) % 4] + step]
    edges = [[k, (k + 1) % 4] for k in range(4)]
    edges += [[k, 4 + 2 * k] for k in range(4)]
    edges += [[(k + 1) % 4, 5 + 2 * k] for k in range(4)]
    rim = 4 + np.argsort([np.arctan2(y - 0.5, x - 0.5) for x, y in ends])
    edges += np.transpose([rim, np.roll(rim, -1)]).tolist()
    content = {
        "vertices_coords": [*square.tolist(), *map(list, ends)],
        "edges_vertices": edges,
        "edges_assignment": ["U"] * 12 + ["B"] * 8,
    }
    return turned(content, rng.uniform(0.0, 6.0))


def answer(mechanism):
    """How many forms there are, and the dimensions of the components."""
    atlas = linkages.map_linkage(mechanism)
    return len(atlas.forms), sorted(one.dimension for one in atlas.surfaces)


@pytest.mark.parametrize("digits", one_in(4, [3, 4, 5, 6]))
@pytest.mark.parametrize(
    "pattern",
    [
        lambda rng: zigzags(rng, 3, 3),
        lambda rng: vertex(rng, 4),
        twist,
    ],
    ids=["zigzags", "vertex", "twist"],
)
def test_a_rounded_pattern_moves_as_the_exact_one(pattern, digits, tmp_path):
    content = pattern(np.random.default_rng(digits))
    exact = read(tmp_path, content)
    repaired = read(tmp_path, rounded(content, digits))
    assert exact.moved == 0.0
    assert 0.0 < repaired.moved < 10.0**-digits
    assert answer(repaired) == answer(exact)


@pytest.mark.parametrize("degree", [4, 6, 8])
def test_sectors_of_a_rounded_vertex_add_up_to_rounding(degree, tmp_path):
    rng = np.random.default_rng(degree)
    for _ in range(20):
        mechanism = read(tmp_path, rounded(vertex(rng, degree), 4))
        corners = np.array([panel.corners[:2] for panel in mechanism.panels])
        turns = np.sort([np.arctan2(y, x) for x, y, _ in corners[:, 1] - corners[:, 0]])
        sectors = np.diff([*turns, turns[0] + 2 * np.pi])
        assert sectors[::2].sum() == pytest.approx(np.pi, abs=4e-15)


def test_a_vertex_that_does_not_nearly_fold_flat_stays_as_it_is(tmp_path):
    content = vertex(np.random.default_rng(0), 4)
    content["vertices_coords"][1][0] += 0.05
    assert read(tmp_path, rounded(content, 4)).moved == 0.0


def test_how_far_vertices_are_moved_is_said(tmp_path, caplog):
    content = rounded(vertex(np.random.default_rng(1), 4), 3)
    mechanism = read(tmp_path, content)
    assert f"vertices_coords: moved by up to {mechanism.moved:.3g}" in caplog.text
    text = describe_joints(Readout(mechanism))
    assert f"Vertices are up to {mechanism.moved:.2g} from where the file has" in text
    values = mechanism_subject(mechanism)["mechanism"]
    assert mechanism_from(values, "").moved == mechanism.moved


def test_a_line_stays_one_through_rounded_vertices(tmp_path):
    """Two lines of other lines that cross: without it no crease folds by itself."""
    lines = meshed(np.stack(np.meshgrid([0.0, 1.0, 2.2, 3.0], [0.0, 0.8, 2.0]), axis=2))
    mechanism = read(tmp_path, rounded(turned(lines, 0.3), 3))
    of_lines = {}
    for joint in mechanism.joints:
        slope = round(float(np.arctan(joint.direction[1] / joint.direction[0])), 1)
        of_lines.setdefault(slope, []).append(joint)
    (across,) = [one for one in of_lines.values() if len(one) == 3]
    places = np.array([joint.place for joint in across])[:, :2]
    steps = np.diff(places, axis=0)
    assert abs(np.linalg.det(steps)) < 1e-15


def test_thick_and_folded_patterns_stay_as_they_are(tmp_path):
    content = rounded(vertex(np.random.default_rng(2), 4), 3)
    assert read(tmp_path, content).moved > 0.0
    assert read(tmp_path, {**content, "bifurc:thickness": 0.1}).moved == 0.0
    points = [[*place, 0.0] for place in content["vertices_coords"]]
    folded = {"vertices_coords": points, "frame_classes": ["foldedForm"]}
    assert read(tmp_path, {**content, **folded}).moved == 0.0
