"""The page of a mechanism in a browser: its bodies are where Python says that they
are, and map, choices and routes work as those of a loop."""

import numpy as np
import pytest

from linkages.closure.closure import Closure
from linkages.links import motion_document
from linkages.mechanisms.joint import JointKind
from linkages.mechanisms.subject import mechanism_of
from linkages.pictures.plot_linkage import painter_of, place_of
from linkages.readout.readout import Readout
from linkages.subject import subject_at
from linkages.viewing.document import make_view_document
from tests.linkages.viewing.test_viewer import drawn_share, picture_of

GO = "([name, places]) => places.map((s) => bifurc.go(name, s))"
ALL = ["slider-crank", "Watt", "Sarrus", "CRCR", "platform", "RSRS", "one of each"]


def poses_in_browser(shown, name, places):
    """The poses (k, b, 3, 4) that the page says at places of a track."""
    states = shown.page.evaluate(GO, [name, [float(s) for s in places]])
    rows = [[body["pose"] for body in state["bodies"]] for state in states]
    return np.array(rows).reshape(len(places), -1, 3, 4)


def largest_gap(readout, found, points):
    """By how much poses miss those at configurations (k, n), lengths in
    characteristic lengths."""
    gap = np.abs(found - readout.poses(points)[:, :, :3])
    gap[..., 3] /= readout.structure.unit
    return gap.max()


@pytest.mark.parametrize("name", [*ALL, "rods", "geared", "octahedron"])
def test_the_poses_in_the_browser_are_those_of_python_everywhere(show_shared, name):
    shown = show_shared(name)
    readout = Readout(mechanism_of(shown.atlas))
    for form in shown.atlas.forms:
        places = np.linspace(0.0, form.branch.length, 24)[:-1]
        found = poses_in_browser(shown, form.name, places)
        assert largest_gap(readout, found, form.branch(places)) < 1e-9
    for one in shown.bifurc("lists"):
        places = range(min(one["count"], 10))
        states = shown.page.evaluate(GO, [one["name"], list(places)])
        points = np.array([state["angles"] for state in states])
        found = poses_in_browser(shown, one["name"], places)
        assert largest_gap(readout, found, points) < 1e-9


@pytest.mark.parametrize("name", ["slider-crank", "Sarrus"])
def test_the_rods_that_are_drawn_move_with_their_bodies(show_shared, name):
    shown = show_shared(name)
    readout = Readout(mechanism_of(shown.atlas))
    form = shown.atlas.forms[0]
    call = "([f, s]) => { bifurc.go(f, s); return bifurc.rods(); }"
    at_first, later = (
        np.array(shown.page.evaluate(call, [form.name, s])) for s in (0.0, 1.0)
    )
    lengths = np.linalg.norm(at_first[:, 1] - at_first[:, 0], axis=1)
    assert np.linalg.norm(later[:, 1] - later[:, 0], axis=1) == pytest.approx(lengths)
    first, last = readout.poses(form.branch(np.array([0.0, 1.0])))
    moves = last @ np.linalg.inv(first)
    for before, after in zip(at_first, later, strict=True):
        carried = [before @ move[:3, :3].T + move[:3, 3] for move in moves]
        assert min(np.abs(one - after).max() for one in carried) < 1e-9


@pytest.mark.parametrize("name", ALL)
def test_a_page_opens_from_disk_without_a_word_and_draws_the_mechanism(
    show_shared, name
):
    shown = show_shared(name)
    assert shown.messages == []
    assert len(shown.requests) == 1
    assert drawn_share(shown) > 0.001
    assert 0 < shown.bifurc("effort().calls") < 100


@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_is_wider_than_the_window(show, width):
    shown = show("platform", window={"width": width, "height": 800})
    wide = shown.page.evaluate("() => document.documentElement.scrollWidth")
    assert wide <= width
    inside = "e => { const b = e.getBoundingClientRect(); return b.x >= 0 && b.right <= innerWidth + 1 }"
    for label in shown.page.locator(".bv-joint-number, .bv-cell b").all():
        assert label.evaluate(inside)


def test_another_body_can_be_held_still(show):
    shown = show("Watt")
    select = shown.page.locator(".bv-space-tools select")
    assert select.locator("option:checked").inner_text() == "frame"
    bodies = shown.bifurc("state().bodies")
    before = picture_of(shown)
    select.select_option("coupler")
    assert picture_of(shown) != before
    assert shown.bifurc("state().bodies") == bodies


def test_a_click_on_a_bifurcation_offers_the_branches(show_shared):
    shown = show_shared("Kempe")
    shown.click(".bv-map [data-point=B2]")
    offered = shown.page.locator(".bv-choice button").all_inner_texts()
    assert len(offered) == 4
    assert any("Form 2" in text for text in offered)


def test_a_route_plays_to_its_end(show_shared):
    shown = show_shared("Kempe")
    shown.bifurc("go('Form 1')")
    shown.bifurc("playRoute('Form 2', 0.5)")
    shown.page.wait_for_function("() => !bifurc.state().playing", timeout=20_000)
    assert shown.bifurc("state().form") == "Form 2"


def test_a_slide_has_an_axis_in_the_unit_of_the_file(show_shared):
    shown = show_shared("slider-crank")
    shown.page.locator("select[aria-label^=horizontal]").select_option("J4")
    titles = shown.page.locator(".bv-axis").all_text_contents()
    assert titles == ["J4", "J2 (deg)"]
    ticks = shown.page.locator(".bv-frame text:not(.bv-axis)").all_text_contents()
    assert {"−8", "0", "90"} <= set(ticks)
    curves = shown.page.locator(".bv-map .bv-curve")
    assert "M" in curves.first.get_attribute("d")
    form = shown.atlas.forms[0]
    readout = Readout(mechanism_of(shown.atlas))
    shown.page.evaluate("f => bifurc.go(f, 1.0)", form.name)
    said = shown.page.locator(".bv-cell", has_text="J4").locator("b").inner_text()
    slide = readout.variables(form.branch(1.0))["J4"]
    assert float(said.replace("−", "-")) == pytest.approx(slide, rel=1e-3)


def test_an_angle_that_is_back_after_two_turns_has_an_axis_of_two_turns(show_shared):
    shown = show_shared("geared")
    shown.page.locator("select[aria-label^=horizontal]").select_option("A")
    shown.page.locator("select[aria-label^=vertical]").select_option("B")
    ticks = shown.page.locator(".bv-frame text:not(.bv-axis)").all_text_contents()
    assert {"−360", "−180", "180", "360"} <= set(ticks)
    assert shown.messages == []


def test_the_strip_shows_where_the_rank_drops(show_shared):
    shown = show_shared("Kempe")
    path = shown.page.locator(".bv-smallest").get_attribute("d")
    heights = [float(pair.split()[1]) for pair in path[1:].split("L")]
    stops = shown.page.locator(".bv-stop").count()
    assert stops == 2
    assert sum(height > 42 for height in heights) >= stops


def test_scripts_get_bodies_by_name(show_shared):
    state = show_shared("slider-crank").bifurc("go(1, 0.5)")
    names = [body["name"] for body in state["bodies"]]
    assert names == ["frame", "crank", "rod", "slider"]
    assert state["bodies"][0]["pose"] == [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
    assert "axes" not in state


@pytest.mark.parametrize("name", [*ALL, "rods", "geared"])
def test_singular_values_in_the_browser_are_those_of_python(show_shared, name):
    shown = show_shared(name)
    closure = Closure(mechanism_of(shown.atlas))
    for form in shown.atlas.forms:
        places = np.linspace(0.0, form.branch.length, 9)
        states = shown.page.evaluate(GO, [form.name, places.tolist()])
        found = np.array([state["singular_values"] for state in states])
        matrices = closure.jacobians(form.branch(places))
        expected = np.linalg.svd(matrices, compute_uv=False)
        assert np.abs(found[:, : expected.shape[1]] - expected).max() < 1e-12
        assert np.all(found[:, expected.shape[1] :] == 0)
    shown.bifurc("go(1)")
    cells = shown.page.locator(".bv-cell:has(.bv-level)")
    assert cells.count() == closure.n


def test_a_mechanism_of_many_unknowns_has_the_smallest_singular_value_only(
    show, monkeypatch
):
    monkeypatch.setattr(motion_document, "MOST_UNKNOWNS", 4)
    shown = show("Kempe")
    assert shown.bifurc("state().singular_values") == []
    assert shown.page.locator(".bv-cell:has(.bv-level)").count() == 0
    assert shown.page.locator(".bv-smallest").count() == 1
    assert shown.page.locator(".bv-distance:not(.bv-hidden)").count() == 1
    assert shown.messages == []


def test_the_bar_shows_how_far_the_singular_points_are(show_shared):
    shown = show_shared("Kempe")
    form = shown.atlas.forms[0]
    point, (_, s) = next(
        (point, one)
        for point in shown.atlas.points
        for one in point.passes
        if shown.atlas.forms[one[0]] is form
    )
    shown.page.evaluate("([f, s]) => bifurc.go(f, s)", [form.name, s - 0.1])
    after = shown.page.locator(".bv-after")
    assert after.inner_text() == f"{np.degrees(0.1):.1f}° ▸ {point.name}"
    after.click()
    assert shown.bifurc("state().s") == pytest.approx(s)


NAMES = """() => {
  const space = document.querySelector('.bv-space').getBoundingClientRect();
  return [...document.querySelectorAll('.bv-joint-number')].map((name) => {
    const box = name.getBoundingClientRect();
    return [box.left - space.left, box.top - space.top, box.right - space.left, box.bottom - space.top];
  });
}"""


def test_names_of_joints_in_one_place_stand_beside_each_other(show_shared):
    shown = show_shared("kite")
    folded = next(form.name for form in shown.atlas.forms if "folded" in form.name)
    shown.page.evaluate("name => bifurc.go(name)", folded)
    picture_of(shown)
    boxes = np.array(shown.page.evaluate(NAMES))
    assert (boxes[:, 2] > boxes[:, 0]).all()


@pytest.mark.parametrize("name", ["platform", "Kempe"])
def test_names_do_not_cover_each_other(show_shared, name):
    shown = show_shared(name)
    picture_of(shown)
    boxes = np.array(shown.page.evaluate(NAMES))
    is_shown = boxes[:, 2] > boxes[:, 0]
    assert np.count_nonzero(is_shown) > 0.5 * len(boxes)
    for k, one in enumerate(boxes[is_shown]):
        for other in boxes[is_shown][:k]:
            low = np.maximum(one[:2], other[:2])
            high = np.minimum(one[2:], other[2:])
            assert not np.all(high - low > 3)


def test_names_stand_beside_joints_that_are_seen_end_on(show_shared):
    shown = show_shared("Kempe")
    picture_of(shown)
    boxes = np.array(shown.page.evaluate(NAMES))
    joints = np.array(shown.bifurc("canvas()")["joints"])
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    is_shown = boxes[:, 2] > boxes[:, 0]
    gaps = np.linalg.norm(middles - joints, axis=1)[is_shown]
    assert gaps.min() > 8


@pytest.mark.parametrize("name, is_angular", [("slider-crank", False), ("Watt", True)])
def test_a_length_of_slides_and_turns_is_not_in_degrees(show_shared, name, is_angular):
    shown = show_shared(name)
    place = shown.page.inner_text(".bv-place")
    assert " of " in place
    assert ("°" in place) is is_angular


def test_a_coupled_joint_has_its_number_beside_the_others(show_shared):
    shown = show_shared("geared")
    script = """() => Object.fromEntries([...document.querySelectorAll(".bv-numbers .bv-cell")].map((cell) =>
      [cell.querySelector("span").textContent, cell.querySelector("b").textContent]))"""
    texts = shown.page.evaluate(script)
    first, follower = (float(texts[name].replace("−", "-")) for name in "AE")
    turns = (follower - 0.5 * first - np.degrees(0.3)) / 180
    assert turns == pytest.approx(round(turns), abs=1e-3)


def test_no_rod_of_a_platform_goes_beyond_the_ends_of_its_leg(show_shared):
    shown = show_shared("platform")
    readout = Readout(mechanism_of(shown.atlas))
    mechanism = readout.mechanism
    joints = [j for j in mechanism.joints if j.kind is JointKind.SPHERICAL]
    call = "([f, s]) => { bifurc.go(f, s); return bifurc.rods(); }"
    for form in shown.atlas.forms:
        for s in np.linspace(0.0, form.branch.length, 5):
            ends = np.array(shown.page.evaluate(call, [form.name, s]))
            poses = readout.poses(form.branch(np.array([s])))[0]
            places = []
            for joint in joints:
                pose = poses[mechanism.bodies.index(joint.bodies[0])]
                places.append(pose[:3, :3] @ joint.place + pose[:3, 3])
            low, high = np.min(places, axis=0), np.max(places, axis=0)
            assert (ends >= low - 1e-9).all()
            assert (ends <= high + 1e-9).all()


def effort_and_sheet(show, side):
    shown = show(f"sheet of {side}", window={"width": 800, "height": 560})
    picture_of(shown)
    return shown, shown.bifurc("effort()")


def test_a_large_sheet_takes_no_more_draw_calls_and_few_triangles_a_panel(show):
    _, small = effort_and_sheet(show, 3)
    shown, large = effort_and_sheet(show, 12)
    panels = len(mechanism_of(shown.atlas).panels)
    assert panels == 144
    assert large["calls"] == small["calls"]
    # at 1,000 panels half a million: a laptop draws ten millions 30 times a second
    assert large["triangles"] < 550 * panels


def test_of_many_joints_those_near_the_pointer_have_names(show):
    shown, _ = effort_and_sheet(show, 12)
    names = shown.page.locator(".bv-joint-number:not(.bv-hidden)")
    assert names.count() == 0
    box = shown.page.locator(".bv-space").bounding_box()
    place = np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])
    shown.page.mouse.move(*place)
    assert 1 <= names.count() <= 6
    for name in names.all():
        own = name.bounding_box()
        middle = [own["x"] + own["width"] / 2, own["y"] + own["height"] / 2]
        assert np.linalg.norm(place - middle) < 100
    shown.page.mouse.move(1, 1)
    assert names.count() == 0


@pytest.mark.parametrize("name", ["slider-crank", "sheet of 12"])
def test_joints_are_as_large_as_in_the_figures(show_shared, name):
    atlas = show_shared(name).atlas
    document = make_view_document(atlas)
    place = place_of(atlas, None, None)
    picture = painter_of(atlas, place)
    assert document["joint_radius"] == pytest.approx(picture.radius, rel=1e-3)
    hinges = [
        symbol.place for symbol in subject_at(atlas).parts.symbols_at(place.point)
    ]
    gaps = np.linalg.norm(np.array(hinges)[:, None] - hinges, axis=-1)
    assert picture.radius < 0.3 * gaps[gaps > 1e-6].min()
