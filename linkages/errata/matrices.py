"""Misprints in the matrix equations, in the closure of known loops and in Wohlhart's
symmetric mechanism."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import radians

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.all_forms import closed_forms
from linkages.errata.conditions import immobility
from linkages.loop import Loop
from linkages.mobility import held_gap

__all__ = ["MATRIX_ROWS"]

Row = tuple[str, str, str, str, str, Callable[[], tuple[float, float]]]


def _along(linkage: str, **values: float) -> tuple[Loop, np.ndarray]:
    """A loop and configurations (k, n) along its first closed form."""
    form, found = closed_forms(linkage)[0], entry(linkage)
    values = {**found.defaults, **values}
    theta = form.configurations(np.linspace(-2.9, 2.8, 40), values)
    return found.build(**values), theta[np.isfinite(theta).all(axis=1)]


def _steps(loop: Loop, theta: np.ndarray) -> list[np.ndarray]:
    """The transforms T_12, T_23, ... at one configuration."""
    frames = loop.frames(theta)
    return [np.linalg.solve(frames[i], frames[i + 1]) for i in range(loop.n)]


def _gap(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(x - y).max())


def _order_of_inverses() -> tuple[float, float]:
    """Equation (2.2.8), along the Bennett linkage."""
    loop, path = _along("bennett")
    printed, corrected = [], []
    for theta in path:
        t12, t23, t34, t41 = _steps(loop, theta)
        printed.append(_gap(t34 @ t41, np.linalg.inv(t12) @ np.linalg.inv(t23)))
        corrected.append(_gap(t34 @ t41, np.linalg.inv(t23) @ np.linalg.inv(t12)))
    return float(np.median(printed)), max(corrected)


def _bennett_entries() -> tuple[float, float]:
    """Equation (2.2.11): the entries (3, 4) of both sides of (2.2.8), for any
    angles."""
    loop, theta = entry("bennett").build(), np.array([0.5, 1.1, -0.7, 1.9])
    (a12, a23, _, _), alpha, _ = loop.arrays
    s12, s23, s2, s4 = np.sin([alpha[0], alpha[1], theta[1], theta[3]])
    t12, t23, t34, t41 = _steps(loop, theta)
    left, right = (t34 @ t41)[2, 3], np.linalg.inv(t12 @ t23)[2, 3]
    both = [
        (abs(left - a23 * s12 * x), abs(right + a12 * s23 * y))
        for x, y in ((s2, s4), (s4, s2))
    ]
    return float(max(both[0])), float(max(both[1]))


def _factors() -> tuple[float, float]:
    """Equation (A2): the product of the link and joint matrices (A3), (A4) beside
    (A1)."""
    loop, theta = (
        entry("bricard-line-symmetric").build(),
        np.array([0.5, 1.1, -0.7, 1.9, 0.3, -1.2]),
    )
    turn, still = _steps(loop, theta)[0], _steps(loop, 0 * theta)[0]
    joint = np.eye(4)
    joint[:2, :2] = [[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]]
    return _gap(still @ joint, turn), _gap(joint @ still, turn)


def _corrector() -> tuple[float, float]:
    """Equation (A17), 0.05 rad off: closure defect after one correction with E, and
    after five with -E."""
    loop, path = _along("bricard-line-symmetric")

    def after(sign: int, corrections: int) -> float:
        theta = path[7] + 0.05 * np.array([1, -1, 0.5, 0.3, 1, -0.6])
        for _ in range(corrections):
            error = loop.frames(theta)[-1] - np.eye(4)
            six = np.array([error[2, 1], error[0, 2], error[1, 0], *error[:3, 3]])
            theta = (
                theta
                + np.linalg.lstsq(loop.joint_screws(theta), sign * six, rcond=1e-6)[0]
            )
        return _gap(loop.frames(theta)[-1], np.eye(4))

    return after(+1, 1), after(-1, 5)


def _free_ratio() -> tuple[float, float]:
    """Equation (3.2.1): a Goldberg 5R whose link 45 has a ratio of its own, a23 = a45 +
    a51."""
    loop = entry("goldberg-5r").build()
    a12, a23, a34, a45, a51 = loop.lengths
    free = Loop((a12, a23 + 0.1 * a45, a34, 1.1 * a45, a51), loop.twists, loop.offsets)
    return held_gap(free), immobility(loop)


def _opposite_angles() -> tuple[float, float]:
    """The angles that are said to be equal before (4.2.1)."""
    _, path = _along("bricard-line-symmetric")
    half = [
        np.abs(np.sin((path[:, [0, 1, 2]] - path[:, others]) / 2)).max(axis=1)
        for others in ([2, 3, 5], [3, 4, 5])
    ]
    return float(np.median(half[0])), float(half[1].max())


def _sixth_angle() -> tuple[float, float]:
    """Equation (3.4.6): theta1S, theta1G from theta2S = ... by the corrected (3.4.4),
    (3.4.5)."""
    values = entry("mixed-double-goldberg-type-i").defaults
    _, path = _along("mixed-double-goldberg-type-i")
    u = {name: np.tan(values[name] / 2) for name in ("alpha", "beta", "delta")}
    m1, m3 = ((u[x] + u["alpha"]) / (u[x] - u["alpha"]) for x in ("beta", "delta"))
    first = 2 * np.arctan2(
        -m1 * np.cos(path[:, 0] / 2), np.sin(path[:, 0] / 2)
    )  # theta1 = theta2S
    other = 2 * np.arctan2(
        m3 * np.cos(path[:, 4] / 2), np.sin(path[:, 4] / 2)
    )  # theta5 = -theta2G
    value = np.pi + first - other
    gaps = [np.abs(np.sin((path[:, k] - value) / 2)) for k in (2, 5)]
    return float(np.median(gaps[0])), float(gaps[1].max())


def _second_twist() -> tuple[float, float]:
    """Equation (3.4.11): alpha34 = delta already; the second "alpha34" is alpha45."""
    found = entry("mixed-double-goldberg-type-ii")
    twists, values = found.build().twists, found.defaults
    expected = values["alpha"] + values["gamma"]
    return abs(twists[2] - expected), abs(twists[3] - expected)


# --- Wohlhart's symmetric mechanism


@cache
def _triangles() -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """Angles theta, phi, points (k, 6, 3) in the frame of O6, twist and length: O6 at
    the origin."""
    twist, a = radians(100), 1.3
    loop, path = _along("wohlhart-symmetric", a=a, alpha=twist)
    frames = loop.frames(path)
    points = np.stack([frames[:, i, :3, 3] for i in (1, 2, 3, 4, 5, 6)], axis=1)
    return path[:, 0], path[:, 1], points, twist, a


def _even_plane() -> tuple[float, float]:
    """Equation (17): the normal of the plane O2 O4 O6 is at right angles to O6 O2 and
    O6 O4."""
    x, y, points, alpha, a = _triangles()
    (sx, cx, sy, cy), (s, c) = (
        (np.sin(x), np.cos(x), np.sin(y), np.cos(y)),
        (np.sin(alpha), np.cos(alpha)),
    )
    n1 = a**2 * sy * s * (sx * cy + cx * sy * c - sy * c + sx)
    n2 = -(a**2) * sy * s * (cx + cy + cx * cy - sx * sy * c + 1)
    out = []
    for factor in (cx + 1, cy + 1):
        n3 = a**2 * (
            sy * c * (cx * cy - sx * sy * c + cx)
            + factor * (sx * cy + cx * sy * c + sx)
        )
        normal = np.stack([n1, n2, n3], axis=-1)
        out.append(
            np.abs(np.einsum("ki,kji->kj", normal, points[:, [1, 3]])).max(axis=1)
        )
    return float(np.median(out[0])), float(out[1].max())


def _distance_of_planes() -> tuple[float, float]:
    """Equation (29): the distance of O1 from the plane O2 O4 O6."""
    x, y, points, alpha, a = _triangles()
    normal = np.cross(points[:, 1] - points[:, 5], points[:, 3] - points[:, 5])
    size = np.linalg.norm(normal, axis=1)
    true = np.abs(np.einsum("ki,ki->k", normal, points[:, 0] - points[:, 5])) / size
    out = []
    for other, first in ((np.full_like(y, alpha), x), (y, y)):
        top = np.abs(a * np.sin(x / 2) * np.sin(other / 2) * np.sin(alpha))
        mixed = np.sin(x / 2) * np.cos(other / 2) + np.cos(x / 2) * np.sin(
            other / 2
        ) * np.cos(alpha)
        out.append(
            np.abs(
                top / np.sqrt(np.sin(first / 2) ** 2 * np.sin(alpha) ** 2 + mixed**2)
                - true
            )
        )
    good = size > 1e-3
    return float(np.median(out[0][good])), float(out[1][good].max())


def _meeting(
    point: np.ndarray, axis: np.ndarray, other: np.ndarray, other_axis: np.ndarray
) -> np.ndarray:
    """Where two lines meet."""
    along = np.linalg.lstsq(
        np.stack([axis, -other_axis], axis=1), other - point, rcond=None
    )[0]
    return np.asarray(point + along[0] * axis)


def _line_of_meetings() -> tuple[float, float]:
    """Equation (25): n, and n divided by its length, beside the unit vector from O'' to
    O'."""
    alpha, out = radians(100), []
    loop, path = _along("wohlhart-symmetric", a=1.3, alpha=alpha)
    for theta in path[np.abs(np.sin(path[:, 0]) * np.sin(path[:, 1])) > 0.3]:
        frames, (x, y) = loop.frames(theta), theta[:2]
        lines = [(frames[i, :3, 3], frames[i, :3, 2]) for i in (6, 4, 1, 5)]
        line = _meeting(*lines[0], *lines[1]) - _meeting(*lines[2], *lines[3])
        third = (np.cos(x) + 1) / np.sin(x) / np.tan(alpha) + (np.cos(y) + 1) / (
            np.sin(y) * np.sin(alpha)
        )
        n = np.array([1, -np.sin(x) / (1 - np.cos(x)), third])
        out.append(
            [_gap(v, line / np.linalg.norm(line)) for v in (n, n / np.linalg.norm(n))]
        )
    gaps = np.array(out)
    return float(np.median(gaps[:, 0])), float(gaps[:, 1].max())


SONG, WOHLHART = "Song 2013", "Racila and Dahan 2010"
BOTH = "Song 2013; Song and Chen 2012 (mixed)"
MATRIX_ROWS: tuple[Row, ...] = (
    (
        SONG,
        "(2.2.8)",
        "bennett",
        "T34 T41 = T12^-1 T23^-1",
        "T34 T41 = T23^-1 T12^-1",
        _order_of_inverses,
    ),
    (
        SONG,
        "(2.2.11)",
        "bennett",
        "a23 sin(alpha12) sin(theta2) = -a12 sin(alpha23) sin(theta4)",
        "theta4 left and theta2 right; harmless where theta2 = theta4 or -theta4",
        _bennett_entries,
    ),
    (
        SONG,
        "(3.2.1)",
        "goldberg-5r",
        "sin(alpha12)/a12 three times",
        "sin(alpha12)/a12 = sin(alpha45)/a45 = sin(alpha51)/a51",
        _free_ratio,
    ),
    (
        SONG,
        "(3.4.6)",
        "mixed-double-goldberg-type-i",
        "theta3 = ... twice",
        "the second is theta6",
        _sixth_angle,
    ),
    (
        BOTH,
        "(3.4.11); (4.11)",
        "mixed-double-goldberg-type-ii",
        "alpha34 = delta and alpha34 = alpha + gamma",
        "the second is alpha45 = alpha + gamma",
        _second_twist,
    ),
    (
        SONG,
        "text before (4.2.1)",
        "bricard-line-symmetric",
        "theta1 = theta3, theta2 = theta4, theta3 = theta6",
        "theta1 = theta4, theta2 = theta5, theta3 = theta6",
        _opposite_angles,
    ),
    (
        SONG,
        "(A2), (A6)",
        "bricard-line-symmetric",
        "T = T^L T^theta",
        "T = T^theta T^L",
        _factors,
    ),
    (
        SONG,
        "(A17)",
        "bricard-line-symmetric",
        "sum of T_i^p dtheta_i = E",
        "... = -E",
        _corrector,
    ),
    (
        WOHLHART,
        "(17)",
        "wohlhart-symmetric",
        "C3 with (cos(theta) + 1)(...)",
        "(cos(phi) + 1)(...)",
        _even_plane,
    ),
    (
        WOHLHART,
        "(25)",
        "wohlhart-symmetric",
        "unit vector n with n_x = 1",
        "n divided by its length",
        _line_of_meetings,
    ),
    (
        WOHLHART,
        "(29)",
        "wohlhart-symmetric",
        "sin(alpha/2), cos(alpha/2) and sin^2(theta/2) sin^2(alpha) under the root",
        "sin(phi/2), cos(phi/2) and sin^2(phi/2) sin^2(alpha)",
        _distance_of_planes,
    ),
)
