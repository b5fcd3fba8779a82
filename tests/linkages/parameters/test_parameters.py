"""Families with free parameters: their equations, points followed, special values."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.following.rest_problem import rest_problems
from bifurc.limits import Deadline
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from linkages.catalogue import catalogue, entry
from linkages.closure.system import ClosureSystem
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.parameters.followed import follow_points
from linkages.parameters.members import Members, range_of_members
from linkages.parameters.special import ChangeKind, special_values
from linkages.parameters.table_family import family_of_table
from linkages.values import GeometryError
from tests.samples import one_in

QUICK = SearchSettings(certify=False)
WITH_PARAMETERS = sorted(name for name, one in catalogue().items() if one.parameters)


@pytest.fixture(autouse=True)
def _few_maps(monkeypatch):
    monkeypatch.setattr("linkages.parameters.special.MEMBERS", 8)


def members(name, **ranges):
    family = entry(name)
    values = family.defaults
    for key, (low, high) in ranges.items():
        if not low < values[key] < high:
            values[key] = 0.5 * (low + high)
    return Members(family, values, ranges)


# --- equations ------------------------------------------------------------------------


def rotation_gap(loop, theta, values):
    """How far twice the vector part (k, 3) of a rotation is from that of the frames."""
    turned = loop.frames(theta)[:, -1, :3, :3]
    twice = np.stack(
        [
            turned[:, 2, 1] - turned[:, 1, 2],
            turned[:, 0, 2] - turned[:, 2, 0],
            turned[:, 1, 0] - turned[:, 0, 1],
        ],
        axis=1,
    )
    scalar = 0.5 * np.sqrt(np.maximum(0.0, 1.0 + np.trace(turned, axis1=1, axis2=2)))
    ours = 2.0 * scalar[:, None] * values
    gaps = np.minimum(np.abs(ours - twice).max(1), np.abs(ours + twice).max(1))
    return gaps.max()


@pytest.mark.parametrize("name", one_in(4, WITH_PARAMETERS))
def test_the_equations_of_a_family_are_those_of_each_of_its_members(name):
    family = entry(name)
    values = family.defaults
    free = Members(family, values, dict.fromkeys(values, (-np.inf, np.inf)))
    rng = np.random.default_rng(0)
    for off in (0.0, 1e-3):
        other = {k: v * (1 + off * rng.uniform(-1, 1)) for k, v in values.items()}
        try:
            loop = family.build(**other)
        except GeometryError:
            continue
        theta = rng.uniform(-np.pi, np.pi, (4, loop.n))
        points = np.column_stack([theta, np.tile(list(other.values()), (4, 1))])
        found = free.problem.tape.compiled.residuals(points)
        assert rotation_gap(loop, theta, found[:, :3]) < 1e-12
        closed, gaps = ClosureSystem(loop).project(theta)
        points[:, : loop.n] = closed
        misses = np.abs(free.problem.tape.compiled.residuals(points)).max(axis=1)
        assert misses[gaps < 1e-13].max(initial=0.0) < 1e-11


def test_there_are_members_up_to_the_end_that_geometry_sets():
    family = entry("four-bar")
    chosen = Members(family, family.defaults, {})
    found = range_of_members(chosen, "d", 0.3, 9.0)
    assert found.low == 0.3
    assert found.high == pytest.approx(1 + 2.4 + 2, abs=1e-12)
    assert "sum of the others" in found.refusal


# --- follow ---------------------------------------------------------------------------


def test_followed_bifurcations_are_those_of_maps_of_their_own():
    chosen = members("reconfigurable-bricard-1", alpha=(0.3, 1.9))
    atlas = map_linkage(chosen.load(chosen.start), settings=QUICK)
    followed = follow_points(chosen, chosen.points(atlas))
    assert len(followed) == 2
    for one in followed:
        assert one.comparison.members == 50
        assert one.comparison.gap < 1e-13
        assert one.comparison.singular_value < 1e-12
        branch = one.curve.branch
        for s in branch.length * np.array([0.15, 0.55, 0.85]):
            p = one.curve.parameters(s)
            other = map_linkage(chosen.load(p), settings=QUICK)
            gaps = [
                np.abs(np.sin(0.5 * (point.point.u - one.curve.unknowns(s)))).max()
                for point in other.bifurcations
            ]
            assert min(gaps) < 1e-10


def test_over_two_parameters_a_spherical_four_bar_keeps_grashofs_equality():
    chosen = members("spherical-four-bar", alpha12=(0.7, 2.1), alpha23=(0.7, 2.1))
    atlas = map_linkage(chosen.load(chosen.start), settings=QUICK)
    (followed,) = follow_points(chosen, chosen.points(atlas))
    s = np.linspace(0.0, followed.curve.branch.length, 40)
    first, second = followed.curve.parameters(s).T
    rest = abs(chosen.values["alpha34"] - chosen.values["alpha41"])
    # the shortest and the longest together are as long as the others
    assert np.allclose(np.abs(first - second), rest, rtol=0, atol=1e-12)
    assert np.ptp(first) > 1.0


def test_what_is_there_for_one_value_alone_is_said_to_be():
    chosen = members("spherical-four-bar", alpha12=(0.7, 2.1))
    atlas = map_linkage(chosen.load(chosen.start), settings=QUICK)
    (followed,) = follow_points(chosen, chosen.points(atlas))
    assert followed.curve is None
    assert "free one more parameter" in followed.reason


# --- special --------------------------------------------------------------------------


def test_the_map_of_a_four_bar_changes_where_grashofs_rule_says():
    changes = special_values(members("four-bar", d=(0.3, 5.3))).changes
    a, b, c = 1.0, 2.4, 2.0
    values = [change.value for change in changes]
    assert np.allclose(values, [a + c - b, a + b - c, b + c - a], rtol=0, atol=1e-13)
    for change in changes:
        assert change.kind is ChangeKind.SINGULAR
        assert change.point is Kind.BIFURCATION
        assert change.error < 1e-12
        assert change.at.bifurcations == 1
        assert {change.before.components, change.after.components} == {1, 2}


def test_a_motion_comes_from_nothing_where_two_links_are_as_long_as_the_others():
    # of a spherical four-bar, that exists beyond
    changes = special_values(members("spherical-four-bar", alpha12=(0.2, 2.9))).changes
    degrees = np.degrees([change.value for change in changes])
    assert np.allclose(degrees, [65.0, 85.0, 105.0], rtol=0, atol=1e-11)


def test_rank_drops_are_special_too_and_agree_with_the_map_there():
    chosen = members("reconfigurable-bricard-1", alpha=(0.25, 0.4))
    changes = special_values(chosen).changes
    assert [change.point for change in changes] == [Kind.RANK_DROP] * 2
    for change in changes:
        counts = [
            shape.other_points for shape in (change.before, change.at, change.after)
        ]
        assert counts == [0, 1, 0]
    # the same in maps made here
    for away, number in ((-1e-4, 0), (0.0, 1), (1e-4, 0)):
        member = chosen.load(np.array([changes[0].value + away]))
        atlas = map_linkage(member, settings=QUICK)
        kinds = [point.kind for point in atlas.points]
        assert kinds.count(Kind.RANK_DROP) == number


def test_a_bennett_linkage_bifurcates_where_its_links_are_alike():
    # beta is 40 degrees
    (change,) = special_values(members("bennett", alpha=(0.3, 1.2))).changes
    assert change.value == pytest.approx(entry("bennett").defaults["beta"], abs=1e-13)
    assert change.point is Kind.BIFURCATION


def test_a_change_that_is_soon_undone_is_found():
    """Two forms are one over a little more than the spacing of members."""
    chosen = members("bricard-line-symmetric", alpha12=(0.8, 1.1))
    lengths = {"a12": 2.1, "a23": 2.8, "a34": 1.253888687478674}
    twists = {"alpha23": np.pi / 4, "alpha34": 2.8797932657906435}
    offsets = {"R1": 0.2, "R2": -0.682505124799208, "R3": -0.5}
    chosen = replace(chosen, values={**chosen.values, **lengths, **twists, **offsets})
    special = special_values(chosen)
    values = [change.value for change in special.changes]
    assert np.allclose(values, [0.90057696114, 0.94472832424], rtol=0, atol=1e-10)
    for change in special.changes:
        counts = {change.before.components, change.after.components}
        assert (counts, change.at.bifurcations) == ({1, 2}, 1)
    assert special.apart < 0.045


def test_the_ends_of_a_range_are_looked_at_and_joints_rest_where_links_are_alike():
    """Within a twentieth of the range from its end two components become one."""
    chosen = members("double-subtractive-goldberg-type-i", beta=(0.27, 0.75))
    gamma, twists = 0.7351186613145371, {"alpha": 1.0801720252447473}
    twists.update(gamma=gamma, delta=1.5023917441008614)
    chosen.values.update(a=0.3451516184155181, beta=0.5, **twists)
    changes = special_values(chosen).changes
    first, last = changes[0], changes[-1]
    assert 0.277 < first.value < 0.31
    assert (first.before.components, first.after.components) == (2, 1)
    assert last.kind is ChangeKind.REST
    assert last.value == pytest.approx(gamma, abs=1e-12)
    assert last.joints == ("joint 1", "joint 2")
    # along one form the one, along another one the other
    assert {("joint 1",), ("joint 2",)} <= set(last.at.at_rest)
    assert {*last.before.at_rest, *last.after.at_rest} == {()}


def test_a_form_in_which_two_joints_come_to_rest_is_the_known_one():
    """Song 2013, eq. (5.2.25): Form II becomes a Bennett linkage."""
    alpha, beta, delta = np.radians([125, 60, 45])
    chosen = members("double-subtractive-goldberg", gamma=np.radians([14.0, 14.4]))
    chosen.values.update(alpha=alpha, beta=beta, delta=delta)
    atlas = map_linkage(chosen.load(chosen.start), settings=QUICK)
    found = {}
    for form in atlas.forms:
        for problem in rest_problems(chosen.problem, form.branch, chosen.start, 0.01):
            points, gaps = problem.project(problem.start[None])
            assert gaps[0] < 1e-14
            found[form.name, problem.resting + 1] = points[0, -1]
    gamma = 2 * np.arctan(np.tan(beta / 2) * np.tan(delta / 2) / np.tan(alpha / 2))
    name = "Form II (constructive 6R)"
    assert found == pytest.approx({(name, 3): gamma, (name, 6): gamma}, abs=1e-14)


ZEROS = (0.0,) * 4
TABLES = {
    "bennett a12": (Loop((1, 0.5, 1, 0.5), np.radians([90, 30, 90, 30]), ZEROS), 1.0),
    "planar R1": (Loop((1.0, 1.7, 1.3, 1.2), ZEROS, ZEROS), 0.0),
    "spherical a23": (Loop(ZEROS, (1.0, 0.8, 1.3, 1.1), ZEROS), 0.0),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_that_moves_at_one_value_alone_is_found(name):
    loop, value = TABLES[name]
    family, free = family_of_table(loop), name.split()[1]
    ranges = {free: (value - 0.3, value + 0.4)}
    (change,) = special_values(Members(family, family.defaults, ranges), QUICK).changes
    assert change.kind is ChangeKind.MOTION
    assert change.what == "at this value alone there is a motion"
    assert change.value == pytest.approx(value, abs=1e-14)
    assert (change.before.forms, change.at.forms, change.after.forms) == (0, 1, 0)


def test_nothing_is_special_where_nothing_changes():
    assert not special_values(members("bennett", alpha=(0.75, 1.2))).changes


def test_a_search_without_time_says_that_it_is_not_whole():
    special = special_values(
        members("bennett", alpha=(0.3, 1.2)), deadline=Deadline(0.0)
    )
    assert special.changes == ()
    assert not special.is_whole


def test_ctrl_c_keeps_what_was_found(monkeypatch):
    made = []

    def interrupted(*arguments, **options):
        atlas = map_linkage(*arguments, **options)
        made.append(atlas)
        if len(made) < 12:
            return atlas
        return replace(atlas, provenance=replace(atlas.provenance, interrupted=True))

    monkeypatch.setattr("linkages.parameters.member_search.map_linkage", interrupted)
    special = special_values(members("bennett", alpha=(0.3, 1.2)))
    assert len(made) == 12
    assert not special.is_whole
    assert len(special.changes) == 1
