"""What is bounded along an arc exceeds what is seen there, and is not far above."""

from dataclasses import dataclass

import numpy as np
import pytest

from bifurc import _core
from bifurc.curves import kantorovich
from bifurc.curves.continuation import trace_branch
from bifurc.curves.kantorovich import CHEBYSHEV, Joints, check_arcs
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.loop import Loop

DENSE = 400
ROUNDING = 2e-15  # of F in doubles, as certificates have it
NEAR_A_SURFACE = {"alpha": 2.0, "beta": 1.0, "delta": 1.0 + 1e-3}


def traced(loop: Loop):
    """A problem, its curve from a fixed start, and the arcs of the pieces."""
    problem = Closure(loop)
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
    across = np.swapaxes(nodes.arrays["left"], 1, 2)[:, None] @ jacobians
    along = branch(s.ravel(), 1).reshape(*s.shape, 1, problem.n)
    frames = np.concatenate([across, along], axis=2)
    return s, frames, problem.residuals(points).reshape(*s.shape, -1)


def test_the_inverse_is_bounded_between_the_nodes(nodes):
    branch, arcs, nodes = nodes
    sizes, _ = _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**nodes.arrays), nodes.degree)
    s, frames, _ = dense_frames(branch, arcs, nodes)
    seen = np.linalg.norm(np.linalg.inv(frames), axis=(2, 3))
    for k in range(len(arcs)):
        cell = np.searchsorted(nodes.edges[k], s[k]).clip(1, sizes.shape[1]) - 1
        bound = sizes[k, cell]
        clear = np.isfinite(bound)
        assert np.any(clear)
        assert np.all(seen[k, clear] <= bound[clear])
        assert np.median(bound[clear] / seen[k, clear]) < 20


def test_the_residual_is_bounded_between_the_nodes(nodes):
    branch, arcs, nodes = nodes
    _, _, residuals = dense_frames(branch, arcs, nodes)
    seen = np.linalg.norm(residuals @ nodes.arrays["left"], axis=2).max(axis=1)
    _, bounds = _core.sizes_on_arcs(CHEBYSHEV, _core.Arcs(**nodes.arrays), nodes.degree)
    assert np.all(seen <= bounds)
    assert np.all(bounds < 20 * seen + 1e-14)


@dataclass(frozen=True)
class Frames:
    """H^-1 at the nodes of arcs: its columns ``across`` the curve (a, N, n, n - 1), the
    sizes of the ``strong`` ones and of the ``weak`` one (a, N), the size of ``all`` of
    them, the determinants, and the size of H."""

    across: np.ndarray
    strong: np.ndarray
    weak: np.ndarray
    all: np.ndarray
    determinants: np.ndarray
    sizes: np.ndarray

    @staticmethod
    def of(nodes) -> "Frames":
        rows = np.einsum(
            "ami,akmn->akin", nodes.arrays["left"], nodes.arrays["jacobians"]
        )
        frames = np.concatenate([rows, nodes.arrays["slopes"][:, :, None]], axis=2)
        inverses = np.linalg.inv(frames)
        return Frames(
            across=inverses[..., :-1],
            strong=np.linalg.norm(inverses[..., :-2], axis=(2, 3)),
            weak=np.linalg.norm(inverses[..., -2], axis=2),
            all=np.linalg.norm(inverses, axis=(2, 3)),
            determinants=np.abs(np.linalg.det(frames)),
            sizes=np.linalg.norm(frames, axis=(2, 3)),
        )


def largest_component(nodes, which):
    """The largest |G| (a, 1) at a node, of some components, and rounding."""
    components = (nodes.arrays["residuals"] @ nodes.arrays["left"])[..., which]
    return np.linalg.norm(components, axis=2).max(axis=1)[:, None] + ROUNDING


def test_the_doubt_at_a_node_is_k_times_the_square_of_the_inverse_times_g(nodes):
    _, _, nodes = nodes
    gaps = largest_component(nodes, slice(None))
    bound = nodes.problem.curvature.bound
    doubts = bound * Frames.of(nodes).all ** 2 * gaps
    assert doubts_of(nodes, None)[1] == pytest.approx(doubts.min(axis=1), rel=1e-6)


def test_the_doubt_of_a_narrow_box_is_half_the_lipschitz_constant_of_newtons_method(
    nodes,
):
    _, _, nodes = nodes
    problem, frames = nodes.problem, Frames.of(nodes)
    flat = nodes.points.reshape(-1, problem.n)
    hessians = problem.hessians(flat)
    forms = np.einsum(
        "ami,akmpq,akpj,akql->akijl",
        nodes.arrays["left"],
        hessians.reshape(*nodes.points.shape[:2], *hessians.shape[1:]),
        frames.across,
        frames.across,
        optimize=True,
    )
    # what F'' may be off: by H^-1, by itself, and by what it changes in the box
    bound = problem.curvature.bound
    product = frames.sizes * frames.all * frames.determinants
    of_inverse = 1e-14 * product.max(axis=1)[:, None] / frames.determinants
    error = bound * (2 * of_inverse + problem.accuracy.hessian_error)
    reach = 0.5 * problem.domain.scale
    (largest,) = problem.curvature.at_complex_points(np.array([reach]))
    strong_gap = largest_component(nodes, slice(None, -1))
    weak_gap = largest_component(nodes, slice(-1, None))

    def box(blocks):
        weak = 2 * weak_gap
        return 2 * strong_gap + 8 * blocks[0, 2] * weak**2, weak

    def travel(strong, weak):
        return frames.strong * strong + frames.weak * weak

    strong, weak = slice(None, -1), slice(-1, None)
    pairs = ((strong, strong), (strong, weak), (weak, weak))
    blocks = np.array(
        [
            [
                np.linalg.norm(
                    forms[:, :, i, j, k].reshape(*forms.shape[:2], -1), axis=2
                )
                for j, k in pairs
            ]
            for i in (strong, weak)
        ]
    )
    radius = 2 * travel(*box(blocks))
    doubt = 2 * largest / reach * radius + error
    products = (frames.strong**2, frames.strong * frames.weak, frames.weak**2)
    blocks += doubt * np.array(products)
    s, w = box(blocks)
    of_strong = blocks[0, 0] * s + 2 * blocks[0, 1] * w + blocks[0, 2] * w * (w / s)
    of_weak = blocks[1, 0] * s * (s / w) + 2 * blocks[1, 1] * s + blocks[1, 2] * w
    doubts = 0.5 * np.maximum(of_strong, of_weak)
    doubts[travel(s, w) > radius] = np.inf
    found = doubts_of(nodes, hessians.reshape(len(flat), -1, problem.n))[1]
    assert found == pytest.approx(doubts.min(axis=1), rel=1e-5)


def doubts_of(nodes, hessians):
    """Doubts in the cells (a, c), the least at a node (a,), what is uneven (a,)."""
    second = nodes._second_derivative
    return _core.doubts_of_arcs(
        CHEBYSHEV, second, _core.Arcs(**nodes.arrays), nodes.degree, hessians
    )


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
    problem = Closure(loop)
    (bound,) = problem.curvature.at_complex_points(np.array([reach]))
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
