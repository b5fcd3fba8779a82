"""Negative controls: a linkage changed by a thousandth stops moving, unless the change
keeps every condition."""

from pathlib import Path

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.mobility import held_gap, survey
from studies.negative_controls import (
    break_conditions,
    conditioned_loops,
    controls,
)

PAGE = Path(__file__).parents[2] / "docs" / "negative_controls.md"


def mobilities(name, every):
    """The mobility after one change in so many, by change: all of them are on the page
    of the docs."""
    changes = list(break_conditions(entry(name).build()))[::every]
    return {changed: survey(broken, starts=20).mobility for changed, broken in changes}


@pytest.mark.parametrize(
    "name",
    ["bennett-line-symmetric", "goldberg-5r", "myard-plane-symmetric-5r"],
)
def test_every_change_of_an_entry_stops_the_linkage(name):
    assert set(mobilities(name, every=4).values()) == {0}


def test_line_symmetric_linkage_moves_only_after_changes_that_keep_its_symmetry():
    mobility = mobilities("bricard-line-symmetric", every=4)
    keeps_symmetry = {changed: "together" in changed for changed in mobility}
    assert mobility == keeps_symmetry
    assert set(keeps_symmetry.values()) == {True, False}


def test_controls_of_the_bennett_linkage_are_those_of_the_page():
    found = list(controls(entry("bennett").build()))
    stiffnesses = [control.stiffness for control in found]
    (row,) = [line for line in PAGE.read_text().splitlines() if "| bennett |" in line]
    cells = row.strip("| ").split(" | ")
    assert cells[1] == cells[2] == str(len(found))
    assert [control.changed for control in found if control.mobility] == []
    assert np.nanmin(stiffnesses) == pytest.approx(float(cells[3]), rel=0.1)


def test_length_of_the_repeated_composite_link_is_no_condition_of_the_double_goldberg_linkage():
    """With links 12 and 45 free but alike it is a linkage of Mavroidis and Roth."""
    loops = dict(break_conditions(entry("wohlhart-double-goldberg").build()))
    assert survey(loops["a12, a45 together"]).mobility == 1
    assert survey(loops["a12"]).mobility == 0
    assert survey(loops["a23, a61 together"]).mobility == 0


def test_controls_change_one_entry_by_a_thousandth():
    loop = entry("bennett").build()
    broken = dict(break_conditions(loop))["alpha12"]
    assert broken.twists[0] - loop.twists[0] == pytest.approx(1e-3)
    assert broken.lengths == loop.lengths and broken.twists[1:] == loop.twists[1:]


def test_held_gap_is_zero_for_a_linkage_and_not_for_a_broken_one():
    loop = entry("goldberg-5r").build()
    broken = Loop((loop.lengths[0] + 0.1, *loop.lengths[1:]), loop.twists, loop.offsets)
    assert held_gap(loop) < 1e-12 < 1e-4 < held_gap(broken)


def test_page_of_the_docs_has_a_row_for_every_linkage_that_needs_a_condition():
    rows = [
        line.split(" | ")[0][2:]
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ")
    ]
    assert rows[1:] == list(conditioned_loops())
