"""Frameworks: bars that spherical joints hold at their ends."""

from itertools import combinations

import numpy as np

from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

OCTAHEDRON = [
    a + b for a, b in combinations("ABCDEF", 2) if a + b not in ("AD", "BE", "CF")
]


def framework(places, bars):
    """Bars that spherical joints hold at their ends."""
    joints = []
    for name, place in places.items():
        bodies = tuple(bar for bar in bars if name in bar)
        joints.append(Joint(name, "spherical", bodies, tuple(place)))
    return Mechanism(tuple(joints))


def places_of(names, seed):
    rng = np.random.default_rng(seed)
    return {name: rng.normal(size=3) for name in names}


def flexible_octahedron(seed=5):
    """Bricard 1897, first kind: opposite corners are images in a half turn."""
    places = places_of("ABC", seed)
    for name, opposite in ("AD", "BE", "CF"):
        places[opposite] = places[name] * [-1.0, -1.0, 1.0]
    return framework(places, OCTAHEDRON)
