"""Mechanisms whose facts are known: axes, or points and bars, in one closed
configuration, counts and mobility, with their sources (data/mechanisms.json)."""

import json
from functools import cache
from pathlib import Path

from linkages.mechanisms.bars import read_bars
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

DATA = Path(__file__).parents[3] / "data" / "mechanisms.json"


@cache
def cases():
    """All cases, by name."""
    content = json.loads(DATA.read_text(encoding="utf-8"))
    return {case["name"]: case for case in content["cases"]}


def mechanism_of_case(case):
    """The mechanism of a case."""
    if "bars" in case:
        return read_bars(case, case["name"])
    return Mechanism(tuple(Joint(**joint) for joint in case["joints"]), case["name"])


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
