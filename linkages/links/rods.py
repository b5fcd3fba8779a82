"""The rods that a link is drawn and built of: along its axis, along the common normal,
and along the next axis.

A joint sits in the middle of its offset. Where two axes meet in a point and neither has
an offset, their joints would be in one place: both move out along their axes, and the
link is the chord between them. viewer/rods.js draws the same.
"""

from __future__ import annotations

import numpy as np

from linkages.loop import Loop

CORNERS = 4  # of a link: seat, foot, next foot, next seat
NOTHING = 1e-9  # of the characteristic length: a length that is none
ASIDE = 0.7  # how far along its axis a joint moves out, in characteristic lengths


def seat_heights(loop: Loop) -> np.ndarray:
    """How far along its axis each joint (n,) sits from the foot of the common normal
    before it, in the unit of the loop."""
    halves = loop.arrays.offsets / 2
    size = loop.characteristic_length
    chords = _is_chord(loop)
    aside = size if np.all(chords) else ASIDE * size
    following = np.roll(chords, 1)
    heights: np.ndarray = np.where(chords | following, aside, halves)
    return _apart_on_one_line(loop, heights, chords)


def _apart_on_one_line(
    loop: Loop, heights: np.ndarray, chords: np.ndarray
) -> np.ndarray:
    """The heights where joints that turn about the same line stand beside each
    other."""
    out: np.ndarray = heights.copy()
    step = ASIDE * loop.characteristic_length / 2
    twists = loop.arrays.twists
    for i in range(loop.n - 1):
        if chords[i] and abs(np.sin(twists[i])) < NOTHING:
            out[i + 1] = out[i] * np.cos(twists[i]) + step
    return out


def _is_chord(loop: Loop) -> np.ndarray:
    """Whether each link (n,) has no length, and no offset at either end."""
    limit = NOTHING * loop.characteristic_length
    lengths, _, offsets = loop.arrays
    has_length = np.abs(lengths) >= limit
    has_offset = np.abs(offsets) >= limit
    is_chord: np.ndarray = ~(has_length | has_offset | np.roll(has_offset, -1))
    return is_chord


def link_corners(loop: Loop) -> np.ndarray:
    """Corners (n, 4, 3) of each link: seat, foot, next foot and next seat, in the frame
    that moves with the link. That of link i stands before joint i + 1; its z axis is
    the axis of that joint."""
    lengths, twists, offsets = loop.arrays
    heights = seat_heights(loop)
    corners = np.zeros((loop.n, CORNERS, 3))
    for i in range(loop.n):
        # the axis of joint i, seen from the frame behind the link
        axis = np.array([0.0, np.sin(twists[i]), np.cos(twists[i])])
        foot = np.array([-lengths[i], 0.0, 0.0])
        next_height = heights[(i + 1) % loop.n]
        corners[i, 0] = foot + (heights[i] - offsets[i]) * axis
        corners[i, 1] = foot
        corners[i, 3] = [0.0, 0.0, next_height]
        if _is_chord(loop)[i]:
            corners[i, 1] = corners[i, 0]
            corners[i, 2] = corners[i, 0]
    return corners
