"""Hinges are put where nothing meets, or it is said that no such seats were seen."""

import numpy as np
import pytest

from linkages.linkage import load
from linkages.printing import seating
from linkages.printing.assembly import Dimensions
from linkages.printing.seating import choose_seats
from tests.maps import map_of


def seat(name, diameter, offsets=None, seed=0):
    forms = map_of(name).forms[:1]
    loop = load(name).loop
    scaled = loop.scaled(100 / loop.characteristic_length)
    dimensions = Dimensions(diameter, 0.3, 1.2)
    random = np.random.default_rng(seed)
    return choose_seats(scaled, dimensions, forms, random, offsets)


def test_seats_keep_the_play_between_all_parts_and_can_be_given_again():
    first = seat("bennett", 6.0)
    assert first.is_apart
    assert first.nearest.at_least >= 0.3
    heights = first.assembly.seats.heights
    assert np.abs(heights).max() <= first.reach
    assert heights == pytest.approx(np.round(heights, 2), abs=1e-12)
    again = seat("bennett", 6.0, offsets=heights, seed=1)
    assert again.is_apart
    assert np.array_equal(again.assembly.seats.heights, heights)


def test_the_same_seed_gives_the_same_seats():
    first, second = seat("bennett", 6.0).assembly, seat("bennett", 6.0).assembly
    assert np.array_equal(first.seats.heights, second.seats.heights)
    assert np.array_equal(first.seats.sides, second.seats.sides)


def test_where_no_seats_are_seen_the_best_ones_and_their_meeting_come_back(monkeypatch):
    monkeypatch.setattr(seating, "REACHES", (0.25,))
    monkeypatch.setattr(seating, "ROUNDS", 2)
    thick = seat("bennett", 60.0)
    assert not thick.is_apart
    assert thick.nearest.at_least < 0.3
    straight = seat("bennett", 6.0, offsets=np.zeros(4))
    assert not straight.is_apart
    assert straight.nearest.clearance < -1.0
