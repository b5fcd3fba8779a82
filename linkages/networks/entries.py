"""What the catalogue keeps of networks of Bennett loops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians, sin

import numpy as np

from linkages.construction.numbers import Number
from linkages.entry import Condition, Parameter, UnknownParameterError
from linkages.networks.network import Network, build_network
from linkages.networks.plan import Plan
from linkages.networks.plans import FOUR_BENNETT, L_SHAPE, SERIAL

LENGTHS = ("b", "c", "d")  # that follow from the other parameters


@dataclass(frozen=True)
class NetworkEntry:
    """One network: its ``plan``, its free ``parameters``, conditions in words, further
    ``remarks``, misprints of the source, and the ``mobility`` that is published.

    The lengths b, c, d follow from the Bennett ratio; they may be given as well, and
    are checked then.
    """

    plan: Plan
    source: str
    parameters: tuple[Parameter, ...]
    conditions: tuple[Condition, ...]
    remarks: tuple[str, ...] = ()
    errata: tuple[str, ...] = ()
    mobility: int = 3

    @property
    def name(self) -> str:
        """What the network is called."""
        return self.plan.name

    @property
    def title(self) -> str:
        """What the network is, in a few words."""
        return self.plan.title

    @property
    def defaults(self) -> dict[str, float]:
        """Default value of every parameter."""
        return {p.name: p.default for p in self.parameters}

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Random parameters within their ranges."""
        return {p.name: float(rng.uniform(p.low, p.high)) for p in self.parameters}

    def build(self, **values: Number) -> Network:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises `GeometryError` and `UnknownParameterError`."""
        defaults: dict[str, Number] = dict(self.defaults)
        for name in values:
            if name not in defaults and name not in LENGTHS:
                raise UnknownParameterError(self.name, name, (*defaults, *LENGTHS))
        return build_network(self.plan, **{**defaults, **values})


PARAMETERS = (
    Parameter.length("a", 1.7 * sin(radians(35)), "length of link a", 0.3, 3.0),
    Parameter.angle("alpha", 35, "twist of link a", 15, 110),
    Parameter.angle("beta", 62, "twist of link b", 15, 110),
    Parameter.angle("gamma", 81, "twist of link c", 15, 110),
    Parameter.angle("delta", 48, "twist of link d", 15, 110),
)
EQUAL_RATIOS = Condition("sin(twist)/length is the same for the links a, b, c, d")
SOURCE = "Goldberg (1943); Baker (1983); Song (2013), section 5.4"

FOUR_JOINTS = (
    "joints 2, 4, 6, 8 all straight (0) or all folded (180): a Bennett linkage if "
    "tan(alpha/2) tan(beta/2) = tan(gamma/2) tan(delta/2), or else rigid"
)
# of table 5.4.1 and of the text beside it
TABLE_MISPRINTS = (
    'table 5.4.1 prints "1/3, 4/5, 5/7, 7/1"; it must be 1/3, 3/5, 5/7, 7/1',
    "table 5.4.1 ends the list of pairs n/n+3 at 5/8; 6/1, 7/2 and 8/3 belong to it",
    "three locks are said to leave nothing that moves; the triples 1/2/3, 3/4/5, 5/6/7 "
    "and 7/8/1 leave mobility 1",
)
TWO_LOCKS = "two locks leave a Bennett linkage for 14 of the 28 pairs, at any geometry"
THREE_MISPRINTS = (
    "the text on figure 5.4.14 exchanges (a) and (b); the caption is right",
)

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
        remarks=(FOUR_JOINTS,),
        errata=TABLE_MISPRINTS,
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
        remarks=(TWO_LOCKS,),
        errata=THREE_MISPRINTS,
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
        remarks=(TWO_LOCKS,),
        errata=THREE_MISPRINTS,
    ),
)
NETWORKS: Mapping[str, NetworkEntry] = {entry.name: entry for entry in _ENTRIES}
