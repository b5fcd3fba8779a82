"""Linkages made with errors, and what becomes of their maps."""

import numpy as np
import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.tolerance import climb, half_branches, measure, slope
from linkages.catalogue import entry
from linkages.linkage import load
from linkages.loop import GeometryError
from linkages.mapping import map_linkage
from linkages.tolerance import make_with_errors


@pytest.fixture(scope="module")
def parallelogram():
    return map_linkage(load("parallelogram")), entry("parallelogram").build()


def test_errors_have_the_size_that_is_asked_for():
    loop = entry("special-double-subtractive-goldberg").build()
    made = [
        make_with_errors(loop, 1e-3, np.random.default_rng(seed)) for seed in range(200)
    ]
    off = np.array(
        [np.concatenate(m.arrays) - np.concatenate(loop.arrays) for m in made]
    )
    lengths, twists = off[:, :6] / loop.characteristic_length, off[:, 6:12]
    assert np.std(lengths) == pytest.approx(1e-3, rel=0.1) and np.std(
        twists
    ) == pytest.approx(1e-3, rel=0.1)
    assert np.all(off[:, 12:] != 0.0)  # offsets that should be zero are not spared


def test_an_error_below_zero_is_refused():
    with pytest.raises(GeometryError, match="error: -1"):
        make_with_errors(entry("bennett").build(), -1.0, np.random.default_rng(0))


def test_without_errors_the_forms_close_and_the_crossings_stay(parallelogram):
    atlas, loop = parallelogram
    made = measure(atlas, loop, 0.0, 0)
    assert made.largest.max() < 1e-13


def test_the_closure_gap_grows_as_the_error_and_the_near_miss_as_its_root(
    parallelogram,
):
    atlas, loop = parallelogram
    ladder = climb(atlas, loop, [0, 1], 10.0 ** -np.array([4.0, 6.0, 8.0]))
    for i in range(2):
        assert slope(ladder.errors, ladder.gaps[:, :, i]) == pytest.approx(
            1.0, abs=0.01
        )
        assert slope(ladder.errors, ladder.widths[:, :, i]) == pytest.approx(
            0.5, abs=0.02
        )
        assert slope(ladder.errors, ladder.weakest[:, :, i]) == pytest.approx(
            0.5, abs=0.02
        )


def test_every_half_branch_of_a_crossing_leads_to_one_of_another_form(parallelogram):
    atlas, loop = parallelogram
    for point, unfolding in zip(
        atlas.bifurcations, measure(atlas, loop, 1e-5, 3).unfoldings, strict=True
    ):
        names = half_branches(atlas, point)[1]
        assert sorted(i for pair in unfolding.pairs for i in pair) == [0, 1, 2, 3]
        for (
            i,
            j,
        ) in (
            unfolding.pairs
        ):  # a crossing that opens joins neighbours, never the two halves of one form
            assert names[i].split(" form")[0] != names[j].split(" form")[0]


def test_a_slope_is_not_given_where_copies_are_missing():
    assert np.isnan(slope(np.array([1.0, 0.1]), np.array([[1.0, np.nan], [0.1, 0.1]])))


def test_the_command_shows_gaps_and_near_misses_and_draws_them(tmp_path):
    result = CliRunner().invoke(
        main, ["tolerance", "kite", "--samples", "1", "--out", str(tmp_path)]
    )
    assert result.exit_code == 0, result.output
    assert "kite form" in result.output and "near miss" in result.output
    assert (tmp_path / "tolerance.png").stat().st_size > 10_000
    assert (tmp_path / "tolerance.txt").read_text() == result.stdout
