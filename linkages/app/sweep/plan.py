"""What a sweep runs through: the members of a family, on a grid of parameters or drawn
at random."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from linkages.catalogue import entry
from linkages.entry import Entry
from linkages.loop import GeometryError

__all__ = ["Block", "Plan", "read_plan"]


@dataclass(frozen=True)
class Block:
    """Members that are stored together: where in the grid, and their indices (in
    row-major order of the grid)."""

    number: int
    region: tuple[slice, ...]
    indices: np.ndarray


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
        return (
            (self.random,)
            if self.random
            else tuple(len(values) for values in self.axes.values())
        )

    @property
    def size(self) -> int:
        """Number of members."""
        return math.prod(self.shape)

    @cached_property
    def chunk(self) -> tuple[int, ...]:
        """Shape of a block: as many of the last dimensions as fit into it."""
        left, out = self.block, []
        for length in reversed(self.shape):
            out.append(max(1, min(length, left)))
            left //= out[-1]
        return tuple(reversed(out))

    def blocks(self) -> Iterator[Block]:
        """All blocks, in order."""
        starts = [range(0, n, c) for n, c in zip(self.shape, self.chunk, strict=True)]
        for number, corner in enumerate(product(*starts)):
            region = tuple(
                slice(a, min(a + c, n))
                for a, c, n in zip(corner, self.chunk, self.shape, strict=True)
            )
            axes = np.meshgrid(
                *(np.arange(s.start, s.stop) for s in region), indexing="ij"
            )
            yield Block(
                number, region, np.ravel_multi_index(tuple(axes), self.shape).ravel()
            )

    @property
    def block_count(self) -> int:
        """Number of blocks."""
        return math.prod(self._blocks_along)

    @property
    def _blocks_along(self) -> tuple[int, ...]:
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk, strict=True))

    def block_of(self, index: int) -> int:
        """Number of the block that holds a member."""
        corner = [
            int(i) // c
            for i, c in zip(
                np.unravel_index(index, self.shape), self.chunk, strict=True
            )
        ]
        return int(np.ravel_multi_index(corner, self._blocks_along))

    def parameters(self, index: int) -> dict[str, float]:
        """Parameters of one member, rad for angles."""
        if self.random:
            rng = np.random.default_rng([self.seed, index])
            drawn = {
                name: float(rng.uniform(low, high))
                for name, (low, high) in self.ranges.items()
            }
            return {**self.fixed, **drawn}
        at = np.unravel_index(index, self.shape)
        varied = {
            name: values[i]
            for (name, values), i in zip(self.axes.items(), at, strict=True)
        }
        return {**self.fixed, **varied}

    def as_dict(self) -> dict[str, Any]:
        """The plan in plain values, by which a journal knows it again."""
        return {
            "family": self.family,
            "axes": {k: list(v) for k, v in self.axes.items()},
            "fixed": dict(self.fixed),
            "ranges": {k: list(v) for k, v in self.ranges.items()},
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
    found = entry(family)
    fixed: dict[str, float] = {}
    spans: dict[str, tuple[float, ...]] = {}
    for text in texts:
        name, numbers = _read(found, text)
        if len(numbers) == 1:
            fixed[name] = numbers[0]
        elif len(numbers) == (2 if random else 3):
            spans[name] = numbers
        else:
            expected = (
                "value or low:high with --random"
                if random
                else "value or first:last:count"
            )
            raise GeometryError(
                f"--param {name}", repr(text), f"of the form {name}=... with {expected}"
            )
    if random < 0:
        raise GeometryError("--random", random, "at least 1")
    if random:
        ranges = {
            p.name: (p.low, p.high) for p in found.parameters if p.name not in fixed
        }
        ranges |= {name: (low, high) for name, (low, high) in spans.items()}
        return Plan(
            family, fixed=fixed, ranges=ranges, random=random, starts=starts, seed=seed
        )
    if not spans:
        raise GeometryError(
            "--param",
            "no grid",
            "given as name=first:last:count at least once, or use --random",
        )
    axes = {}
    for name, (first, last, count) in spans.items():
        if count != int(count) or count < 1:
            raise GeometryError(
                f"number of values of {name}", count, "a whole number from 1"
            )
        axes[name] = tuple(np.linspace(first, last, int(count)).tolist())
    return Plan(family, axes, fixed, starts=starts, seed=seed)


def _read(found: Entry, text: str) -> tuple[str, tuple[float, ...]]:
    """Name and numbers of "name=number:number:..."; angles turned to rad, the third
    number left as it is."""
    name, equals, values = text.partition("=")
    name = name.strip()
    kinds = {p.name: p.kind for p in found.parameters}
    if not equals or name not in kinds:
        raise GeometryError(
            "--param", repr(text), f"name=... with a name out of {', '.join(kinds)}"
        )
    try:
        numbers = [float(part) for part in values.split(":")]
    except ValueError:
        raise GeometryError(
            f"--param {name}", repr(values), "numbers separated by colons"
        ) from None
    if not all(math.isfinite(x) for x in numbers):
        raise GeometryError(f"--param {name}", repr(values), "finite numbers")
    if kinds[name] == "angle":
        numbers[:2] = [math.radians(x) for x in numbers[:2]]
    return name, tuple(numbers)
