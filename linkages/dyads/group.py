"""Groups of bodies that pins hold, more than a dyad: all of their assemblies, in a plane
or on a sphere.

The pins are at the places z of the plane, complex numbers, with their conjugates w as
unknowns of their own. From a place 1 a place 2 is seen at d = z2 - z1; on the unit
sphere, in stereographic projection, at d = (z2 - z1) / (1 + w1 z2), as the turn that
takes 1 to the origin takes 2 there. The product of d with the same of w is the square
of a length, or of the tangent of half an arc, and a third pin of a body is seen at r d.
The parameters (these squares, ratios r and places that stand) are functions of the
places of the pins. So the solutions of all members of a family are one irreducible
variety, and monodromy reaches all of one member (`bifurc.paths.monodromy`). From these
all isolated assemblies of given lengths follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain, combinations
from operator import itemgetter
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np

from bifurc.equations.recorded import RecordedNumber, Recorder, unknowns_of
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.follow import PathEnd
from bifurc.paths.monodromy import GenericSolutions, Projection
from linkages.decisions import is_short_bar
from linkages.dyads.canonical import canonical_order, in_order, numbers_in
from linkages.dyads.generic import RealFamily, UnfollowedError

MOST_ASSEMBLIES = 200  # complex ones of a generic member, which take 15 s

Places: TypeAlias = Sequence[complex] | np.ndarray
# z and w of a pin: numbers, recorded or not
Place: TypeAlias = tuple[Any, ...]


class Pattern(NamedTuple):
    """The pins (numbers) of every body, and how many of the pins, the first ones,
    stand; in a plane, or on a sphere."""

    bodies: tuple[tuple[int, ...], ...]
    standing: int
    is_spherical: bool = False

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


class Assemblies(NamedTuple):
    """All ``places`` (k, pins) of pins in regular assemblies, and how many of the complex
    ones are ``singular``: of lower rank, or not isolated."""

    places: np.ndarray
    singular: int


def all_assemblies(
    pattern: Pattern, own: Sequence[Places], standing: Places
) -> Assemblies:
    """Where bodies have their pins at the places ``own``, and the first pins are at the
    places ``standing``. Raises `UnfollowedError` where paths were lost."""
    numbering = _Numbering(pattern)
    own, standing = numbering.own(own), numbering.standing(standing)
    group = group_of(pattern)
    last = group.real_parameters(own, standing)
    paths = group.paths_to(last)
    if not np.all(paths.is_regular):
        _require_no_short_bar(group.pattern, own, standing)
    places = [group.places(end, last) for end in group.real_ends(paths)]
    singular = int(np.count_nonzero(paths.ends == PathEnd.SINGULAR))
    numbered = np.array(places).reshape(-1, pattern.pins)
    return Assemblies(numbered[:, numbering.pins], singular)


def generic_of(pattern: Pattern) -> GenericSolutions:
    """The solutions of a generic member. Raises `UnfollowedError`."""
    return group_of(pattern).generic


def group_of(pattern: Pattern) -> Group:
    """The equations of all patterns that differ in numbers alone."""
    return _group(_Numbering(pattern).pattern)


class _Numbering:
    """A ``pattern`` with its pins and bodies numbered as in all patterns of its type."""

    def __init__(self, pattern: Pattern):
        self._bodies = pattern.bodies
        self._order = canonical_order(pattern.bodies, pattern.standing)
        self.pins = numbers_in(self._order)  # the number of every pin
        self.pattern = pattern._replace(bodies=in_order(pattern.bodies, self._order))

    def own(self, own: Sequence[Places]) -> list[Places]:
        """Places in bodies, in the order of these."""
        numbered = [
            sorted(
                zip((self.pins[pin] for pin in pins), places, strict=True),
                key=itemgetter(0),
            )
            for pins, places in zip(self._bodies, own, strict=True)
        ]
        numbered.sort(key=lambda body: [pin for pin, _ in body])
        return [[place for _, place in body] for body in numbered]

    def standing(self, standing: Places) -> list[complex]:
        """Places of the pins that stand, in the order of these."""
        return [complex(standing[pin]) for pin in self._order[: self.pattern.standing]]


def _require_no_short_bar(
    pattern: Pattern, own: Sequence[Places], standing: Places
) -> None:
    """Raise `UnfollowedError` where paths may come back that seem to end at infinity, or
    where assemblies are so near to one another that they seem to be singular."""
    pairs = [(pins[0], pins[1]) for pins in own]
    pairs += [(a, b) for a, b in combinations(standing, 2) if a != b]
    seen = [_seen(pattern, _real(here), _real(there)) for here, there in pairs]
    squares = np.array([abs(there) ** 2 for there, _ in seen])
    if pattern.is_spherical:
        # of the sine of an arc: half a turn is as bad as none
        squares = np.append(4.0 * squares / (1.0 + squares) ** 2, 1.0)
    if is_short_bar(float(squares.min() / squares.max())):
        raise UnfollowedError("a bar is so short that paths seem to end elsewhere")


# --- equations ------------------------------------------------------------------------


class _Third(NamedTuple):
    """A pin of a body beside its first two."""

    body: int
    place: int  # among the pins of the body


@dataclass(frozen=True)
class Group(RealFamily):
    """The equations of a ``pattern``.

    Parameters are those of the equations, one each (squares of lengths, and ratios of
    third pins that were placed before, twice), then the ratios of third pins that the
    others place, twice, then the places that stand, twice.
    """

    pattern: Pattern
    most: ClassVar[int] = MOST_ASSEMBLIES

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
            along = self._seen(places, pins, 1)
            outputs.append(along[0] * along[1] - next(of_equations))
        for third in self.checked:
            pins = self.pattern.bodies[third.body]
            along = self._seen(places, pins, 1)
            for seen, base in zip(
                self._seen(places, pins, third.place), along, strict=True
            ):
                outputs.append(seen - next(of_equations) * base)
        return Family(writer.tape([one.slot for one in outputs]), n)

    def _seen(
        self, places: Mapping[int, Place], pins: Sequence[int], place: int
    ) -> Place:
        """Where a pin of a body, by its place there, is seen from the first one."""
        return _seen(self.pattern, places[pins[0]], places[pins[place]])

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
            own = ratios[2 * number : 2 * number + 2]
            both = zip(own, self._seen(places, pins, 1), strict=True)
            there = tuple(ratio * base for ratio, base in both)
            places[pin] = _beside(self.pattern, places[pins[0]], there)
        return places

    # --- members ----------------------------------------------------------------------

    @cached_property
    def projection(self) -> Projection:
        """The parameters of equations vary, and one coordinate is looked at."""
        varied = np.arange(self.family.parameters) < self.counts[0]
        coordinates = (slice(k, k + 1) for k in range(self.family.n))
        return Projection(varied, tuple(coordinates))

    def conjugates(self, points: np.ndarray) -> np.ndarray:
        """The conjugates (k, n) of solutions (k, n): z and w change places."""
        pairs = points.reshape(len(points), self.family.n // 2, 2)
        conjugates: np.ndarray = pairs[:, :, ::-1].conj().reshape(points.shape)
        return conjugates

    def generic_member(
        self, rng: np.random.Generator, attempt: int
    ) -> tuple[np.ndarray, np.ndarray]:
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
        bases = [self._own(pins, 1) for pins in own]
        lengths = [abs(base) ** 2 + 0j for base in bases]
        thirds = [*self.checked, *self.placed.values()]
        ratios = [
            self._own(own[one.body], one.place) / bases[one.body] for one in thirds
        ]
        numbers = [*ratios, *standing]
        both = np.column_stack([numbers, np.conj(numbers)]).ravel()
        return np.concatenate([lengths, both])

    def _own(self, pins: Places, place: int) -> complex:
        """Where a pin of a body is seen from the first one, from their own places."""
        start, end = complex(pins[0]), complex(pins[place])
        return complex(_seen(self.pattern, _real(start), _real(end))[0])

    def places(self, point: np.ndarray, parameters: np.ndarray) -> list[complex]:
        """The places of all pins at a real solution (n,)."""
        places = self._all_places(point, parameters)
        return [places[pin][0] for pin in range(self.pattern.pins)]


def _seen(pattern: Pattern, here: Place, there: Place) -> Place:
    """Where a place is seen from another one."""
    along = there[0] - here[0], there[1] - here[1]
    if not pattern.is_spherical:
        return along
    return along[0] / (1.0 + here[1] * there[0]), along[1] / (1.0 + here[0] * there[1])


def _beside(pattern: Pattern, here: Place, seen: Place) -> Place:
    """The place that is seen so from another one."""
    there = here[0] + seen[0], here[1] + seen[1]
    if not pattern.is_spherical:
        return there
    return there[0] / (1.0 - here[1] * seen[0]), there[1] / (1.0 - here[0] * seen[1])


def _real(place: complex) -> Place:
    """z and w of a place."""
    return complex(place), complex(place).conjugate()


@cache
def _group(pattern: Pattern) -> Group:
    """The equations of a pattern, the same ones every time."""
    return Group(pattern)
