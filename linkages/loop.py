"""Geometry of a single closed loop of revolute joints.

Convention (Denavit and Hartenberg, in the form of the sources of the catalogue): the
transform of joint i and the link that follows it is ``T_i = Rz(theta_i) Tz(R_i) Tx(a_i)
Rx(alpha_i)``, and the loop is closed when ``T_1 T_2 ... T_n = I``. Entry i of
``lengths`` is a_{i,i+1}, of ``twists`` alpha_{i,i+1}, of ``offsets`` R_i; the last link
joins joint n to joint 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from bifurc.errors import BifurcError

__all__ = ["MAX_JOINTS", "MIN_JOINTS", "GeometryError", "Loop", "loop_from_axes"]

MIN_JOINTS, MAX_JOINTS = 4, 12
NUMBERS = (int, float, np.integer, np.floating)


class GeometryError(BifurcError, ValueError):
    """A linkage that cannot be built: ``name`` is the offending quantity, ``value``
    what was given and ``allowed`` what it may be."""

    def __init__(self, name: str, value: Any, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f"{name}: {value} is not allowed; it must be {allowed}")


@dataclass(frozen=True)
class Loop:
    """A closed chain of n revolute joints, 4 <= n <= 12.

    ``lengths`` a_{i,i+1} and ``offsets`` R_i share one unit of length, ``twists``
    alpha_{i,i+1} are in radians. Entries may be floats, mpmath numbers or sympy
    expressions; `arrays` gives the floats that the compiled kernels read. Raises
    `GeometryError` for unequal or wrong numbers of entries and for values that are not
    finite.
    """

    lengths: tuple[Any, ...]
    twists: tuple[Any, ...]
    offsets: tuple[Any, ...]
    name: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        for which in ("lengths", "twists", "offsets"):
            object.__setattr__(self, which, tuple(getattr(self, which)))
        n = len(self.lengths)
        if not MIN_JOINTS <= n <= MAX_JOINTS:
            raise GeometryError(
                "number of joints", n, f"from {MIN_JOINTS} to {MAX_JOINTS}"
            )
        for which in ("twists", "offsets"):
            if len(getattr(self, which)) != n:
                raise GeometryError(
                    f"number of {which}",
                    len(getattr(self, which)),
                    f"{n}, the number of lengths",
                )
        for which in ("lengths", "twists", "offsets"):
            for i, value in enumerate(getattr(self, which), start=1):
                if isinstance(value, NUMBERS) and not math.isfinite(value):
                    raise GeometryError(f"{which}[{i}]", value, "a finite number")

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lengths)

    @cached_property
    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(lengths, twists, offsets) as float arrays of shape (n,)."""
        a, b, c = (
            np.array([float(x) for x in v])
            for v in (self.lengths, self.twists, self.offsets)
        )
        return a, b, c

    @cached_property
    def characteristic_length(self) -> float:
        """Mean of |length| + |offset| over the links that have any; 1 for a spherical
        loop without any.

        Residuals and Jacobians measure translations in it, so that results do not
        depend on the unit.
        """
        a, _, offsets = self.arrays
        extent = np.abs(a) + np.abs(offsets)
        return float(extent[extent > 0].mean()) if np.any(extent > 0) else 1.0

    def frames(self, theta: np.ndarray) -> np.ndarray:
        """Homogeneous transforms (..., n + 1, 4, 4) from the base to frame i before
        joint i is turned.

        ``theta`` has shape (..., n), rad. Entry 0 is I, entry n the product of all: I
        when closed.
        """
        theta = np.asarray(theta, dtype=float)
        if theta.shape[-1:] != (self.n,):
            raise GeometryError("number of joint angles", theta.shape[-1:], f"{self.n}")
        a, alpha, offset = self.arrays
        out = np.empty((*theta.shape[:-1], self.n + 1, 4, 4))
        out[..., 0, :, :] = np.eye(4)
        for i in range(self.n):
            c, s = np.cos(theta[..., i]), np.sin(theta[..., i])
            ca, sa = np.cos(alpha[i]), np.sin(alpha[i])
            step = np.zeros((*theta.shape[:-1], 4, 4))
            step[..., 0, 0], step[..., 0, 1], step[..., 0, 2], step[..., 0, 3] = (
                c,
                -s * ca,
                s * sa,
                a[i] * c,
            )
            step[..., 1, 0], step[..., 1, 1], step[..., 1, 2], step[..., 1, 3] = (
                s,
                c * ca,
                -c * sa,
                a[i] * s,
            )
            step[..., 2, 1], step[..., 2, 2], step[..., 2, 3] = sa, ca, offset[i]
            step[..., 3, 3] = 1.0
            out[..., i + 1, :, :] = out[..., i, :, :] @ step
        return out

    def joint_screws(self, theta: np.ndarray) -> np.ndarray:
        """Joint screws (..., 6, n) in the base frame: unit direction over moment, in
        the loop's unit."""
        frames = self.frames(theta)[..., :-1, :, :]
        direction, point = frames[..., :3, 2], frames[..., :3, 3]
        return np.moveaxis(
            np.concatenate([direction, np.cross(point, direction)], axis=-1), -1, -2
        )

    def relabelled(self, shift: int) -> Loop:
        """The same linkage with joint 1 + shift called joint 1; a configuration is
        ``np.roll(theta, -shift)``."""
        k = shift % self.n
        a, b, c = (v[k:] + v[:k] for v in (self.lengths, self.twists, self.offsets))
        return Loop(a, b, c, self.name)

    def reversed(self) -> Loop:
        """The same linkage read the other way round; a configuration is
        ``theta[::-1]``.

        Reversing order inverts every factor; half turns about x and z turn the signs
        back, so that only the order of the entries changes, the last link staying last.
        """
        a, b = (v[-2::-1] + v[-1:] for v in (self.lengths, self.twists))
        return Loop(a, b, self.offsets[::-1], self.name)

    def mirrored(self) -> Loop:
        """The mirror image; a configuration keeps its angles."""
        twists, offsets = (tuple(-x for x in v) for v in (self.twists, self.offsets))
        return Loop(self.lengths, twists, offsets, self.name)

    def scaled(self, factor: float) -> Loop:
        """The linkage with all lengths and offsets times ``factor``; a configuration
        keeps its angles."""
        a, c = (tuple(factor * x for x in v) for v in (self.lengths, self.offsets))
        return Loop(a, self.twists, c, self.name)


def loop_from_axes(
    points: Sequence[Sequence[float]],
    directions: Sequence[Sequence[float]],
    name: str = "",
) -> tuple[Loop, np.ndarray]:
    """The loop whose joint axes, in one configuration, pass through ``points`` along
    ``directions``.

    Both are (n, 3), in loop order, any unit and frame; directions need not be unit
    vectors. Returns the loop and the joint angles (n,) of that configuration. Where
    neighbouring axes are parallel, the common normal is drawn through the foot of the
    previous one. Raises `GeometryError` for wrong shapes, values that are not finite, a
    zero direction, or neighbouring axes that coincide.
    """
    p, d = np.asarray(points, dtype=float), np.asarray(directions, dtype=float)
    for what, v in (("points", p), ("directions", d)):
        if v.ndim != 2 or v.shape[1] != 3 or v.shape != p.shape:
            raise GeometryError(
                f"shape of {what}",
                v.shape,
                "(n, 3), the same for points and directions",
            )
        if not np.all(np.isfinite(v)):
            raise GeometryError(what, v[~np.isfinite(v)][0], "finite numbers")
    n = len(p)
    size = np.linalg.norm(d, axis=1)
    if np.any(size == 0):
        raise GeometryError(
            f"directions[{int(np.argmin(size)) + 1}]", "0, 0, 0", "a non-zero vector"
        )
    z = d / size[:, None]
    extent = max(float(np.ptp(p, axis=0).max()), 1e-300)

    crossing = [np.cross(z[i], z[(i + 1) % n]) for i in range(n)]
    oblique = [i for i in range(n) if np.linalg.norm(crossing[i]) > 1e-9]
    start = oblique[-1] if oblique else n - 1
    lengths, twists, x = np.zeros(n), np.zeros(n), np.zeros((n, 3))
    out_foot, in_foot = (
        np.zeros((n, 3)),
        np.zeros((n, 3)),
    )  # feet of the normals to the next and from the previous axis
    in_foot[(start + 1) % n] = p[(start + 1) % n]
    for step in range(start, start + n):
        i, j = step % n, (step + 1) % n
        gap = p[j] - p[i]
        if i in oblique:
            normal = crossing[i] / np.linalg.norm(crossing[i])
            # p_i + u z_i and p_j + v z_j are the nearest points of the two lines
            u, v = np.linalg.lstsq(np.column_stack([z[i], -z[j]]), gap, rcond=None)[0]
            out_foot[i], in_foot[j] = p[i] + u * z[i], p[j] + v * z[j]
            across = in_foot[j] - out_foot[i]
            x[i] = normal if across @ normal >= 0 else -normal
            lengths[i] = across @ x[i]
        else:
            out_foot[i] = in_foot[i] if step > start else p[i]
            across = gap + p[i] - out_foot[i]
            across -= (across @ z[i]) * z[i]
            lengths[i] = np.linalg.norm(across)
            if lengths[i] < 1e-12 * extent:
                raise GeometryError(
                    f"axes {i + 1} and {j + 1}", "the same line", "different lines"
                )
            x[i], in_foot[j] = across / lengths[i], out_foot[i] + across
        twists[i] = np.arctan2(np.cross(z[i], z[j]) @ x[i], z[i] @ z[j])
    offsets = np.einsum("ij,ij->i", out_foot - in_foot, z)
    rounding = 1e-13 * float(
        np.abs(p).max()
    )  # of axes that meet: a loop of nothing else would be measured by it
    for values in (lengths, offsets):
        values[np.abs(values) < rounding] = 0.0
    before = np.roll(x, 1, axis=0)
    theta = np.arctan2(
        np.einsum("ij,ij->i", np.cross(before, x), z), np.einsum("ij,ij->i", before, x)
    )
    return Loop(tuple(lengths), tuple(twists), tuple(offsets), name), theta
