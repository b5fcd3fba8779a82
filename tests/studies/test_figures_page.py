"""The page of the figures is the one that their table makes."""

from linkages.source_figures.table import source_figures
from studies.figures_page import KINDS, PAGE, figures_page


def test_the_page_is_current():
    page = PAGE.read_text(encoding="utf-8")
    assert page == figures_page(), "run python -m studies.figures_page"


def test_every_figure_has_a_row_and_every_kind_its_words():
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = [line.split("|")[1].strip() for line in lines if line.count("|") == 6]
    assert [row for row in rows if row in source_figures()] == list(source_figures())
    assert {figure.kind for figure in source_figures().values()} == set(KINDS)
