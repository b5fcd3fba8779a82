"""All configurations of a mechanism while some unknowns have given values.

The complex solutions of a generic member are found once a process for all mechanisms of
the same equations; of common types with many of them they are at hand. From there paths
lead to a member with the geometry of the mechanism, generic in what is held, and from
that to every other value of it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from bifurc.limits import current_deadline
from bifurc.paths.family import Family
from bifurc.paths.follow import PathEnd, Paths, copy_of, follow_paths
from bifurc.paths.monodromy import (
    Fibre,
    GenericSolutions,
    Projection,
    solve_generic,
)
from linkages.decisions import is_short_bar
from linkages.dyads.group import UnfollowedError
from linkages.modules.equations import ClosureFamily
from linkages.modules.skeleton import Skeleton
from linkages.structure.structure import Structure

SEED = 28  # of the generic member from which paths begin
# Complex ones of a generic member that are looked for: some seconds. Types with more of
# them are at hand, or are not followed.
MOST_SOLUTIONS = 24
# Imaginary parts of the numbers of generic members that are tried, one after the other.
# Along a chain of displacements products of numbers that are far from real become large;
# from numbers that are nearly real paths pass near singular members.
IMAGINARY = (0.5, 0.4, 0.6, 0.3)
ROUNDING = 1e-12  # of a length: it is none
SHIPPED = Path(__file__).with_name("generic_solutions.npz")


class Module:
    """The mechanism of a ``full`` structure while the unknowns ``held``, by number, have
    given values.

    Raises `UnfollowedError` where it is not known that all configurations are found.
    """

    def __init__(self, full: Structure, held: tuple[int, ...] = ()):
        self.skeleton = Skeleton.of(full, held)
        self.held: dict[int, int] = {}  # by their numbers in the full structure
        for column in held:
            own = self.skeleton.held(column)
            if own is None:
                raise UnfollowedError("what is held is in no chain")
            self.held[column] = own
        try:
            structure = self.skeleton.structure
            self.family = ClosureFamily(structure, tuple(self.held.values()))
        except ValueError as error:
            raise UnfollowedError(str(error)) from error

    @cached_property
    def generic(self) -> GenericSolutions:
        """The solutions of a generic member of the family."""
        return generic_solutions(self.family)

    @property
    def count(self) -> int:
        """How many complex configurations there are for generic lengths: what a plane
        through two points of it mirrors is counted once."""
        return self.generic.count >> self._mirrored

    @property
    def _mirrored(self) -> int:
        """How many points stay in a plane, on one side of a line in it."""
        points = self.skeleton.structure.free_points
        return sum(
            len(one.directions) == 2 and bool(-one.limits[1, 0] != one.limits[1, 1])
            for one in points
        )

    @cached_property
    def _start(self) -> Fibre:
        """The solutions with the geometry of the mechanism, at generic values of what
        is held."""
        fibre = self.generic.fibre
        rng = np.random.default_rng(SEED)
        last = self.family.member(dict.fromkeys(self.held.values(), 0.0))
        drawn = self.family.generic_parameters(rng, 1.0)
        for column in self.held.values():
            block = self.family.parameters.blocks["held", column]
            last[block] = drawn[block]
        if not self.held:
            return fibre
        paths = self._followed(fibre, last)
        return Fibre(last, paths.regular)

    def configurations(self, values: Mapping[int, float]) -> np.ndarray:
        """All real configurations (k, n), in the unknowns of the full structure, where
        the held ones have these ``values``, angles between -pi and pi."""
        own = {self.held[column]: value for column, value in values.items()}
        paths = self._followed(self._start, self.family.member(own))
        points = self.family.points(self._real_ends(paths))
        for column, value in own.items():
            points[:, column] = value
        full = [self.skeleton.unknowns(point) for point in points]
        rows = np.array(full).reshape(-1, len(self.skeleton.full.unknowns))
        for column, value in values.items():
            rows[:, column] = value
        return rows

    def _real_ends(self, paths: Paths) -> np.ndarray:
        """The ends (k, n) that are real: each is its own conjugate.

        Raises `UnfollowedError` unless the conjugate of each end is one of them.
        """
        ends = paths.regular
        count = len(ends)
        conjugates = self.family.conjugates(ends)
        partners = copy_of(np.concatenate([ends, conjugates]))[count:]
        if np.any(partners >= count):
            raise UnfollowedError("a configuration has no conjugate one")
        real: np.ndarray = ends[partners == np.arange(count)]
        return real

    def _followed(self, start: Fibre, last: np.ndarray) -> Paths:
        """The paths to a member; where one is lost, from another generic one."""
        family, deadline = self.family.family, current_deadline()
        rng = np.random.default_rng(SEED)
        for imaginary in reversed(IMAGINARY):
            paths = follow_paths(
                family, start.solutions, start.parameters, last, deadline
            )
            if not np.any(paths.is_lost) or deadline.passed:
                break
            start = self._elsewhere(start, rng, imaginary)
        if np.any(paths.is_lost):
            raise UnfollowedError(f"paths were lost: {', '.join(paths.reasons())}")
        if np.any(paths.ends == PathEnd.SINGULAR):
            raise UnfollowedError("some configurations are singular or move")
        if np.any(paths.ends == PathEnd.AT_INFINITY):
            _require_no_short_length(self.skeleton.structure)
        return paths

    def _elsewhere(
        self, start: Fibre, rng: np.random.Generator, imaginary: float
    ) -> Fibre:
        """The solutions of another member that differs where the given one is generic:
        in all parameters, or else in what is held."""
        drawn = self.family.generic_parameters(rng, imaginary)
        is_first = start.parameters is self.generic.fibre.parameters
        if not self.held or is_first:
            moved = drawn
        else:
            moved = start.parameters.copy()
            for column in self.held.values():
                block = self.family.parameters.blocks["held", column]
                moved[block] = drawn[block]
        family, deadline = self.family.family, current_deadline()
        paths = follow_paths(family, start.solutions, start.parameters, moved, deadline)
        if not np.all(paths.is_regular):
            return start
        return Fibre(moved, paths.points)


def _require_no_short_length(structure: Structure) -> None:
    """Raise `UnfollowedError` where paths may come back that seem to end at infinity."""
    points = [
        variable.motion.point / structure.unit
        for variable in structure.mechanism.variables
        if variable.motion.is_turn
    ]
    places = [
        place / structure.unit
        for closure in structure.closures
        for place in (closure.first, closure.second)
    ]
    rows = np.array(points + places)
    gaps = np.linalg.norm(rows[:, None] - rows[None], axis=2)
    gaps = gaps[gaps > ROUNDING]
    if len(gaps) and is_short_bar(float((gaps.min() / gaps.max()) ** 2)):
        raise UnfollowedError("a length is so short that paths seem to end at infinity")


# --- generic solutions ----------------------------------------------------------------

_known: dict[str, GenericSolutions] = {}


def generic_solutions(family: ClosureFamily) -> GenericSolutions:
    """Those of one generic member: of a common type, known, or found.

    Raises `UnfollowedError` where it moves, where there are more than `MOST_SOLUTIONS`,
    and where the time is over.
    """
    name = name_of(family.family)
    if name not in _known:
        shipped = _shipped().get(name)
        _known[name] = shipped or find_generic(family, MOST_SOLUTIONS)
    return _known[name]


def find_generic(family: ClosureFamily, most: int) -> GenericSolutions:
    """The solutions of a generic member, at ``most`` so many, by monodromy: all of them,
    as the trace test says.

    Raises `UnfollowedError`.
    """
    deadline = current_deadline()
    projection = Projection(family.are_targets, tuple(family.columns.values()))
    for attempt, imaginary in enumerate(IMAGINARY):
        rng = np.random.default_rng(SEED + attempt)
        start, parameters = family.generic_member(rng, imaginary)
        if not family.family.is_regular(start, parameters):
            raise UnfollowedError("it moves, or more holds it than has to")
        generic = solve_generic(
            family.family,
            start,
            parameters,
            rng,
            deadline,
            most,
            projection=projection,
        )
        if deadline.passed:
            raise UnfollowedError("out of time")
        if generic.count > most:
            raise UnfollowedError("there are too many complex configurations")
        if generic.are_all:
            return generic
    raise UnfollowedError("complex configurations may be missing")


def name_of(family: Family) -> str:
    """What equations are called: the same have the same name."""
    nodes, outputs = family.tape.nodes()
    return hashlib.sha256(repr((nodes, outputs, family.n)).encode()).hexdigest()[:32]


@cache
def _shipped() -> dict[str, GenericSolutions]:
    """The solutions of generic members of common types, by the names of their
    equations."""
    if not SHIPPED.exists():
        return {}
    with np.load(SHIPPED) as arrays:
        names = sorted({key.split()[0] for key in arrays})
        return {
            name: GenericSolutions(
                Fibre(arrays[f"{name} parameters"], arrays[f"{name} solutions"]),
                float(arrays[f"{name} trace"]),
            )
            for name in names
        }
