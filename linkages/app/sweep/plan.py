"""What a sweep runs through: the members of a family, on a grid of parameters or drawn
at random."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from linkages.app.choice import read_number, split_parameter
from linkages.catalogue import entry
from linkages.entry import Entry, ParameterKind
from linkages.loop import GeometryError
from linkages.values import check_angle

__all__ = ["Block", "Plan", "PlanDocument", "read_plan"]

MOST_VALUES = 1_000_000  # of one parameter on a grid


class PlanDocument(TypedDict):
    """A plan in plain values, by which journal and dataset know it again."""

    family: str
    axes: dict[str, list[float]]
    fixed: dict[str, float]
    ranges: dict[str, list[float]]
    random: int
    starts: int
    seed: int
    block: int


@dataclass(frozen=True)
class Block:
    """Members that are stored together: where in the grid, and their indices (in
    row-major order of the grid)."""

    number: int
    region: tuple[slice, ...]
    indices: NDArray[np.intp]


@dataclass(frozen=True)
class Plan:
    """The members of a sweep, numbered in row-major order of the grid.

    ``axes`` are the values of the varied parameters (rad for angles), ``fixed`` those
    of one value. With ``random`` > 0 there is no grid: that many members are drawn,
    each from its own random stream, within ``ranges``. ``starts`` and ``seed`` are
    those of `bifurc.search.explore.explore`.
    """

    family: str
    axes: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    random: int = 0
    starts: int = 200
    seed: int = 0
    block: int = 512  # members written to the dataset together

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions: the varied parameters, or "member"."""
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

    def parameters(self, index: int) -> dict[str, float]:
        """Parameters of one member, rad for angles."""
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

    def as_dict(self) -> PlanDocument:
        """The plan in plain values."""
        return {
            "family": self.family,
            "axes": {name: list(values) for name, values in self.axes.items()},
            "fixed": dict(self.fixed),
            "ranges": {name: list(bounds) for name, bounds in self.ranges.items()},
            "random": self.random,
            "starts": self.starts,
            "seed": self.seed,
            "block": self.block,
        }


def read_plan(
    family: str, texts: Sequence[str], random: int = 0, starts: int = 200, seed: int = 0
) -> Plan:
    """The plan of a sweep from "name=value", "name=first:last:count" (a grid) and
    "name=low:high" (with ``random``).

    Angles are in degrees. Parameters not named are at their defaults, or with
    ``random`` drawn from the catalogue's ranges. Raises `GeometryError` and
    `linkages.catalogue.UnknownLinkageError`.
    """
    if random < 0:
        raise GeometryError("--random", random, "at least 1")
    linkage = entry(family)
    fixed: dict[str, float] = {}
    spans: dict[str, tuple[float, ...]] = {}
    for text in texts:
        name, numbers = _read(linkage, text)
        if name in fixed or name in spans:
            raise GeometryError(f"--param {name}", repr(text), "given only once")
        if len(numbers) == 1:
            fixed[name] = numbers[0]
        elif len(numbers) == (2 if random else 3):
            spans[name] = numbers
        else:
            raise GeometryError(f"--param {name}", repr(text), _form(name, random))
    if random:
        ranges = _ranges(linkage, fixed, spans)
        return Plan(
            family, fixed=fixed, ranges=ranges, random=random, starts=starts, seed=seed
        )
    if not spans:
        raise GeometryError(
            "--param",
            "no grid",
            "given as name=first:last:count at least once, or use --random",
        )
    axes = {name: _axis(name, span) for name, span in spans.items()}
    return Plan(family, axes, fixed, starts=starts, seed=seed)


def _form(name: str, random: int) -> str:
    """What a parameter may look like."""
    values = (
        "value or low:high with --random" if random else "value or first:last:count"
    )
    return f"of the form {name}=... with {values}"


def _ranges(
    linkage: Entry, fixed: Mapping[str, float], spans: Mapping[str, tuple[float, ...]]
) -> dict[str, tuple[float, float]]:
    """Bounds of the parameters that are drawn: those given, or else the
    catalogue's."""
    ranges = {}
    for parameter in linkage.parameters:
        if parameter.name in spans:
            low, high = spans[parameter.name]
            ranges[parameter.name] = (low, high)
        elif parameter.name not in fixed:
            ranges[parameter.name] = (parameter.low, parameter.high)
    return ranges


def _axis(name: str, span: Sequence[float]) -> tuple[float, ...]:
    """The values of a parameter on a grid; raises `GeometryError`."""
    first, last, count = span
    if count != int(count) or not 1 <= count <= MOST_VALUES:
        allowed = f"a whole number from 1 to {MOST_VALUES}"
        raise GeometryError(f"number of values of {name}", count, allowed)
    return tuple(np.linspace(first, last, int(count)).tolist())


def _read(linkage: Entry, text: str) -> tuple[str, tuple[float, ...]]:
    """Name and numbers of "name=number:number:..."; angles turned to rad, the third
    number left as it is. Raises `GeometryError`."""
    name, values = split_parameter(text)
    kinds = {parameter.name: parameter.kind for parameter in linkage.parameters}
    if name not in kinds:
        allowed = f"name=... with a name out of {', '.join(kinds)}"
        raise GeometryError("--param", repr(text), allowed)
    numbers = [read_number(name, part) for part in values.split(":")]
    if kinds[name] is ParameterKind.ANGLE:
        for degrees in numbers[:2]:
            check_angle(f"--param {name}", degrees, in_degrees=True)
        numbers[:2] = [math.radians(degrees) for degrees in numbers[:2]]
    return name, tuple(numbers)
