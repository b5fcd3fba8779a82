"""The map of a mechanism that is a single loop is in the variables of its joints."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import linkages
from bifurc.files.dataset import load_atlas, save_atlas
from bifurc.routes.route import find_route
from bifurc.system import jacobian_at, relative_gaps
from bifurc.torus import SEAM
from linkages.closure.closure import Closure
from linkages.labels import FormLabels, subject_of
from linkages.readout.readout import Readout
from linkages.subject import as_subject
from tests.linkages.mechanisms.single_loops import (
    FEW,
    SINGLE_LOOPS,
    single_loop,
    with_a_held_joint,
)
from tests.maps import map_of

DSG = "special-double-subtractive-goldberg"
MIURA = "Miura-ori, one vertex (spherical 4R)"
CLOSED = 1e-12  # residual of what was traced with a tolerance of 1e-13
# of points, whose angles may be put at half a turn from so near (`bifurc.torus.wrap`)
CLOSED_AT_POINTS = 10 * 2 * np.pi * SEAM


@cache
def mapped(name):
    mechanism = single_loop(name)
    return mechanism, map_of(mechanism, settings=FEW)


def along_forms(atlas):
    """Configurations (k, n) all along the forms of an atlas."""
    samples = [form.branch.sample(300) for form in atlas.forms]
    return np.concatenate([np.empty((0, len(atlas.names))), *samples])


def points_of(atlas):
    """The configurations (k, n) that an atlas holds besides its forms."""
    points = [surface.samples for surface in atlas.surfaces]
    points += [s.charts.vertices for s in atlas.surfaces if s.charts is not None]
    points += [meeting.point.u[None] for meeting in atlas.points]
    points += [event.u[None] for event in (*atlas.near_misses, *atlas.dead_points)]
    return np.concatenate([*points, atlas.rigid])


@pytest.mark.parametrize("name", SINGLE_LOOPS)
def test_unknowns_are_the_joint_variables_and_close_the_mechanism(name):
    mechanism, atlas = mapped(name)
    problem = Closure(mechanism)
    assert atlas.names == problem.domain.names
    assert set(atlas.names) == {joint.name for joint in mechanism.joints}
    assert atlas.units == problem.domain.units
    assert atlas.periods.tolist() == problem.domain.periods.tolist()
    assert relative_gaps(problem, along_forms(atlas)).max(initial=0.0) < CLOSED
    assert relative_gaps(problem, points_of(atlas)).max(initial=0.0) < CLOSED_AT_POINTS
    for meeting in atlas.points:
        jacobian = jacobian_at(problem, meeting.point.u)
        assert np.abs(jacobian @ meeting.point.null_space).max() < 1e-9
        assert np.abs(jacobian @ meeting.tangents.T).max(initial=0.0) < 1e-9
    for event in atlas.dead_points:
        rate = atlas.forms[event.form].branch(event.s, 1)
        assert abs(rate[event.index]) < 1e-7


# charts of a component of three dimensions run out
@pytest.mark.parametrize("name", [n for n in SINGLE_LOOPS if "degenerate" not in n])
def test_a_form_or_surface_passes_through_the_reference_configuration(name):
    _, atlas = mapped(name)
    zero = np.zeros((1, len(atlas.names)))
    near = [form.branch.nearest(zero)[0][0] < 1e-9 for form in atlas.forms]
    near += [bool(surface.charts.covers(zero)[0]) for surface in atlas.surfaces]
    assert any(near)


@pytest.mark.parametrize("name", SINGLE_LOOPS)
def test_in_the_angles_of_its_loop_it_closes_the_loop(name):
    mechanism, atlas = mapped(name)
    loop = Readout(mechanism).single_loop.loop
    of_loop = as_subject(mechanism).in_loop_angles(atlas)
    problem = Closure(loop)
    assert of_loop.names == problem.domain.names
    assert linkages.loop_of(of_loop) == loop
    assert linkages.mechanism_of(of_loop) is None
    assert relative_gaps(problem, along_forms(of_loop)).max(initial=0.0) < CLOSED
    assert (
        relative_gaps(problem, points_of(of_loop)).max(initial=0.0) < CLOSED_AT_POINTS
    )


@pytest.mark.parametrize("name", [DSG, MIURA])
def test_labels_name_the_joints_that_stand_still(name):
    _, atlas = mapped(name)
    numbers = []
    for form in atlas.forms:
        labels = FormLabels.of(form)
        samples = form.branch.sample(100)
        still = np.ptp(samples, axis=0) < 1e-8
        inactive = [joint - 1 for joint in labels.inactive_joints]
        assert inactive == np.flatnonzero(still).tolist()
        gaps = samples[0, inactive] - labels.inactive_angles
        assert np.abs(np.sin(gaps / 2)).max(initial=0.0) < 1e-8
        numbers += inactive
    assert numbers


def test_a_joint_that_is_held_is_no_unknown():
    mechanism = with_a_held_joint(single_loop("goldberg-5r"))
    assert Readout(mechanism).single_loop is not None
    atlas = map_of(mechanism, settings=FEW)
    assert "held" not in atlas.names
    assert relative_gaps(Closure(mechanism), along_forms(atlas)).max() < CLOSED
    values = Readout(mechanism).values(along_forms(atlas))
    assert values[:, 0].tolist() == [0.0] * len(values)


def test_a_dataset_has_the_variables_by_the_names_of_joints_and_is_read_back(tmp_path):
    mechanism, atlas = mapped(DSG)
    again = load_atlas(save_atlas(atlas, tmp_path / "atlas.nc"))
    assert again.names == tuple(joint.name for joint in mechanism.joints)
    assert set(again.units) == {"rad"}
    assert linkages.mechanism_of(again) == mechanism
    first, last = again.forms[0].name, again.forms[-1].name
    problem = Closure(mechanism)
    route = find_route(again, first, last, problem=problem)
    assert route.length == pytest.approx(
        find_route(atlas, first, last, problem=problem).length
    )
    assert relative_gaps(problem, route.path).max() < CLOSED


def test_a_map_in_the_angles_of_a_table_is_refused():
    mechanism, atlas = mapped(DSG)
    loop = Readout(mechanism).single_loop.loop
    former = replace(atlas, subject={**subject_of(loop), **atlas.subject})
    with pytest.raises(linkages.NoLinkageError, match="map the mechanism again"):
        linkages.mechanism_of(former)
