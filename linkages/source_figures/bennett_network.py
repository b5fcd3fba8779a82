"""The network of four Bennett linkages as an assembly: its ring of eight joints, and
the links to joint 0 in the middle."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkages.networks.network import Network, build_network, other_angle
from linkages.networks.plans import FOUR_BENNETT
from linkages.source_figures.assembly import (
    Assembly,
    bar_between,
    fourth_joint,
    loop_assembly,
)
from linkages.source_figures.table import Content

SPOKES = (("2", "c"), ("4", "b"), ("6", "d"), ("8", "a"))


def network_assembly(panel: Content) -> Assembly:
    """The network that a panel describes.

    ``twists`` are those of a, b, c, d in degrees, ``odd`` the angles at the joints 1, 3
    and 5; ``straight`` lists even joints that are to be straight, which the angles at
    the odd joints beyond them follow; joints of ``without`` are left out.
    """
    twists = {key: float(np.radians(value)) for key, value in panel["twists"].items()}
    network = _network(twists)
    theta = network.ring_angles(_states(network, panel))
    plan = network.plan
    letters = [plan.bars[plan.ring_bar(place)] for place in range(len(plan.ring))]
    assembly = loop_assembly(network.ring_loop, theta, plan.ring, letters)
    assembly.axes["0"] = fourth_joint(
        assembly.axes["8"], assembly.axes["1"], assembly.axes["2"]
    )
    for joint, letter in SPOKES:
        assembly.bars.append(bar_between(assembly, "0", joint, letter))
    for joint in panel.get("without", ()):
        assembly.remove(joint)
    return assembly


def _network(twists: Mapping[str, float]) -> Network:
    """The network with these twists (rad) of its links, each as long as their sine."""
    length = float(np.sin(twists["a"]))
    return build_network(FOUR_BENNETT, length, *(twists[name] for name in "abcd"))


def _states(network: Network, panel: Content) -> np.ndarray:
    """The angles (4,), rad, at the joints 1, 3, 5 and 7, with the even joints straight
    that are to be."""
    odd = [float(np.radians(angle)) for angle in panel["odd"]]
    for part, joint in enumerate(("2", "4")):
        if joint in panel.get("straight", ()):
            # the even angle is pi - inner + following = 0
            inner = other_angle(network.factors[part], np.array(odd[part]))
            following = other_angle(network.factors[part + 1], inner - np.pi)
            odd[part + 1] = float(following)
    return np.array([*odd, -sum(odd)])
