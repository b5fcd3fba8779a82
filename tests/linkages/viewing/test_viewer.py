"""The page in a browser: what it draws is where Python says that the linkage is."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.errors import RouteError
from bifurc.figures.style import form_style
from bifurc.routes.route import find_route
from bifurc.torus import wrap
from linkages.app.texts.form_names import listed_forms
from linkages.closure.closure import Closure
from linkages.labels import loop_of
from linkages.mechanisms.subject import mechanism_of
from linkages.readout.readout import Readout
from linkages.subject import subject_at
from linkages.viewing.document import make_view_document
from linkages.viewing.page import write_page
from tests.linkages.placed_links import place_links

DSG = "special-double-subtractive-goldberg"
NOT_EMPTY = """() => {
  const canvas = document.querySelector('.bv-space canvas');
  const gl = canvas.getContext('webgl2');
  const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let drawn = 0;
  for (let i = 3; i < pixels.length; i += 4) drawn += pixels[i] > 0;
  return drawn / (w * h);
}"""


def picture_of(shown):
    """The picture of the linkage, after the frames that are on their way."""
    return shown.page.evaluate(
        """() => new Promise((resolve) => {
          const canvas = document.querySelector('.bv-space canvas');
          const read = () => resolve(canvas.toDataURL());
          requestAnimationFrame(() => requestAnimationFrame(read));
        })"""
    )


def drawn_share(shown):
    return shown.page.evaluate(NOT_EMPTY)


@pytest.mark.parametrize("name", [DSG, "spherical-four-bar", "folded Sarrus", "rigid"])
def test_a_page_opens_from_disk_without_a_word_and_draws_the_linkage(show, name):
    shown = show(name)
    assert shown.messages == []
    assert all(url.startswith("file:") for url in shown.requests)
    assert len(shown.requests) == 1
    assert drawn_share(shown) > 0.002
    assert 0 < shown.bifurc("effort().calls") < 100


@pytest.mark.parametrize(
    "name", [DSG, "generic 7R", "spherical-four-bar", "huge", "tiny"]
)
def test_the_axes_in_the_browser_are_those_of_python_everywhere(show_shared, name):
    shown = show_shared(name)
    loop, problem = loop_of(shown.atlas), Closure(loop_of(shown.atlas))
    size = loop.characteristic_length
    for form in shown.atlas.forms:
        places = np.linspace(0.0, form.branch.length, 24)[:-1]
        theta = form.branch(places)
        states = shown.page.evaluate(
            "([form, places]) => places.map((s) => bifurc.go(form, s))",
            [form.name, places.tolist()],
        )
        frames = loop.frames(theta)
        axes = np.array([state["axes"] for state in states])
        ends = np.array([state["end"] for state in states]).reshape(-1, 3, 4)
        angles = np.array([state["angles"] for state in states])
        values = np.array([state["singular_values"] for state in states])
        expected = np.linalg.svd(problem.jacobians(theta))[1]
        assert {state["form"] for state in states} == {form.name}
        assert np.abs(angles - theta).max() < 1e-12
        assert np.abs(axes[:, :, 0] - frames[:, :-1, :3, 3]).max() < 1e-9 * size
        assert np.abs(axes[:, :, 1] - frames[:, :-1, :3, 2]).max() < 1e-9
        assert np.abs(ends[:, :, :3] - np.eye(3)).max() < 1e-9
        assert np.abs(ends[:, :, 3]).max() < 1e-9 * size
        assert np.abs(values[:, : expected.shape[1]] - expected).max() < 1e-12


def test_a_loop_that_is_given_by_joints_has_their_names_and_its_axes(show_shared):
    shown = show_shared("DSG of joints")
    readout = Readout(mechanism_of(shown.atlas))
    loop = readout.single_loop.loop
    form = shown.atlas.forms[0]
    places = np.linspace(0.0, form.branch.length, 24)[:-1]
    theta = subject_at(shown.atlas).to_angles.points(form.branch(places))
    states = shown.page.evaluate(
        "([form, places]) => places.map((s) => bifurc.go(form, s))",
        [form.name, places.tolist()],
    )
    frames = loop.frames(theta)
    axes = np.array([state["axes"] for state in states])
    angles = np.array([state["angles"] for state in states])
    values = np.array([state["singular_values"] for state in states])
    expected = np.linalg.svd(Closure(loop).jacobians(theta))[1]
    assert np.abs(angles - form.branch(places)).max() < 1e-12
    size = loop.characteristic_length
    assert np.abs(axes[:, :, 0] - frames[:, :-1, :3, 3]).max() < 1e-9 * size
    assert np.abs(axes[:, :, 1] - frames[:, :-1, :3, 2]).max() < 1e-9
    assert np.abs(values[:, : expected.shape[1]] - expected).max() < 1e-12
    names = shown.page.locator(".bv-numbers .bv-dial").locator("..").locator("span")
    assert names.all_inner_texts() == list(shown.atlas.names)
    in_picture = shown.page.locator(".bv-joint-number").all_inner_texts()
    assert sorted(in_picture) == sorted(shown.atlas.names)
    assert shown.messages == []


@pytest.mark.parametrize("name", [DSG, "spherical-four-bar", "folded Sarrus"])
def test_the_rods_that_are_drawn_are_those_of_python(show_shared, name):
    shown = show_shared(name)
    loop, form = loop_of(shown.atlas), shown.atlas.forms[0]
    call = "f => { bifurc.go(f, 1.0); return bifurc.rods(); }"
    rods = np.array(shown.page.evaluate(call, form.name))
    corners = place_links(loop, form.branch(1.0))
    expected = np.stack([corners[:, :-1], corners[:, 1:]], axis=2).reshape(-1, 2, 3)
    is_rod = np.linalg.norm(expected[:, 1] - expected[:, 0], axis=1) > 1e-9
    assert rods == pytest.approx(expected[is_rod], abs=1e-9)


BORDER = """() => {
  const canvas = document.querySelector('.bv-space canvas');
  const gl = canvas.getContext('webgl2');
  const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  let drawn = 0;
  for (const [x, y, dx, dy] of [[0, 0, w, 2], [0, h - 2, w, 2], [0, 0, 2, h], [w - 2, 0, 2, h]]) {
    const pixels = new Uint8Array(4 * dx * dy);
    gl.readPixels(x, y, dx, dy, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (let i = 3; i < pixels.length; i += 4) drawn += pixels[i] > 0;
  }
  return drawn;
}"""
NUMBERS_OUTSIDE = """() => {
  const space = document.querySelector('.bv-space').getBoundingClientRect();
  const shown = '.bv-joint-number:not(.bv-hidden)';  // where there is no room some are not
  return [...document.querySelectorAll(shown)].filter((number) => {
    const box = number.getBoundingClientRect();
    return box.top < space.top || box.bottom > space.bottom
      || box.left < space.left || box.right > space.right;
  }).length;
}"""


def assert_all_is_in_the_picture(shown):
    """No joint or number is near the border of the canvas, and nothing drawn on it, at
    several positions of every track."""
    places = []
    for form in shown.bifurc("forms"):
        places += [(form["name"], form["length"] * k / 3) for k in range(3)]
    for one in shown.bifurc("lists"):
        places += [(one["name"], k) for k in range(min(one["count"], 3))]
    for place in places:
        shown.page.evaluate("([name, s]) => bifurc.go(name, s)", place)
        picture_of(shown)
        canvas = shown.bifurc("canvas()")
        joints = np.array(canvas["joints"])
        assert joints.min() > 20
        assert (joints < [canvas["width"] - 20, canvas["height"] - 20]).all()
        assert shown.page.evaluate(BORDER) == 0
        assert shown.page.evaluate(NUMBERS_OUTSIDE) == 0


@pytest.mark.parametrize("name", ["spherical-four-bar", "nearly Bennett", DSG])
def test_the_whole_motion_is_in_the_picture_whatever_the_window(show, name):
    shown = show(name, window={"width": 1280, "height": 800})
    assert_all_is_in_the_picture(shown)
    shown.page.set_viewport_size({"width": 420, "height": 800})
    assert_all_is_in_the_picture(shown)
    shown.page.locator(".bv-space-tools select").select_option("1")
    assert_all_is_in_the_picture(shown)


def test_all_is_in_the_picture_again_when_that_is_asked_for(show):
    shown = show("spherical-four-bar", window={"width": 1280, "height": 800})
    before = shown.bifurc("canvas()")
    box = shown.page.locator(".bv-space canvas").bounding_box()
    shown.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    for _ in range(8):
        shown.page.mouse.wheel(0, -400)
        picture_of(shown)
    assert shown.bifurc("canvas()") != before
    shown.page.get_by_role("button", name="See all").click()
    picture_of(shown)
    joints = np.array(shown.bifurc("canvas()")["joints"])
    assert joints == pytest.approx(np.array(before["joints"]), abs=1e-6)
    assert_all_is_in_the_picture(shown)


def test_the_slider_moves_the_rods(show_shared):
    shown = show_shared(DSG)
    before = shown.bifurc("state()")
    picture = picture_of(shown)
    shown.page.locator(".bv-slider").fill("1000")
    after = shown.bifurc("state()")
    length = next(f for f in shown.bifurc("forms") if f["name"] == after["form"])
    assert after["s"] == pytest.approx(length["length"] / 4)
    assert np.abs(np.array(after["axes"]) - before["axes"]).max() > 0.1
    assert picture_of(shown) != picture


def test_the_slider_stays_at_the_end_of_a_closed_form(show_shared):
    shown = show_shared(DSG)
    slider = shown.page.locator(".bv-slider")
    slider.fill("4000")
    assert shown.bifurc("state().s") == 0
    assert slider.input_value() == "4000"
    shown.bifurc("go(1, 0.5)")
    assert float(slider.input_value()) < 1000


def test_places_beyond_the_ends_are_on_the_form_however_far_away(show_shared):
    shown = show_shared(DSG)
    length = shown.bifurc("forms")[0]["length"]
    for s in (-0.5, 2.5 * length, 1e17, -1e17, 1e300, -1e-300):
        state = shown.page.evaluate("s => bifurc.go(1, s)", s)
        assert 0 <= state["s"] < length
        assert state["s"] == pytest.approx(s % length % length)
        assert np.isfinite(state["angles"]).all()
    shown = show_shared("slider-crank")
    for form in shown.bifurc("forms"):
        if form["closed"]:
            continue
        ends = [
            shown.page.evaluate("([f, s]) => bifurc.go(f, s).s", [form["name"], s])
            for s in (-1e300, 1e300)
        ]
        assert ends == [0, form["length"]]


def test_playing_twice_asks_for_no_more_frames_than_once(show):
    shown = show(DSG)
    counted = """([times]) => new Promise((resolve) => {
      const real = requestAnimationFrame;
      let asked = 0;
      window.requestAnimationFrame = (call) => { asked += 1; return real(call); };
      for (let k = 0; k < times; k += 1) bifurc.play();
      let frames = 0;
      const next = () => {
        frames += 1;
        if (frames < 20) return real(next);
        window.requestAnimationFrame = real;
        bifurc.stop();
        resolve(asked);
      };
      real(next);
    })"""
    once = shown.page.evaluate(counted, [1])
    assert shown.page.evaluate(counted, [6]) < once + 10


def test_a_click_on_a_bifurcation_offers_the_branches_that_leave_it(show_shared):
    shown = show_shared(DSG)
    point = shown.atlas.bifurcations[1]
    shown.click(f".bv-map [data-point={point.name}]")
    names = {shown.atlas.forms[form].name for form, _ in point.passes}
    offered = shown.page.locator(".bv-choice button")
    branches = [offered.nth(i).get_attribute("data-branch") for i in range(4)]
    assert offered.count() == 4
    assert set(branches) == names
    here = shown.bifurc("state()")
    gap = np.array(here["angles"]) - point.point.u
    assert np.abs(np.sin(gap / 2)).max() < 1e-9
    other = next(name for name in branches if name != here["form"])
    offered.nth(branches.index(other)).click()
    shown.page.wait_for_timeout(200)
    assert shown.bifurc("state().form") == other
    assert shown.bifurc("state().playing")


def test_a_click_on_a_curve_takes_the_linkage_there(show_shared):
    shown = show_shared("bennett")
    plane = make_view_document(shown.atlas)["plane"]
    goal = shown.atlas.forms[0].branch(1.0)[list(plane)]
    frame = shown.page.locator(".bv-frame rect").bounding_box()
    x, y = np.degrees(wrap(goal, np.full(2, 2 * np.pi))) / 360 + 0.5
    shown.page.mouse.click(
        frame["x"] + x * frame["width"], frame["y"] + (1 - y) * frame["height"]
    )
    assert shown.bifurc("state().s") == pytest.approx(1.0, abs=0.05)


def test_a_click_on_the_graph_goes_to_the_form(show_shared):
    shown = show_shared(DSG)
    for form in shown.atlas.forms:
        shown.page.locator(f'.bv-graph [data-node="{form.name}"]').click()
        assert shown.bifurc("state().form") == form.name


def test_a_route_plays_to_its_end_and_is_the_one_that_python_finds(show_shared):
    shown = show_shared(DSG)
    shown.bifurc("go('Form I')")
    start = shown.bifurc("state().angles")
    route = shown.bifurc("route('Form II')")
    shown.bifurc("playRoute('Form II', 0.4)")
    expected = find_route(shown.atlas, np.array(start), "Form II")
    assert route["length"] == pytest.approx(expected.length, abs=1e-6)
    through = [leg["at"] for leg in route["legs"][:-1]]
    assert through == [leg.at for leg in expected.legs[:-1]]
    shown.page.wait_for_function("() => !bifurc.state().playing", timeout=20_000)
    end = shown.bifurc("state()")
    assert end["form"] == "Form II (Bennett 4R)"
    gap = np.array(end["angles"]) - expected.path[-1]
    assert np.abs(np.sin(gap / 2)).max() < 1e-6
    assert shown.page.locator(".bv-route-text").inner_text() == "arrived"


@pytest.mark.parametrize("name", [DSG, "altmann"])
def test_every_route_between_two_forms_is_that_of_python(show_shared, name):
    shown = show_shared(name)
    names = [form.name for form in shown.atlas.forms]
    pairs = [(start, goal) for start in names for goal in names if start != goal]
    routes = shown.page.evaluate(
        """pairs => pairs.map(([start, goal]) => {
          bifurc.go(start);
          return bifurc.route(goal) ?? { length: -1, legs: [] };
        })""",
        pairs,
    )
    for (start, goal), route in zip(pairs, routes, strict=True):
        length, stops = route_in_python(shown.atlas, start, goal)
        assert route["length"] == pytest.approx(length)
        assert [leg["at"] for leg in route["legs"][:-1]] == stops


def route_in_python(atlas, start, goal):
    """The length of the route between two forms, and the singular points that it
    passes; -1 and none where there is no route."""
    try:
        route = find_route(atlas, start, goal, count=2)
    except RouteError:
        return -1.0, []
    return route.length, [leg.at for leg in route.legs[:-1]]


def test_playing_pauses_at_a_bifurcation(show):
    shown = show(DSG)
    shown.page.locator(".bv-controls select[aria-label=speed]").select_option("4")
    shown.page.keyboard.press("Space")
    shown.page.wait_for_function("() => !bifurc.state().playing", timeout=20_000)
    assert shown.page.locator(".bv-choice button").count() == 4


def test_keys_move_the_linkage(show_shared):
    shown = show_shared(DSG)
    s = shown.bifurc("state().s")
    shown.page.keyboard.press("ArrowRight")
    assert shown.bifurc("state().s") > s
    shown.page.keyboard.press("3")
    assert shown.bifurc("state().form") == "Form III (non-constructive 6R)"
    for key in ("5", "9"):
        shown.page.keyboard.press(key)
        assert shown.bifurc("state().form") == "Form III (non-constructive 6R)"
    shown.page.keyboard.press("ArrowUp")
    assert shown.page.locator(".bv-choice button").count() == 4
    shown.page.keyboard.press("Space")
    assert shown.bifurc("state().playing")
    shown.page.keyboard.press("ArrowLeft")
    assert not shown.bifurc("state().playing")
    shown.page.keyboard.press("Space")
    shown.page.keyboard.press("Escape")
    assert not shown.bifurc("state().playing")


def test_ghosts_and_the_fixed_link_change_the_picture(show):
    shown = show(DSG)
    calls = shown.bifurc("effort().calls")
    shown.page.keyboard.press("g")
    for _ in range(12):
        shown.page.keyboard.press("ArrowRight")
    picture = picture_of(shown)
    assert shown.bifurc("effort().calls") == calls + 1
    axes = shown.bifurc("state().axes")
    shown.page.locator(".bv-space-tools select").select_option("3")
    assert picture_of(shown) != picture
    assert shown.bifurc("state().axes") == axes


def test_the_map_can_be_drawn_in_any_plane(show):
    shown = show(DSG)
    curve = shown.page.locator(".bv-map .bv-curve").first
    drawn = {curve.get_attribute("d")}
    shown.page.locator("select[aria-label^=horizontal]").select_option("1")
    drawn.add(curve.get_attribute("d"))
    shown.page.locator(".bv-map-tools input").check()
    drawn.add(curve.get_attribute("d"))
    assert len(drawn) == 3
    assert shown.page.locator(".bv-axis").first.text_content() == "first principal axis"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_forms_have_the_colours_of_the_figures(show, theme):
    shown = show(DSG, color_scheme=theme)
    for index, form in enumerate(shown.atlas.forms):
        curve = shown.page.locator(f'.bv-map [data-form="{form.name}"]')
        assert curve.get_attribute("stroke") == form_style(index).color
    back = "() => getComputedStyle(document.querySelector('main')).backgroundColor"
    is_dark = sum(map(int, shown.page.evaluate(back)[4:-1].split(","))) < 200
    assert is_dark == (theme == "dark")


def test_configurations_that_do_not_move_are_shown_one_by_one(show_shared):
    shown = show_shared("rigid")
    assert {"name": "rigid assemblies", "count": 8} in shown.bifurc("lists")
    angles = [shown.bifurc(f"go('rigid assemblies', {k}).angles") for k in range(8)]
    assert len({tuple(one) for one in angles}) == 8
    loop = loop_of(shown.atlas)
    assert loop.closure_error(np.array(angles)).max() < 1e-9


def test_a_near_motion_runs_like_a_form(show_shared):
    shown = show_shared("nearly Bennett")
    (curve,) = shown.bifurc("forms")
    assert curve["name"] == "near motion 1"
    places = np.linspace(0.0, curve["length"], 9)
    angles = [shown.bifurc(f"go('near motion 1', {s}).angles") for s in places]
    error = loop_of(shown.atlas).closure_error(np.array(angles)).max()
    assert 1e-9 < error < 1e-2


def test_a_surface_is_shown_by_closed_configurations(show_shared):
    shown = show_shared("folded Sarrus")
    (surface,) = shown.bifurc("lists")
    states = [
        shown.bifurc(f"go('surface 1', {k})") for k in range(0, surface["count"], 50)
    ]
    loop = loop_of(shown.atlas)
    angles = np.array([state["angles"] for state in states])
    assert loop.closure_error(angles).max() < 1e-9


def test_where_a_surface_is_met_it_is_offered(show_shared):
    shown = show_shared("folded Sarrus")
    point = next(point for point in shown.atlas.points if point.surfaces)
    form, s = point.passes[0]
    name = shown.atlas.forms[form].name
    shown.page.evaluate("([f, s]) => bifurc.go(f, s)", [name, s])
    offered = shown.page.locator(".bv-choice button").all_inner_texts()
    assert any("surface 1" in text for text in offered)


def test_a_linkage_that_cannot_be_assembled_is_drawn_open(show_shared):
    shown = show_shared("too long")
    assert shown.bifurc("state().form") == "open chain"
    assert "no form" in shown.page.locator(".bv-note").text_content()
    assert drawn_share(shown) > 0.002


def test_wrong_calls_of_scripts_are_refused_by_name(show_shared):
    shown = show_shared(DSG)
    before = shown.bifurc("state()")
    for call, words in (
        ("go('Form X')", "form Form X"),
        ("go(0)", "form 0"),
        ("go(5, 1)", "form 5"),
        ("go('5')", "form 5"),
        ("go(1.5)", "form 1.5"),
        ("go()", "form undefined"),
        ("go(1, Infinity)", "s = Infinity"),
        ("go(1, '1')", "s = 1"),
        ("go(1, NaN)", "s = NaN"),
        ("route('Form X')", "form Form X"),
        ("playRoute('Form X')", "form Form X"),
        ("playRoute('Form II', 0)", "seconds = 0"),
        ("playRoute('Form II', -1)", "seconds = -1"),
        ("playRoute('Form II', '1')", "seconds = 1"),
    ):
        caught = f"() => {{ try {{ bifurc.{call} }} catch (e) {{ return `${{e}}` }} }}"
        assert words in shown.page.evaluate(caught)
    assert shown.bifurc("state()") == before


@pytest.mark.parametrize("name", [DSG, "generic 12R"])
@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_is_wider_than_the_window(show, name, width):
    shown = show(name, window={"width": width, "height": 800})
    wide = shown.page.evaluate("() => document.documentElement.scrollWidth")
    assert wide <= width
    inside = "e => { const b = e.getBoundingClientRect(); return b.x >= 0 && b.right <= innerWidth + 1 && b.width > 0 }"
    for label in shown.page.locator(".bv-joint-number").all():
        assert label.evaluate(inside)


def test_without_webgl_map_and_numbers_work(show):
    before = """
      const get = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest);
      };"""
    shown = show(DSG, before=before)
    assert "no WebGL" in shown.page.locator(".bv-no-webgl").inner_text()
    shown.click(".bv-map [data-point=B1]")
    assert shown.page.locator(".bv-choice button").count() == 4


def test_forms_stand_in_the_order_of_their_numbers(browser, atlas_of, tmp_path):
    atlas = atlas_of(DSG).renamed(["Form 10", "Form 2", "Form 1", "Bennett 4R"])
    path = write_page(make_view_document(atlas), tmp_path / "page.html")
    page = browser.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready=true]", timeout=20_000)
    names = page.evaluate("() => bifurc.forms.map((form) => form.name)")
    page.close()
    assert names == ["Bennett 4R", "Form 1", "Form 2", "Form 10"]
    assert names == [form.name for form in listed_forms(atlas)]


def test_of_many_forms_those_are_listed_that_hold_the_words_of_the_filter(
    browser, atlas_of, tmp_path
):
    document = make_view_document(atlas_of("spherical-four-bar"))
    first = document["forms"][0]
    document["forms"] += [{**first, "name": f"Copy {k}"} for k in range(30)]
    page = browser.new_page()
    page.goto(write_page(document, tmp_path / "many.html").as_uri())
    page.wait_for_selector(".bv-forms tbody button")
    seen = page.locator(".bv-forms tbody button:visible")
    total = seen.count()
    assert total > 30
    page.get_by_role("searchbox").fill("copy 27")
    assert seen.all_inner_texts() == ["Copy 27"]
    page.get_by_role("searchbox").fill("")
    assert seen.count() == total
    for order in ("ascending", "descending"):
        page.get_by_role("button", name="length").click()
        head = page.locator(".bv-forms th[data-column=size]")
        assert head.get_attribute("aria-sort") == order
        lengths = page.locator(".bv-forms td:nth-child(4)").all_inner_texts()
        degrees = [float(text.removesuffix("°")) for text in lengths]
        assert degrees == sorted(degrees, reverse=order == "descending")
    page.close()


def atlas_of_many_forms(atlas, count):
    """Forms that meet in a tree, each one of the first ones with some later ones."""
    (form, *_), (point, *_) = atlas.forms, atlas.points
    forms = [replace(form, name=f"Form {k + 1}") for k in range(count)]
    points = [
        replace(point, name=f"B{k}", passes=((k, 1.0), ((k - 1) // 3, 2.0)))
        for k in range(1, count)
        if k % 11
    ]
    others = {"near_misses": (), "dead_points": ()}
    return replace(atlas, forms=tuple(forms), points=tuple(points), **others)


GRAPH = """() => {
  const boxOf = (node) => { const { left, top, right, bottom } = node.getBoundingClientRect(); return [left, top, right, bottom]; };
  const shapes = [...document.querySelectorAll('.bv-box > :is(rect, circle)')];
  return { room: boxOf(document.querySelector('.bv-graph-box')), shapes: shapes.map(boxOf) };
}"""


@pytest.mark.parametrize("count", [1, 2, 30, 100])
def test_the_graph_stays_in_its_box_and_no_two_forms_overlap(
    browser, atlas_of, tmp_path, count
):
    atlas = atlas_of_many_forms(atlas_of(DSG), count)
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(write_page(make_view_document(atlas), tmp_path / "graph.html").as_uri())
    page.wait_for_selector("body[data-ready=true]", timeout=20_000)
    graph = page.evaluate(GRAPH)
    page.close()
    shapes, room = np.array(graph["shapes"]), graph["room"]
    assert len(shapes) == count
    assert (shapes[:, :2] >= room[:2]).all()
    assert (shapes[:, 2:] <= room[2:]).all()
    for k, one in enumerate(shapes):
        others = shapes[:k]
        width = np.minimum(one[2], others[:, 2]) - np.maximum(one[0], others[:, 0])
        height = np.minimum(one[3], others[:, 3]) - np.maximum(one[1], others[:, 1])
        assert not np.any((width > 0) & (height > 0))
