"""The table of the figures of the sources: every figure stands there, and only once."""

import numpy as np
import pytest

from linkages.errata.misprints import misprints
from linkages.source_figures.configurations import atlas_of, linkage_of
from linkages.source_figures.draw import DRAWINGS
from linkages.source_figures.table import (
    Agreement,
    Kind,
    UnknownFigureError,
    figure_named,
    source_figures,
)

# Figures of a chapter or section of the thesis, and of each paper.
THESIS = {
    "2.1": 1, "2.2": 2, "2.3": 3, "2.4": 10,
    "3.2": 2, "3.3": 2, "3.4": 12, "3.5": 1,
    "4.2": 5, "4.3": 4, "4.4": 7,
    "5.2": 7, "5.3": 19, "5.4": 14,
}  # fmt: skip
TABLES = {"thesis": ("3.3.1", "3.5.1", "3.5.2", "3.5.3"), "000": ("2", "3")}
PAPERS = {"000": 17, "001": 5, "003": 4, "004": 13}


def test_every_figure_of_the_sources_is_in_the_table():
    expected = [
        f"thesis-{section}.{number}"
        for section, count in THESIS.items()
        for number in range(1, count + 1)
    ]
    assert len(expected) == 89
    expected += [f"thesis-table-{number}" for number in TABLES["thesis"]]
    for paper, count in PAPERS.items():
        prefix = "001-5." if paper == "001" else f"{paper}-"
        expected += [f"{prefix}{number}" for number in range(1, count + 1)]
        expected += [f"{paper}-table-{number}" for number in TABLES.get(paper, ())]
    assert list(source_figures()) == expected


def test_every_kind_has_a_drawing_and_a_figure():
    assert set(DRAWINGS) == set(Kind)
    assert {figure.kind for figure in source_figures().values()} == set(Kind)


def test_a_figure_that_differs_says_why():
    for figure in source_figures().values():
        if figure.agreement is Agreement.DIFFERS:
            assert figure.remark, figure.name


def test_equations_that_a_remark_calls_misprinted_are_among_the_errata():
    known = " ".join(erratum.equation for erratum in misprints())
    for equation in (
        "(2.3.4)",
        "(2.4.22)",
        "(3.4.8)",
        "(3.4.16)",
        "(5.2.34)",
        "(5.3.6)",
        "(25)",
        "(29)",
        "(2.1)",
        "(2.6)",
    ):
        assert equation in known


def test_a_figure_like_another_takes_over_what_it_does_not_say():
    own = figure_named("001-5.4")
    model = figure_named("thesis-5.2.7")
    exchanged = {"parameters": {"beta": 45, "delta": 60}}
    assert own.content == {**model.content, **exchanged}
    assert own.title == model.title
    assert own.remark != model.remark


def test_an_unknown_figure_is_refused_with_the_nearest_names():
    with pytest.raises(UnknownFigureError, match=r"thesis-5\.2\.7"):
        figure_named("thesis-5.2.77")
    with pytest.raises(UnknownFigureError, match="no name is like it; bifurc figure"):
        figure_named("nothing")


def test_the_caption_holds_name_title_and_remark():
    caption = figure_named("thesis-5.2.4").caption
    assert caption.startswith("thesis-5.2.4: The constructive forms")
    assert caption.endswith("b = 1.0572.")


def test_links_of_paper_001_are_those_of_its_geometry():
    """By (5.1) links 23 and 61 are b/beta, links 34 and 56 d/delta."""
    for name in ("001-5.1", "001-5.3"):
        for panel in figure_named(name).content["panels"]:
            assert panel["labels"][1:3] == ["b", "d"]
            assert panel["labels"][4:] == ["d", "b"]
            twists = np.degrees(linkage_of(panel).loop.arrays.twists)
            is_special = panel["linkage"].startswith("special")
            beta, delta = (60, 45) if is_special else (50, 83)  # as in the thesis
            np.testing.assert_allclose(twists[[1, 5]], beta)
            np.testing.assert_allclose(twists[[2, 4]], delta)


@pytest.mark.parametrize(
    ("figure", "named"),
    [
        (
            "thesis-5.3.16",
            {"I": ("Form I", "Bennett 4R form"), "II": ("Form II", "Bennett 4R form")},
        ),
        (
            "thesis-4.4.7",
            {
                "I": ("Form I", "Form I'"),
                "II": ("Form I'", "Form II"),
                "III": ("Form II", "Form II'"),
                "IV": ("Form II'", "Form I"),
            },
        ),
    ],
)
def test_bifurcations_are_called_as_in_the_source(figure, named):
    atlas = atlas_of(figure_named(figure).content)
    found = {}
    for point in atlas.points:
        forms = {atlas.forms[form].name.split(" (")[0] for form, _ in point.passes}
        found[point.name] = forms
    assert found == {f"B$_{{{number}}}$": set(forms) for number, forms in named.items()}
