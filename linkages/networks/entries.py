"""What the catalogue keeps of networks of Bennett loops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from linkages.construction.numbers import Number
from linkages.entry import Condition, Parameter, UnknownParameterError, WithParameters
from linkages.entry_table import read_records
from linkages.networks.network import Network, build_network
from linkages.networks.plan import PLANS, Plan

LENGTHS = ("b", "c", "d")  # that follow from the other parameters


@dataclass(frozen=True)
class NetworkEntry(WithParameters):
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

    def build(self, **values: Number) -> Network:
        """The member with the given parameters (angles in rad), the others at their
        defaults. Raises `GeometryError` and `UnknownParameterError`."""
        defaults: dict[str, Number] = dict(self.defaults)
        for name in values:
            if name not in defaults and name not in LENGTHS:
                raise UnknownParameterError(self.name, name, (*defaults, *LENGTHS))
        return build_network(self.plan, **{**defaults, **values})


NETWORKS: Mapping[str, NetworkEntry] = {
    fields["name"]: NetworkEntry(PLANS[fields.pop("name")], **fields)
    for fields in read_records("linkages.networks", "entries", "network")
}
