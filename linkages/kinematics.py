"""Forward kinematics of a loop: transforms of joints and links, and joint screws.

The transform of joint i and the link that follows it is ``T_i = Rz(theta_i) Tz(R_i)
Tx(a_i) Rx(alpha_i)`` (Denavit and Hartenberg 1955, in the form of the sources of the
catalogue).
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np

# a float, an array of floats, an mpmath number, a sympy expression or an exact number:
# two of these libraries have no types to name
Number: TypeAlias = Any


class LinkTable(NamedTuple):
    """The geometry of n links in floats, each (n,): ``lengths`` a_{i,i+1}, ``twists``
    alpha_{i,i+1} (rad) and ``offsets`` R_i."""

    lengths: np.ndarray
    twists: np.ndarray
    offsets: np.ndarray


class Direction(NamedTuple):
    """An angle by its cosine and its sine."""

    cosine: Number
    sine: Number


def link_transform(
    turn: Direction, twist: Direction, length: Number, offset: Number
) -> tuple[tuple[Number, ...], ...]:
    """The upper three rows, of four entries each, of the transform of one joint and its
    link, over any number type."""
    c, s = turn
    ca, sa = twist
    return (
        (c, -s * ca, s * sa, length * c),
        (s, c * ca, -c * sa, length * s),
        (0, sa, ca, offset),
    )


def joint_frames(table: LinkTable, theta: np.ndarray) -> np.ndarray:
    """Homogeneous transforms (..., n + 1, 4, 4) from the base to frame i before joint i
    is turned, at joint angles (..., n), rad.

    Entry 0 is I, entry n the product of all: I when closed.
    """
    turns = Direction(np.cos(theta), np.sin(theta))
    twists = Direction(np.cos(table.twists), np.sin(table.twists))
    rows = link_transform(turns, twists, table.lengths, table.offsets)
    steps = np.zeros((*theta.shape, 4, 4))
    steps[..., 3, 3] = 1.0
    for r, row in enumerate(rows):
        for k, entries in enumerate(row):
            steps[..., r, k] = entries
    *batch, n = theta.shape
    frames = np.empty((*batch, n + 1, 4, 4))
    frames[..., 0, :, :] = np.eye(4)
    for i in range(n):
        frames[..., i + 1, :, :] = frames[..., i, :, :] @ steps[..., i, :, :]
    return frames


def joint_screws(frames: np.ndarray) -> np.ndarray:
    """Joint screws (..., 6, n) in the base frame, unit direction over moment, from the
    `joint_frames` (..., n + 1, 4, 4)."""
    joints = frames[..., :-1, :, :]
    direction = joints[..., :3, 2]
    point = joints[..., :3, 3]
    moment = np.cross(point, direction)
    screws = np.concatenate([direction, moment], axis=-1)
    return np.moveaxis(screws, -1, -2)


def link_geometry(table: LinkTable, size: float) -> np.ndarray:
    """What compiled kernels read of the links, (6, n): lengths and offsets over
    ``size``, cosines and sines of the twists, cosines and sines of half the twists."""
    twists = table.twists
    return np.array(
        [
            table.lengths / size,
            table.offsets / size,
            np.cos(twists),
            np.sin(twists),
            np.cos(twists / 2),
            np.sin(twists / 2),
        ]
    )
