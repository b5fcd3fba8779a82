"""Pictures of linkages: what is seen from where, in figures and in drawings."""

import json
from itertools import pairwise

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from bifurc.errors import ProblemError
from linkages.linkage import load
from linkages.pictures.dxf import make_dxf
from linkages.pictures.picture import Part, Picture
from linkages.pictures.plot_linkage import painter_of, place_of, plot_linkage
from studies.miura import miura
from tests.linkages.test_figures_in_print import LINKAGES, SIZES, overlapping_texts
from tests.maps import map_of

SLIDER_CRANK = """
name = "slider-crank"
[[joints]]
name = "A"
kind = "revolute"
bodies = ["frame", "crank"]
point = [0, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "B"
kind = "revolute"
bodies = ["crank", "rod"]
point = [1, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "C"
kind = "revolute"
bodies = ["rod", "slider"]
point = [4, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "D"
kind = "prismatic"
bodies = ["frame", "slider"]
direction = [1, 0, 0]
"""


RPRP = """
[[joints]]
name = "A"
kind = "revolute"
bodies = ["frame", "arm"]
point = [0, 0, 0]
direction = [0, 0, 1]
[[joints]]
name = "S"
kind = "prismatic"
bodies = ["arm", "block"]
point = [0.5, 0, 0]
direction = [1, 0.2, 0]
[[joints]]
name = "B"
kind = "revolute"
bodies = ["block", "carriage"]
point = [1, 0.6, 0]
direction = [0, 0, 1]
[[joints]]
name = "T"
kind = "prismatic"
bodies = ["frame", "carriage"]
point = [1, 0.2, 0]
direction = [0, 1, 0]
"""


@pytest.fixture(scope="module")
def slider_crank(tmp_path_factory):
    path = tmp_path_factory.mktemp("pictures") / "slider_crank.toml"
    path.write_text(SLIDER_CRANK)
    return map_of(load(str(path)))


def picture_of(atlas, s=None) -> Picture:
    place = place_of(atlas, atlas.forms[0].name, s)
    return painter_of(atlas, place).picture(place.point)


def places_in(picture: Picture) -> dict[str, np.ndarray]:
    return {name.text: name.place for name in picture.names}


@pytest.mark.parametrize("s", [0.3, 1.7, 3.0])
def test_a_planar_mechanism_is_seen_straight_from_above(slider_crank, s):
    places = places_in(picture_of(slider_crank, s))
    # all lengths are as they are, x is to the right and y upwards
    np.testing.assert_allclose(np.linalg.norm(places["B"] - places["A"]), 1, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(places["C"] - places["B"]), 3, atol=1e-9)
    np.testing.assert_allclose(places["A"], 0, atol=1e-9)
    np.testing.assert_allclose(places["C"][1], 0, atol=1e-9)
    angle = slider_crank.forms[0].branch(s)[slider_crank.names.index("A")]
    crank = [np.cos(angle), np.sin(angle)]
    np.testing.assert_allclose(places["B"], crank, atol=1e-9)


def test_pins_and_sliders_on_the_frame_have_ground(slider_crank):
    strokes = picture_of(slider_crank).strokes
    feet = [one for one in strokes if one.part is Part.GROUND and one.closed]
    assert len(feet) == 1  # of A; below D there are strokes only
    lines = [one for one in strokes if one.part is Part.GROUND and not one.closed]
    assert len(lines) == 2 * 7
    assert sum(one.part is Part.JOINT for one in strokes) == 4
    assert not any(one.part is Part.AXIS for one in strokes)


def test_symbols_are_as_large_as_rails_need_and_names_beside_their_own(tmp_path):
    file = tmp_path / "rprp.toml"
    file.write_text(RPRP)
    atlas = map_of(load(str(file)))
    figure = plot_linkage(atlas, 1)
    picture = picture_of(atlas)
    joints = [one.points for one in picture.strokes if one.part is Part.JOINT]
    smallest = min(np.ptp(points, axis=0).max() for points in joints)
    assert smallest > 0.02 * np.ptp(picture.corners, axis=0).max()
    figure.draw_without_rendering()
    (ax,) = figure.axes
    spots = {name: ax.transData.transform(at) for name, at in picture.names}
    for text in ax.texts:
        middle = np.mean(text.get_window_extent().get_points(), axis=0)
        distances = {k: np.linalg.norm(middle - spots[k]) for k in spots}
        assert min(distances, key=distances.__getitem__) == text.get_text()


def test_joints_in_space_show_their_axes_and_no_ground():
    strokes = picture_of(map_of("bennett")).strokes
    parts = [one.part for one in strokes]
    assert parts.count(Part.AXIS) == parts.count(Part.JOINT) == 4
    assert Part.GROUND not in parts
    assert parts[-4:] == [Part.JOINT] * 4  # in front of all else


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", LINKAGES)
def test_the_picture_fits_a_column_and_a_page(name, size):
    with matplotlib.rc_context({"figure.figsize": SIZES[size]}):
        figure = plot_linkage(map_of(name))
    assert overlapping_texts(figure) == []
    box = figure.get_tightbbox()
    width, height = SIZES[size]
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -1e-9


def test_a_linkage_is_drawn_into_axes_at_a_place_of_a_form(slider_crank):
    left, right = Figure().subplots(1, 2)
    figure = plot_linkage(slider_crank, 1, 0.5, ax=left)
    assert figure is left.figure and left.lines and not right.lines


def test_what_is_no_place_is_refused(slider_crank):
    with pytest.raises(ProblemError, match="Form 9"):
        plot_linkage(slider_crank, "Form 9")
    with pytest.raises(ProblemError, match="has to be named"):
        plot_linkage(slider_crank, s=1.0)


def test_a_drawing_has_the_strokes_of_the_picture(slider_crank):
    picture = picture_of(slider_crank)
    lines = make_dxf(picture).splitlines()
    groups = list(zip(lines[::2], lines[1::2], strict=True))
    assert groups[0] == ("0", "SECTION") and groups[-1] == ("0", "EOF")
    starts = [k for k, group in enumerate(groups) if group == ("0", "LINE")]
    drawn = []
    for k in starts:
        values = dict(groups[k + 1 : k + 8])
        ends = [float(values[code]) for code in ("10", "20", "11", "21")]
        drawn.append((values["8"], *ends))
    expected = []
    for stroke in picture.strokes:
        points = [*stroke.points, *stroke.points[: 1 if stroke.closed else 0]]
        for a, b in pairwise(points):
            expected.append((stroke.part.value, *a, *b))
    assert drawn == expected
    texts = [groups[k + 6][1] for k, one in enumerate(groups) if one == ("0", "TEXT")]
    assert texts == [name.text for name in picture.names]


def test_a_sheet_of_paper_is_drawn_as_panels_and_no_rods(tmp_path):
    path = tmp_path / "sheet.fold"
    path.write_text(json.dumps(miura(2, 2)))
    picture = picture_of(map_of(load(str(path))))
    parts = [stroke.part for stroke in picture.strokes]
    assert parts.count(Part.PANEL) == 4
    assert not {Part.LINK, Part.FRAME} & {*parts}
    panels = [one.points for one in picture.strokes if one.part is Part.PANEL]
    for place in places_in(picture).values():  # each is on an edge of two panels
        gaps = [
            np.linalg.norm((corners + np.roll(corners, 1, axis=0)) / 2 - place, axis=1)
            for corners in panels
        ]
        assert sorted(gap.min() for gap in gaps)[1] < 1e-9


def test_a_picture_is_of_what_is_drawn_or_listed_first(slider_crank):
    assert np.array_equal(place_of(slider_crank, None, None).point, slider_crank.drawn)
    atlas = map_of("special-double-subtractive-goldberg")
    first = place_of(atlas, None, None)
    assert atlas.forms[first.form].name.startswith("Form I ")
