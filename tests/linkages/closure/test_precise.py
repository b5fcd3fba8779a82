"""The closure at high precision is that of the compiled kernels."""

import mpmath
import numpy as np
import pytest

from bifurc.singular.confirm import Convergence, confirm_singular_point
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.closure.precise import precise_residual


def precise_member(name):
    linkage = entry(name)
    parameters = {key: mpmath.mpf(value) for key, value in linkage.defaults.items()}
    return linkage.build(**parameters)


@pytest.mark.parametrize(
    "name",
    ["parallelogram", "goldberg-5r", "bricard-line-symmetric", "wohlhart-symmetric"],
)
def test_residuals_agree_with_the_compiled_ones(name):
    theta = np.random.default_rng(0).uniform(-3, 3, entry(name).build().n)
    with mpmath.workdps(50):
        residual = precise_residual(precise_member(name))
        precise = [float(x) for x in residual([mpmath.mpf(t) for t in theta])]
    compiled = Closure(entry(name).build()).residuals(theta[None])[0]
    # a few roundings of numbers of size one
    assert np.abs(compiled - precise).max() < 5e-15


def test_the_flat_bifurcation_of_the_special_linkage_is_exact():
    name = "special-double-subtractive-goldberg"
    with mpmath.workdps(180):
        residual = precise_residual(precise_member(name))
    flat = np.pi * np.array([0.0, 1, 0, 0, 1, 0])
    jacobian = Closure(entry(name).build()).jacobians(flat[None])[0]
    null_space = np.linalg.svd(jacobian)[2][4:].T
    point = confirm_singular_point(residual, flat, null_space)
    with mpmath.workdps(60):
        assert abs(point.u[1] - mpmath.pi) < mpmath.mpf(10) ** -49
    assert point.convergence is Convergence.QUADRATIC
    assert point.nullity == 2
    assert point.angle < 1e-14
