"""Moebius kaleidocycles: the twist at which all their motions are one curve."""

import mpmath
import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.families.kaleidocycle import LEAST_HALF_TANGENTS, twisted_ring
from linkages.mapping import map_linkage
from tests.samples import one_in

QUICK = SearchSettings(count=False, near_motions=False)
DIGITS = 50
# in the cosine of the twist, highest power first; other rings have longer polynomials
POLYNOMIALS = {
    7: [128, -183, 202, -47],
    9: [8, -15, 18, -7],
    12: [64, 0, -128, 0, 144, 0, -52, 0, -1],
}


@pytest.fixture(scope="module", params=one_in(3, list(LEAST_HALF_TANGENTS)))
def ring(request):
    """The number of hinges, the loop, and its map."""
    loop = entry(f"moebius-kaleidocycle-{request.param}").build()
    return request.param, loop, map_linkage(loop)


def fold_equations(theta, twist, reaction):
    """Closure of a twisted ring of unit links, the vanishing products of the wrench
    ``reaction`` (6,) with all screws, and its size, in mpmath or complex numbers."""
    is_exact = isinstance(twist, mpmath.mpf)
    lib = mpmath if is_exact else np
    frame, products = np.identity(4) * (twist / twist), []
    for k, angle in enumerate(theta):
        z, p = frame[:3, 2], frame[:3, 3]
        moment = [p[i - 2] * z[i - 1] - p[i - 1] * z[i - 2] for i in range(3)]
        products.append(sum([*z, *moment] * reaction))
        sign = -1 if k == len(theta) - 1 else 1
        c, s = lib.cos(angle), lib.sin(angle)
        ca, sa = sign * lib.cos(twist), sign * lib.sin(twist)
        link = [[c, -s * ca, s * sa, c], [s, c * ca, -c * sa, s], [0, sa, ca, 0]]
        frame = frame @ np.array([*link, [0, 0, 0, 1]])
    turn = frame[:3, :3]
    skew = [turn[i - 1, i - 2] - turn[i - 2, i - 1] for i in range(3)]
    size = sum(reaction * reaction) - 1
    return np.array([*skew, *frame[:3, 3], *products, size])


def test_the_least_twist_is_that_of_the_fold_to_fifty_digits(ring):
    """Newton's method on the equations of a fold, its matrix that of doubles."""
    joints, loop, atlas = ring
    theta = atlas.forms[0].branch(np.array([1.0]))[0]
    left, *_ = np.linalg.svd(loop.joint_screws(theta))
    start = [*theta, loop.twists[0], *left[:, 5]]

    def gaps(x):
        return fold_equations(x[:joints], x[joints], x[joints + 1 :])

    step = 1e-30j * np.identity(len(start))
    matrix = np.stack([gaps(start + one).imag / 1e-30 for one in step], axis=1)
    assert np.linalg.matrix_rank(matrix) == len(start) - 1  # a curve of such points
    inverse = np.linalg.pinv(matrix)
    with mpmath.workdps(DIGITS + 10):
        x = np.array([mpmath.mpf(value) for value in start])
        for _ in range(6):
            x = x - inverse @ gaps(x)
        exact = mpmath.tan(x[joints] / 2)
        stated = mpmath.mpf(LEAST_HALF_TANGENTS[joints])
        assert abs(exact - stated) < mpmath.mpf(10) ** -DIGITS


@pytest.mark.parametrize("joints", POLYNOMIALS)
def test_the_cosine_of_the_least_twist_is_a_root_of_a_short_polynomial(joints):
    with mpmath.workdps(DIGITS):
        square = mpmath.mpf(LEAST_HALF_TANGENTS[joints]) ** 2
        cosine = (1 - square) / (1 + square)
        value = mpmath.polyval(POLYNOMIALS[joints], cosine)
        assert abs(value) < mpmath.mpf(10) ** (4 - DIGITS)


def test_all_configurations_are_one_closed_curve_and_what_is_open_is_said(ring):
    _, _, atlas = ring
    (form,) = atlas.forms
    assert form.branch.closed
    assert not atlas.surfaces and not atlas.points
    assert atlas.completeness.level.value == "estimated"
    assert atlas.completeness.doubts


def test_the_second_order_leaves_one_dimension_everywhere_along_the_curve(ring):
    """The reaction that resists all screws does work of one sign in every direction of
    their null space but that of the curve."""
    joints, loop, atlas = ring
    (form,) = atlas.forms
    problem = Closure(loop)
    s = np.linspace(0.0, form.branch.length, 20)
    points, tangents = form.branch(s), form.branch(s, 1)
    for point, tangent in zip(points, tangents, strict=True):
        left, sigma, right = np.linalg.svd(problem.jacobians(point[None])[0])
        assert sigma[4] > 0.1 > 1e-11 > sigma[5]
        hessian = np.tensordot(left[:, 5], problem.hessians(point[None])[0], 1)
        null_space = right[5:]
        across = null_space - np.outer(null_space @ tangent, tangent)
        across = np.linalg.svd(across)[2][: joints - 6]
        work = np.linalg.eigvalsh(across @ hessian @ across.T)
        assert abs(tangent @ hessian @ tangent) < 1e-10
        assert (work > 0.01).all() or (work < -0.01).all()


def test_rings_of_a_smaller_twist_do_not_close_and_of_a_larger_one_move_freely():
    least = entry("moebius-kaleidocycle-8").build().twists[0]
    below = map_linkage(twisted_ring(1.0, least - 1e-3, 8), settings=QUICK)
    above = map_linkage(twisted_ring(1.0, least + 1e-2, 8), settings=QUICK)
    assert not below.forms and not below.surfaces
    assert above.mobility == 2
