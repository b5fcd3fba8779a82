"""Branches that touch to a high order, traced outward from the exact germs."""

import numpy as np
import pytest

from bifurc import FunctionProblem, Kind, explore

BOX = [[-1.0, 1.1], [-1.2, 1.0]]
SHIFT = np.array([0.13, -0.64])


def explored(polynomial, shift=0.0, bounds=BOX):
    """The atlas of a polynomial, moved by a ``shift``."""
    moved = np.array(bounds) + np.zeros((2, 1)) + np.reshape(shift, (-1, 1))
    return explore(
        FunctionProblem(lambda u: np.array([polynomial(*(u - shift))]), moved)
    )


def test_two_parabolas_that_touch_are_two_forms_and_meet_once():
    atlas = explored(lambda x, y: (y - x**2) * (y - x**2 - x**4))
    (point,) = atlas.points
    assert (point.kind, len(atlas.forms)) == (Kind.BIFURCATION, 2)
    assert np.linalg.norm(point.point.u) < 1e-15
    assert len(point.point.half_branches) == 4
    for form in atlas.forms:
        x, y = form.branch.sample(500).T
        misses = [np.abs(y - x**2).max(), np.abs(y - x**2 - x**4).max()]
        assert min(misses) < 1e-12 < max(misses)


@pytest.mark.parametrize("power", [4, 6, 8])
def test_forms_do_not_go_over_to_the_other_side_at_a_contact(power):
    atlas = explored(lambda x, y: y**2 - x**power, SHIFT)
    assert len(atlas.forms) == 2
    for form in atlas.forms:
        x, y = (form.branch.sample(500) - SHIFT).T
        root = x ** (power // 2)
        assert min(np.abs(y - root).max(), np.abs(y + root).max()) < 1e-12


def test_both_forms_end_at_a_sharp_cusp():
    atlas = explored(lambda x, y: y**2 - x**7, SHIFT)
    (cusp,) = atlas.points
    assert cusp.kind is Kind.CUSP
    assert np.linalg.norm(cusp.point.u - SHIFT) < 1e-15
    assert len(atlas.forms) == 2
    for form in atlas.forms:
        ends = form.branch(np.array([0.0, form.branch.length]))
        assert np.linalg.norm(ends - SHIFT, axis=1).min() < 1e-12


def test_one_form_passes_where_three_roots_come_together():
    atlas = explored(lambda x, y: 10 * (x**3 + y**7))
    (point,) = atlas.points
    assert point.kind is Kind.RANK_DROP
    (form,) = atlas.forms
    x, y = form.branch.sample(500).T
    assert np.abs(x + np.sign(y) * np.abs(y) ** (7 / 3)).max() < 1e-9


def test_what_rounding_leaves_about_an_isolated_point_is_no_form():
    atlas = explored(lambda x, y: y**2 + x**6)
    (point,) = atlas.points
    assert point.kind is Kind.ISOLATED
    assert (len(atlas.forms), len(atlas.rigid)) == (0, 0)


def test_a_closed_curve_goes_on_through_a_contact():
    # a lemniscate with both halves tangent to one line: y^2 = x^6 (1 - x^2)
    atlas = explored(lambda x, y: y**2 - x**6 * (1 - x**2), bounds=[[-1.5, 1.6]] * 2)
    (point,) = atlas.points
    assert point.kind is Kind.BIFURCATION
    assert len(point.passes) == 2
    (form,) = atlas.forms
    assert form.branch.closed
    x, y = form.branch.sample(1000).T
    assert np.abs(y**2 - x**6 * (1 - x**2)).max() < 1e-12


def test_a_curve_beside_a_contact_is_kept():
    atlas = explored(lambda x, y: (y**2 - x**8) * (y - 0.05))
    line = [
        form
        for form in atlas.forms
        if np.abs(form.branch.sample(50)[:, 1] - 0.05).max() < 1e-12
    ]
    assert len(line) == 1


def test_a_curve_beside_an_isolated_point_is_kept():
    atlas = explored(lambda x, y: (y**2 + x**6) * (y - 0.02))
    (form,) = atlas.forms
    assert np.abs(form.branch.sample(50)[:, 1] - 0.02).max() < 1e-12
    (point,) = atlas.points
    assert point.kind is Kind.ISOLATED
