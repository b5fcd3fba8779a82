"""Linkages made with errors, and what becomes of their maps."""

import numpy as np
import pytest
from click.testing import CliRunner

from bifurc.system import relative_gaps
from linkages.app.cli import main
from linkages.app.reports.tolerance import climb, half_branches, measure, slope
from linkages.catalogue import entry
from linkages.file import read_file
from linkages.formats.table import mechanism_text
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.mechanisms.of_loop import mechanism_of_loop
from linkages.subject import as_subject
from linkages.tolerance import make_with_errors
from linkages.values import GeometryError
from tests.linkages.app.slider_cranks import slider_crank_text


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
    atlas, _ = parallelogram
    made = measure(atlas, 0.0, 0)
    assert made.largest.max() < 1e-13


def test_the_closure_gap_grows_as_the_error_and_the_near_miss_as_its_root(
    parallelogram,
):
    atlas, _ = parallelogram
    ladder = climb(atlas, [0, 1], 10.0 ** -np.array([4.0, 6.0, 8.0]))
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
    atlas, _ = parallelogram
    for point, unfolding in zip(
        atlas.bifurcations, measure(atlas, 1e-5, 3).unfoldings, strict=True
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


# --- mechanisms -----------------------------------------------------------------------

SLIDER_CRANK = slider_crank_text((0.6, 0.8), 1.2)


def test_a_mechanism_is_made_with_errors_of_its_joints(tmp_path):
    file = tmp_path / "slider_crank.toml"
    file.write_text(SLIDER_CRANK)
    out = tmp_path / "out"
    result = CliRunner().invoke(
        main, ["tolerance", str(file), "--samples", "1", "--out", str(out)]
    )
    assert result.exit_code == 0, result.output
    assert "Errors of joints on bodies of 0.0001" in result.stdout
    assert "near miss (rad, lengths over 0.8)" in result.stdout
    assert (out / "tolerance.txt").read_text() == result.stdout
    # the crossings open as the root of the error
    rows = [row.split() for row in result.stdout.splitlines() if row.startswith("  B")]
    powers = [float(row[1]) for row in rows if row[3:5] == ["0", "of"]]
    assert powers == pytest.approx([0.5] * len(powers), abs=0.02) and powers


def test_a_network_is_made_with_errors_and_joints_locked():
    network = load("four-bennett-network")
    locked = network.held({"2": np.radians(40), "6": np.radians(-75)})
    made = measure(map_linkage(locked), 1e-4, 0)
    assert len(made.largest) == 2
    assert np.all(made.largest > 1e-5) and np.all(made.largest < 1e-2)


def test_joints_are_held_on_the_command_line():
    command = ["tolerance", "four-bennett-network", "--lock", "elbow=40"]
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 2
    assert '"elbow" is not allowed' in result.output


def test_a_loop_given_as_a_mechanism_is_made_as_the_loop(parallelogram, tmp_path):
    atlas, loop = parallelogram
    mechanism = mechanism_of_loop(loop, atlas.forms[0].branch(0.4))
    file = tmp_path / "joints.toml"
    file.write_text(mechanism_text(mechanism, file))
    command = ["tolerance", str(file), "--error", "1e-3", "--samples", "1"]
    result = CliRunner().invoke(main, command)
    assert result.stdout.startswith("Errors of 0.001 ")
    of_loop = as_subject(mechanism).in_loop_angles(map_linkage(mechanism))
    made = measure(of_loop, 1e-3, 0)
    rows = [line.split() for line in result.stdout.splitlines()]
    for form, largest in zip(of_loop.forms, made.largest, strict=True):
        row = next(row for row in rows if " ".join(row[:2]) == form.name)
        assert float(row[2]) == pytest.approx(largest, rel=0.01)


def test_a_mechanism_is_made_in_the_unknowns_of_its_atlas(parallelogram):
    atlas, loop = parallelogram
    mechanism = mechanism_of_loop(loop, atlas.forms[0].branch(0.4))
    subject = as_subject(mechanism)
    exact = subject.closure_with_errors(0.0, np.random.default_rng(0))
    for form in map_linkage(mechanism).forms:
        assert relative_gaps(exact, form.branch.sample(50)).max() < 1e-12


def test_a_form_has_no_half_branch_beyond_its_end(tmp_path):
    file = tmp_path / "limited.toml"
    file.write_text(SLIDER_CRANK.strip() + "\nlimits = [-1.2, 0.5]\n")
    atlas = map_linkage(read_file(file))
    assert len(atlas.bifurcations) == 2
    for point in atlas.bifurcations:
        starts, _ = half_branches(atlas, point)
        distances = np.linalg.norm(starts - point.point.u, axis=1)
        assert len(starts) == 3
        assert np.all(distances > 0.0)
        assert np.all(distances <= 0.3 + 1e-9)
