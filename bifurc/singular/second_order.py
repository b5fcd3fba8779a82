"""The tangent cone of second order at a singular point.

With V the null space of F' and W the left null space, every branch has a tangent V x
with W^T F''(V x, V x) = 0. For a null space of dimension 2 these are binary quadratic
forms a x^2 + b x y + c y^2, as many as W has columns, and often proportional to each
other.
"""

from __future__ import annotations

import numpy as np

from bifurc.decisions import has_no_form, is_zero_form
from bifurc.numerics.binary_forms import unit_vectors
from bifurc.numerics.singular_values import factors_of
from bifurc.system import System, hessian_at, relative_jacobians

# Singular value of the coefficients, over the largest, of a form that depends on
# others.
DEPENDENT = 1e-6


def second_order_tangents(
    problem: System, point: np.ndarray, null_space: np.ndarray
) -> np.ndarray | None:
    """Unit tangents (t, n) at a singular point of nullity 2 that second order allows;
    None where it does not decide.

    The forms are reduced to independent ones. One form with two distinct real roots
    gives two tangents, without real roots none; two or more have a common root or not.
    No form at all, or a double root, is for higher order.
    """
    if null_space.shape[1] != 2:
        return None
    lines = common_lines(_reduced_forms(problem, point, null_space))
    return None if lines is None else lines @ null_space.T


def common_lines(forms: np.ndarray) -> np.ndarray | None:
    """Unit vectors (t, 2) along which all binary quadratic forms, rows (w, 3) of
    coefficients, vanish; None where that is not told, as of a double root, and where
    no form is left."""
    if not np.all(np.isfinite(forms)):
        return None
    forms = independent_forms(forms)
    if not len(forms):
        return None
    a, b, c = forms[0]
    discriminant = b * b - 4 * a * c
    if len(forms) == 1 and is_zero_form(abs(discriminant)):
        return None
    if discriminant < 0:
        return np.empty((0, 2))
    roots = _real_roots(a, b, c)
    values = _values(forms, roots)
    common = np.all(is_zero_form(np.abs(values)), axis=1)
    if not np.any(common) and len(forms) == 2 and _have_common_root(forms):
        return None
    lines: np.ndarray = roots[common]
    return lines


def lines_of_form(form: np.ndarray) -> np.ndarray:
    """Unit vectors (t, 2) on which a symmetric form (2, 2) vanishes: two, or none where
    none is real or the form does not decide."""
    coefficients = np.array([form[0, 0], 2.0 * form[0, 1], form[1, 1]])
    size = float(np.linalg.norm(coefficients))
    if size == 0.0:
        return np.empty((0, 2))
    a, b, c = coefficients / size
    discriminant = float(b * b - 4.0 * a * c)
    if discriminant < 0.0 or is_zero_form(discriminant):
        return np.empty((0, 2))
    return _real_roots(a, b, c)


def forms_on_null_space(
    problem: System, point: np.ndarray, null_space: np.ndarray
) -> np.ndarray:
    """The forms W^T F''(V x, V x) (w, k, k) of second order at a singular point with the
    ``null_space`` V (n, k), over the magnitude; not finite where F'' is not."""
    left = factors_of(relative_jacobians(problem, point[None])[0]).left
    left_null_space = left[:, problem.n - null_space.shape[1] :]
    hessian = hessian_at(problem, point) / problem.magnitude
    forms: np.ndarray = np.tensordot(
        left_null_space.T, null_space.T @ (hessian @ null_space), axes=1
    )
    return forms


def _reduced_forms(
    problem: System, point: np.ndarray, null_space: np.ndarray
) -> np.ndarray:
    """Coefficients (w, 3) of the quadratic forms W^T F''(V x, V x); not finite where
    F'' is not."""
    forms = forms_on_null_space(problem, point, null_space)
    xx = forms[:, 0, 0]
    xy = 2 * forms[:, 0, 1]
    yy = forms[:, 1, 1]
    return np.stack([xx, xy, yy], axis=1)


def independent_forms(forms: np.ndarray) -> np.ndarray:
    """Independent forms (i, c), of unit length, that span the given ones, rows (w, c) of
    coefficients; none where these are zero."""
    _, sigma, right = np.linalg.svd(forms, full_matrices=False)
    if not len(sigma) or has_no_form(float(sigma[0])):
        return forms[:0]
    independent: np.ndarray = right[sigma > DEPENDENT * sigma[0]]
    return independent


def _real_roots(a: float, b: float, c: float) -> np.ndarray:
    """Unit vectors (2, 2) at which a x^2 + b x y + c y^2 = 0, for a discriminant that
    is not negative."""
    # With x = cos t, y = sin t: (a + c)/2 + (a - c)/2 cos 2t + b/2 sin 2t = 0.
    phase = np.arctan2(b, a - c)
    size = np.hypot(b, a - c)
    cosine = np.clip(-(a + c) / size, -1.0, 1.0)
    offset = np.arccos(cosine)
    first = (phase + offset) / 2
    second = (phase - offset) / 2
    return unit_vectors(np.array([first, second]) % np.pi)


def _values(forms: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Values (k, i) of forms (i, 3) at vectors (k, 2)."""
    x, y = vectors.T
    powers = np.stack([x**2, x * y, y**2], axis=1)
    values: np.ndarray = powers @ forms.T
    return values


def _have_common_root(pair: np.ndarray) -> bool:
    """Whether the resultant of two forms (2, 3) vanishes."""
    (a, b, c), (d, e, f) = pair
    outer = a * f - c * d
    low = a * e - b * d
    high = b * f - c * e
    return is_zero_form(float(abs(outer**2 - low * high)))
