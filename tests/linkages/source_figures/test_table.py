"""The table of the figures of the sources: every figure stands there, and only once."""

import pytest

from linkages.errata.misprints import misprints
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
PAPERS = {"000": 17, "001": 5, "003": 4, "004": 13}


def test_every_figure_of_the_sources_is_in_the_table():
    expected = [
        f"thesis-{section}.{number}"
        for section, count in THESIS.items()
        for number in range(1, count + 1)
    ]
    assert len(expected) == 89
    for paper, count in PAPERS.items():
        prefix = "001-5." if paper == "001" else f"{paper}-"
        expected += [f"{prefix}{number}" for number in range(1, count + 1)]
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
    assert own.content == model.content
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
