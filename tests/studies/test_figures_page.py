"""The page of the figures is the one that their table makes."""

from itertools import combinations

import pytest

from linkages.source_figures.table import source_figures
from studies.figures_page import KINDS, PAGE, figures_page, lock_kind, moving_joints


def test_the_page_is_current():
    page = PAGE.read_text(encoding="utf-8")
    assert page == figures_page(), "run python -m studies.pages figures"


def test_every_figure_has_a_row_and_every_kind_its_words():
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = [line.split("|")[1].strip() for line in lines if line.count("|") == 6]
    assert [row for row in rows if row in source_figures()] == list(source_figures())
    assert {figure.kind for figure in source_figures().values()} == set(KINDS)


# joints that stand still besides the two that are locked, where there is one
STILL = {(1, 2): 3, (2, 3): 1, (3, 4): 5, (4, 5): 3, (5, 6): 7, (6, 7): 5, (7, 8): 1, (1, 8): 7, (1, 3): 2, (3, 5): 4, (5, 7): 6, (1, 7): 8}  # fmt: skip


@pytest.mark.parametrize("locks", list(combinations(range(1, 9), 2)))
def test_two_locks_leave_a_5r_or_a_6r_linkage(locks):
    still = {*locks}
    if locks in STILL:
        still.add(STILL[locks])
    assert set(moving_joints(locks)) == set(range(1, 9)) - still
    assert lock_kind(locks).endswith("5R") == (locks in STILL)
