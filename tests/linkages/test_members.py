"""Random members of every family close somewhere, with one degree of freedom by rank, and move."""

import numpy as np
import pytest

from linkages.catalogue import catalogue
from linkages.entry import Entry
from linkages.loop import GeometryError, Loop

ENTRIES = [entry for entry in catalogue().values() if entry.facts.get("mobility") == 1]
MEMBERS = 6


def closure(loop: Loop, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals (k, 12) of the closing transform and their Jacobians (k, 12, n) for configurations (k, n)."""
    frames = loop.frames(theta)
    end, axes, points = frames[:, -1], frames[:, :-1, :3, 2], frames[:, :-1, :3, 3]
    turned = np.cross(axes[:, :, None, :], np.swapaxes(end[:, None, :3, :3], -1, -2))
    moved = np.cross(axes, end[:, None, :3, 3] - points) / loop.characteristic_length
    jacobian = np.concatenate([np.swapaxes(turned, -1, -2).reshape(*theta.shape, 9), moved], axis=-1)
    turn = (end[:, :3, :3] - np.eye(3)).reshape(-1, 9)
    residual = np.concatenate([turn, end[:, :3, 3] / loop.characteristic_length], axis=-1)
    return residual, np.swapaxes(jacobian, -1, -2)


def project(loop: Loop, theta: np.ndarray, steps: int = 40) -> np.ndarray:
    """Configurations that closed, from the starts ``theta`` (k, n), by damped Gauss-Newton."""
    for _ in range(steps):
        residual, jacobian = closure(loop, theta)
        damping = 0.1 * np.minimum(1, np.sum(residual**2, axis=1)) + 1e-14
        normal = np.einsum("kij,kil->kjl", jacobian, jacobian) + damping[:, None, None] * np.eye(loop.n)
        step = np.linalg.solve(normal, -np.einsum("kij,ki->kj", jacobian, residual)[..., None])[..., 0]
        theta = theta + np.clip(step, -1, 1)
    return theta[np.abs(closure(loop, theta)[0]).max(axis=1) < 1e-11]


def moves(loop: Loop, theta: np.ndarray) -> bool:
    """Whether the screws at ``theta`` (n,) have nullity 1 and a step along the null vector stays a step."""
    _, jacobian = closure(loop, theta[None])
    _, values, right = np.linalg.svd(jacobian[0])
    if not values[-2] > 1e-6 * values[0] > values[-1] * 1e2:
        return False
    after = project(loop, (theta + 0.02 * right[-1])[None])
    return len(after) == 1 and 0.018 < np.linalg.norm(after[0] - theta) < 0.022


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_random_members_move(entry: Entry):
    rng = np.random.default_rng(7)
    accepted = moving = closed = 0
    for _ in range(60):
        try:
            loop = entry.build(**entry.draw(rng))
        except GeometryError:
            continue
        accepted += 1
        found = project(loop, rng.uniform(-np.pi, np.pi, (60, loop.n)))
        closed += len(found) > 0
        moving += any(moves(loop, theta) for theta in found)
        if accepted == MEMBERS:
            break
    assert accepted == MEMBERS
    assert moving == closed  # a member may have no real configuration; one that has moves
    assert closed > MEMBERS // 2 or entry.name == "bricard-octahedral-line-symmetric"
