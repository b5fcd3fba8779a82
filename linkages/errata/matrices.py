"""Misprints in the matrix equations, and in the closure of known loops."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.errata.conditions import immobility
from linkages.errata.erratum import Amounts, Erratum, median_and_largest
from linkages.loop import Loop
from linkages.mobility import held_gap

ANGLES = np.array([0.5, 1.1, -0.7, 1.9, 0.3, -1.2])  # rad, of a loop that is not closed


class Path(NamedTuple):
    """A loop and configurations (k, n) of it, rad."""

    loop: Loop
    theta: np.ndarray


def path_along(linkage: str, **values: float) -> Path:
    """Configurations along the first closed form of the member with these
    parameters."""
    owner = entry(linkage)
    parameters = {**owner.defaults, **values}
    inputs = np.linspace(-2.9, 2.8, 40)
    theta = owner.closed_forms[0].configurations(inputs, parameters)
    return Path(owner.build(**parameters), theta[np.isfinite(theta).all(axis=1)])


def _steps(loop: Loop, theta: np.ndarray) -> list[np.ndarray]:
    """The transforms T_12, T_23, ... at one configuration."""
    frames = loop.frames(theta)
    return [np.linalg.solve(frames[i], frames[i + 1]) for i in range(loop.n)]


def _gap(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(x - y).max())


def _order_of_inverses() -> Amounts:
    """Equation (2.2.8), along the Bennett linkage."""
    loop, path = path_along("bennett")
    printed = []
    corrected = []
    for theta in path:
        t12, t23, t34, t41 = _steps(loop, theta)
        left = t34 @ t41
        printed.append(_gap(left, np.linalg.inv(t12) @ np.linalg.inv(t23)))
        corrected.append(_gap(left, np.linalg.inv(t23) @ np.linalg.inv(t12)))
    return median_and_largest(printed, corrected)


def _bennett_entries() -> Amounts:
    """Equation (2.2.11): the entries (3, 4) of both sides of (2.2.8), for any
    angles."""
    loop = entry("bennett").build()
    theta = ANGLES[:4]
    a12, a23 = loop.arrays[0][:2]
    s12, s23 = np.sin(loop.arrays[1][:2])
    s2, s4 = np.sin(theta[[1, 3]])
    t12, t23, t34, t41 = _steps(loop, theta)
    left = (t34 @ t41)[2, 3]
    right = np.linalg.inv(t12 @ t23)[2, 3]

    def largest(in_left: float, in_right: float) -> float:
        left_gap = abs(left - a23 * s12 * in_left)
        right_gap = abs(right + a12 * s23 * in_right)
        return float(max(left_gap, right_gap))

    return Amounts(largest(s2, s4), largest(s4, s2))


def _factors() -> Amounts:
    """Equation (A2): the product of the link and joint matrices (A3), (A4) beside
    (A1)."""
    loop = entry("bricard-line-symmetric").build()
    transform = _steps(loop, ANGLES)[0]
    link = _steps(loop, 0 * ANGLES)[0]
    c = np.cos(ANGLES[0])
    s = np.sin(ANGLES[0])
    joint = np.eye(4)
    joint[:2, :2] = [[c, -s], [s, c]]
    return Amounts(_gap(link @ joint, transform), _gap(joint @ link, transform))


def _corrector() -> Amounts:
    """Equation (A17), 0.05 rad off: closure defect after one correction with E, and
    after five with -E."""
    return Amounts(_defect_after(+1, 1), _defect_after(-1, 5))


def _defect_after(sign: int, corrections: int) -> float:
    loop, path = path_along("bricard-line-symmetric")
    theta = path[7] + 0.05 * np.array([1, -1, 0.5, 0.3, 1, -0.6])
    identity = np.eye(4)
    for _ in range(corrections):
        error = loop.frames(theta)[-1] - identity
        rotation = [error[2, 1], error[0, 2], error[1, 0]]
        shift = error[:3, 3].tolist()
        six = np.array([*rotation, *shift])
        screws = loop.joint_screws(theta)
        solution = np.linalg.lstsq(screws, sign * six, rcond=1e-6)
        theta = theta + solution[0]
    return _gap(loop.frames(theta)[-1], identity)


def _free_ratio() -> Amounts:
    """Equation (3.2.1): a Goldberg 5R whose link 45 has a ratio of its own, a23 = a45 +
    a51."""
    loop = entry("goldberg-5r").build()
    a12, a23, a34, a45, a51 = loop.lengths
    lengths = (a12, a23 + 0.1 * a45, a34, 1.1 * a45, a51)
    free = Loop(lengths, loop.twists, loop.offsets)
    return Amounts(held_gap(free), immobility(loop))


def _opposite_angles() -> Amounts:
    """The angles that are said to be equal before (4.2.1)."""
    _, path = path_along("bricard-line-symmetric")

    def gaps(others: list[int]) -> np.ndarray:
        half = (path[:, [0, 1, 2]] - path[:, others]) / 2
        return np.asarray(np.abs(np.sin(half)).max(axis=1))

    return median_and_largest(gaps([2, 3, 5]), gaps([3, 4, 5]))


def _sixth_angle() -> Amounts:
    """Equation (3.4.6): theta1S, theta1G from theta2S = ... by the corrected (3.4.4),
    (3.4.5)."""
    linkage = "mixed-double-goldberg-type-i"
    _, path = path_along(linkage)
    values = entry(linkage).defaults
    u_a = np.tan(values["alpha"] / 2)
    u_b = np.tan(values["beta"] / 2)
    u_d = np.tan(values["delta"] / 2)
    m1 = (u_b + u_a) / (u_b - u_a)
    m3 = (u_d + u_a) / (u_d - u_a)
    # theta1 = theta2S and theta5 = -theta2G
    first_half = path[:, 0] / 2
    other_half = path[:, 4] / 2
    first = 2 * np.arctan2(-m1 * np.cos(first_half), np.sin(first_half))
    other = 2 * np.arctan2(m3 * np.cos(other_half), np.sin(other_half))
    value = np.pi + first - other

    def gaps(i: int) -> np.ndarray:
        return np.asarray(np.abs(np.sin((path[:, i] - value) / 2)))

    return median_and_largest(gaps(2), gaps(5))


def _second_twist() -> Amounts:
    """Equation (3.4.11): alpha34 = delta already; the second "alpha34" is alpha45."""
    linkage = entry("mixed-double-goldberg-type-ii")
    _, _, alpha34, alpha45, *_ = linkage.build().twists
    expected = linkage.defaults["alpha"] + linkage.defaults["gamma"]
    return Amounts(abs(alpha34 - expected), abs(alpha45 - expected))


SONG = "Song 2013"
BOTH = "Song 2013; Song and Chen 2012 (mixed)"

MATRIX_ERRATA: tuple[Erratum, ...] = (
    Erratum(
        SONG,
        "(2.2.8)",
        "bennett",
        "T34 T41 = T12^-1 T23^-1",
        "T34 T41 = T23^-1 T12^-1",
        _order_of_inverses,
    ),
    Erratum(
        SONG,
        "(2.2.11)",
        "bennett",
        "a23 sin(alpha12) sin(theta2) = -a12 sin(alpha23) sin(theta4)",
        "theta4 left and theta2 right; harmless where theta2 = theta4 or -theta4",
        _bennett_entries,
    ),
    Erratum(
        SONG,
        "(3.2.1)",
        "goldberg-5r",
        "sin(alpha12)/a12 three times",
        "sin(alpha12)/a12 = sin(alpha45)/a45 = sin(alpha51)/a51",
        _free_ratio,
    ),
    Erratum(
        SONG,
        "(3.4.6)",
        "mixed-double-goldberg-type-i",
        "theta3 = ... twice",
        "the second is theta6",
        _sixth_angle,
    ),
    Erratum(
        BOTH,
        "(3.4.11); (4.11)",
        "mixed-double-goldberg-type-ii",
        "alpha34 = delta and alpha34 = alpha + gamma",
        "the second is alpha45 = alpha + gamma",
        _second_twist,
    ),
    Erratum(
        SONG,
        "text before (4.2.1)",
        "bricard-line-symmetric",
        "theta1 = theta3, theta2 = theta4, theta3 = theta6",
        "theta1 = theta4, theta2 = theta5, theta3 = theta6",
        _opposite_angles,
    ),
    Erratum(
        SONG,
        "(A2), (A6)",
        "bricard-line-symmetric",
        "T = T^L T^theta",
        "T = T^theta T^L",
        _factors,
    ),
    Erratum(
        SONG,
        "(A17)",
        "bricard-line-symmetric",
        "sum of T_i^p dtheta_i = E",
        "... = -E",
        _corrector,
    ),
)
