"""What the lines of a sweep's journal say: members that are finished, and blocks that
are in the dataset.

In: the lines of the journal, which a disk or an editor may have damaged. Out: entries
that fit the plan.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np

from linkages.app.sweep.journal import Journal, JournalError, Line
from linkages.app.sweep.member import FIELDS, Field, Record, Status
from linkages.app.sweep.plan import Plan


@dataclass(frozen=True)
class FinishedMember:
    """The ``record`` of the member number ``index``."""

    index: int
    record: Record


@dataclass(frozen=True)
class WrittenBlock:
    """The ``number`` of a block that was written to the dataset."""

    number: int


Entry: TypeAlias = FinishedMember | WrittenBlock

# a value that is no number is left out of a line, others are not
_COUNTS = {name for name, field in FIELDS.items() if np.dtype(field.dtype).kind != "f"}
_ALWAYS = _COUNTS - {"mobility"}  # journals of earlier versions are without it


def read_entries(journal: Journal, plan: Plan) -> Iterator[Entry]:
    """All entries below the header, one at a time; raises `JournalError` for a line
    that is none of this plan."""
    joints = len(plan.subject.joints)
    lines = enumerate(journal.lines(), start=1)
    next(lines)
    for number, line in lines:
        found = _entry(line, plan, joints)
        if found is None:
            raise JournalError.of_line(journal.path, number)
        yield found


def _entry(line: Line, plan: Plan, joints: int) -> Entry | None:
    """What a line says; None where that is nothing of this plan."""
    if line.keys() == {"block"}:
        number = line["block"]
        is_block = _is_number_below(number, plan.block_count)
        return WrittenBlock(number) if is_block else None
    index = line.get("member")
    if not _is_number_below(index, plan.size):
        return None
    if line.get("status") not in (Status.MAPPED, Status.REFUSED, Status.FAILED):
        return None
    if line["status"] == Status.MAPPED and not line.keys() >= _ALWAYS:
        return None
    is_whole = all(_fits(name, value, joints) for name, value in line.items())
    return FinishedMember(cast(int, index), line) if is_whole else None


def _is_number_below(value: object, count: int) -> bool:
    """Whether a value is a whole number from 0 on and less than ``count``."""
    return type(value) is int and 0 <= value < count


def _fits(name: str, value: object, joints: int) -> bool:
    """Whether the dataset can hold the value of an entry in a record."""
    if name == "member":
        return True
    if name == "message":
        return isinstance(value, str)
    field = FIELDS.get(name)
    if field is None:
        return False
    if not field.per_joint:
        return _is_of(field, value)
    if not isinstance(value, list) or len(value) != joints:
        return False
    return all(_is_of(field, each) for each in value)


def _is_of(field: Field, value: object) -> bool:
    """Whether a number is one of those that a variable of the dataset can hold."""
    dtype = np.dtype(field.dtype)
    if dtype.kind == "f":
        return type(value) in (int, float)
    limits = np.iinfo(dtype)
    return type(value) is int and int(limits.min) <= value <= int(limits.max)
