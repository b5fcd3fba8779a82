"""Generic solutions that one process keeps for others."""

import numpy as np
import pytest

from linkages.dyads import generic
from linkages.dyads.generic import CACHE, find_generic, keep, kept, name_of
from linkages.dyads.group import Pattern, group_of

TRIAD = Pattern(((3, 4, 5), (0, 3), (1, 4), (2, 5)), 3)


@pytest.fixture(scope="module")
def triad():
    return group_of(TRIAD)


@pytest.fixture(scope="module")
def solutions(triad):
    return find_generic(triad, 10)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE, str(tmp_path / "kept"))
    return tmp_path / "kept"


def test_what_was_kept_is_read_again(triad, solutions, folder):
    assert kept("triad", triad.family) is None
    keep("triad", solutions)
    again = kept("triad", triad.family)
    assert again.trace == solutions.trace
    assert np.array_equal(again.fibre.solutions, solutions.fibre.solutions)
    assert [path.name for path in folder.iterdir()] == ["triad.npz"]


def test_a_damaged_file_is_found_anew(triad, solutions, folder):
    keep("triad", solutions)
    place = folder / "triad.npz"
    whole = place.read_bytes()
    for damaged in (b"", b"not a file of numbers", whole[: len(whole) // 2]):
        place.write_bytes(damaged)
        assert kept("triad", triad.family) is None


@pytest.mark.parametrize("wrong", ["solutions", "equations"])
def test_numbers_that_solve_nothing_are_not_taken(triad, solutions, folder, wrong):
    if wrong == "solutions":
        solutions.fibre.solutions[0, 0] += 1e-6
        keep("triad", solutions)
        solutions.fibre.solutions[0, 0] -= 1e-6
        assert kept("triad", triad.family) is None
    else:
        keep("triad", solutions)
        on_sphere = group_of(TRIAD._replace(is_spherical=True))
        assert kept("triad", on_sphere.family) is None


def test_a_folder_that_cannot_be_written_keeps_nothing(
    triad, solutions, tmp_path, monkeypatch
):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv(CACHE, str(tmp_path / "file"))
    keep("triad", solutions)
    assert kept("triad", triad.family) is None


def test_solutions_are_found_once(triad, folder, monkeypatch):
    monkeypatch.setattr(generic, "_known", {})
    monkeypatch.setattr(generic, "_shipped", dict)
    monkeypatch.delitem(triad.__dict__, "generic", raising=False)
    found = triad.generic
    monkeypatch.setattr(generic, "find_generic", None)
    monkeypatch.setattr(generic, "_known", {})
    monkeypatch.delitem(triad.__dict__, "generic")
    assert triad.generic.count == found.count == 6
    assert [path.stem for path in folder.iterdir()] == [name_of(triad.family)]
