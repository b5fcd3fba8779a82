"""Paths of points of bodies."""

import numpy as np
import pytest
from click.testing import CliRunner

import linkages
from linkages import GeometryError, Joint, Mechanism
from linkages.app.cli import main
from linkages.links.traced_points import traced_path, traced_point
from linkages.pictures.picture import Painter, Part
from linkages.subject import subject_at

PLACES = {"A": (0.0, 0.0), "B": (0.0, 1.0), "C": (2.0, 2.0), "D": (3.0, 0.0)}
BODIES = {"A": "frame crank", "B": "crank rod", "C": "rod rocker", "D": "frame rocker"}


@pytest.fixture(scope="module")
def four_bar():
    joints = [
        Joint(name, "revolute", tuple(BODIES[name].split()), (x, y, 0.0), (0, 0, 1))
        for name, (x, y) in PLACES.items()
    ]
    return linkages.map_linkage(Mechanism(tuple(joints), "four-bar"))


def test_a_traced_point_keeps_its_distances_from_the_joints_of_its_body(four_bar):
    parts = subject_at(four_bar).flat_parts
    assert not four_bar.completeness.doubts
    for form in four_bar.forms:
        points = form.branch.sample(50)
        apart = {}
        for name, at in {"P": (1.5, 3.0), "B": PLACES["B"], "C": PLACES["C"]}.items():
            text = f"rod:{at[0]},{at[1]}"
            apart[name] = traced_path(parts, traced_point(parts, text), points)
        on_crank = traced_path(parts, traced_point(parts, "crank:0,1"), points)
        assert np.allclose(apart["B"], on_crank, atol=1e-12)
        assert np.allclose(np.linalg.norm(on_crank, axis=1), 1.0, atol=1e-12)
        to_rocker = apart["C"] - [3.0, 0.0, 0.0]
        assert np.allclose(np.linalg.norm(to_rocker, axis=1), 5**0.5, atol=1e-12)
        for joint in "BC":
            length = np.hypot(*np.subtract((1.5, 3.0), PLACES[joint]))
            gaps = np.linalg.norm(apart["P"] - apart[joint], axis=1)
            assert np.allclose(gaps, length, atol=1e-12)


def test_the_path_is_in_the_picture_and_the_point_on_it(four_bar):
    parts, branch = subject_at(four_bar).flat_parts, four_bar.forms[0].branch
    points = branch.sample(200)
    traced = traced_point(parts, "rod:1.5,3")
    picture = Painter(parts, points[0], points, [traced]).picture(points[7])
    (path,) = [stroke for stroke in picture.strokes if stroke.part is Part.PATH]
    assert np.allclose(path.points, traced_path(parts, traced, points)[:, :2])
    (name,) = [name for name in picture.names if name.text == "rod:1.5,3"]
    assert np.allclose(name.place, path.points[7])


@pytest.mark.parametrize(
    "text", ["rod", "rud:1,2", "rod:1", "rod:1,x", "rod:1,nan", ""]
)
def test_what_is_no_point_of_a_body_is_refused_by_name(four_bar, text):
    with pytest.raises(GeometryError, match="traced point"):
        traced_point(subject_at(four_bar).flat_parts, text)


def test_the_table_of_a_form_has_the_path(tmp_path):
    path = tmp_path / "coupler.csv"
    words = ["export", "four-bar", "--form", "1", "--count", "5", "--to", str(path)]
    result = CliRunner().invoke(main, [*words, "--trace", "23:1,0.5"])
    assert result.exit_code == 0, result.output
    head, *rows = path.read_text().splitlines()
    assert head.endswith('"23:1,0.5 x","23:1,0.5 y","23:1,0.5 z"')
    assert len({row.count(",") for row in rows}) == 1
    result = CliRunner().invoke(main, [*words, "--trace", "23"])
    assert result.exit_code != 0
    assert "traced point" in result.output
