"""The network of four Bennett linkages as an assembly: its ring of eight joints, and
the links to joint 0 in the middle."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkages.closed_forms.bennett_network import (
    RING_LINKS,
    angle_for,
    inner_angle,
    ring_angles,
    ring_loop,
)
from linkages.source_figures.assembly import (
    Assembly,
    bar_between,
    fourth_joint,
    loop_assembly,
)
from linkages.source_figures.table import Content

__all__ = ["network_assembly"]

RING = ("1", "2", "3", "4", "5", "6", "7", "8")
SPOKES = (("2", "c"), ("4", "b"), ("6", "d"), ("8", "a"))


def network_assembly(panel: Content) -> Assembly:
    """The network that a panel describes.

    ``twists`` are those of a, b, c, d in degrees, ``odd`` the angles at the joints 1, 3
    and 5; ``straight`` lists even joints that are to be straight, which the angles at
    the odd joints beyond them follow; joints of ``without`` are left out.
    """
    twists = {key: float(np.radians(value)) for key, value in panel["twists"].items()}
    theta = _angles(twists, panel)
    assembly = loop_assembly(ring_loop(twists), theta, RING, RING_LINKS)
    assembly.axes["0"] = fourth_joint(
        assembly.axes["8"], assembly.axes["1"], assembly.axes["2"]
    )
    for joint, letter in SPOKES:
        assembly.bars.append(bar_between(assembly, "0", joint, letter))
    for joint in panel.get("without", ()):
        assembly.remove(joint)
    return assembly


def _angles(twists: Mapping[str, float], panel: Content) -> np.ndarray:
    """Joint angles (8,), rad, with the even joints straight that are to be."""
    odd = [float(np.radians(angle)) for angle in panel["odd"]]
    for part, joint in enumerate(("2", "4")):
        if joint in panel.get("straight", ()):
            # the even angle is pi - inner + following = 0
            following = inner_angle(twists, part, odd[part]) - np.pi
            odd[part + 1] = angle_for(twists, part + 1, following)
    return ring_angles(twists, *odd)
