"""What the slices prove of a list of motions, and that no planted motion refutes it."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.loop import Loop
from linkages.slices import completeness
from linkages.slices.assemblies import isolated_assemblies
from linkages.statements import LinkageClaim
from tests.maps import curves_of
from tests.samples import one_in

# near this twist of a plane-symmetric Bricard linkage a second, small motion appears
# beside the large one
SMALL = {
    "a12": 0.483,
    "a23": 1.966,
    "a34": 0.890,
    "alpha23": 1.213,
    "alpha34": 1.023,
    "R2": 0.043,
    "R3": -0.267,
}

NUMBERS_ALONE = SearchSettings(count=False)


def small_and_large(twist):
    return Closure(entry("bricard-plane-symmetric").build(alpha12=twist, **SMALL))


def extents(atlas):
    return sorted(np.ptp(form.branch.sample(200), axis=0).max() for form in atlas.forms)


@pytest.mark.parametrize(
    "name",
    [
        "bennett",
        "parallelogram",
        "goldberg-5r",
        "serial-goldberg-6r",
        "waldron-hybrid",
        "bricard-line-symmetric",
    ],
)
def test_numbers_alone_prove_many_linkages_complete(name):
    atlas = curves_of(entry(name).build(), settings=NUMBERS_ALONE)
    assert atlas.completeness.level == "counted"
    assert atlas.completeness.statement.startswith("no motion is missing")


@pytest.mark.parametrize(
    "name",
    [
        "special-double-subtractive-goldberg",
        "wohlhart-hybrid",
        "bricard-plane-symmetric",
    ],
)
def test_following_proves_what_numbers_leave_open(name):
    problem = Closure(entry(name).build())
    counted = explore(problem, settings=NUMBERS_ALONE)
    followed = explore(problem, settings=SearchSettings(count=True))
    assert counted.completeness.level == "certified"
    assert "more than 15 degrees" in counted.completeness.statement
    assert followed.completeness.level == "counted"
    assert len(counted.forms) == len(followed.forms)


def test_sheets_that_run_to_infinity_leave_the_statement_at_certified():
    problem = Closure(entry("wohlhart-symmetric").build())
    atlas = explore(problem, settings=SearchSettings(count=True))
    assert atlas.completeness.level == "certified"


@pytest.mark.parametrize(
    "name",
    ["parallelogram", "special-double-subtractive-goldberg", "bricard-line-symmetric"],
)
def test_no_list_with_a_motion_left_out_is_called_complete(name):
    problem = Closure(entry(name).build())
    branches = [form.branch for form in explore(problem).forms]
    audit = problem.seeds(np.random.default_rng(0), 10).audit
    assert audit(branches, np.inf).level == "counted"
    for i in range(len(branches)):
        assert audit(branches[:i] + branches[i + 1 :], np.inf).level == "estimated"


# the small motion turns by 0.14, 0.039 and 0.0023 rad
@pytest.mark.parametrize("twist", [2.264, 2.2643, 2.264327])
@pytest.mark.parametrize("seed", one_in(3, range(3)))
def test_a_motion_smaller_than_the_gap_between_slices_is_found(twist, seed):
    settings = SearchSettings(starts=1, count=True)
    atlas = explore(small_and_large(twist), settings=settings, seed=seed)
    small, large = extents(atlas)
    assert small < 0.15 < 5 < large
    assert atlas.completeness.level == "counted"


@pytest.mark.parametrize("twist", [2.2643, 2.264327])
@pytest.mark.parametrize("seed", one_in(3, range(3)))
def test_a_small_motion_that_no_slice_passes_is_not_denied_and_is_reached_from_the_audit(
    twist, seed
):
    problem = small_and_large(twist)
    forms = explore(problem).forms
    by_length = sorted(forms, key=lambda form: form.branch.length)
    small, large = by_length[0].branch, by_length[-1].branch
    audit = problem.seeds(np.random.default_rng(seed), 1).audit
    blind = audit([large], np.inf)
    assert blind.level != "counted"
    if blind.level == "certified":  # else a slice happens to pass the small motion
        points, gaps = problem.project(blind.starts)
        distance, _ = small.nearest(points[gaps < 1e-12])
        assert np.count_nonzero(distance < 1e-6) >= 2


@pytest.mark.parametrize("missing", [1e-2, 1e-4, 1e-5])
def test_a_four_bar_that_hardly_closes_is_found_and_proved(missing):
    # the longest bar is as long as the others together, but for a little: the motion is
    # an oval of its square root
    loop = entry("four-bar").build(a=1.0, b=1.1, c=1.2, d=3.3 - missing)
    settings = SearchSettings(starts=1, count=True)
    atlas = curves_of(loop, settings=settings)
    assert len(atlas.forms) == 1
    assert 3 * np.sqrt(missing) < extents(atlas)[0] < 5 * np.sqrt(missing)
    assert atlas.completeness.level == "counted"


def test_a_loop_that_cannot_move_is_proved_not_to():
    rng = np.random.default_rng(3)
    lengths = rng.uniform(0.5, 1, 6)
    twists = rng.uniform(0.5, 2.5, 6)
    offsets = rng.uniform(-0.3, 0.3, 6)
    atlas = curves_of(Loop(lengths, twists, offsets, "general 6R"))
    assert not atlas.forms
    assert atlas.completeness.level == "counted"
    assert atlas.completeness.statement.startswith("there is no motion")


def test_surfaces_and_long_loops_are_estimated():
    planar = Loop((1.0, 1.2, 0.9, 1.1, 0.8), (0.0,) * 5, (0.0,) * 5, "planar 5R")
    settings = SearchSettings(starts=20, charts=50, count=True)
    atlas = curves_of(planar, settings=settings)
    assert atlas.completeness.level == "estimated"
    assert "could not be made complete" in atlas.completeness.statement


def test_little_time_ends_at_numbers_alone():
    problem = Closure(entry("bricard-plane-symmetric").build())
    branches = [form.branch for form in explore(problem).forms]
    audit = problem.seeds(np.random.default_rng(0), 10).audit
    assert audit(branches, 1e-6).level == "certified"


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    "name",
    [
        "kite",
        "goldberg-5r",
        "wohlhart-double-goldberg",
        "bricard-plane-symmetric",
        "altmann",
    ],
)
def test_random_members_are_proved_and_other_seeds_find_the_same(name, seed):
    found = entry(name)
    problem = Closure(found.build(**found.draw(np.random.default_rng(seed))))
    settings = SearchSettings(starts=20, count=True)
    atlases = [explore(problem, settings=settings, seed=k) for k in range(2)]
    assert [a.completeness.level for a in atlases] == ["counted"] * 2
    lengths = [sorted(form.branch.length for form in a.forms) for a in atlases]
    np.testing.assert_allclose(lengths[0], lengths[1], rtol=1e-9)


# --- isolated assemblies --------------------------------------------------------------

# the 6R of the CUIK suite with 16 real assemblies: see test_assemblies.py
SIXTEEN = Loop(
    (0.3, 1, 0, 1.5, 0, 1.1353),
    (np.pi / 2, 0.0175, np.pi / 2, 0.0175, np.pi / 2, 1.4716),
    (0.1049, 0.0106, 0, 0.2, 0, 0),
)
ONE_START = SearchSettings(starts=1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("loop", "count"), [(SIXTEEN, 16), (entry("yu-baker-two-ratios").build(), 6)]
)
def test_every_isolated_assembly_is_in_the_atlas_whatever_the_seed(loop, count, seed):
    atlas = curves_of(loop, settings=ONE_START, seed=seed)
    assert len(atlas.rigid) == count
    assert atlas.completeness.level == "counted"
    assert "no isolated assembly of full rank is missing" in (
        atlas.completeness.statement
    )


@pytest.mark.parametrize("budget", np.geomspace(0.01, 0.3, 12))
def test_a_budget_that_ends_at_any_moment_leaves_no_proof_of_half_a_list(budget):
    settings = SearchSettings(starts=1, budget=float(budget))
    atlas = curves_of(SIXTEEN, settings=settings)
    assert len(atlas.rigid) == 16 or atlas.completeness.level == "out of time"


def test_without_time_isolated_assemblies_are_said_to_be_those_of_random_starts():
    problem = Closure(SIXTEEN)
    atlas = explore(problem, settings=NUMBERS_ALONE)
    assert "are those that random starts reached" in atlas.completeness.statement
    audit = problem.seeds(np.random.default_rng(0), 1).audit([], 1e-9)
    assert LinkageClaim.RANDOM_ASSEMBLIES.is_kind_of(audit.claims[-1])
    assert not len(audit.starts)


def test_nothing_is_proved_where_a_path_to_an_assembly_is_lost(monkeypatch):
    def lose_one(loop, seconds):
        found = isolated_assemblies(loop, seconds)
        return replace(found, complete=False, statement="1 stopped on the way")

    monkeypatch.setattr(completeness, "isolated_assemblies", lose_one)
    atlas = explore(Closure(entry("bennett").build()))
    assert atlas.completeness.level == "certified"
    assert "isolated assemblies may be missing" in atlas.completeness.statement
    assert "1 stopped on the way" in atlas.completeness.statement
