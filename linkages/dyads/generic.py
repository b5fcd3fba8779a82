"""All real solutions of a member of a family, from the complex ones of a generic member.

These are found once for all mechanisms of the same equations, and kept in the cache of
the user; of common types with many of them they are part of the package. From there
paths lead to all isolated solutions of any other member.
"""

from __future__ import annotations

import hashlib
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cache, cached_property
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, ClassVar
from zipfile import BadZipFile

import numpy as np
from platformdirs import user_cache_path

from bifurc.limits import current_deadline
from bifurc.paths.family import Family
from bifurc.paths.follow import AGAIN, PathEnd, Paths, copy_of, follow_paths
from bifurc.paths.monodromy import (
    PATHS_EACH,
    Effort,
    Fibre,
    GenericSolutions,
    Projection,
    solve_generic,
)

SEED = 28  # of the generic member from which paths begin
ATTEMPTS = 4  # generic members that are tried, one after the other
SHIPPED = Path(__file__).with_name("generic_solutions.npz")
# Environment variable that names another folder for the solutions that are kept.
CACHE = "BIFURC_CACHE"
SOLVED = 1e-8  # residual of solutions that are kept, over the largest parameter


class UnfollowedError(ArithmeticError):
    """It is not known that all assemblies were found; says why."""


class RealFamily(ABC):
    """Equations of which some members are those of mechanisms: with each solution its
    conjugate is one."""

    # complex solutions that are looked for: some seconds
    most: ClassVar[int]

    @property
    def most_paths(self) -> int:
        """How many paths are followed at most to find them."""
        return ATTEMPTS * PATHS_EACH * self.most

    @property
    @abstractmethod
    def family(self) -> Family:
        """The equations."""

    @property
    @abstractmethod
    def projection(self) -> Projection:
        """What is enough to vary and to look at."""

    @abstractmethod
    def generic_member(
        self, rng: np.random.Generator, attempt: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """A random solution (n,), and the parameters (q,) of the member that it is of,
        drawn in another way at every ``attempt``."""

    @abstractmethod
    def conjugates(self, points: np.ndarray) -> np.ndarray:
        """The conjugates (k, n) of solutions (k, n)."""

    @property
    def name(self) -> str:
        """What its equations are called: the same have the same name."""
        return name_of(self.family)

    @cached_property
    def generic(self) -> GenericSolutions:
        """The solutions of one generic member: of a common type, known, or found.

        Raises `UnfollowedError` where it moves, where there are more than are looked
        for, and where the time is over.
        """
        name = self.name
        if name in _unknown:
            raise UnfollowedError(_unknown[name])
        if name not in _known:
            known = _shipped().get(name) or kept(name, self.family)
            try:
                _known[name] = known or find_generic(self, self.most)
            except UnfollowedError as error:
                if not current_deadline().passed:
                    _unknown[name] = str(error)
                raise
            if known is None:
                keep(name, _known[name])
        return _known[name]

    @property
    def is_regular(self) -> bool:
        """Whether the solutions of a generic member are isolated."""
        start, parameters = self.generic_member(np.random.default_rng(SEED), 0)
        return self.family.is_regular(start, parameters)

    def paths_to(self, last: np.ndarray, are_regular: bool = False) -> Paths:
        """The paths to all isolated solutions of the member with the parameters
        ``last`` (q,); where one is lost, from another generic member, unless some end at
        singular ones where all are to be regular (``are_regular``).

        Raises `UnfollowedError` unless every path came to a solution, or to infinity.
        """
        start = self.generic.fibre
        rng = np.random.default_rng(SEED)
        for attempt in reversed(range(ATTEMPTS)):
            paths = self.followed(start, last)
            is_over = are_regular and len(paths.singular) > 0
            if is_over or not np.any(paths.is_lost) or current_deadline().passed:
                break
            _, moved = self.generic_member(rng, attempt)
            elsewhere = self.followed(start, moved)
            if np.all(elsewhere.is_regular):
                start = Fibre(moved, elsewhere.points)
        if np.any(paths.is_lost):
            raise UnfollowedError(f"paths were lost: {', '.join(paths.reasons())}")
        return paths

    def paths_to_regular(self, last: np.ndarray) -> Paths:
        """The same. Raises `UnfollowedError` where some ends are singular, too."""
        paths = self.paths_to(last, are_regular=True)
        if np.any(paths.ends == PathEnd.SINGULAR):
            raise UnfollowedError("some configurations are singular or move")
        return paths

    def followed(self, start: Fibre, last: np.ndarray, again: int = AGAIN) -> Paths:
        """The paths from the solutions of one member, or of one each, to the one with
        the parameters ``last``, (q,) or (k, q); so often ``again`` where they are
        lost."""
        return follow_paths(
            self.family,
            start.solutions,
            start.parameters,
            last,
            current_deadline(),
            again=again,
        )

    def are_real(self, ends: np.ndarray) -> np.ndarray:
        """Which of all ends (k, n) of real members are real (k,): each is its own
        conjugate.

        Raises `UnfollowedError` unless the conjugate of each end is one of them.
        """
        count = len(ends)
        partners = copy_of(np.concatenate([ends, self.conjugates(ends)]))[count:]
        if np.any(partners >= count):
            raise UnfollowedError("a configuration has no conjugate one")
        are_real: np.ndarray = partners == np.arange(count)
        return are_real

    def real_ends(self, paths: Paths) -> np.ndarray:
        """The ends (k, n) that are real. Raises `UnfollowedError`, as `are_real`."""
        ends = paths.regular
        real: np.ndarray = ends[self.are_real(ends)]
        return real


_known: dict[str, GenericSolutions] = {}
_unknown: dict[str, str] = {}  # why


def find_generic(one: RealFamily, most: int) -> GenericSolutions:
    """The solutions of a generic member, at ``most`` so many, by monodromy: all of them,
    as the trace test says.

    Raises `UnfollowedError`.
    """
    deadline = current_deadline()
    if not one.is_regular:
        raise UnfollowedError("it moves, or more holds it than has to")
    effort = Effort(deadline, one.most_paths)
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng(SEED + attempt)
        start, parameters = one.generic_member(rng, attempt)
        generic = solve_generic(
            one.family,
            start,
            parameters,
            rng,
            effort,
            most,
            projection=one.projection,
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


# --- files of solutions ---------------------------------------------------------------


@cache
def _shipped() -> dict[str, GenericSolutions]:
    """The solutions of generic members of common types, by the names of their
    equations."""
    return read_generic(SHIPPED) if SHIPPED.exists() else {}


def kept(name: str, family: Family) -> GenericSolutions | None:
    """The solutions of equations that were kept; None where there are none, or they are
    none."""
    try:
        generic = read_generic(_place_of(name))[name]
    except (OSError, EOFError, ValueError, KeyError, BadZipFile):
        return None
    solutions, parameters = generic.fibre.solutions, generic.fibre.parameters
    if solutions.shape[1:] != (family.n,) or parameters.shape != (family.parameters,):
        return None
    misses = np.abs(family.residuals(solutions, parameters)).max()
    return generic if misses < SOLVED * np.abs(parameters).max() else None


def keep(name: str, generic: GenericSolutions) -> None:
    """Keep the solutions of equations for other processes, where that can be."""
    place = _place_of(name)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        # another process finds the whole file, or none
        with NamedTemporaryFile(dir=place.parent, suffix=".npz", delete=False) as file:
            write_generic(Path(file.name), {name: generic})
        Path(file.name).replace(place)
    except OSError:
        return


def _place_of(name: str) -> Path:
    return Path(os.environ.get(CACHE) or user_cache_path("bifurc")) / f"{name}.npz"


def read_generic(path: Path) -> dict[str, GenericSolutions]:
    """The solutions of a file, by the names of their equations."""
    with np.load(path) as arrays:
        names = sorted({key.split("/")[0] for key in arrays})
        return {
            name: GenericSolutions(
                Fibre(arrays[f"{name}/parameters"], arrays[f"{name}/solutions"]),
                float(arrays[f"{name}/trace"]),
            )
            for name in names
        }


def write_generic(path: Path, known: Mapping[str, GenericSolutions]) -> None:
    """Write a file of solutions, by the names of their equations."""
    arrays: dict[str, Any] = {}
    for name, one in known.items():
        arrays[f"{name}/parameters"] = one.fibre.parameters
        arrays[f"{name}/solutions"] = one.fibre.solutions
        arrays[f"{name}/trace"] = np.array(one.trace)
    np.savez_compressed(path, **arrays)
