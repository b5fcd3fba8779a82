"""Routes of a network over its locks: along forms with the same locks, and from locks
to locks by locking one more joint and releasing another.

The graph has a node for every place under every set of locks that holds there. Under
one set of locks its edges are the routes through the map of the network so locked, over
bifurcations where that is the way. Where one joint more stands at the angle at which it
may be locked, edges of length 0 lead from each set of locks without one of these joints
to each other one. There the network is rigid while all are locked, so that such places
are finite in number; the closed form gives all of them.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import combinations, count, pairwise
from math import degrees
from typing import NamedTuple, TypeAlias

import numpy as np

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.routes.route import Route, find_route
from linkages.decisions import is_same_network_place
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.mechanism import NetworkMechanism, lock_network
from linkages.networks.network import Network, wrap_angles
from linkages.networks.placement import PlacedNetwork
from linkages.values import require

# Joints with the D-H angles (rad) at which they are locked.
Locks: TypeAlias = frozenset[tuple[str, float]]
# The transition map of a network with locked joints.
Explore: TypeAlias = Callable[[NetworkMechanism], Atlas]


@dataclass(frozen=True)
class NetworkPlace:
    """Where a route begins or ends: ``locks``, and D-H angles (rad) of further outer
    joints ``at`` the place; none where any place with these locks will do.

    The first of these angles is exact; others only tell places with the same first one
    apart, and the place nearest to them is taken.
    """

    locks: Mapping[str, float]
    at: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Travel:
    """A stretch with the same ``locks``: the ``route`` through the ``atlas`` of the
    network so locked, and the D-H angles (n,) of the ring at its ``end``."""

    locks: Locks
    atlas: Atlas
    route: Route
    end: np.ndarray

    @property
    def length(self) -> float:
        """Arclength in the space of all joint variables, rad."""
        return self.route.length


@dataclass(frozen=True)
class Switch:
    """One joint is ``locked`` at a D-H angle (rad), then another one ``released``."""

    locked: tuple[str, float]
    released: tuple[str, float]
    length: float = 0.0


@dataclass(frozen=True, eq=False)
class LockRoute:
    """A route over locks: its ``steps``, the D-H angles (n,) of the ring at its
    ``start``, the locks before and after, and how many ``starts`` satisfy what was
    asked for, of which the route leaves from one."""

    steps: tuple[Travel | Switch, ...]
    start: np.ndarray
    before: Locks
    after: Locks
    starts: int

    @property
    def switches(self) -> int:
        """How often a joint is locked and another one released."""
        return sum(isinstance(step, Switch) for step in self.steps)

    @property
    def length(self) -> float:
        """Arclength in the space of all joint variables, rad."""
        return float(sum(step.length for step in self.steps))


def find_lock_route(
    network: Network, start: NetworkPlace, goal: NetworkPlace, explore: Explore
) -> LockRoute:
    """The route with the fewest switches, and of these the shortest one.

    Only the locks of start and goal are used, where they are enough; or else joints are
    also locked where they stand at the start. Raises `GeometryError` for locks that do
    not leave mobility 1 or places that do not exist, and `RouteError` where no route is
    found.
    """
    search = _Search(network, start, goal, explore)
    for locks in (search.given_locks(), search.further_locks()):
        route = search.run(locks)
        if route is not None:
            return route
    raise RouteError(
        f"no route leads from the locks {show_locks(search.before)} to "
        f"{show_locks(search.after)} over these locks and those where joints stand at "
        "the start"
    )


def show_locks(locks: Iterable[tuple[str, float]]) -> str:
    """Locks as text, in degrees."""
    return ", ".join(f"{joint}={degrees(angle):.6g}" for joint, angle in sorted(locks))


class _Node(NamedTuple):
    """A place, by number, under the locks that hold there."""

    place: int
    locks: Locks


class _Search:
    """What routes over locks are looked for in: places (c,) of the network, and the
    maps of its locked states, each made when it is first needed."""

    def __init__(
        self,
        network: Network,
        start: NetworkPlace,
        goal: NetworkPlace,
        explore: Explore,
    ):
        self.network = network
        self._explore = explore
        self._maps: dict[Locks, tuple[PlacedNetwork, Atlas]] = {}
        self._routes: dict[tuple[Locks, int, int], Route | None] = {}
        self._places: list[np.ndarray] = []
        self.before = frozenset(start.locks.items())
        self.after = frozenset(goal.locks.items())
        count = len(self.after)
        is_same = count == len(self.before)
        allowed = f"{len(self.before)}, as many as at the start"
        require(is_same, "number of locks at the goal", count, allowed)
        self._starts = self._places_of(start, "start")
        self._goals = self._places_of(goal, "goal")

    # --- places -----------------------------------------------------------------------

    def _places_of(self, place: NetworkPlace, what: str) -> list[int] | None:
        """The numbers of the places that are asked for; None for any with the locks."""
        states = lock_network(self.network, place.locks).placed.reference
        mobility = motion_at(self.network, list(place.locks), states).mobility
        allowed = f"such that mobility 1 is left; they leave {mobility}"
        shown = show_locks(place.locks.items())
        require(mobility == 1, f"locks at the {what}", shown, allowed)
        if not place.at:
            return None
        for joint in place.at:
            name = f"angle of joint {joint} at the {what}"
            value = show_locks([(joint, place.at[joint])])
            is_free = joint not in place.locks
            require(is_free, name, value, "left out, as the joint is locked")
            self.network.require_axis(joint, f"joint at the {what}")
        (joint, angle), *hints = place.at.items()
        numbers = self._isolated({**place.locks, joint: angle})
        angles = show_locks({**place.locks, **place.at}.items())
        allowed = "angles that the network has at one place at least, and not all along a form"
        require(len(numbers) > 0, f"{what} of the route", angles, allowed)
        # of routes as long as each other the first is taken: that nearest to the
        # reference configuration; rounded, so that it does not hang on the last bits
        ordered = sorted(numbers, key=lambda number: self._distance(number, states))
        if not hints:
            return ordered
        return [min(ordered, key=lambda number: self._misfit(number, dict(hints)))]

    def _misfit(self, place: int, hints: Mapping[str, float]) -> float:
        """How far outer joints are from where they are said to be, rad."""
        angles = self.network.ring_angles(self._places[place])
        ring = self.network.plan.ring
        gaps = [angles[ring.index(joint)] - angle for joint, angle in hints.items()]
        return round(float(np.linalg.norm(wrap_angles(np.array(gaps)))), 9)

    def _distance(self, place: int, states: np.ndarray) -> float:
        gaps = wrap_angles(self._places[place] - states)
        return round(float(np.linalg.norm(gaps)), 9)

    def _isolated(self, angles: Mapping[str, float]) -> list[int]:
        """The numbers of all places with these D-H angles, where they are isolated."""
        numbers = []
        for states in assemble(self.network, angles):
            if motion_at(self.network, list(angles), states).mobility == 0:
                numbers.append(self._number(states))
        return list(dict.fromkeys(numbers))

    def _number(self, states: np.ndarray) -> int:
        for number, place in enumerate(self._places):
            distance = float(np.abs(wrap_angles(states - place)).max())
            if is_same_network_place(distance):
                return number
        self._places.append(states)
        return len(self._places) - 1

    # --- locks ------------------------------------------------------------------------

    def given_locks(self) -> list[tuple[str, float]]:
        """The locks of start and goal."""
        return sorted(self.before | self.after)

    def further_locks(self) -> list[tuple[str, float]]:
        """These, and every outer joint where it stands at the start."""
        if self._starts is None:
            placed = lock_network(self.network, dict(self.before)).placed
            states = placed.reference
        else:
            states = self._places[self._starts[0]]
        angles = self.network.ring_angles(states).tolist()
        held = {joint for joint, _ in self.before}
        standing = zip(self.network.plan.ring, angles, strict=True)
        others = [lock for lock in standing if lock[0] not in held]
        return self.given_locks() + others

    def _switches(
        self, locks: list[tuple[str, float]]
    ) -> dict[Locks, dict[int, set[Locks]]]:
        """For every set of locks the places at which it can be exchanged, and the sets
        of locks for which."""
        size = len(self.before)
        exchanges: dict[Locks, dict[int, set[Locks]]] = {}
        for every in combinations(locks, size + 1):
            if len({joint for joint, _ in every}) <= size:
                continue
            choices = [frozenset(some) for some in combinations(every, size)]
            for place in self._isolated(dict(every)):
                for some in choices:
                    others = {other for other in choices if other != some}
                    exchanges.setdefault(some, {}).setdefault(place, set())
                    exchanges[some][place] |= others
        return exchanges

    # --- the shortest route -----------------------------------------------------------

    def run(self, locks: list[tuple[str, float]]) -> LockRoute | None:
        """The best route over these locks; None where there is none (Dijkstra)."""
        exchanges = self._switches(locks)
        starts = self._starts
        if starts is None:
            starts = list(exchanges.get(self.before, {}))
        order = count()  # nodes are not compared
        queue: list[tuple[int, float, int, _Node, _Node | None]] = [
            (0, 0.0, next(order), _Node(place, self.before), None) for place in starts
        ]
        origins: dict[_Node, _Node | None] = {}
        while queue:
            switches, length, _, node, origin = heapq.heappop(queue)
            if node in origins:
                continue
            origins[node] = origin
            is_place = self._goals is None or node.place in self._goals
            if node.locks == self.after and is_place:
                return self._route(_chain(origins, node), len(starts))
            places = exchanges.get(node.locks, {})
            for other in places.get(node.place, ()):
                there = _Node(node.place, other)
                heapq.heappush(queue, (switches + 1, length, next(order), there, node))
            goals = self._goals or [] if node.locks == self.after else []
            for target in dict.fromkeys([*places, *goals]):
                if target == node.place:
                    continue
                route = self._way(node.locks, node.place, target)
                if route is not None:
                    there = _Node(target, node.locks)
                    cost = length + route.length
                    heapq.heappush(queue, (switches, cost, next(order), there, node))
        return None

    def _way(self, locks: Locks, first: int, last: int) -> Route | None:
        """The route between two places with the same locks; None where there is
        none."""
        key = (locks, first, last)
        if key not in self._routes:
            placed, atlas = self._map(locks)
            ends = [self._unknowns(placed, atlas, place) for place in (first, last)]
            try:
                self._routes[key] = find_route(atlas, *ends)
            except RouteError:
                self._routes[key] = None
        return self._routes[key]

    def _map(self, locks: Locks) -> tuple[PlacedNetwork, Atlas]:
        if locks not in self._maps:
            mechanism = lock_network(self.network, dict(sorted(locks)))
            self._maps[locks] = mechanism.placed, self._explore(mechanism)
        return self._maps[locks]

    def _unknowns(self, placed: PlacedNetwork, atlas: Atlas, place: int) -> np.ndarray:
        """The unknowns (n,) of an atlas at a place."""
        values = placed.variables(self._places[place])
        labels = [variable.label for variable in placed.mechanism.variables]
        by_label = dict(zip(labels, values.tolist(), strict=True))
        return np.array([by_label[name] for name in atlas.names])

    def _route(self, chain: list[_Node], starts: int) -> LockRoute:
        steps: list[Travel | Switch] = []
        for first, last in pairwise(chain):
            if first.locks != last.locks:
                (locked,) = last.locks - first.locks
                (released,) = first.locks - last.locks
                steps.append(Switch(locked, released))
                continue
            route = self._way(first.locks, first.place, last.place)
            assert route is not None
            _, atlas = self._map(first.locks)
            end = self.network.ring_angles(self._places[last.place])
            steps.append(Travel(first.locks, atlas, route, end))
        start = self.network.ring_angles(self._places[chain[0].place])
        return LockRoute(tuple(steps), start, self.before, self.after, starts)


def _chain(origins: Mapping[_Node, _Node | None], node: _Node) -> list[_Node]:
    """The nodes of the way to a node, from its start."""
    chain = [node]
    while (origin := origins[chain[-1]]) is not None:
        chain.append(origin)
    return chain[::-1]
