"""What is bounded along an arc exceeds what is seen there, and is not far above."""

import numpy as np
import pytest

from bifurc.curves import kantorovich
from bifurc.curves.continuation import trace_branch
from bifurc.curves.kantorovich import Joints, check_arcs
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop

DENSE = 400
NEAR_A_SURFACE = {"alpha": 2.0, "beta": 1.0, "delta": 1.0 + 1e-3}


def traced(loop: Loop):
    """A problem, its curve from a fixed start, and the arcs of the pieces."""
    problem = LoopClosure(loop)
    rng = np.random.default_rng(3)
    points, gaps = problem.project(rng.uniform(-np.pi, np.pi, (20, problem.n)))
    branch = trace_branch(problem, points[np.argmin(gaps)])
    return problem, branch, np.column_stack([branch.breaks[:-1], branch.breaks[1:]])


@pytest.fixture(
    scope="module",
    params=[
        ("goldberg-5r", {}),
        ("special-double-subtractive-goldberg", NEAR_A_SURFACE),
    ],
)
def nodes(request):
    name, parameters = request.param
    problem, branch, arcs = traced(entry(name).build(**parameters))
    joints = Joints.of(problem, branch)
    return branch, arcs, kantorovich._Nodes.on(problem, branch, arcs, joints)


def dense_frames(branch, arcs, nodes):
    """H (a, DENSE, n, n) and F (a, DENSE, m) at places all along the arcs."""
    problem = nodes.problem
    shares = np.linspace(0.0, 1.0, DENSE)
    s = arcs[:, :1] + np.diff(arcs, axis=1) * shares
    points = branch(s.ravel())
    jacobians = problem.jacobians(points).reshape(*s.shape, -1, problem.n)
    across = np.swapaxes(nodes.left, 1, 2)[:, None] @ jacobians
    along = branch(s.ravel(), 1).reshape(*s.shape, 1, problem.n)
    frames = np.concatenate([across, along], axis=2)
    return s, frames, problem.residuals(points).reshape(*s.shape, -1)


def test_the_inverse_is_bounded_between_the_nodes(nodes):
    branch, arcs, nodes = nodes
    inverse = kantorovich._Inverse.of(nodes)
    s, frames, _ = dense_frames(branch, arcs, nodes)
    seen = np.linalg.norm(np.linalg.inv(frames), axis=(2, 3))
    for k in range(len(arcs)):
        cell = np.searchsorted(nodes.edges[k], s[k]).clip(1, inverse.sizes.shape[1] - 1)
        bound = np.maximum(inverse.sizes[k, cell - 1], inverse.sizes[k, cell])
        clear = np.minimum(inverse.lowest[k, cell - 1], inverse.lowest[k, cell]) > 0
        signs = np.sign(inverse.determinants_at_edges[k])
        clear &= signs[cell - 1] == signs[cell]
        assert np.all(seen[k, clear] <= bound[clear])
        assert np.median(bound[clear] / seen[k, clear]) < 20


def test_the_residual_is_bounded_between_the_nodes(nodes):
    branch, arcs, nodes = nodes
    _, _, residuals = dense_frames(branch, arcs, nodes)
    seen = np.linalg.norm(residuals @ nodes.left, axis=2).max(axis=1)
    bounds = kantorovich._gaps_between(nodes, slice(None))[:, 0]
    assert np.all(seen <= bounds)


def test_the_forms_of_second_order_are_those_of_the_hessian(nodes):
    _, _, nodes = nodes
    inverse = kantorovich._Inverse.of(nodes)
    forms = kantorovich._second_derivatives(nodes, inverse)
    hessian = nodes.problem.hessian(nodes.points[0, 5])
    across = inverse.adjugates[0, 5, :, :-1]
    expected = np.einsum(
        "mi,mpq,pj,qk->ijk", nodes.left[0], hessian, across, across, optimize=True
    )
    assert forms[0, 5] == pytest.approx(expected, rel=1e-12, abs=1e-14)


def closure(loop, theta):
    """Closure residual (6,) at complex angles (n,), from 4 x 4 matrices: the skew part
    of the rotation, to second order that of the quaternion, and the translation."""
    lengths, twists, offsets = loop.arrays
    size = loop.characteristic_length
    product = np.eye(4, dtype=complex)
    for a, alpha, d, angle in zip(lengths, twists, offsets, theta, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        ca, sa = np.cos(alpha), np.sin(alpha)
        product = product @ np.array(
            [
                [c, -s * ca, s * sa, a / size * c],
                [s, c * ca, -c * sa, a / size * s],
                [0.0, sa, ca, d / size],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )
    return product[:3, 3]


@pytest.mark.parametrize("name", ["bennett", "bricard-line-symmetric", "goldberg-5r"])
@pytest.mark.parametrize("reach", [0.1, 1.0, 2.0])
def test_the_bound_on_second_derivatives_holds_at_complex_points(name, reach):
    loop = entry(name).build()
    problem = LoopClosure(loop)
    (bound,) = problem.complex_curvature(np.array([reach]))
    rng = np.random.default_rng(0)
    step = 1e-4
    largest = 0.0
    for _ in range(40):
        imaginary = rng.normal(size=loop.n)
        imaginary *= reach / np.linalg.norm(imaginary)
        theta = rng.uniform(-np.pi, np.pi, loop.n) + 1j * imaginary
        direction = rng.normal(size=loop.n)
        direction /= np.linalg.norm(direction)
        values = [closure(loop, theta + k * step * direction) for k in (-1, 0, 1)]
        second = (values[0] - 2.0 * values[1] + values[2]) / step**2
        largest = max(largest, np.linalg.norm(second))
    assert largest < bound


def test_a_step_between_two_pieces_is_seen_at_their_joint_only():
    problem, branch, arcs = traced(entry("bennett").build())
    joints = Joints.of(problem, branch)
    images = joints.images.copy()
    images[3] = 0.3
    checks = check_arcs(problem, branch, arcs, Joints(joints.arclengths, images))
    is_refused = ~checks.holds.all(axis=1)
    # joint 3 is at the end of piece 2 and the begin of piece 3
    assert np.flatnonzero(is_refused).tolist() == [2, 3]
    assert not np.any(checks.is_closed[is_refused])
