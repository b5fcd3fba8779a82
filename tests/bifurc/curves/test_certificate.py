"""Certificates: what is certified is one arc, and what jumps is not certified."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import (
    Certificate,
    CertificateStatus,
    certify_branch,
)
from bifurc.curves.continuation import trace_branch
from bifurc.curves.kantorovich import NODE_COUNT
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem
from bifurc.system import Curvature


class Hyperbola(FunctionProblem):
    """x y = gap in a box; the derivative of (y, x) is a rotation, so that K = 1
    exactly."""

    def __init__(self, gap: float, largest_residual: float = np.inf):
        super().__init__(lambda u: np.array([u[0] * u[1] - gap]), [[-1, 1], [-1, 1]])
        self.magnitude = 1.0
        self.largest_residual = largest_residual

    @property
    def curvature(self) -> Curvature:
        return Curvature(1.0, np.ones_like, self.largest_residual)


def straight_branch(problem: FunctionProblem) -> Branch:
    """The line y = 0 as a traced curve would look that ran across the gap."""
    pieces = np.zeros((1, 3, 2))
    pieces[0, 1] = [0.9, 0.0]
    return Branch(
        pieces,
        np.array([0.9]),
        np.array([0.9]),
        np.array([0.0, 1.8]),
        np.zeros(1),
        problem.domain.periods,
        Outcome.LEFT_REGION,
    )


@pytest.mark.parametrize("gap", [1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_a_near_miss_is_followed_and_certified_with_points_that_grow_like_the_logarithm_of_the_gap(
    gap,
):
    problem = Hyperbola(gap)
    branch = trace_branch(problem, np.array([0.9, gap / 0.9]))
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    assert certificate.status is CertificateStatus.CERTIFIED
    # as many arcs as Taylor pieces, and these shorten with the distance to the vertex
    assert certificate.points < NODE_COUNT * (10 + 3.5 * np.log(1 / gap))


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_a_curve_that_runs_straight_across_a_near_miss_is_not_certified(gap):
    problem = Hyperbola(gap)
    branch = straight_branch(problem)
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    assert certificate.status is CertificateStatus.NOT_CERTIFIED
    middle = certificate.gaps.mean(axis=1)
    assert np.all(np.abs(middle - 0.9) < 4 * np.sqrt(gap))


@pytest.mark.parametrize("largest", [1e-5, np.inf])
def test_nothing_is_certified_where_the_residual_is_too_large_for_the_bound(largest):
    problem = Hyperbola(1e-4, largest)
    branch = straight_branch(problem)
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    refused = certificate.refused_length / branch.length
    assert (refused == 1.0) == (largest < 1e-4)


@pytest.mark.parametrize("gap", 10.0 ** -np.arange(1, 11))
def test_a_curve_glued_from_two_arcs_where_they_are_closest_is_not_certified(gap):
    problem = Hyperbola(gap)
    arc = trace_branch(problem, np.array([0.9, gap / 0.9]))
    vertex = 0.5 * arc.length
    assert arc(vertex) == pytest.approx(2 * [np.sqrt(gap)], rel=1e-3)
    half = (
        int(np.searchsorted(arc.breaks, vertex)) - 1
    )  # the piece with the vertex belongs to both halves
    other = replace(arc, pieces=-arc.pieces)
    glued = replace(
        arc,
        pieces=np.concatenate([arc.pieces[: half + 1], other.pieces[half:]]),
        centers=np.insert(arc.centers, half, arc.centers[half]),
        radii=np.insert(arc.radii, half, arc.radii[half]),
        breaks=np.insert(arc.breaks, half + 1, vertex),
        residuals=np.insert(arc.residuals, half, 0.0),
    )
    certificate = certify_branch(problem, glued, profile_branch(problem, glued))
    assert certificate.status is CertificateStatus.NOT_CERTIFIED
    # nothing but the jump is refused
    assert np.abs(certificate.gaps - vertex).max() < 1e-3 * np.sqrt(gap)
    whole = certify_branch(problem, arc, profile_branch(problem, arc))
    assert whole.status is CertificateStatus.CERTIFIED


class Sheets(FunctionProblem):
    """y = gap / 2 and y = - gap / 2, of which F' is as small as the gap."""

    def __init__(self, gap: float):
        super().__init__(
            lambda u: np.array([u[1] ** 2 - gap**2 / 4]), [[-1, 1], [-1, 1]]
        )
        self.magnitude = 1.0

    @property
    def curvature(self) -> Curvature:
        return Curvature(2.0, lambda reach: np.full_like(reach, 2.0))


def heights(problem: Sheets, *pieces) -> Branch:
    """A branch along x of pieces of length 0.5, on which y is a polynomial of the
    coordinate with the given coefficients."""
    count = len(pieces)
    coefficients = np.zeros((count, 6, 2))
    coefficients[:, 0, 0] = 0.5 * np.arange(count) + 0.25 - 0.75
    coefficients[:, 1, 0] = 0.25
    for k, piece in enumerate(pieces):
        coefficients[k, : len(piece), 1] = piece
    breaks = 0.5 * np.arange(count + 1)
    return Branch(
        pieces=coefficients,
        centers=breaks[:-1] + 0.25,
        radii=np.full(count, 0.25),
        breaks=breaks,
        residuals=np.zeros(count),
        periods=problem.domain.periods,
        outcome=Outcome.LEFT_REGION,
    )


def status_of(problem: FunctionProblem, branch: Branch) -> CertificateStatus:
    profile = profile_branch(problem, branch)
    return certify_branch(problem, branch, profile).status


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
def test_a_branch_on_one_of_two_near_sheets_is_certified_and_one_that_hops_is_refused(
    gap,
):
    problem = Sheets(gap)
    up = [gap / 2]
    down = [-gap / 2]
    # from the lower sheet to the upper one within a piece, flat at both ends
    across = np.array([0.0, 15.0, 0.0, -10.0, 0.0, 3.0]) / 8.0 * gap / 2
    assert status_of(problem, heights(problem, up, up, up)) == "certified"
    assert status_of(problem, heights(problem, up, up, down)) == "not certified"
    assert status_of(problem, heights(problem, down, across, up)) == "not certified"


def test_a_hop_between_sheets_is_refused_where_it_is():
    problem = Sheets(1e-6)
    branch = heights(problem, [5e-7], [5e-7], [-5e-7])
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    assert certificate.gaps == pytest.approx(np.array([[1.0, 1.0]]), abs=1e-8)


def test_a_problem_without_a_bound_on_its_second_derivative_is_not_certified():
    problem = FunctionProblem(lambda u: np.array([u @ u - 1]), [[-2, 2], [-2, 2]])
    branch = trace_branch(problem, np.array([1.0, 0.0]))
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    assert certificate.status is CertificateStatus.NOT_CERTIFIED
    assert certificate.gaps.tolist() == [[0.0, branch.length]]


@pytest.mark.parametrize("gap", [1e-2, 1e-12])
def test_a_certificate_goes_through_json_without_loss_and_its_status_as_a_text(gap):
    problem = Hyperbola(gap)
    branch = straight_branch(problem)
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    values = json.loads(json.dumps(certificate.as_values()))
    assert values["status"] == "not certified"
    again = Certificate.from_values(values)
    assert again.status is certificate.status
    assert np.array_equal(again.gaps, certificate.gaps)
    assert again.blurred.shape == (0, 2)
