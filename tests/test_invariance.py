"""The atlas does not depend on where one starts, what the joints are called, the unit,
the hand, or the seed."""

from collections import Counter

import networkx as nx
import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.graphs import arc_graph, transition_graph
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from linkages.catalogue import catalogue, entry
from linkages.closure.closure import Closure
from linkages.values import GeometryError
from tests.maps import curves_of
from tests.samples import one_in

NAMES = [
    "special-double-subtractive-goldberg",
    "bricard-line-symmetric-zero-offset",
    "reconfigurable-bricard-1",
    "bricard-line-symmetric",
    "parallelogram",
    "bennett",
    "goldberg-5r",
]
CHANGES = {
    "another seed": (lambda loop: loop, lambda u: u),
    "joints relabelled": (
        lambda loop: loop.relabelled(2),
        lambda u: np.roll(u, -2, axis=-1),
    ),
    "order reversed": (lambda loop: loop.reversed(), lambda u: u[..., ::-1]),
    "a thousandth of the size": (lambda loop: loop.scaled(1e-3), lambda u: u),
    "a thousand times the size": (lambda loop: loop.scaled(1e3), lambda u: u),
    "mirrored": (lambda loop: loop.mirrored(), lambda u: u),
}


@pytest.fixture(scope="module")
def atlases():
    return {name: curves_of(entry(name).build()) for name in NAMES}


def assert_same_atlas(one, other, change=lambda u: u):
    """Forms with their lengths and places, bifurcations with their places, and the
    graphs."""
    assert len(other.forms) == len(one.forms)
    assert [f.branch.outcome for f in other.forms] == [
        f.branch.outcome for f in one.forms
    ]
    lengths = [sorted(f.branch.length for f in atlas.forms) for atlas in (one, other)]
    assert lengths[0] == pytest.approx(lengths[1], abs=1e-9)
    where = []
    for form in (
        one.forms
    ):  # each form of the one lies on a form of the other, and no two on the same
        samples = change(form.branch.sample(50))
        distances = [f.branch.nearest(samples)[0].max() for f in other.forms]
        assert min(distances) < 1e-9
        where.append(int(np.argmin(distances)))
    assert sorted(where) == list(range(len(one.forms)))
    assert Counter(p.kind for p in one.points) == Counter(p.kind for p in other.points)
    for point in one.bifurcations:
        gaps = [
            np.abs(turned(change(point.point.u) - p.point.u)).max()
            for p in other.bifurcations
        ]
        assert min(gaps) < 1e-11
    assert len(one.rigid) == len(other.rigid)
    assert one.components == other.components
    assert nx.is_isomorphic(transition_graph(one), transition_graph(other))
    arcs = arc_graph(one), arc_graph(other)
    assert nx.is_isomorphic(*arcs, edge_match=same_lengths)


def same_lengths(one, other):
    left, right = (
        sorted(edge["length"] for edge in edges.values()) for edges in (one, other)
    )
    return left == pytest.approx(right, abs=1e-8)


def turned(gap):
    return gap - 2 * np.pi * np.round(gap / (2 * np.pi))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("change", CHANGES)
def test_the_atlas_is_the_same(atlases, name, change):
    on_loop, on_angles = CHANGES[change]
    other = curves_of(on_loop(entry(name).build()), seed=7)
    assert_same_atlas(atlases[name], other, on_angles)


@pytest.mark.parametrize("name", NAMES)
def test_the_atlas_is_the_same_from_a_single_start_on_every_component(atlases, name):
    # from one random point a component, the forms that hang together are found through
    # their bifurcations alone
    atlas, rng = atlases[name], np.random.default_rng(1)
    firsts = {form.component: form for form in atlas.forms}
    points = [
        form.branch(rng.uniform(0, form.branch.length)) for form in firsts.values()
    ]
    starts = np.array([*points, *atlas.rigid])
    none = np.empty((0, starts.shape[1]))
    seeds = Seeds(starts, np.zeros(len(starts), dtype=bool), np.empty(0), none)
    assert_same_atlas(atlas, explore(Closure(entry(name).build()), seeds=seeds))


@pytest.mark.parametrize("name", NAMES)
def test_the_atlas_is_the_same_with_starts_in_reverse(atlases, name):
    # the first direction followed is that of an SVD and changes with the turn of a
    # start by whole turns and its order
    problem = Closure(entry(name).build())
    drawn = problem.seeds(np.random.default_rng(0), 200)
    turns = 2 * np.pi * np.random.default_rng(2).integers(-1, 2, drawn.points.shape)
    seeds = Seeds(
        (drawn.points + turns)[::-1],
        drawn.random[::-1],
        drawn.gaps,
        drawn.missed,
        drawn.audit,
    )
    assert_same_atlas(atlases[name], explore(problem, seeds=seeds))


# --- random members of the catalogue ------------------------------------------------------------------

FAMILIES = [
    "four-bar",
    "parallelogram",
    "kite",
    "spherical-four-bar",
    "bennett",
    "bennett-line-symmetric",
    "goldberg-5r",
    "subtractive-goldberg-5r",
    "extended-myard-5r",
    "serial-goldberg-6r",
    "l-shape-goldberg-6r",
    "wohlhart-double-goldberg",
    "double-subtractive-goldberg",
    "special-double-subtractive-goldberg",
    "mixed-double-goldberg-type-i",
    "mixed-double-goldberg-type-iii",
    "back-to-back-double-goldberg-sum",
    "waldron-hybrid",
    "bricard-line-symmetric",
    "bricard-line-symmetric-zero-offset",
    "bricard-plane-symmetric",
    "bricard-trihedral",
    "altmann",
    "reconfigurable-bricard-1",
    "reconfigurable-bricard-2",
]


def members(name, count):
    """The first members that the constructor takes, of parameters drawn with a fixed
    seed."""
    rng, found = np.random.default_rng(11), []
    while len(found) < count:
        values = catalogue()[name].draw(rng)
        try:
            found.append(catalogue()[name].build(**values))
        except GeometryError:
            continue
    return found


@pytest.mark.parametrize("name", one_in(3, FAMILIES))
def test_random_members_are_traced_whole_with_closure_and_the_same_from_two_seeds(name):
    for loop in members(name, 2):
        problem = Closure(loop)
        one, other = (
            explore(problem, seed=0),
            explore(problem, settings=SearchSettings(starts=300), seed=1),
        )
        assert_same_atlas(one, other)
        assert one.forms
        assert all(form.branch.outcome is Outcome.CLOSED for form in one.forms)
        assert not any(point.note for point in one.points)
        for form in one.forms:
            gap = loop.frames(form.branch.sample(2000))[:, -1] - np.eye(4)
            gap[:, :3, 3] /= loop.characteristic_length
            assert np.abs(gap).max() <= 1e-12
        for point in one.bifurcations:
            assert_branches_leave(problem, point)


def assert_branches_leave(problem, point):
    """Independently of the atlas: as many curves leave the point, by Newton's method
    across each tangent."""
    ends = []
    for tangent in point.tangents:
        for sign in (1, -1):
            u = point.point.u + sign * 0.02 * tangent
            for _ in range(8):
                matrix = np.vstack([problem.jacobians(u[None])[0], tangent])
                u = (
                    u
                    + np.linalg.lstsq(
                        matrix,
                        np.append(-problem.residuals(u[None])[0], 0.0),
                        rcond=1e-10,
                    )[0]
                )
            assert np.linalg.norm(problem.residuals(u[None])[0]) < 1e-13
            assert (
                np.linalg.norm(u - point.point.u - sign * 0.02 * tangent) < 0.01
            )  # it stayed by its tangent
            ends.append(u)
    apart = [np.linalg.norm(a - b) for i, a in enumerate(ends) for b in ends[:i]]
    assert len(ends) >= 4
    assert min(apart) > 1e-3
    assert (
        np.linalg.svd(problem.jacobians(point.point.u[None])[0], compute_uv=False)[
            problem.n - 2
        ]
        < 1e-11
    )
