"""The network of four Bennett linkages of Song (2013), section 5.4, and that of three
in the shape of an L, by their closed forms.

Joint 0 stands in the middle, with links c, b, d, a to the joints 2, 4, 6, 8; around run
the links 12 = a, 23 = b, 34 = c, 45 = d, 56 = b, 67 = a, 78 = d, 81 = c. The Bennett
linkages are A (0, 2, 1, 8), B (0, 4, 3, 2), C (0, 6, 5, 4), D (0, 8, 7, 6).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from linkages.loop import Loop
from linkages.source_figures.assembly import (
    Assembly,
    Bar,
    bar_between,
    fourth_joint,
    loop_assembly,
)

__all__ = ["network_assembly", "network_loop", "ring_angles"]

RING = ("1", "2", "3", "4", "5", "6", "7", "8")
RING_LINKS = ("a", "b", "c", "d", "b", "a", "d", "c")
SPOKES = (("2", "c"), ("4", "b"), ("6", "d"), ("8", "a"))
STRAIGHT = 0.0


class BasicLink(NamedTuple):
    """Length and twist (rad) of a basic link."""

    length: float
    twist: float


def network_loop(twists: Mapping[str, float], scale: float = 1.0) -> Loop:
    """The loop of the joints 1 to 8 around the network, from the twists (rad) of the
    basic links, each ``scale`` times the sine of its twist long."""
    return Loop(
        tuple(scale * float(np.sin(twists[letter])) for letter in RING_LINKS),
        tuple(twists[letter] for letter in RING_LINKS),
        (0.0,) * 8,
        "Bennett network",
    )


def _ratio(x: float, y: float) -> float:
    return float(np.sin((x + y) / 2) / np.sin((x - y) / 2))


def ring_angles(
    twists: Mapping[str, float], first: float, third: float, fifth: float
) -> np.ndarray:
    """The angles (8,), rad, of the joints 1 to 8 from those of the joints 1, 3 and 5.

    Each Bennett linkage turns by itself: K = m(alpha, gamma) and so on, and v = 2
    atan(K / tan(p/2)) is its angle at joint 0. The odd angles sum up to nothing, and
    every even one is pi less the v of the linkage before it and plus that of the next.
    """
    a, b, c, d = (twists[letter] for letter in "abcd")
    odd = np.array([first, third, fifth, -(first + third + fifth)])
    constants = np.array([_ratio(a, c), _ratio(c, b), _ratio(b, d), _ratio(d, a)])
    inner = 2 * np.arctan2(constants * np.cos(odd / 2), np.sin(odd / 2))
    out = np.empty(8)
    out[0::2] = odd
    out[1::2] = np.pi - inner + np.roll(inner, -1)
    return out


def _angle_for(constant: float, inner: float) -> float:
    """The angle at an odd joint for which its Bennett linkage has ``inner`` at
    joint 0."""
    return float(2 * np.arctan2(constant * np.cos(inner / 2), np.sin(inner / 2)))


def network_assembly(
    panel: Mapping[str, Any],
) -> tuple[Assembly, dict[str, BasicLink]]:
    """The network that a panel describes, and its basic links by their letters.

    ``twists`` are those of a, b, c, d in degrees, ``odd`` the angles at the joints 1, 3
    and 5; ``straight`` lists even joints that are to be straight, which the angles at
    the odd joints beyond them follow.
    """
    twists = {key: float(np.radians(value)) for key, value in panel["twists"].items()}
    loop = network_loop(twists)
    theta = _angles(twists, panel)
    assembly = loop_assembly(loop, theta, RING, RING_LINKS)
    assembly.axes["0"] = fourth_joint(
        assembly.axes["8"], assembly.axes["1"], assembly.axes["2"]
    )
    for joint, letter in SPOKES:
        assembly.bars.append(bar_between(assembly, "0", joint, letter))
    missing = panel.get("without", [])
    for joint in missing:
        del assembly.axes[joint]
    assembly.bars = [
        bar
        for bar in assembly.bars
        if bar.first not in missing and bar.last not in missing
    ]
    links = {
        letter: BasicLink(float(np.sin(twist)), twist)
        for letter, twist in twists.items()
    }
    return assembly, links


def _angles(twists: Mapping[str, float], panel: Mapping[str, Any]) -> np.ndarray:
    """Joint angles (8,), rad, with the even joints straight that are to be."""
    a, b, c, d = (twists[letter] for letter in "abcd")
    constants = [_ratio(a, c), _ratio(c, b), _ratio(b, d)]
    odd = [float(np.radians(angle)) for angle in panel["odd"]]
    straight = panel.get("straight", [])
    for place, joint in enumerate(("2", "4")):
        if joint in straight:
            inner = 2 * np.arctan2(
                constants[place] * np.cos(odd[place] / 2), np.sin(odd[place] / 2)
            )
            # the even angle is pi - inner + following = 0
            odd[place + 1] = _angle_for(constants[place + 1], inner - np.pi)
    return ring_angles(twists, *odd)


