"""Equations between numbers, vectors and matrices as printed, against the corrected ones:
formulas of what they leave, which is 0 where they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import nan, tan
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.construction.equations import evaluate, numbers_of
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import CompositeLink, composite_link
from linkages.errata.erratum import Amounts, median_and_largest
from linkages.families.bricard import LETTERS, closure_equation
from linkages.identification.equivalence import table
from linkages.loop import Loop

NEAR = 1e-13  # rad, from the input where a root changes


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


def compare_equations(
    linkage: str,
    where: Mapping[str, str | float | list[float]],
    printed: list[str],
    corrected: list[str],
    along: Mapping[str, str] | None = None,
    at: list[float] | None = None,
) -> Amounts:
    """What the formulas leave, those of the print and the corrected ones, of the numbers
    and the parameters of a linkage, and of names defined ``where``.

    With ``along``, the parameters of a member, they are taken along its closed form,
    with ``at`` at angles, rad. The largest is taken at each place; places where a formula
    is not a number do not count.
    """
    values = {name: evaluate(text) for name, text in (along or {}).items()}
    parameters = entry(linkage).defaults | values
    loop = entry(linkage).build(**parameters)
    names = {**FUNCTIONS, **parameters, **numbers_of(table(loop))}
    theta = np.empty((1, 0)) if at is None else np.array([at])
    if along is not None:
        theta = path_along(linkage, **values).theta
    if theta.size:
        names |= _names_along(loop, theta)

    def left(formulas: list[str]) -> np.ndarray:
        gaps = [np.reshape(evaluate(one, names), (len(theta), -1)) for one in formulas]
        largest = np.abs(np.concatenate(gaps, axis=1)).max(axis=1)
        return np.asarray(largest[~np.isnan(largest)])

    with np.errstate(all="ignore"):
        define(names, where)
        return median_and_largest(left(printed), left(corrected))


def define(
    names: dict[str, Any], where: Mapping[str, str | float | list[float]]
) -> None:
    """Add to ``names`` what formulas or numbers define ``where``, one after the other."""
    for name, value in where.items():
        is_text = isinstance(value, str)
        names[name] = evaluate(str(value), names) if is_text else np.array(value)


def _names_along(loop: Loop, theta: np.ndarray) -> dict[str, np.ndarray]:
    """At configurations (k, n): the angles theta1 (k,), the transforms T12 (k, 4, 4), and
    the points O1 and directions Z1 (k, 3) of the axes."""
    frames = loop.frames(theta)
    steps = np.linalg.solve(frames[:, :-1], frames[:, 1:])
    names: dict[str, np.ndarray] = {}
    for i in range(loop.n):
        number = i + 1
        names[f"theta{number}"] = theta[:, i]
        names[f"T{number}{number % loop.n + 1}"] = steps[:, i]
        names[f"O{number}"] = frames[:, number, :3, 3]
        names[f"Z{number}"] = frames[:, number, :3, 2]
    return names


# --- what formulas may use besides those names


def _turn(axis: int) -> Callable[[Any], np.ndarray]:
    """The transform (..., 4, 4) that turns by an angle about an axis, 0, 1 or 2."""
    i = (axis + 1) % 3
    j = (axis + 2) % 3

    def turn(angle: Any) -> np.ndarray:
        out = np.zeros((*np.shape(angle), 4, 4)) + np.eye(4)
        out[..., i, i] = out[..., j, j] = np.cos(angle)
        out[..., j, i] = np.sin(angle)
        out[..., i, j] = -out[..., j, i]
        return out

    return turn


def _shift(x: float, y: float, z: float) -> np.ndarray:
    """The transform (4, 4) that moves by these lengths."""
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out


def _vector(*parts: Any) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _moved(transform: np.ndarray, point: np.ndarray) -> np.ndarray:
    """A point (3,) after transforms (..., 4, 4)."""
    moved: np.ndarray = transform[..., :3, :3] @ point + transform[..., :3, 3]
    return moved


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(np.sum(one * other, axis=-1))


def _unit(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / np.linalg.norm(vector, axis=-1, keepdims=True))


def _meeting(
    point: np.ndarray, direction: np.ndarray, other: np.ndarray, along: np.ndarray
) -> np.ndarray:
    """Where lines meet (k, 3), each with its point and its direction."""
    normal = np.cross(direction, along)
    way = _dot(np.cross(other - point, along), normal) / _dot(normal, normal)
    return np.asarray(point + way[:, None] * direction)


def _triangle(
    a: float, alpha: float, b: float, beta: float, kink: float, offset: float
) -> CompositeLink:
    return composite_link(Link(a, alpha), Link(b, beta), kink, offset)


def _closure(linkage: str, number: int) -> SimpleNamespace:
    """The coefficients of the equation for joint 2 or 3 of a line-symmetric Bricard
    linkage, by their letters."""
    row = closure_equation(number, numbers_of(table(entry(linkage).build())))
    return SimpleNamespace(**dict(zip(LETTERS, row, strict=True)))


def _ratio(x: Any, y: Any) -> Any:
    """m of two twists, rad."""
    return np.sin((x + y) / 2) / np.sin((x - y) / 2)


def _jump(degrees: list[float], t: float, below: int, above: int) -> float:
    """The gap between the angles theta4 of a double-Goldberg linkage, as |sin| of half
    their difference, at tan(theta1/2) = ``t`` between the root ``below`` and the root
    ``above``: at a switch of the root the curve must go on."""
    at = 2 * np.arctan(t)
    before = _fourth(degrees, at - NEAR, below)
    after = _fourth(degrees, at + NEAR, above)
    return float(abs(np.sin((before - after) / 2)))


def _fourth(degrees: list[float], theta_1: float, root: int) -> float:
    """theta4 by (5.2.2), (5.2.4) with 1 - m1 m6 throughout; nan where there is none."""
    alpha, beta, gamma, delta = np.radians(degrees)
    m6 = _ratio(beta, gamma)
    k = _ratio(delta, alpha) * _ratio(delta, gamma)
    product = _ratio(beta, alpha) * m6
    t = tan(theta_1 / 2)
    q = (k - 1) * t / (k + t * t)
    square = (1 - product) ** 2 - 4 * product * q * q
    if square < 0:
        return nan
    p = ((1 - product) + root * np.sqrt(square)) / (2 * m6 * q)
    return float(2 * np.arctan(m6 * p))


FUNCTIONS: dict[str, Any] = {
    **{name: getattr(np, name) for name in ("sin", "cos", "tan", "abs", "round")},
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sqrt": np.emath.sqrt,
    "least": lambda *values: np.min(np.abs(values)),
    "unless": lambda is_left_out, value: np.where(is_left_out, np.nan, value),
    "m": _ratio,
    "inv": np.linalg.inv,
    "I": np.eye(4),
    "Rx": _turn(0),
    "Ry": _turn(1),
    "Rz": _turn(2),
    "shift": _shift,
    "vector": _vector,
    "moved": _moved,
    "dot": _dot,
    "cross": np.cross,
    "unit": _unit,
    "meeting": _meeting,
    "triangle": _triangle,
    "closure": _closure,
    "jump": _jump,
}


# --- what is no formula


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
    return float(np.abs(loop.frames(theta)[-1] - identity).max())
