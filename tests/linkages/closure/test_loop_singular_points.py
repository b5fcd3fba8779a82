"""Singular points of loops, and what only nearly is one."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.certificate import certify_branch
from bifurc.curves.continuation import trace_branch
from bifurc.curves.monitor import profile_branch
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings, TraceSettings
from bifurc.singular.point import Kind
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.loop import Loop
from tests.maps import curves_of, map_of


@pytest.mark.parametrize("longest", [0.1, 0.5])
@pytest.mark.parametrize("error", [1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_a_near_parallelogram_is_followed_on_its_true_circuit(error, longest):
    problem = Closure(Loop((1.0, 2.0, 1.0 + error, 2.0), (0.0,) * 4, (0.0,) * 4))
    start = problem.project(np.array([[1.0, -0.7, 1.0, -0.9]]))[0][0]
    branch = trace_branch(problem, start, settings=TraceSettings(longest=longest))
    # the long link on one side lets one crank turn fully: the parallelogram's two
    # circuits are one, split in halves
    assert branch.outcome is Outcome.CLOSED
    assert sorted(np.abs(branch.winding)) == [0, 0, 1, 1]
    allowed = (
        60 + 30 * longest**-0.5
    )  # pieces: as for a plain four-bar, and some more for every decade of 1/error
    assert len(branch.pieces) < allowed + 8 * np.log10(1 / error)


@pytest.mark.parametrize("longest", [0.1, 2.0])
@pytest.mark.parametrize("error", [1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_a_near_parallelogram_is_certified(error, longest):
    problem = Closure(Loop((1.0, 2.0, 1.0 + error, 2.0), (0.0,) * 4, (0.0,) * 4))
    start = problem.project(np.array([[1.0, -0.7, 1.0, -0.9]]))[0][0]
    branch = trace_branch(problem, start, settings=TraceSettings(longest=longest))
    assert (
        certify_branch(problem, branch, profile_branch(problem, branch)).status
        == "certified"
    )


@pytest.mark.parametrize("error", [1e-11, 1e-12, 1e-13, 1e-14, 1e-15])
def test_below_the_resolution_of_doubles_a_wrong_circuit_is_never_called_certified(
    error,
):
    problem = Closure(Loop((1.0, 2.0, 1.0 + error, 2.0), (0.0,) * 4, (0.0,) * 4))
    branch = trace_branch(
        problem, problem.project(np.array([[1.0, -0.7, 1.0, -0.9]]))[0][0]
    )
    right = branch.closed and sorted(np.abs(branch.winding)) == [0, 0, 1, 1]
    assert (
        right
        or certify_branch(problem, branch, profile_branch(problem, branch)).status
        != "certified"
    )


@pytest.mark.parametrize("longest", [0.02, 0.05, 0.1, 0.5])
def test_a_form_that_another_nearly_crosses_to_rounding_is_followed_whole(longest):
    """A line-symmetric Bricard linkage with the offsets of another kink: no singular
    point solves the equations, and the smallest singular value, 1e-10 over 1e-8 rad,
    leaves Taylor steps no direction."""
    lengths, twists = (
        (0.7941613126706226, 2.6403832273715606, 2.5864115048816054),
        (
            0.22856792577804788,
            0.5102232137337113,
            2.618285062280901,
        ),
    )
    offsets = (-0.1860767779601384, -0.52734918464006, 0.3064219516890632)
    problem = Closure(Loop(lengths * 2, twists * 2, offsets * 2))
    start = problem.project(
        np.array(
            [[1.38539007, 4.4886844, 3.27712703, 1.38539007, -1.7945009, -3.00605828]]
        )
    )[0][0]
    branch = trace_branch(problem, start, settings=TraceSettings(longest=longest))
    assert branch.outcome is Outcome.CLOSED
    assert branch.length == pytest.approx(12.8139091108992, abs=1e-12)
    points = branch.sample(3000)
    assert np.abs(np.sin((points[:, 3:] - points[:, :3]) / 2)).max() < 1e-7


def test_neighbouring_pieces_overlap_also_where_a_bridge_was_laid():
    """A member of the special Wohlhart double-Goldberg family whose Form I crosses
    another at a small angle."""
    found = entry("special-wohlhart-double-goldberg")
    rng = np.random.default_rng(0)
    for _ in range(22):
        values = found.draw(rng)
    problem = Closure(found.build(**values))
    for form in explore(problem, settings=SearchSettings(starts=60)).forms:
        for start in form.branch(form.branch.length * np.linspace(0, 1, 6)):
            branch = trace_branch(problem, start)
            assert np.all(
                np.diff(branch.centers)
                <= (branch.radii[:-1] + branch.radii[1:]) * (1 + 1e-9)
            )
            assert np.abs(problem.residuals(branch.sample(4000))).max() < 1e-12


@pytest.mark.parametrize(
    "name",
    [
        "mixed-double-goldberg-type-ii",
        "mixed-double-goldberg-type-vi",
        "double-goldberg-type-ii",
    ],
)
def test_a_second_tangent_that_misses_one_equation_by_a_part_in_1e8_is_none(name):
    """At 50 digits the coefficients of the two equations of second order have the
    singular values 0.419 and 2.29e-8 (Type II): they are independent, and one tangent
    solves both."""
    values = {
        "a": 2.144874646208794,
        "alpha": 1.5668555382374716,
        "beta": 0.5795111767234356,
        "gamma": 1.5921695469201371,
        "delta": 0.5790264703154796,
    }
    atlas = curves_of(entry(name).build(**values), settings=SearchSettings(starts=20))
    assert [(p.kind, len(p.point.half_branches), p.note) for p in atlas.points] == 2 * [
        (Kind.RANK_DROP, 2, "")
    ]


@pytest.mark.parametrize("power", [6, 7, 8, 10, 11])
def test_a_near_miss_that_doubles_resolve_is_no_rank_drop(power):
    # with R1 = R4 = e the singular values there are proportional to e
    base = entry("bricard-line-symmetric-zero-offset").build()
    offset = 10.0**-power
    loop = Loop(base.lengths, base.twists, (offset, 0.0, 0.0, offset, 0.0, 0.0))
    atlas = map_of(loop)
    assert not atlas.points
    assert len(atlas.forms) == 2
    ratios = sorted(event.value / offset for event in atlas.near_misses)
    expected = [0.12289117, 0.14503899, 0.25317093, 0.35926642]
    bound = max(event.error for event in atlas.near_misses) / offset
    assert ratios == pytest.approx(expected, abs=bound + 1e-8)


def test_small_near_misses_are_found_in_many_digits():
    base = entry("bricard-line-symmetric-zero-offset").build()
    ratios = []
    for offset in (1e-4, 1e-5, 1e-6):
        loop = Loop(base.lengths, base.twists, (offset, 0.0, 0.0, offset, 0.0, 0.0))
        near_misses = map_of(loop).near_misses
        assert all(event.error < 1e-9 * event.value for event in near_misses)
        ratios.append(np.sort([event.value / offset for event in near_misses]))
    # the ratios change in proportion to the offset; doubles miss the last by 2e-9
    expected = ratios[1] + 0.1 * (ratios[1] - ratios[0])
    assert ratios[2] == pytest.approx(expected, rel=5e-10)
