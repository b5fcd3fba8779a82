"""What a sweep keeps of a member: the variables of its dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias

# values of `FIELDS` by name, and the message of a member that was refused or failed
Record: TypeAlias = dict[str, int | float | str | list[int]]


class Status(IntEnum):
    """What became of a member."""

    PENDING = -1  # not mapped yet
    MAPPED = 0
    REFUSED = 1  # its parameters or locks make no member
    FAILED = 2  # mapping raised an error, which the journal keeps


@dataclass(frozen=True)
class Field:
    """A variable of the dataset: its type, unit and meaning; ``per_joint`` has one
    value for each joint."""

    dtype: str
    unit: str
    meaning: str
    per_joint: bool = False

    @property
    def missing(self) -> float:
        """What stands where there is no value."""
        return math.nan if self.dtype.startswith("f") else -1


def _count(meaning: str) -> Field:
    return Field("i2", "", f"number of {meaning}")


def _flag(meaning: str) -> Field:
    return Field("i1", "", meaning)


def _ratio(meaning: str) -> Field:
    return Field("f8", "1", meaning)


def _way(meaning: str) -> Field:
    return Field("f8", "rad", meaning)


FIELDS: Mapping[str, Field] = {
    "status": _flag("0 mapped, 1 refused, 2 failed, -1 not done"),
    "mobility": Field("i2", "", "largest dimension of a component; 0 where rigid"),
    "forms": _count("motion forms"),
    "closed_forms": _count("closed forms"),
    "bifurcations": _count("bifurcations"),
    "components": _count("connected components made of forms"),
    "one_cycle": _flag("1 where the graph of forms is one cycle through all of them"),
    "rank_drops": _count("rank drops with a single branch"),
    "surfaces": _count("components of mobility 2 or more"),
    "rigid": _count("isolated rigid assemblies"),
    "inactive_joints": Field(
        "i2", "", "number of forms in which the joint does not turn", per_joint=True
    ),
    "smallest_gap": _ratio("smallest singular value at a near miss, relative"),
    "total_length": _way("joint-space length of all forms"),
    "longest_form": _way("joint-space length of the longest form"),
    "longest_route": _way(
        "largest of the shortest distances between two singular points"
    ),
    "mean_route": _way("mean of the shortest distances between two singular points"),
    "closure": _ratio(
        "largest closure error along any form, relative to the characteristic length"
    ),
    "closure_gap": _ratio("where there is no form: residual left along the valley"),
    "missed_probability": _ratio(
        "estimated probability that one more start finds something new"
    ),
    "complete": _flag("1 where every slice was complete"),
    "seconds": Field("f8", "s", "processor time taken"),
}
