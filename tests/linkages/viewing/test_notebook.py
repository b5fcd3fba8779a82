"""The widget: its traits lead the linkage and follow it."""

import json
import subprocess
import sys

import numpy as np
import pytest

import linkages
from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from linkages.labels import NoLinkageError
from linkages.viewing.document import make_view_document
from linkages.viewing.page import viewer_script

DSG = "special-double-subtractive-goldberg"

# A model as anywidget hands it over, with what it was told to save; then the view.
FAKE_NOTEBOOK = """async ([script, values]) => {
  const listeners = [];
  window.saved = [];
  window.model = {
    get: (name) => values[name],
    set: (name, value) => {
      if (values[name] === value) return;
      values[name] = value;
      for (const [names, listener] of [...listeners]) {
        if (names.split(' ').includes(`change:${name}`)) listener();
      }
    },
    on: (names, listener) => listeners.push([names, listener]),
    off: (names, listener) => {
      const at = listeners.findIndex((one) => one[0] === names && one[1] === listener);
      if (at >= 0) listeners.splice(at, 1);
    },
    save_changes: () => window.saved.push({ form: values.form, position: values.position }),
  };
  const source = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
  const { default: widget } = await import(source);
  const el = document.createElement('div');
  window.leave = widget.render({ model: window.model, el });
  document.body.append(el);
}"""


@pytest.fixture
def notebook(browser, atlas_of):
    """A page with the widget of a linkage in it, as a notebook shows it."""
    page = browser.new_page(viewport={"width": 900, "height": 720})
    messages = []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    atlas = atlas_of(DSG)
    values = {"document": make_view_document(atlas), "form": "Form I (constructive 6R)"}
    values["position"] = 1.25
    page.evaluate(FAKE_NOTEBOOK, [viewer_script(), json.loads(json.dumps(values))])
    page.wait_for_selector(".bv-forms tbody button")
    yield page
    assert messages == []
    page.close()


def test_the_traits_lead_the_linkage(notebook):
    pressed = notebook.locator(".bv-forms tbody button[aria-pressed=true]")
    assert pressed.get_attribute("data-track") == "Form I (constructive 6R)"
    slider = notebook.locator(".bv-slider")
    at_first = slider.input_value()
    notebook.evaluate("() => model.set('position', 2.5)")
    assert float(slider.input_value()) == pytest.approx(2 * float(at_first))
    notebook.evaluate("() => model.set('form', 'Form II (Bennett 4R)')")
    assert pressed.get_attribute("data-track") == "Form II (Bennett 4R)"


def test_the_traits_follow_the_reader(notebook):
    notebook.locator(".bv-forms tbody button").nth(2).click()
    notebook.wait_for_function("() => saved.length > 0")
    last = notebook.evaluate("() => saved.at(-1)")
    assert last["form"] == "Form III (non-constructive 6R)"
    assert last["position"] > 0
    notebook.evaluate("() => leave()")


def test_a_view_that_is_left_gives_its_picture_back(notebook):
    is_lost = """() => {
      const canvas = document.querySelector('.bv-space canvas');
      leave();
      return canvas.getContext('webgl2').isContextLost();
    }"""
    assert notebook.evaluate(is_lost)
    notebook.emulate_media(color_scheme="dark")
    notebook.evaluate("() => model.set('position', 2.0)")
    notebook.wait_for_timeout(100)


def test_two_widgets_on_a_page_move_by_themselves(notebook, atlas_of):
    values = {"document": make_view_document(atlas_of("bennett"))}
    values |= {"form": atlas_of("bennett").forms[0].name, "position": 0.5}
    notebook.evaluate(FAKE_NOTEBOOK, [viewer_script(), json.loads(json.dumps(values))])
    notebook.wait_for_function(
        "() => document.querySelectorAll('.bv-forms tbody button').length > 4"
    )
    sliders = notebook.locator(".bv-slider")
    first, second = (float(sliders.nth(k).input_value()) for k in range(2))
    sliders.nth(1).focus()
    notebook.keyboard.press("ArrowRight")
    assert float(sliders.nth(1).input_value()) > second
    assert float(sliders.nth(0).input_value()) == first


def test_a_widget_begins_at_the_first_form_and_knows_all_names(atlas_of):
    pytest.importorskip("anywidget", reason="the widget needs anywidget")
    widget = linkages.view(atlas_of(DSG))
    assert widget.form == "Form I (constructive 6R)"
    widget.form = "Form II"
    assert widget.form == "Form II (Bennett 4R)"
    assert linkages.view(atlas_of("rigid")).form == "rigid assemblies"
    assert linkages.view(atlas_of("too long")).form == "open chain"


def test_traits_that_cannot_be_are_refused_by_name(atlas_of):
    traitlets = pytest.importorskip("traitlets", reason="the widget needs anywidget")
    pytest.importorskip("anywidget", reason="the widget needs anywidget")
    widget = linkages.view(atlas_of(DSG))
    with pytest.raises(traitlets.TraitError, match="form 'Form X'"):
        widget.form = "Form X"
    with pytest.raises(traitlets.TraitError, match="position nan"):
        widget.position = np.nan


def test_a_position_is_brought_onto_the_form(atlas_of):
    pytest.importorskip("anywidget", reason="the widget needs anywidget")
    atlas = atlas_of(DSG)
    length = {form.name: form.branch.length for form in atlas.forms}
    widget = linkages.view(atlas)
    widget.position = length[widget.form] + 1.0
    assert widget.position == pytest.approx(1.0)
    widget.position = -1.0
    far = widget.position
    assert far == pytest.approx(length[widget.form] - 1.0)
    shortest = min(length, key=length.get)
    widget.form = shortest
    assert widget.position == pytest.approx(far % length[shortest])
    with widget.hold_trait_notifications():
        widget.position = 100.0
        widget.form = "Form I"
    assert widget.position == pytest.approx(100 % length[widget.form])
    rigid = linkages.view(atlas_of("rigid"))
    rigid.position = 100
    assert rigid.position == len(atlas_of("rigid").rigid) - 1
    rigid.position = 1.4
    assert rigid.position == 1.0


def test_the_browser_places_positions_as_python_does(notebook, atlas_of):
    pytest.importorskip("anywidget", reason="the widget needs anywidget")
    widget = linkages.view(atlas_of(DSG))
    slider = notebook.locator(".bv-slider")
    for position in (-1.0, 100.0, 2.5):
        widget.position = position
        notebook.evaluate("s => model.set('position', s)", position)
        at_given = slider.input_value()
        notebook.evaluate("s => model.set('position', s)", widget.position)
        assert slider.input_value() == at_given


def test_what_is_no_atlas_of_a_linkage_is_refused():
    with pytest.raises(ProblemError, match="atlas"):
        linkages.view("bennett")
    circle = FunctionProblem(lambda u: np.array([u @ u - 1.0]), [[-2, 2], [-2, 2]])
    with pytest.raises(NoLinkageError, match="not of a linkage"):
        linkages.view(explore(circle))


def test_without_anywidget_it_is_said_what_to_install():
    code = (
        "import sys; sys.modules['anywidget'] = None\n"
        "import linkages\n"
        "atlas = linkages.map_linkage(linkages.load('bennett'))\n"
        "try:\n    linkages.view(atlas)\n"
        "except ImportError as error:\n    print(error)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout.strip() == (
        "the widget needs anywidget; pip install 'bifurc[jupyter]' brings it"
    )
