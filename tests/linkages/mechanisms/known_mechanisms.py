"""Mechanisms whose facts are known (`studies.known_mechanisms`), and one with gears."""

from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from studies.known_mechanisms import cases, mechanism_of_case

__all__ = ["cases", "geared_five_bar", "mechanism_of_case"]


def geared_five_bar(ratio=-2.0, offset=0.0):
    """Two cranks with gears on a frame, and two rods between them."""
    joints = (
        Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0, 1)),
        Joint("B", "revolute", ("a", "b"), (0.3, 1.1, 0), (0, 0, 1)),
        Joint("C", "revolute", ("b", "c"), (1.4, 1.9, 0), (0, 0, 1)),
        Joint("D", "revolute", ("c", "d"), (2.6, 1.0, 0), (0, 0, 1)),
        Joint(
            "E",
            "revolute",
            ("d", "frame"),
            (2.2, 0, 0),
            (0, 0, 1),
            coupled=(Coupling("A", ratio, offset),),
        ),
    )
    return Mechanism(joints, "geared five-bar")
