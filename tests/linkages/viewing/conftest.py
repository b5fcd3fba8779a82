"""Maps that are shown, and a browser to show them in."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from bifurc.atlas import Atlas
from linkages.app.answer.verdict import judge
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.viewing.document import make_view_document
from linkages.viewing.page import write_page
from tests.linkages.mechanisms.frameworks import flexible_octahedron
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.single_loops import catalogue_loop
from tests.linkages.mechanisms.spatial_mechanisms import (
    one_of_each,
    platform,
    rods,
    rsrs,
)
from tests.linkages.mechanisms.test_couplings import five_bar
from tests.maps import map_of

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
# drawn without a graphics card, a small window is quicker
WINDOW = {"width": 800, "height": 560}


def degrees(*angles):
    return np.radians(angles)


LOOPS = {
    "folded Sarrus": lambda: Loop(
        [1.25**0.5, 1.25**0.5, 0, 1.49**0.5, 1.49**0.5, 0],
        degrees(0, 0, 90, 0, 0, 90),
        [0] * 6,
    ),
    "rigid": lambda: Loop(
        [1.5, 0.7, 1.2, 0.9, 1.1, 0.6],
        degrees(50, 80, 30, 100, 60, 110),
        [0.2, -0.3, 0.5, 0.1, -0.4, 0.6],
    ),
    "too long": lambda: Loop(
        [10, 1, 1, 1, 1, 1],
        degrees(50, 80, 30, 100, 60, 110),
        [0.2, -0.3, 0.5, 0.1, -0.4, 0.6],
    ),
    "nearly Bennett": lambda: rounded(load("bennett").loop),
    "generic 7R": lambda: Loop(
        [1.5, 0.7, 1.2, 0.9, 1.1, 0.6, 0.8],
        degrees(50, 80, 30, 100, 60, 110, 45),
        [0.2, -0.3, 0.5, 0.1, -0.4, 0.6, 0.1],
    ),
    "generic 12R": lambda: Loop(
        [1.5, 0.7, 1.2, 0.9, 1.1, 0.6] * 2,
        np.tile(degrees(50, 80, 30, 100, 60, 110), 2),
        [0.2, -0.3, 0.5, 0.1, -0.4, 0.6] * 2,
    ),
    "huge": lambda: load("bricard-line-symmetric").loop.scaled(1e60),
    "tiny": lambda: load("bennett").loop.scaled(1e-60),
}


def rounded(loop):
    lengths, twists, offsets = (np.round(column, 3) for column in loop.arrays)
    return Loop(lengths, twists, offsets, "nearly Bennett")


UP = (0, 0, 1)


def slider_crank():
    """A crank, a rod, and a slider on a line through the pivot of the crank."""
    return Mechanism(
        (
            Joint("J1", "revolute", ("frame", "crank"), (0, 0, 0), UP),
            Joint("J2", "revolute", ("crank", "rod"), (1, 0, 0), UP),
            Joint("J3", "revolute", ("rod", "slider"), (4, 0, 0), UP),
            Joint("J4", "prismatic", ("frame", "slider"), direction=(1, 0, 0)),
        ),
        "slider-crank",
    )


def watt():
    """Two four-bars that share the coupler and the rocker of the first one."""
    places = {
        ("frame", "crank"): (0, 0, 0),
        ("crank", "coupler"): (0.4, 1.2, 0),
        ("coupler", "rocker"): (2.3, 1.8, 0),
        ("frame", "rocker"): (2.8, 0, 0),
        ("coupler", "arm"): (1.6, 3.0, 0),
        ("arm", "hand"): (3.6, 3.4, 0),
        ("rocker", "hand"): (4.0, 1.4, 0),
    }
    joints = [
        Joint(name, "revolute", bodies, place, UP)
        for name, (bodies, place) in zip("ABCDEFG", places.items(), strict=True)
    ]
    return Mechanism(tuple(joints), "Watt six-bar")


def case(name):
    return lambda: mechanism_of_case(cases()[name])


MECHANISMS = {
    "sheet of 3": lambda: load("miura-ori", rows=2, columns=2),
    "sheet of 12": lambda: load("miura-ori", rows=11, columns=11),
    "DSG of joints": lambda: catalogue_loop("special-double-subtractive-goldberg"),
    "slider-crank": slider_crank,
    "Watt": watt,
    "Sarrus": case("Sarrus with a P joint between base and platform"),
    "Kempe": case("Kempe's four antiparallelograms (planar limit of thesis 5.4.5)"),
    "CRCR": case("Bennett geometry with joints CRCR"),
    "platform": lambda: platform((0.0, 0.02, -0.03, 0.05, 0.0, None)),
    "geared": lambda: five_bar(E=Coupling("A", 0.5, 0.3)),
    "RSRS": lambda: rsrs().with_locks({"R1": 0.0}),
    "one of each": one_of_each,
    "rods": rods,
    "octahedron": flexible_octahedron,
}


@cache
def mapped(name):
    """The atlas of a linkage of the catalogue, or of one of those above."""
    made = (LOOPS | MECHANISMS).get(name)
    return map_of(made() if made else load(name))


@pytest.fixture(scope="session")
def atlas_of():
    return mapped


@dataclass
class OpenPage:
    """A page in the browser, the atlas that it shows, and what the browser says of it:
    console messages, errors, and addresses that were asked for."""

    page: object
    atlas: Atlas
    messages: list[str]
    requests: list[str]

    def bifurc(self, call):
        """The value of ``bifurc.CALL`` in the page."""
        return self.page.evaluate(f"() => bifurc.{call}")

    def click(self, selector):
        """Click in the middle of the first element, whatever lies over it."""
        box = self.page.locator(selector).first.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.click(x, y)


@pytest.fixture(scope="session")
def browser():
    """Chromium without a window; tests are skipped where there is none."""
    api = pytest.importorskip(
        "playwright.sync_api", reason="playwright drives the browser: pip install it"
    )
    named = (shutil.which(name) for name in BROWSERS)
    program = os.environ.get("BIFURC_CHROMIUM") or next(filter(None, named), None)
    if program is None:
        pytest.skip("no Chromium was found: install chromium-headless-shell")
    with api.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=program, args=FLAGS)
        yield chromium
        chromium.close()


def open_page(browser, name, folder, window=WINDOW, before="", trace=(), **options):
    """The page of a linkage, opened from disk and ready to be used."""
    atlas = mapped(name)
    path = folder / "page.html"
    write_page(make_view_document(atlas, judge(atlas).sentence, trace), path)
    context = browser.new_context(viewport=window, **options)
    if before:
        context.add_init_script(before)
    page = context.new_page()
    shown = OpenPage(page, atlas, [], [])
    page.on("console", lambda message: shown.messages.append(message.text))
    page.on("pageerror", lambda error: shown.messages.append(str(error)))
    page.on("request", lambda request: shown.requests.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready=true]", timeout=20_000)
    return shown


@pytest.fixture
def show(browser, tmp_path):
    """A function that opens the page of a linkage, as nobody has used it yet."""
    opened = []

    def show_page(name, **options):
        opened.append(open_page(browser, name, tmp_path, **options))
        return opened[-1]

    yield show_page
    for shown in opened:
        shown.page.context.close()


@pytest.fixture(scope="session")
def open_pages():
    """The pages that tests share, by the names of their linkages."""
    return {}


@pytest.fixture
def show_shared(browser, open_pages, tmp_path):
    """A function that shows a linkage on a page that other tests use as well, at the
    middle of its first form."""

    def show_page(name):
        if name not in open_pages:
            open_pages[name] = open_page(browser, name, tmp_path)
        shown = open_pages[name]
        shown.bifurc("stop()")
        shown.bifurc("go(1)")
        return shown

    return show_page
