"""Certificates of the forms of loops."""

import numpy as np
import pytest

from bifurc import certify_atlas
from bifurc.completeness import Level
from bifurc.curves.certificate import CertificateStatus, certify_branch
from bifurc.curves.monitor import profile_branch
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.system import hessian_at
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.families.bricard import bricard_line_symmetric
from linkages.loop import Loop
from tests.maps import curves_of


@pytest.mark.parametrize(
    "name",
    [
        "special-double-subtractive-goldberg",
        "bricard-octahedral-line-symmetric",
        "goldberg-5r",
        "bennett",
    ],
)
def test_the_curvature_bound_exceeds_every_second_derivative_near_closed_configurations(
    name,
):
    problem = Closure(entry(name).build())
    bound, rng, worst = problem.curvature.bound, np.random.default_rng(1), 0.0
    for form in explore(problem, settings=SearchSettings(starts=20)).forms:
        for theta in form.branch.sample(40) + rng.normal(
            scale=1e-2, size=(40, problem.n)
        ):
            direction = rng.normal(size=problem.n)
            direction /= np.linalg.norm(direction)
            worst = max(
                worst, np.linalg.norm(hessian_at(problem, theta) @ direction, 2)
            )
    assert 0.1 * bound < worst <= bound


def test_a_form_without_singular_points_is_certified_all_along():
    problem = Closure(entry("bennett").build())
    (form,) = certify_atlas(problem, explore(problem)).forms
    certificate = form.certificate
    assert certificate.status is CertificateStatus.CERTIFIED
    assert not len(certificate.gaps) and not len(certificate.blurred)


def test_forms_that_cross_are_certified_up_to_the_crossings():
    problem = Closure(entry("special-double-subtractive-goldberg").build())
    for form in certify_atlas(problem, explore(problem)).forms:
        assert form.certificate.status is CertificateStatus.UP_TO_SINGULAR_POINTS


def test_a_crossing_that_is_not_handed_over_is_named_as_singular():
    problem = Closure(Loop([2, 1, 2, 1], [0] * 4, [0] * 4))
    atlas = explore(problem)
    branch = atlas.forms[0].branch
    certificate = certify_branch(problem, branch, profile_branch(problem, branch))
    assert certificate.status is CertificateStatus.UP_TO_ROUNDING
    crossings = sorted(
        s for point in atlas.bifurcations for i, s in point.passes if i == 0
    )
    assert certificate.blurred.mean(axis=1) == pytest.approx(crossings, abs=1e-6)
    assert np.diff(certificate.blurred).max() < 1e-5


ERRORS = [1e-2, 1e-3, 1e-4]


SETTINGS = SearchSettings(starts=40)


def counts(atlas):
    return len(atlas.forms), len(atlas.bifurcations)


@pytest.mark.parametrize("error", ERRORS)
def test_a_right_map_near_a_surface_is_certified(error):
    loop = entry("special-double-subtractive-goldberg").build(
        alpha=2.0, beta=1.0, delta=1.0 + error
    )
    atlas = curves_of(loop, settings=SETTINGS)
    assert counts(atlas) == (4, 4)
    assert all(form.certificate.holds for form in atlas.forms)
    assert atlas.completeness.level is Level.COUNTED


@pytest.mark.parametrize("error", [1e-2, 1e-3])
def test_a_right_map_of_a_bricard_linkage_near_a_surface_is_certified(error):
    lengths = twists = (1.0, 1.0 + error)
    loop = bricard_line_symmetric(*lengths, 1.3, *twists, 1.9, 0, 0, 0)
    atlas = curves_of(loop, settings=SETTINGS)
    assert counts(atlas) == (4, 4)
    assert all(form.certificate.holds for form in atlas.forms)
    assert atlas.completeness.level is Level.COUNTED
