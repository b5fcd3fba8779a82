"""Networks of Bennett loops whose facts are known (data/network_locks.json)."""

import json
from functools import cache
from math import radians
from pathlib import Path

from linkages.networks.entries import NETWORKS

DATA = Path(__file__).parents[3] / "data" / "network_locks.json"


@cache
def facts():
    """All that is known of the locks of networks."""
    return json.loads(DATA.read_text(encoding="utf-8"))


def network(name="four-bennett-network", **degrees):
    """A network with twists in degrees, the others at their defaults."""
    twists = {key: radians(value) for key, value in degrees.items()}
    return NETWORKS[name].build(**twists)


def kinks_of(case):
    """The locks of a case, in rad by the name of the joint."""
    return dict(zip(case["locks"], map(radians, case["kinks_deg"]), strict=True))


def in_radians(**degrees):
    """Angles by the names of joints, written with a "p" before."""
    return {name.removeprefix("p"): radians(value) for name, value in degrees.items()}
