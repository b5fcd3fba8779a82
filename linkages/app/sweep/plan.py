"""What a sweep runs through: the members of a family, a network, a mechanism or of
equations, on a grid of parameters and locks or drawn at random."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from linkages.app.choice import read_number, split_parameter
from linkages.app.exit_codes import CommandError
from linkages.app.sweep.subjects import (
    LOCK,
    PARAM,
    MemberSource,
    Quantity,
    choose_subject,
)
from linkages.values import GeometryError, check_angle

MOST_VALUES = 1_000_000  # of one quantity on a grid


@dataclass(frozen=True)
class Block:
    """Members that are stored together: where in the grid, and their indices (in
    row-major order of the grid)."""

    number: int
    region: tuple[slice, ...]
    indices: NDArray[np.intp]


@dataclass(frozen=True)
class Plan:
    """The members of a sweep of a ``subject``, numbered in row-major order of the grid.

    ``axes`` are the values of the quantities that vary, by name (rad for angles),
    ``fixed`` those of one value. With ``random`` > 0 there is no grid: that many members are drawn,
    each from its own random stream, within ``ranges``. ``starts`` and ``seed`` are
    those of `bifurc.search.explore.explore`.
    """

    subject: MemberSource
    axes: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    random: int = 0
    starts: int = 200
    seed: int = 0
    block: int = 512  # members written to the dataset together

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions: the quantities that vary, or "member"."""
        return ("member",) if self.random else tuple(self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of members along each dimension."""
        if self.random:
            return (self.random,)
        return tuple(len(values) for values in self.axes.values())

    @property
    def size(self) -> int:
        """Number of members."""
        return math.prod(self.shape)

    @cached_property
    def chunk(self) -> tuple[int, ...]:
        """Shape of a block: as many of the last dimensions as fit into it."""
        room = self.block
        chunk: list[int] = []
        for length in reversed(self.shape):
            along = max(1, min(length, room))
            chunk.append(along)
            room //= along
        return tuple(reversed(chunk))

    def blocks(self) -> Iterator[Block]:
        """All blocks, in order."""
        corners = [
            range(0, length, step)
            for length, step in zip(self.shape, self.chunk, strict=True)
        ]
        for number, corner in enumerate(product(*corners)):
            region = self._region(corner)
            axes = [np.arange(along.start, along.stop) for along in region]
            grid = np.meshgrid(*axes, indexing="ij")
            indices = np.ravel_multi_index(tuple(grid), self.shape).ravel()
            yield Block(number, region, indices)

    def _region(self, corner: Sequence[int]) -> tuple[slice, ...]:
        """The part of the grid that the block with this first corner covers."""
        bounds = zip(corner, self.chunk, self.shape, strict=True)
        return tuple(
            slice(start, min(start + step, length)) for start, step, length in bounds
        )

    @property
    def block_count(self) -> int:
        """Number of blocks."""
        return math.prod(self._blocks_along)

    @property
    def _blocks_along(self) -> tuple[int, ...]:
        pairs = zip(self.shape, self.chunk, strict=True)
        return tuple(math.ceil(length / step) for length, step in pairs)

    def block_of(self, index: int) -> int:
        """Number of the block that holds a member."""
        place = np.unravel_index(index, self.shape)
        pairs = zip(place, self.chunk, strict=True)
        corner = [int(along) // step for along, step in pairs]
        return int(np.ravel_multi_index(corner, self._blocks_along))

    def values(self, index: int) -> dict[str, float]:
        """The values of one member by the names of the quantities, rad for angles."""
        values = dict(self.fixed)
        if self.random:
            rng = np.random.default_rng([self.seed, index])
            for name, (low, high) in self.ranges.items():
                values[name] = float(rng.uniform(low, high))
            return values
        place = np.unravel_index(index, self.shape)
        for (name, axis), along in zip(self.axes.items(), place, strict=True):
            values[name] = axis[along]
        return values

    def as_dict(self) -> dict[str, object]:
        """The plan in plain values, by which journal and dataset know it again."""
        return {
            **self.subject.identity,
            "axes": {name: list(values) for name, values in self.axes.items()},
            "fixed": dict(self.fixed),
            "ranges": {name: list(bounds) for name, bounds in self.ranges.items()},
            "random": self.random,
            "starts": self.starts,
            "seed": self.seed,
            "block": self.block,
        }


def read_plan(
    source: str,
    parameters: Sequence[str],
    random: int = 0,
    starts: int = 200,
    seed: int = 0,
    *,
    locks: Sequence[str] = (),
    is_without_centre: bool = False,
) -> Plan:
    """The plan of a sweep from ``parameters`` and ``locks``: "name=value",
    "name=first:last:count" (a grid) and "name=low:high" (with ``random``).

    ``source`` is what `choose_subject` takes; a network can be taken
    ``is_without_centre``. Angles are in degrees. Parameters not named are at their
    defaults, or with ``random`` drawn from the catalogue's ranges; joints not named are
    free. Raises `GeometryError`, and as `choose_subject`.
    """
    if random < 0:
        raise GeometryError("--random", random, "at least 1")
    subject = choose_subject(source, is_without_centre)
    if locks and not _of_option(subject, LOCK):
        raise CommandError(
            f"--lock: it takes a network or the file of a mechanism, and {source} has no "
            "joints that could be locked"
        )
    fixed: dict[str, float] = {}
    spans: dict[str, tuple[float, ...]] = {}
    texts = [(PARAM, text) for text in parameters] + [(LOCK, text) for text in locks]
    for option, text in texts:
        quantity, numbers = _read(subject, option, text)
        name = quantity.name
        if name in fixed or name in spans:
            what = f"{option} {quantity.key}"
            raise GeometryError(what, repr(text), "given only once")
        if len(numbers) == 1:
            fixed[name] = numbers[0]
        elif len(numbers) == (2 if random else 3):
            spans[name] = numbers
        else:
            values = "low:high with --random" if random else "first:last:count"
            allowed = f"of the form {quantity.key}=... with value or {values}"
            raise GeometryError(f"{option} {quantity.key}", repr(text), allowed)
    if random:
        ranges = _ranges(subject, fixed, spans)
        if not ranges:
            allowed = "given as name=low:high at least once"
            raise GeometryError(_options(subject), "no range", allowed)
        return Plan(
            subject, fixed=fixed, ranges=ranges, random=random, starts=starts, seed=seed
        )
    if not spans:
        raise GeometryError(
            _options(subject),
            "no grid",
            "given as name=first:last:count at least once, or use --random",
        )
    axes = {name: _axis(subject.quantity(name), span) for name, span in spans.items()}
    return Plan(subject, axes, fixed, starts=starts, seed=seed)


def _of_option(subject: MemberSource, option: str) -> dict[str, Quantity]:
    """The quantities behind an option, by their keys."""
    return {one.key: one for one in subject.quantities if one.option == option}


def _options(subject: MemberSource) -> str:
    """The options behind which the quantities of a subject stand."""
    options = dict.fromkeys(one.option for one in subject.quantities) or [PARAM]
    return " or ".join(options)


def _ranges(
    subject: MemberSource,
    fixed: Mapping[str, float],
    spans: Mapping[str, tuple[float, ...]],
) -> dict[str, tuple[float, float]]:
    """Bounds of the quantities that are drawn: those given, or else the
    catalogue's."""
    ranges = {}
    for quantity in subject.quantities:
        if quantity.name in spans:
            low, high = spans[quantity.name]
            ranges[quantity.name] = (low, high)
        elif quantity.name not in fixed and quantity.bounds is not None:
            ranges[quantity.name] = quantity.bounds
    return ranges


def _axis(quantity: Quantity, span: Sequence[float]) -> tuple[float, ...]:
    """The values of a quantity on a grid; raises `GeometryError`."""
    first, last, count = span
    if count != int(count) or not 1 <= count <= MOST_VALUES:
        allowed = f"a whole number from 1 to {MOST_VALUES}"
        raise GeometryError(f"number of values of {quantity.key}", count, allowed)
    return tuple(np.linspace(first, last, int(count)).tolist())


def _read(
    subject: MemberSource, option: str, text: str
) -> tuple[Quantity, tuple[float, ...]]:
    """The quantity and the numbers of "key=number:number:..." behind an option; angles
    turned to rad, the third number left as it is. Raises `GeometryError`."""
    key, values = split_parameter(text, option)
    known = _of_option(subject, option)
    if key not in known:
        names = ", ".join(known) or "none: the file has no constants"
        allowed = f"name=... with a name out of {names}"
        raise GeometryError(option, repr(text), allowed)
    quantity = known[key]
    numbers = [read_number(key, part, option) for part in values.split(":")]
    if quantity.is_angle:
        for degrees in numbers[:2]:
            check_angle(f"{option} {key}", degrees, in_degrees=True)
        numbers[:2] = [math.radians(degrees) for degrees in numbers[:2]]
    return quantity, tuple(numbers)
