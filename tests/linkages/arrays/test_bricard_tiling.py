"""Arrays of Bricard loops: their closed form, their one freedom, and their forms."""

import numpy as np
import pytest

import linkages
from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from linkages import Closure
from linkages.arrays.bricard_tiling import other_angle
from linkages.values import GeometryError

THETA = np.radians(80.0)  # in the state that is given
RING = (3, 2)  # columns and rows of six loops around a cell of the honeycomb


def array_of(columns, rows, twist=75.0):
    mechanism = linkages.load(
        "bricard-array", columns=columns, rows=rows, twist=np.radians(twist)
    )
    problem = Closure(mechanism)
    is_phi = np.array([int(name[-1]) % 2 == 0 for name in problem.domain.names])
    return mechanism, problem, is_phi


def relation(twist, theta, phi):
    c, s = np.cos(twist), np.sin(twist)
    alike = (1 + c**2) * np.cos(theta) * np.cos(phi)
    alike -= 2 * c * np.sin(theta) * np.sin(phi)
    return c**2 + s**2 * (np.cos(theta) + np.cos(phi)) + alike


@pytest.mark.parametrize(
    ("shape", "loops"),
    [((1, 1), 1), ((1, 2), 2), ((2, 2), 4), (RING, 6 + 1), ((4, 5), 20 + 4)],
)
@pytest.mark.parametrize("twist", [40.0, 90.0, 110.0])
def test_an_array_has_one_freedom_and_closes_at_every_angle(shape, loops, twist):
    """With either root, the same one for all loops; cells of the honeycomb are loops."""
    mechanism, problem, is_phi = array_of(*shape, twist)
    assert mechanism.independent_loops == loops
    jacobian = problem.jacobians(problem.reference[None])[0]
    sigma = np.linalg.svd(jacobian, compute_uv=False)
    assert sigma[-1] < 1e-14 < 1e-2 < sigma[-2]
    alpha = np.radians(twist)
    phi = other_angle(alpha, THETA)
    for theta in np.radians([-100.0, -20.0, 0.0, 45.0, 100.0]):
        for other in (other_angle(alpha, theta), -other_angle(alpha, -theta)):
            point = np.where(is_phi, other - phi, theta - THETA)
            assert np.abs(problem.residuals(point[None])).max() < 1e-13


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 2), RING])
def test_its_form_keeps_the_closed_form_everywhere(shape):
    """Up to the ends of its range of theta and back with the other root."""
    _, problem, is_phi = array_of(*shape)
    branch = trace_branch(problem, problem.reference)
    assert branch.outcome is Outcome.CLOSED
    points = branch.sample(400)
    twist = np.radians(75.0)
    thetas = points[:, ~is_phi] + THETA
    phis = points[:, is_phi] + other_angle(twist, THETA)
    assert max(np.ptp(thetas, axis=1).max(), np.ptp(phis, axis=1).max()) < 1e-11
    assert np.abs(relation(twist, thetas[:, 0], phis[:, 0])).max() < 1e-11
    most = np.arccos(-(1 + 2 * np.cos(twist) ** 2) / (2 * np.sin(twist) ** 2))
    assert np.abs(thetas).max() == pytest.approx(most, abs=1e-3)


@pytest.mark.parametrize(
    ("shape", "twist", "forms", "bifurcations"),
    [
        ((1, 1), 75.0, 1, 0),
        ((1, 2), 75.0, 2, 2),
        ((2, 2), 90.0, 8, 2),
        ((1, 1), 40.0, 2, 0),
        ((1, 2), 40.0, 4, 0),
    ],
)
def test_every_loop_may_have_either_root(shape, twist, forms, bifurcations):
    """Of n loops in no ring: where roots meet the forms do, half as many as choices."""
    atlas = linkages.map_linkage(array_of(*shape, twist)[0])
    assert atlas.mobility == 1
    assert (len(atlas.forms), len(atlas.bifurcations)) == (forms, bifurcations)


def test_what_makes_no_array_is_refused():
    with pytest.raises(GeometryError, match=r"angle: 50 is .* more than 52\.577 deg"):
        linkages.load("bricard-array", angle=np.radians(50.0))
    with pytest.raises(GeometryError, match="twist: 5 is not allowed"):
        linkages.load("bricard-array", twist=np.radians(5.0))
    with pytest.raises(GeometryError, match="columns: 1 is not allowed; it must be 2"):
        linkages.load("bricard-array", columns=1, rows=3)
