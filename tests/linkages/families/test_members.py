"""Motion found from random starts: members of every family move, loops built by
misprinted conditions do not."""

import numpy as np
import pytest

from linkages.catalogue import catalogue
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.entry import Entry
from linkages.families.bricard_other import wohlhart_hybrid
from linkages.families.bricard_plane import plane_symmetric, plane_symmetric_octahedral
from linkages.families.goldberg_5r import extended_myard
from linkages.families.goldberg_6r import syncopated_serial_goldberg
from linkages.families.mavroidis_roth import dietmaier
from linkages.loop import Loop
from linkages.values import GeometryError
from tests.samples import one_in

ENTRIES = [entry for entry in catalogue().values() if entry.facts.get("mobility") == 1]
# but those of which the screws have a lower rank all along
ENTRIES = [entry for entry in ENTRIES if "moebius" not in entry.name]
MEMBERS = 6
STARTS = 40
ROUNDING = 1e-14  # rad; no step after a smaller one changes more than last bits
TWISTS = np.radians([35.0, 62.0, 41.0, 22.0])


def closure(loop: Loop, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals (k, 12) of the closing transform and their Jacobians (k, 12, n) for
    configurations (k, n)."""
    frames = loop.frames(theta)
    end, axes, points = frames[:, -1], frames[:, :-1, :3, 2], frames[:, :-1, :3, 3]
    turned = np.cross(axes[:, :, None, :], np.swapaxes(end[:, None, :3, :3], -1, -2))
    moved = np.cross(axes, end[:, None, :3, 3] - points) / loop.characteristic_length
    jacobian = np.concatenate(
        [np.swapaxes(turned, -1, -2).reshape(*theta.shape, 9), moved], axis=-1
    )
    turn = (end[:, :3, :3] - np.eye(3)).reshape(-1, 9)
    residual = np.concatenate(
        [turn, end[:, :3, 3] / loop.characteristic_length], axis=-1
    )
    return residual, np.swapaxes(jacobian, -1, -2)


def project(loop: Loop, theta: np.ndarray, steps: int = 40) -> np.ndarray:
    """Configurations that closed, from the starts ``theta`` (k, n), by damped
    Gauss-Newton."""
    theta, moving = theta.copy(), np.arange(len(theta))
    for _ in range(steps):
        residual, jacobian = closure(loop, theta[moving])
        damping = 0.1 * np.minimum(1, np.sum(residual**2, axis=1)) + 1e-14
        normal = np.einsum("kij,kil->kjl", jacobian, jacobian) + damping[
            :, None, None
        ] * np.eye(loop.n)
        step = np.linalg.solve(
            normal, -np.einsum("kij,ki->kj", jacobian, residual)[..., None]
        )[..., 0]
        theta[moving] += np.clip(step, -1, 1)
        moving = moving[np.abs(step).max(axis=1) > ROUNDING]
        if not len(moving):
            break
    return theta[np.abs(closure(loop, theta)[0]).max(axis=1) < 1e-11]


def moves(loop: Loop, theta: np.ndarray) -> bool:
    """Whether the screws at ``theta`` (n,) have nullity 1 and a step along the null
    vector stays a step."""
    _, jacobian = closure(loop, theta[None])
    _, values, right = np.linalg.svd(jacobian[0])
    if not values[-2] > 1e-6 * values[0] > values[-1] * 1e2:
        return False
    after = project(loop, (theta + 0.02 * right[-1])[None])
    return len(after) == 1 and 0.018 < np.linalg.norm(after[0] - theta) < 0.022


def closed_and_moving(
    loop: Loop, rng: np.random.Generator, starts: int
) -> tuple[bool, bool]:
    """Whether any random start closes, and whether the loop moves at any configuration
    found."""
    found = project(loop, rng.uniform(-np.pi, np.pi, (starts, loop.n)))
    return len(found) > 0, any(moves(loop, theta) for theta in found)


@pytest.mark.parametrize("entry", one_in(3, ENTRIES, lambda entry: entry.name))
def test_random_members_move(entry: Entry):
    rng = np.random.default_rng(7)
    accepted = moving = closed = 0
    for _ in range(60):
        try:
            loop = entry.build(**entry.draw(rng))
        except GeometryError:
            continue
        accepted += 1
        found, moved = closed_and_moving(loop, rng, 60)
        closed += found
        moving += moved
        if accepted == MEMBERS:
            break
    assert accepted == MEMBERS
    assert (
        moving == closed
    )  # a member may have no real configuration; one that has moves
    assert closed > MEMBERS // 2 or entry.name == "bricard-octahedral-line-symmetric"


# --- misprinted conditions


def with_twist(loop: Loop, link: int, twist: float) -> Loop:
    twists = list(loop.twists)
    twists[link - 1] = twist
    return Loop(loop.lengths, tuple(twists), loop.offsets)


def printed_syncopated_serial() -> Loop:
    """Song (2013), equation (2.4.2): the triple product without its minus sign."""
    a, b, c, d = bennett_links(
        1.0, TWISTS[0], b=(TWISTS[1], None), c=(TWISTS[2], None), d=(TWISTS[3], None)
    )
    product = np.prod([half_angle_ratio(t, TWISTS[1]) for t in TWISTS[[0, 2, 3]]])
    side = syncopated_link(a + c + d, product) - b
    return closed_chain(side, a + c + d, side, d, c, a)


def printed_dietmaier() -> Loop:
    """Song (2013), equation (2.4.12): sin/a for a/sin, and R1 = R5, R2 = R4, R3 = R6 =
    0."""
    alpha12, alpha61, alpha34, alpha45 = np.radians([50, 75, 35, 62])
    scale = (np.cos(alpha34) + np.cos(alpha45)) / (np.cos(alpha12) + np.cos(alpha61))
    link12, link61 = bennett_links(1.3, alpha12, a61=(alpha61, None))
    first = 1.3 / np.sin(alpha12) * scale * np.sin(alpha34)
    link34, link45 = bennett_links(first, alpha34, a45=(alpha45, None))
    free = Link(1.13, 1.27)
    return closed_chain(
        link12,
        free,
        link34,
        link45,
        free,
        link61,
        offsets=(0.31, -0.47, 0, -0.47, 0.31, 0),
    )


def printed_wohlhart_hybrid() -> Loop:
    """Song (2013), equation (2.4.22): the pairs 12-23, 34-45, 56-61 with R2 + R4 + R6 =
    0."""
    links = [Link(a, t) for a, t in ((1.0, -0.9), (0.8, 1.3), (1.25, 1.9))]
    pairs = [part for link in links for part in (link, Link(link.length, -link.twist))]
    return closed_chain(*pairs, offsets=(0, 0.4, 0, 0.3, 0, -0.7))


MYARD = extended_myard(1.0, *TWISTS[:2], 0.4)
PLANE = plane_symmetric(1.0, 0.8, 1.25, 0.9, 1.3, 1.9, -0.45, 0.6)
OCTAHEDRON = plane_symmetric_octahedral(2.19, 0.94, 2.26, 0.81, 0.59, 1.9)
PAIRS = {
    "2.3.5 alpha34 = pi - 2 alpha with offsets": (
        with_twist(MYARD, 3, np.pi - 2 * TWISTS[0]),
        MYARD,
    ),
    "2.4.2 sign": (
        printed_syncopated_serial(),
        syncopated_serial_goldberg(1.0, *TWISTS),
    ),
    "2.4.12 ratios and offsets": (
        printed_dietmaier(),
        dietmaier(1.3, *np.radians([50, 75, 35, 62]), 1.13, 1.27, 0.31, -0.47),
    ),
    "2.4.14 alpha23 + alpha56 = pi": (with_twist(PLANE, 5, np.pi - 1.3), PLANE),
    "2.4.17 alpha56 free": (
        with_twist(OCTAHEDRON, 5, OCTAHEDRON.twists[4] + 0.1),
        OCTAHEDRON,
    ),
    "2.4.22 pairs": (
        printed_wohlhart_hybrid(),
        wohlhart_hybrid(1.0, 0.8, 1.25, -0.9, 1.3, 1.9, 0.4, 0.3),
    ),
}


@pytest.mark.parametrize(("printed", "corrected"), PAIRS.values(), ids=PAIRS.keys())
def test_printed_loop_is_rigid_and_the_corrected_one_moves(printed, corrected):
    rng = np.random.default_rng(3)
    assert not closed_and_moving(printed, rng, STARTS)[1]
    assert closed_and_moving(corrected, rng, STARTS)[1]
