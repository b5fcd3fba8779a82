"""Groups of bodies in a plane that pins hold, more than a dyad: all of their assemblies.

The pins are at the places z of the plane, complex numbers; with their conjugates w as
unknowns of their own the equations are polynomials: (z2 - z1) (w2 - w1) is the square
of a length, and a third pin of a body is at z1 + r (z2 - z1). The parameters (squares
of lengths, ratios r and places that stand) are functions of the places of the pins. So
the solutions of all members of a family are one irreducible variety, and monodromy
reaches all of one member (`bifurc.paths.monodromy`). From these all isolated assemblies
of given lengths follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from bifurc.equations.recorded import RecordedNumber, Recorder, unknowns_of
from bifurc.limits import current_deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import PathEnd, Paths, copy_of, follow_paths
from bifurc.paths.monodromy import GenericSolutions, solve_generic
from linkages.decisions import is_short_bar

SEED = 24  # of the generic member from which paths begin
MOST_ASSEMBLIES = 200  # complex ones of a generic member, which take 15 s

Places: TypeAlias = Sequence[complex] | np.ndarray
# z and w of a pin: numbers, recorded or not
Place: TypeAlias = tuple[Any, ...]


class UnfollowedError(ArithmeticError):
    """It is not known that all assemblies of a group were found; says why."""


class Pattern(NamedTuple):
    """The pins (numbers) of every body, and how many of the pins, the first ones,
    stand."""

    bodies: tuple[tuple[int, ...], ...]
    standing: int

    @property
    def pins(self) -> int:
        """The number of pins."""
        return 1 + max(chain.from_iterable(self.bodies), default=-1)

    @property
    def is_square(self) -> bool:
        """Whether there are as many equations as unknowns, and every body is held."""
        unknowns = 2 * (self.pins - self.standing)
        equations = sum(2 * len(pins) - 3 for pins in self.bodies)
        return unknowns == equations and all(len(pins) > 1 for pins in self.bodies)


def all_assemblies(
    pattern: Pattern, own: Sequence[Places], standing: Places
) -> np.ndarray:
    """All places (k, pins) of the pins where bodies have their pins at the places
    ``own``, and the first pins are at the places ``standing``.

    Raises `UnfollowedError` where some are not isolated or paths were lost.
    """
    group = _group(pattern)
    generic = generic_solutions(pattern)
    if not generic.are_all:
        raise UnfollowedError("complex assemblies may be missing")
    last = group.real_parameters(own, standing)
    fibre, deadline = generic.fibre, current_deadline()
    paths = follow_paths(
        group.family, fibre.solutions, fibre.parameters, last, deadline
    )
    if np.any(paths.ends == PathEnd.AT_INFINITY):
        _require_no_short_bar(own)
    places = [group.places(end, last) for end in _real_ends(paths)]
    return np.array(places).reshape(-1, pattern.pins)


def _require_no_short_bar(own: Sequence[Places]) -> None:
    """Raise `UnfollowedError` where paths may come back that seem to end at infinity."""
    squares = np.array([abs(pins[1] - pins[0]) ** 2 for pins in own])
    if is_short_bar(float(squares.min() / squares.max())):
        raise UnfollowedError("a bar is so short that paths seem to end at infinity")


def _real_ends(paths: Paths) -> np.ndarray:
    """The ends (k, n) that are real: each is its own conjugate.

    Raises `UnfollowedError` unless every path came to an end, isolated or at infinity,
    and the conjugate of each end is one of them.
    """
    if np.any(paths.is_lost):
        raise UnfollowedError(f"paths were lost: {', '.join(paths.reasons())}")
    if np.any(paths.ends == PathEnd.SINGULAR):
        raise UnfollowedError("some assemblies are singular or move")
    ends = paths.regular
    count = len(ends)
    # z and w change places
    pairs = ends.reshape(count, ends.shape[1] // 2, 2)
    conjugates = pairs[:, :, ::-1].conj().reshape(ends.shape)
    partners = copy_of(np.concatenate([ends, conjugates]))[count:]
    if np.any(partners >= count):
        raise UnfollowedError("an assembly has no conjugate one")
    real: np.ndarray = ends[partners == np.arange(count)]
    return real


# --- equations ------------------------------------------------------------------------


class _Third(NamedTuple):
    """A pin of a body beside its first two."""

    body: int
    place: int  # among the pins of the body


@dataclass(frozen=True)
class _Group:
    """The equations of a ``pattern``.

    Parameters are those of the equations, one each (squares of lengths, and ratios of
    third pins that were placed before, twice), then the ratios of third pins that the
    others place, twice, then the places that stand, twice.
    """

    pattern: Pattern

    @cached_property
    def placed(self) -> dict[int, _Third]:
        """The pins that others of a body place."""
        placed: dict[int, _Third] = {}
        known = set(range(self.pattern.standing))
        for number, pins in enumerate(self.pattern.bodies):
            for place, pin in enumerate(pins):
                if place > 1 and pin not in known:
                    placed[pin] = _Third(number, place)
                known.add(pin)
        return placed

    @cached_property
    def free(self) -> list[int]:
        """The pins whose places are the unknowns."""
        pins = range(self.pattern.standing, self.pattern.pins)
        return [pin for pin in pins if pin not in self.placed]

    @cached_property
    def checked(self) -> list[_Third]:
        """The third pins that are placed elsewhere, too."""
        thirds = [
            _Third(number, place)
            for number, pins in enumerate(self.pattern.bodies)
            for place in range(2, len(pins))
        ]
        return [one for one in thirds if self.placed.get(self._pin(one)) != one]

    def _pin(self, third: _Third) -> int:
        return self.pattern.bodies[third.body][third.place]

    @cached_property
    def counts(self) -> tuple[int, int, int]:
        """The number of parameters of equations, of placed pins and of standing
        ones."""
        equations = len(self.pattern.bodies) + 2 * len(self.checked)
        return equations, 2 * len(self.placed), 2 * self.pattern.standing

    @cached_property
    def family(self) -> Family:
        """The equations, in the unknowns z and w of the free pins."""
        n = 2 * len(self.free)
        writer = Recorder(n + sum(self.counts))
        numbers = unknowns_of(writer)
        places = self._all_places(numbers[:n], numbers[n:])
        of_equations = iter(numbers[n:])
        outputs: list[RecordedNumber] = []
        for pins in self.pattern.bodies:
            along = [end - start for start, end in _between(places, pins)]
            outputs.append(along[0] * along[1] - next(of_equations))
        for third in self.checked:
            pins = self.pattern.bodies[third.body]
            ends = zip(places[self._pin(third)], _between(places, pins), strict=True)
            for place, (start, end) in ends:
                outputs.append(place - start - next(of_equations) * (end - start))
        return Family(writer.tape([one.slot for one in outputs]), n)

    def _all_places(self, unknowns: Any, parameters: Any) -> dict[int, Place]:
        """(z, w) of every pin."""
        equations, of_placed, _ = self.counts
        ratios = parameters[equations : equations + of_placed]
        stand = parameters[equations + of_placed :]
        places = {
            pin: (stand[2 * pin], stand[2 * pin + 1])
            for pin in range(self.pattern.standing)
        }
        for number, pin in enumerate(self.free):
            places[pin] = unknowns[2 * number], unknowns[2 * number + 1]
        for number, (pin, third) in enumerate(self.placed.items()):
            pins = self.pattern.bodies[third.body]
            both = zip(
                ratios[2 * number : 2 * number + 2], _between(places, pins), strict=True
            )
            places[pin] = tuple(
                start + ratio * (end - start) for ratio, (start, end) in both
            )
        return places

    # --- members ----------------------------------------------------------------------

    def generic_member(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """A random solution (n,), and the parameters (q,) of the member that it is
        of."""
        family = self.family
        start = complex_normal(rng, family.n)
        without = complex_normal(rng, family.parameters)
        equations = self.counts[0]
        without[:equations] = 0.0
        at_one = without.copy()
        at_one[:equations] = 1.0
        # every equation is linear in a parameter of its own
        values = family.residuals(start[None], without)[0]
        rates = values - family.residuals(start[None], at_one)[0]
        without[:equations] = values / rates
        return start, without

    def real_parameters(self, own: Sequence[Places], standing: Places) -> np.ndarray:
        """The parameters (q,) of bodies with their pins at the places ``own``."""
        lengths = [abs(pins[1] - pins[0]) ** 2 + 0j for pins in own]
        thirds = [*self.checked, *self.placed.values()]
        numbers = [_ratio(own[one.body], one.place) for one in thirds] + [*standing]
        both = np.column_stack([numbers, np.conj(numbers)]).ravel()
        return np.concatenate([lengths, both])

    def places(self, point: np.ndarray, parameters: np.ndarray) -> list[complex]:
        """The places of all pins at a real solution (n,)."""
        places = self._all_places(point, parameters)
        return [places[pin][0] for pin in range(self.pattern.pins)]


def _between(places: Mapping[int, Place], pins: Sequence[int]) -> list[Place]:
    """(start, end) of z and of w, of the first two pins of a body."""
    return list(zip(places[pins[0]], places[pins[1]], strict=True))


def _ratio(own: Places, place: int) -> complex:
    return complex((own[place] - own[0]) / (own[1] - own[0]))


@cache
def _group(pattern: Pattern) -> _Group:
    return _Group(pattern)


@cache
def generic_solutions(pattern: Pattern) -> GenericSolutions:
    """Those of one generic member, found once a process. Raises `UnfollowedError` where
    it moves, and where the time is over."""
    group, deadline = _group(pattern), current_deadline()
    rng = np.random.default_rng(SEED)
    start, parameters = group.generic_member(rng)
    if not group.family.is_regular(start, parameters):
        raise UnfollowedError("it moves, or has more bars than hold it")
    generic = solve_generic(
        group.family, start, parameters, rng, deadline, MOST_ASSEMBLIES
    )
    if deadline.passed:
        raise UnfollowedError("out of time")
    return generic
