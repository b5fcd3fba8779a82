"""The closure at high precision is that of the compiled kernels."""

import mpmath
import numpy as np
import pytest

from bifurc.singular.confirm import Convergence, confirm_singular_point
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.closure.precise import precise_residual


def precise_member(name):
    found = entry(name)
    return found.build(
        **{key: mpmath.mpf(value) for key, value in found.defaults.items()}
    )


@pytest.mark.parametrize(
    "name",
    ["parallelogram", "goldberg-5r", "bricard-line-symmetric", "wohlhart-symmetric"],
)
def test_residuals_agree_with_the_compiled_ones(name):
    theta = np.random.default_rng(0).uniform(-3, 3, entry(name).build().n)
    with mpmath.workdps(50):
        precise = [
            float(x)
            for x in precise_residual(precise_member(name))(
                [mpmath.mpf(t) for t in theta]
            )
        ]
    compiled = LoopClosure(entry(name).build()).residuals(theta[None])[0]
    assert (
        np.abs(compiled - precise).max() < 5e-15
    )  # a few roundings of numbers of size one


def test_the_flat_bifurcation_of_the_special_linkage_is_exact():
    with mpmath.workdps(180):
        residual = precise_residual(
            precise_member("special-double-subtractive-goldberg")
        )
    flat = np.pi * np.array([0.0, 1, 0, 0, 1, 0])
    null_space = np.linalg.svd(
        LoopClosure(entry("special-double-subtractive-goldberg").build()).jacobians(
            flat[None]
        )[0]
    )
    found = confirm_singular_point(residual, flat, null_space[2][4:].T)
    with mpmath.workdps(60):
        assert abs(found.u[1] - mpmath.pi) < mpmath.mpf(10) ** -49
    assert found.convergence is Convergence.QUADRATIC and found.nullity == 2
    assert found.angle < 1e-14
