"""Geometry of a single closed loop of revolute joints.

Convention (Denavit and Hartenberg, in the form of the sources of the catalogue): the
transform of joint i and the link that follows it is ``T_i = Rz(theta_i) Tz(R_i) Tx(a_i)
Rx(alpha_i)``, and the loop is closed when ``T_1 T_2 ... T_n = I``. Entry i of
``lengths`` is a_{i,i+1}, of ``twists`` alpha_{i,i+1}, of ``offsets`` R_i; the last link
joins joint n to joint 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkages import kinematics
from linkages.geometry_table import geometry_rows, geometry_text
from linkages.kinematics import LinkTable, Number
from linkages.values import (
    GeometryError,
    check_angles,
    check_numbers,
    quoted,
)

MIN_JOINTS = 4
MAX_JOINTS = 12
# Characteristic lengths beyond which squares of lengths leave the range of doubles.
SMALLEST, LARGEST = 1e-100, 1e100


@dataclass(frozen=True)
class Loop:
    """A closed chain of n revolute joints, 4 <= n <= 12.

    ``lengths`` a_{i,i+1} and ``offsets`` R_i share one unit of length, ``twists``
    alpha_{i,i+1} are in radians. Entries may be floats, mpmath numbers, sympy
    expressions or exact numbers; `arrays` gives the floats. ``rounding``: how far off
    lengths may be, as coordinates far from the origin were rounded; 0 where that is not
    known. Raises `GeometryError` for unequal or wrong numbers of entries, for entries that are not finite numbers, and
    for twists of over a thousand turns.

    >>> import linkages, numpy as np
    >>> loop = linkages.Loop([1, 0.5, 1, 0.5], np.radians([90, 30, 90, 30]), [0, 0, 0, 0])
    >>> linkages.map_linkage(loop).forms[0].branch.closed
    True
    """

    lengths: tuple[Number, ...]
    twists: tuple[Number, ...]
    offsets: tuple[Number, ...]
    name: str = field(default="", compare=False)
    rounding: float = field(default=0.0, compare=False)

    def __post_init__(self) -> None:
        for column in ("lengths", "twists", "offsets"):
            values = getattr(self, column)
            if not isinstance(values, Iterable):
                raise GeometryError(column, quoted(values), "a list of numbers")
            object.__setattr__(self, column, tuple(values))
        n = len(self.lengths)
        if not MIN_JOINTS <= n <= MAX_JOINTS:
            allowed = f"from {MIN_JOINTS} to {MAX_JOINTS}"
            raise GeometryError("number of joints", n, allowed)
        for column in ("twists", "offsets"):
            count = len(getattr(self, column))
            if count != n:
                allowed = f"{n}, the number of lengths"
                raise GeometryError(f"number of {column}", count, allowed)
        check_numbers("lengths", self.lengths)
        check_angles("twists", self.twists)
        check_numbers("offsets", self.offsets)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lengths)

    @cached_property
    def arrays(self) -> LinkTable:
        """Lengths, twists (rad) and offsets as float arrays of shape (n,)."""
        return LinkTable(
            np.array([float(length) for length in self.lengths]),
            np.array([float(twist) for twist in self.twists]),
            np.array([float(offset) for offset in self.offsets]),
        )

    @cached_property
    def characteristic_length(self) -> float:
        """Mean of |length| + |offset| over the links that have any; 1 for a spherical
        loop without any.

        Residuals and Jacobians measure translations in it, so that results do not
        depend on the unit.
        """
        extent = np.abs(self.arrays.lengths) + np.abs(self.arrays.offsets)
        if not np.any(extent > 0):
            return 1.0
        with np.errstate(over="ignore"):  # infinite lengths are refused by whoever maps
            return float(extent[extent > 0].mean())

    @cached_property
    def link_geometry(self) -> np.ndarray:
        """What compiled kernels read of the links, (6, n): lengths and offsets in
        characteristic lengths, cosines and sines of the twists and of half the
        twists."""
        return kinematics.link_geometry(self.arrays, self.characteristic_length)

    def frames(self, theta: np.ndarray) -> np.ndarray:
        """Homogeneous transforms (..., n + 1, 4, 4) from the base to frame i before
        joint i is turned.

        ``theta`` has shape (..., n), rad. Entry 0 is I, entry n the product of all: I
        when closed. Raises `GeometryError` for another number of angles.
        """
        angles = np.asarray(theta, dtype=float)
        if angles.shape[-1:] != (self.n,):
            raise GeometryError(
                "number of joint angles", angles.shape[-1:], f"{self.n}"
            )
        return kinematics.joint_frames(self.arrays, angles)

    def joint_screws(self, theta: np.ndarray) -> np.ndarray:
        """Joint screws (..., 6, n) in the base frame: unit direction over moment, in
        the loop's unit."""
        return kinematics.joint_screws(self.frames(theta))

    def closure_error(self, theta: np.ndarray) -> np.ndarray:
        """The largest entry (...,) of T_1 ... T_n - I at joint angles (..., n), rad,
        translations in characteristic lengths: 0 where the loop is closed."""
        gap = self.frames(theta)[..., -1, :, :] - np.eye(4)
        gap[..., :3, 3] /= self.characteristic_length
        largest: np.ndarray = np.abs(gap).max(axis=(-2, -1))
        return largest

    def relabelled(self, shift: int) -> Loop:
        """The same linkage with joint 1 + shift called joint 1; a configuration is
        ``np.roll(theta, -shift)``."""
        first = shift % self.n
        return Loop(
            self.lengths[first:] + self.lengths[:first],
            self.twists[first:] + self.twists[:first],
            self.offsets[first:] + self.offsets[:first],
            self.name,
            self.rounding,
        )

    def reversed(self) -> Loop:
        """The same linkage read the other way round; a configuration is
        ``theta[::-1]``.

        Reversing order inverts every factor; half turns about x and z turn the signs
        back, so that only the order of the entries changes, the last link staying last.
        """
        lengths = self.lengths[-2::-1] + self.lengths[-1:]
        twists = self.twists[-2::-1] + self.twists[-1:]
        return Loop(lengths, twists, self.offsets[::-1], self.name, self.rounding)

    def mirrored(self) -> Loop:
        """The mirror image; a configuration keeps its angles."""
        twists = tuple(-twist for twist in self.twists)
        offsets = tuple(-offset for offset in self.offsets)
        return Loop(self.lengths, twists, offsets, self.name, self.rounding)

    def scaled(self, factor: float) -> Loop:
        """The linkage with all lengths and offsets times ``factor``; a configuration
        keeps its angles."""
        lengths = tuple(factor * length for length in self.lengths)
        offsets = tuple(factor * offset for offset in self.offsets)
        rounding = factor * self.rounding
        return Loop(lengths, self.twists, offsets, self.name, rounding)

    def __repr__(self) -> str:
        rows = geometry_rows(self.lengths, self.twists, self.offsets)
        title = f"{self.name or 'Loop'}: {self.n} joints"
        return f"{title}\n{geometry_text(rows)}"
