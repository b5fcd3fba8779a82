"""Maps of random mechanisms are those that samples of their bodies show."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from click.testing import CliRunner

from bifurc.completeness import Level
from linkages.mapping import map_linkage
from studies.random_mechanisms import (
    Bodies,
    Curves,
    compare,
    draw,
    eight_bar,
    faults_of,
    main,
)
from tests.samples import one_in

# numbers of mechanisms of a kind: the first planar one is built by larger groups, and the
# first spatial one sliced by paths
NUMBERS = {
    "planar": [7, 0, *range(10, 32)],
    "platform": range(24),
    "spherical": range(24),
    "spatial": [6, *range(24)],
}


@pytest.mark.parametrize("number", one_in(24, NUMBERS["planar"]))
def test_planar_eight_bars_have_the_forms_that_are_sampled(number):
    require_right("planar", number, Level.CERTIFIED)


@pytest.mark.parametrize("number", one_in(24, NUMBERS["platform"]))
def test_planar_platforms_have_the_forms_that_are_sampled(number):
    require_right("platform", number, Level.CERTIFIED)


@pytest.mark.parametrize("number", one_in(24, NUMBERS["spherical"]))
def test_spherical_eight_bars_have_the_forms_that_are_sampled(number):
    require_right("spherical", number, Level.CERTIFIED)


@pytest.mark.parametrize("number", one_in(25, NUMBERS["spatial"]))
def test_spatial_mechanisms_have_the_forms_that_are_sampled(number):
    require_right("spatial", number, Level.ESTIMATED)


def require_right(kind, number, level):
    result = compare(draw(kind, 0, number), number, budget=np.inf, starts=30)
    assert result.faults == ()
    assert result.sampled > 10
    assert result.level in {level, Level.CERTIFIED}


def test_eight_bars_of_many_topologies_are_drawn():
    """There are 16 in all."""
    rng = np.random.default_rng(0)
    kinds: list[nx.Graph] = []
    for _ in range(40):
        graph = nx.Graph(eight_bar(rng))
        if not any(nx.is_isomorphic(graph, other) for other in kinds):
            kinds.append(graph)
    assert 10 <= len(kinds) <= 16


def test_forms_that_are_missing_or_twice_or_wrong_are_noticed():
    mechanism = draw("planar", 0, 4)
    atlas = map_linkage(mechanism)
    assert len(atlas.forms) == 2
    one, other = atlas.forms
    assert "missing" in faults_with(mechanism, replace(atlas, forms=(one,)))
    assert "listed twice" in faults_with(
        mechanism, replace(atlas, forms=(one, other, one))
    )
    assert "wrong" in faults_with(mechanism, map_linkage(draw("planar", 0, 1)))


def faults_with(mechanism, atlas):
    bodies = Bodies(mechanism)
    samples = bodies.closed(bodies.random(np.random.default_rng(0), 20))
    faults, _ = faults_of(atlas, bodies, Curves(atlas, bodies), samples)
    return faults


def test_residuals_of_bodies_change_as_their_derivatives_say():
    """To first order, by central differences."""
    bodies = Bodies(draw("spatial", 0, 13))
    poses = bodies.random(np.random.default_rng(0), 1)
    (jacobian,) = bodies.jacobians(poses)
    for column in range(len(bodies.free)):
        step = np.zeros((1, len(bodies.free)))
        step[0, column] = 1e-6
        ahead, behind = (
            bodies.residuals(bodies.moved(poses, sign * step))[0] for sign in (1, -1)
        )
        change = (ahead - behind) / 2e-6
        np.testing.assert_allclose(change, jacobian[:, column], atol=1e-8)


def test_the_command_counts_what_is_right():
    arguments = ["--kind", "platform", "--count", "1", "--starts", "10"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert "right    certified  1" in result.output
