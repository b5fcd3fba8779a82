"""The journal of a sweep: one JSON object a line, with a checksum of the rest of it,
appended and forced to disk before anything depends on it."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from bifurc.errors import PathError
from linkages.app.sweep.member import FIELDS, Field, Record, Status
from linkages.app.sweep.plan import Plan

try:
    import fcntl
except ImportError:  # not a Unix system: nothing keeps two sweeps off one journal
    fcntl = None  # type: ignore[assignment]

Line: TypeAlias = dict[str, Any]  # values of JSON; who writes a line knows which

NO_JOURNAL = "it is no journal of a sweep; choose another --out or delete it"
WITHOUT_LINE = "delete this line, and what it held is mapped again"
CHECK = "crc32"  # the key of the checksum of a line
CHUNK = 4096  # bytes read at a time on the way back to the last newline


class JournalError(PathError):
    """A journal that cannot be continued: ``path`` and why."""

    @classmethod
    def of_line(cls, path: Path, number: int) -> JournalError:
        """The error of a line that says nothing of this sweep, numbered from 1."""
        if number == 1:
            return cls(path, NO_JOURNAL)
        return cls(path, f"line {number} is damaged; {WITHOUT_LINE}")


class Journal:
    """An append-only file of JSON lines that survives the death of its writer at any
    moment.

    The first line is ``header``; an existing file must begin with the same one. A last
    line that was cut off is dropped. Raises `JournalError` for a file that is no
    journal, for that of another header, and where another process writes it.
    """

    def __init__(self, path: Path, header: Mapping[str, object]):
        self.path = path
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        try:
            self._lock()
            self._drop_torn_line()
            self._begin_with(header)
        except BaseException:
            os.close(self._file)
            raise

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._file)

    def append(self, line: Mapping[str, object]) -> None:
        """Write one line and force it to disk."""
        checked = {**line, CHECK: _checksum(line)}
        rest = (json.dumps(checked) + "\n").encode()
        while rest:
            count = os.write(self._file, rest)
            rest = rest[count:]
        os.fsync(self._file)

    def lines(self) -> Iterator[Line]:
        """All lines, the header first, read one at a time; raises `JournalError` for a
        line that is no JSON object, or not the one that was written."""
        with open(self.path, "rb") as file:
            for number, content in enumerate(file, start=1):
                line = _parsed(content)
                if line is None:
                    raise JournalError.of_line(self.path, number)
                yield line

    def _lock(self) -> None:
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise JournalError(self.path, "another sweep is writing it") from None

    def _drop_torn_line(self) -> None:
        """Cut off what stands behind the last newline."""
        end = os.lseek(self._file, 0, os.SEEK_END)
        while end:
            start = max(0, end - CHUNK)
            newline = os.pread(self._file, end - start, start).rfind(b"\n")
            if newline >= 0:
                end = start + newline + 1
                break
            end = start
        os.ftruncate(self._file, end)

    def _begin_with(self, header: Mapping[str, object]) -> None:
        """Write the header to an empty file, or compare it with that of the file."""
        first = next(self.lines(), None)
        if first is None:
            self.append(header)
        elif first != json.loads(json.dumps(header)):
            why = "it belongs to another sweep; choose another --out or delete it"
            raise JournalError(self.path, why)


def _checksum(line: Mapping[str, object]) -> int:
    """The CRC-32 of the values of a line."""
    return zlib.crc32(json.dumps(line).encode())


def _parsed(content: bytes) -> Line | None:
    """The JSON object that a line holds; None where it holds none, or not what its
    checksum is of."""
    try:
        line = json.loads(content.decode("utf-8"))
        if not isinstance(line, dict):
            return None
        # journals of earlier versions have none
        checksum = line.pop(CHECK, None)
        is_whole = checksum is None or checksum == _checksum(line)
    except (ValueError, RecursionError):  # also for numbers of thousands of digits
        return None
    return line if is_whole else None


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
# not in journals of earlier versions, and not without a diagram
_SOMETIMES = {"mobility", "folds", "hopf_points", "events"}
_ALWAYS = _COUNTS - _SOMETIMES


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
