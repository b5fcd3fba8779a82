"""Equations between numbers and matrices as printed, against the corrected ones."""

from __future__ import annotations

from math import cos, pi, radians, sin
from typing import NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link
from linkages.errata.erratum import Amounts, largest_gap, median_and_largest
from linkages.loop import Loop

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


def order_of_inverses() -> Amounts:
    """Equation (2.2.8), along the Bennett linkage."""
    loop, path = path_along("bennett")
    printed = []
    corrected = []
    for theta in path:
        t12, t23, t34, t41 = _steps(loop, theta)
        left = t34 @ t41
        printed.append(largest_gap(left, np.linalg.inv(t12) @ np.linalg.inv(t23)))
        corrected.append(largest_gap(left, np.linalg.inv(t23) @ np.linalg.inv(t12)))
    return median_and_largest(printed, corrected)


def bennett_entries() -> Amounts:
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


def factors() -> Amounts:
    """Equation (A2): the product of the link and joint matrices (A3), (A4) beside
    (A1)."""
    loop = entry("bricard-line-symmetric").build()
    transform = _steps(loop, ANGLES)[0]
    link = _steps(loop, 0 * ANGLES)[0]
    c = np.cos(ANGLES[0])
    s = np.sin(ANGLES[0])
    joint = np.eye(4)
    joint[:2, :2] = [[c, -s], [s, c]]
    return Amounts(
        largest_gap(link @ joint, transform), largest_gap(joint @ link, transform)
    )


def corrector() -> Amounts:
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
    return largest_gap(loop.frames(theta)[-1], identity)


def opposite_angles() -> Amounts:
    """The angles that are said to be equal before (4.2.1)."""
    _, path = path_along("bricard-line-symmetric")

    def gaps(others: list[int]) -> np.ndarray:
        half = (path[:, [0, 1, 2]] - path[:, others]) / 2
        return np.asarray(np.abs(np.sin(half)).max(axis=1))

    return median_and_largest(gaps([2, 3, 5]), gaps([3, 4, 5]))


def sixth_angle() -> Amounts:
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


def second_twist() -> Amounts:
    """Equation (3.4.11): alpha34 = delta already; the second "alpha34" is alpha45."""
    linkage = entry("mixed-double-goldberg-type-ii")
    _, _, alpha34, alpha45, *_ = linkage.build().twists
    expected = linkage.defaults["alpha"] + linkage.defaults["gamma"]
    return Amounts(abs(alpha34 - expected), abs(alpha45 - expected))


# --- between numbers


def special_length() -> Amounts:
    """Equation (5.2.34): b = sin(beta)/sin(alpha), to the four decimals that are
    printed."""
    rounded = round(sin(radians(60)) / sin(radians(125)), 4)
    return Amounts(abs(1.5072 - rounded), abs(1.0572 - rounded))


def cosine_multipliers() -> Amounts:
    """Equation (5.2.21): the first fraction must stay sin((d+g)/2)/sin((d-g)/2), times
    one; (5.2.22) follows."""
    d = radians(83)
    g = radians(28)
    half_sum = (d + g) / 2
    half_difference = (d - g) / 2
    value = sin(half_sum) / sin(half_difference)
    printed = sin(d + g) / (sin(d) - cos(g))
    corrected = (sin(d) + sin(g)) / sin(d - g)
    second = sin(d + g) / (sin(d) - sin(g)) * cos(half_sum) / cos(half_sum)
    double = 2 * cos(half_sum)
    expected = sin(half_sum) * double / (sin(half_difference) * double)
    left = max(abs(corrected - value), abs(second - expected))
    return Amounts(abs(printed - expected), left)


def triangle_offset() -> Amounts:
    """Equation (5.3.2): R3 over sin(alpha31) sin(theta3), or over sin(alpha23)
    sin(theta2)."""
    a = 0.9
    alpha = radians(35)
    b = 2.0
    beta = radians(60)
    theta_2 = radians(-70)
    triangle = composite_link(Link(a, alpha), Link(b, beta), theta_2, 0.7)
    d = float(triangle.link.length)
    r3 = -float(triangle.after.offset)
    theta_3 = pi - float(triangle.after.angle)
    mixed = cos(beta) * sin(theta_2) * sin(theta_3) - cos(theta_2) * cos(theta_3)
    top = d * mixed - a - b * cos(theta_2)
    printed = top / (sin(float(triangle.link.twist)) * sin(theta_3))
    corrected = top / (sin(beta) * sin(theta_2))
    return Amounts(abs(abs(printed) - abs(r3)), abs(abs(corrected) - abs(r3)))


def line_symmetric_bennett() -> Amounts:
    """Equation (5.3.6): cosines or sines with the twist gamma, the second twist being
    gamma - pi."""
    alpha = radians(66)
    gamma = radians(50)
    loop = entry("bennett-lb-2").build(a=1.0, alpha=alpha, beta=gamma)

    def defect(product: float) -> float:
        t = 0.8
        one = 2 * np.arctan(t)
        other = 2 * np.arctan(product / t)
        product_of_all = loop.frames(np.array([one, other, one, other]))[-1]
        return float(np.abs(product_of_all - np.eye(4)).max())

    total = (gamma + alpha) / 2
    difference = (gamma - alpha) / 2
    printed = defect(cos(total) / cos(difference))
    corrected = defect(sin(total) / sin(difference))
    return Amounts(printed, corrected)
