"""Closed forms: they close, they are the numerical curves, they have no poles, and
their LaTeX comes out of them."""

import subprocess
import sys

import numpy as np
import pytest

from linkages.catalogue import catalogue, entry
from linkages.closed_forms.closed_form import HalfTangent, joint
from linkages.values import GeometryError
from tests.samples import one_in

FORMS = [form for linkage in catalogue().values() for form in linkage.closed_forms]


def named(form):
    return f"{form.linkage}: {form.form}"


POLES = np.array(
    [0.0, np.pi, 1e-9, np.pi - 1e-9, 1e-5 - np.pi]
)  # of the tangents and just beside


def members(form, count, seed):
    """The default member and random ones that the constructor accepts."""
    rng, found = np.random.default_rng(seed), entry(form.linkage)
    out = [found.defaults]
    while len(out) < count:
        values = found.draw(rng)
        try:
            found.build(**values)
        except GeometryError:
            continue
        out.append(values)
    return out


def closure(loop, theta):
    gap = np.abs(loop.frames(theta)[:, -1] - np.eye(4))
    gap[:, :3, 3] /= loop.characteristic_length
    return gap.max(initial=0.0)


@pytest.mark.parametrize("form", one_in(3, FORMS, named))
def test_closed_form_closes_the_loop_everywhere_and_at_its_poles(form):
    rng, seen = np.random.default_rng(5), 0
    for values in members(form, 6, seed=1):
        theta_1 = np.concatenate([rng.uniform(-np.pi, np.pi, 60), POLES])
        for root in form.roots:
            theta = form.configurations(theta_1, values, root)
            theta = theta[np.isfinite(theta).all(axis=1)]
            seen += len(theta)
            assert (
                closure(entry(form.linkage).build(**values), theta) < 1e-12
            )  # rounding times the ratios of the links
    assert seen > 60


@pytest.mark.parametrize("form", FORMS, ids=named)
def test_input_angle_is_the_first_angle(form):
    theta_1 = np.linspace(-3, 3, 31)
    theta = form.configurations(theta_1, entry(form.linkage).defaults)
    found = np.isfinite(theta[:, 0])
    assert np.allclose(theta[found, 0], theta_1[found], atol=1e-14)


@pytest.mark.parametrize(
    "form",
    [form for form in FORMS if form.relation is not None],
    ids=lambda form: form.linkage,
)
def test_the_two_roots_are_different_configurations(form):
    values = entry(form.linkage).defaults
    one, other = (
        form.configurations(np.linspace(-3, 3, 41), values, root) for root in form.roots
    )
    found = np.isfinite(one[:, 0])
    assert np.any(np.abs(np.sin((one - other)[found] / 2)) > 1e-3)


def test_motion_of_the_mixed_linkage_loses_no_digits_beside_a_pole():
    """The printed quotient for Q loses ten digits there; pairs lose none."""
    form = entry("mixed-double-goldberg-type-i").closed_forms[0]
    values = entry(form.linkage).defaults
    theta = form.configurations(np.array([0.7, 0.9, 1.1]), values)
    assert (
        closure(entry(form.linkage).build(**values), theta[np.isfinite(theta[:, 0])])
        < 1e-14
    )


def test_sum_of_two_angles_has_no_pole():
    top, bottom = (HalfTangent(1, 0) + HalfTangent(1, 1)).pair  # pi + pi/2
    assert 2 * np.arctan2(top, bottom) % (2 * np.pi) == pytest.approx(3 * np.pi / 2)
    assert (HalfTangent(*joint(1)) - HalfTangent(0, 1)).pair == joint(1)


@pytest.mark.parametrize("form", FORMS, ids=named)
def test_latex_names_every_joint_and_every_constant(form):
    latex = form.latex()
    assert all(rf"\tan\frac{{\theta_{i}}}{{2}}" in latex for i in range(1, form.n + 1))
    assert len(latex) == form.n + len(form.constants) + (form.relation is not None)
    assert not any("nan" in value or "s_" in value for value in latex.values())


def test_latex_of_bennett_is_the_textbook_formula():
    assert (
        entry("bennett").closed_forms[0].latex()[r"\tan\frac{\theta_2}{2}"]
        == r"\frac{m}{t_{1}}"
    )


def test_linkage_without_closed_form_has_none():
    assert entry("dietmaier").closed_forms == ()


def test_catalogue_does_not_import_sympy():
    code = "import sys; from linkages.catalogue import catalogue; catalogue(); sys.exit('sympy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
