"""What the catalogue keeps of networks of Bennett loops."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass

from linkages.construction.basic_links import (
    EQUAL_RATIOS,
    length_a,
    twists_of_links,
)
from linkages.construction.numbers import Number
from linkages.entry import Condition, Parameter, UnknownParameterError
from linkages.networks.network import Network, build_network
from linkages.networks.plan import Plan
from linkages.networks.plans import FOUR_BENNETT, L_SHAPE, SERIAL

__all__ = ["NETWORKS", "NetworkEntry", "nearest_network"]

LENGTHS = ("b", "c", "d")


@dataclass(frozen=True)
class NetworkEntry:
    """One network: its ``plan``, its free ``parameters``, and conditions in words.

    The lengths b, c, d follow from the Bennett ratio; they may be given as well, and
    are checked then.
    """

    plan: Plan
    source: str
    parameters: tuple[Parameter, ...]
    conditions: tuple[Condition, ...]

    @property
    def name(self) -> str:
        """What the network is called."""
        return self.plan.name

    @property
    def title(self) -> str:
        """What the network is, in a few words."""
        return self.plan.title

    def build(self, **values: Number) -> Network:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises `GeometryError` and `UnknownParameterError`."""
        defaults: dict[str, Number] = {p.name: p.default for p in self.parameters}
        for name in values:
            if name not in defaults and name not in LENGTHS:
                raise UnknownParameterError(self.name, name, (*defaults, *LENGTHS))
        return build_network(self.plan, **{**defaults, **values})


def nearest_network(name: str) -> tuple[str, ...]:
    """The names of networks that are like ``name``."""
    return tuple(difflib.get_close_matches(name, NETWORKS, n=2))


PARAMETERS = (length_a(35), *twists_of_links(a=35, b=62, c=81, d=48))
SOURCE = "Goldberg (1943); Baker (1983); Song (2013), section 5.4"

_ENTRIES = (
    NetworkEntry(
        FOUR_BENNETT,
        SOURCE,
        PARAMETERS,
        (
            EQUAL_RATIOS,
            Condition("bars 12 = 67 = 08 = a, 23 = 56 = 04 = b, 34 = 81 = 02 = c"),
            Condition("bars 45 = 78 = 06 = d; no offsets"),
        ),
    ),
    NetworkEntry(
        L_SHAPE,
        SOURCE,
        PARAMETERS,
        (
            EQUAL_RATIOS,
            Condition("bars 12 = 08 = a, 23 = 56 = 04 = b, 34 = 81 = 02 = c"),
            Condition("bars 45 = 60 = d; no offsets"),
        ),
    ),
    NetworkEntry(
        SERIAL,
        SOURCE,
        PARAMETERS,
        (
            EQUAL_RATIOS,
            Condition("rails U0U1 = V1V0 = a, U1U2 = V2V1 = b, U2U3 = V3V2 = c"),
            Condition("rungs V0U0 = U1V1 = U2V2 = U3V3 = d; no offsets"),
        ),
    ),
)
NETWORKS: Mapping[str, NetworkEntry] = {entry.name: entry for entry in _ENTRIES}
