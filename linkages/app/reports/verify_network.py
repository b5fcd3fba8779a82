"""Verification of networks: the closed form against the closure in space, and the
mobility."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkages.app.reports.verify import CLOSURE, NAN
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.decisions import is_dependent_constraint
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.entries import NETWORKS, NetworkEntry
from linkages.networks.mechanism import lock_network
from linkages.values import GeometryError

CONFIGURATIONS = 200  # of the closed form, at which closure in space is looked at


@dataclass(frozen=True)
class NetworkMember:
    """One member of a network: its parameters, or why the constructor ``refused`` them.

    ``closure`` is the largest residual in space over so many ``configurations`` of the
    closed form, relative to the characteristic length; ``mobility`` is the number of
    unknowns less the largest rank there, and that ``by_closed_form``.
    """

    parameters: Mapping[str, float]
    refused: str = ""
    configurations: int = 0
    closure: float = NAN
    mobility: int = 0
    by_closed_form: int = 0


@dataclass(frozen=True)
class NetworkVerification:
    """Everything checked about one network; ``expected`` is the mobility that is
    published."""

    name: str
    conditions: tuple[str, ...]
    members: tuple[NetworkMember, ...]
    expected: int

    @property
    def failures(self) -> tuple[str, ...]:
        """What does not hold, in words; empty when all is well."""
        sentences = []
        real = [member for member in self.members if not member.refused]
        for number, member in enumerate(real, start=1):
            sentences += [f"member {number}: {text}" for text in self._faults(member)]
        if not real:
            sentences.append("no member that is not refused")
        return tuple(sentences)

    def _faults(self, member: NetworkMember) -> list[str]:
        """What is wrong with one member."""
        faults = []
        if member.mobility != self.expected:
            faults.append(f"mobility {member.mobility} by rank, not {self.expected}")
        if member.by_closed_form != self.expected:
            mobility = member.by_closed_form
            faults.append(f"mobility {mobility} by closed form, not {self.expected}")
        if not member.closure <= CLOSURE:
            faults.append(f"closed form misses closure by {member.closure:.1e}")
        return faults


def verify_network(name: str, members: int = 1, seed: int = 0) -> NetworkVerification:
    """Verify the default member of the network called ``name`` and ``members`` - 1
    random ones."""
    source = NETWORKS[name]
    rng = np.random.default_rng(seed)
    parameters = [source.defaults]
    parameters += [source.draw(rng) for _ in range(members - 1)]
    return NetworkVerification(
        name=name,
        conditions=tuple(condition.text for condition in source.conditions),
        members=tuple(_check_member(source, values, rng) for values in parameters),
        expected=source.mobility,
    )


def _check_member(
    source: NetworkEntry, values: Mapping[str, float], rng: np.random.Generator
) -> NetworkMember:
    """Build a member, and look at configurations of its closed form in space."""
    try:
        network = source.build(**values)
        mechanism = lock_network(network, {})
    except GeometryError as refusal:
        return NetworkMember(values, refused=str(refusal))
    placed = mechanism.placed
    problem = MechanismClosure(mechanism)
    states = rng.permutation(assemble(network, {}))[:CONFIGURATIONS]
    states = np.concatenate([placed.reference[None], states])
    free = list(problem.structure.column_of)
    points = placed.variables(states)[:, free]
    residuals = np.linalg.norm(problem.residuals(points), axis=1)
    singular_values = np.linalg.svd(problem.jacobians(points), compute_uv=False)
    ranks = np.count_nonzero(~is_dependent_constraint(singular_values), axis=1)
    return NetworkMember(
        values,
        configurations=len(points),
        closure=float(residuals.max()),
        mobility=problem.n - int(ranks.max()),
        by_closed_form=motion_at(network, (), placed.reference).mobility,
    )
