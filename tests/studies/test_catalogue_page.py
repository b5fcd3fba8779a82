"""The page of the catalogue is the one that the entries make, and the figures can be
drawn."""

import re

import numpy as np

from linkages.app.scene_figure import draw_configuration
from linkages.catalogue import catalogue, entry
from linkages.linkage import load
from linkages.mapping import map_linkage
from studies import catalogue_page
from studies.catalogue_page import (
    PAGE,
    clearest_configuration,
    count_map,
    make_page,
    read_counts,
)
from studies.relations_figure import draw_relations

CLOSED_FORMS = re.compile(r"^Closed forms:\n\n(?:- .*\n|  - .*\n)+\n", re.MULTILINE)


def test_the_page_is_current(monkeypatch):
    page = PAGE.read_text(encoding="utf-8")
    monkeypatch.setattr(
        catalogue_page, "_closed_forms", lambda found: []
    )  # LaTeX depends on the version of sympy
    made = make_page(read_counts(page))
    assert made == CLOSED_FORMS.sub("", page), (
        "run python -m studies.catalogue_page --keep-counts"
    )


def test_the_page_holds_every_closed_form():
    page = PAGE.read_text(encoding="utf-8")
    for linkage in catalogue().values():
        for form in linkage.closed_forms:
            assert f"- {form.form} ({form.source}):\n" in page


def test_the_page_counts_the_map_of_every_linkage():
    counts = read_counts(PAGE.read_text(encoding="utf-8"))
    assert list(counts) == list(catalogue())
    assert all(
        re.match(r"\d+ forms?, \d+ bifurcations?, \d+ components?", count)
        for count in counts.values()
    )


def test_a_count_of_the_page_is_that_of_the_map():
    counts = read_counts(PAGE.read_text(encoding="utf-8"))
    for name in ("bennett", "special-double-subtractive-goldberg"):
        assert counts[name] == count_map(map_linkage(load(name)))


def test_every_linkage_has_its_section_and_every_condition_stands_on_the_page():
    page = PAGE.read_text(encoding="utf-8")
    assert re.findall(r"^## (\S+)$", page, re.MULTILINE) == list(catalogue())
    assert all(
        condition.text in page
        for found in catalogue().values()
        for condition in found.conditions
    )


def test_links_on_the_page_lead_to_sections():
    page = PAGE.read_text(encoding="utf-8")
    assert set(re.findall(r"\]\(#(\S+?)\)", page)) <= set(catalogue())


def test_a_parallelogram_is_not_drawn_folded():
    found = entry("parallelogram")
    theta = clearest_configuration(map_linkage(load("parallelogram")), found)
    assert np.abs(np.sin(theta)).max() > 0.5


def test_a_configuration_is_drawn_with_its_joint_numbers():
    figure = draw_configuration(
        entry("bennett").build(), np.array([1.0, 2.0, -1.0, -2.0]), "Bennett"
    )
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[0].texts] == ["1", "2", "3", "4"]


def test_the_relations_are_drawn_with_every_linkage_that_has_one():
    figure = draw_relations()
    shown = "\n".join(text.get_text() for text in figure.axes[0].texts).replace(
        "\n", ""
    )
    for name in ("bennett-lb-2", "wohlhart-symmetric", "torus-5r"):
        assert name in shown
