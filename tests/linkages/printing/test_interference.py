"""Parts that meet are seen wherever they do, and by how much."""

import numpy as np
import pytest

from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.printing.assembly import Assembly, Dimensions, Kind, Seats
from linkages.printing.seating import find_meetings, nearest_approach

DIMENSIONS = Dimensions(6.0, 0.3, 1.2)


@pytest.fixture(scope="module")
def form():
    return map_linkage(load("bennett")).forms[0]


def assembly_at(heights, sides):
    loop = load("bennett").loop
    scaled = loop.scaled(100 / loop.characteristic_length)
    return Assembly(scaled, DIMENSIONS, Seats(np.array(heights), np.array(sides)))


@pytest.mark.parametrize(
    "heights", [[0, 0, 0, 0], [20.0, -12, 25, -23], [-30, 14, 5, 22]]
)
@pytest.mark.parametrize("sides", [[1, 1, 1, 1], [1, -1, -1, 1]])
def test_nothing_along_a_form_is_nearer_than_is_said(form, heights, sides):
    assembly = assembly_at(heights, np.array(sides, float))
    nearest = nearest_approach(assembly, form)
    s = np.linspace(0, form.branch.length, 2003)
    seen = assembly.clearances(assembly.placed(form.branch(s)), assembly.pairs).min()
    assert nearest.clearance <= seen + 1e-9
    assert nearest.at_least <= seen
    assert nearest.error < 0.1
    there = assembly.placed(nearest.theta[None])
    assert assembly.clearances(there, assembly.pairs).min() == pytest.approx(
        nearest.clearance, abs=1e-9
    )


def test_all_parts_that_meet_are_listed_the_nearest_first(form):
    assembly = assembly_at([0, 0, 0, 0], np.ones(4))
    meetings = find_meetings(assembly, form, 0.3)
    named = [meeting.parts for meeting in meetings]
    assert len(set(named)) == len(named)
    links = [
        [part.joint for part in parts if part.kind is Kind.LINK] for parts in named
    ]
    assert [0, 2] in links  # the common normals of a Bennett linkage meet
    depths = [meeting.clearance for meeting in meetings]
    assert depths == sorted(depths)
    assert depths[0] == pytest.approx(nearest_approach(assembly, form).clearance)
    assert max(depths) < 0.3
