"""The journal of a sweep: one JSON object a line, appended and forced to disk before
anything depends on it."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

try:
    import fcntl
except (
    ImportError
):  # not a Unix system: nothing guards against two sweeps on one journal
    fcntl = None  # type: ignore[assignment]

__all__ = ["Journal", "JournalError"]


class JournalError(ValueError):
    """A journal that cannot be continued: ``path`` and why."""

    def __init__(self, path: Path, why: str):
        self.path = path
        super().__init__(f"{path}: {why}")


class Journal:
    """An append-only file of JSON lines that survives the death of its writer at any
    moment.

    The first line is ``header``; an existing file must begin with the same one. A last
    line that was cut off is dropped. One writer at a time: a second one raises
    `JournalError`.
    """

    def __init__(self, path: Path, header: Mapping[str, Any]):
        self.path = path
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        try:
            self._lock()
            self._drop_torn_line()
            first = next(self.lines(), None)
            if first is None:
                self.append(header)
            elif first != json.loads(json.dumps(header)):
                raise JournalError(
                    path, "belongs to another sweep; choose another --out or delete it"
                )
        except BaseException:
            os.close(self._file)
            raise

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.close(self._file)

    def append(self, record: Mapping[str, Any]) -> None:
        """Write one line and force it to disk."""
        line = (json.dumps(record) + "\n").encode()
        while line:
            line = line[os.write(self._file, line) :]
        os.fsync(self._file)

    def lines(self) -> Iterator[dict[str, Any]]:
        """All lines, the header first, read one at a time."""
        with open(self.path, encoding="utf-8") as file:
            for line in file:
                yield json.loads(line)

    def _lock(self) -> None:
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise JournalError(self.path, "another sweep is writing it") from None

    def _drop_torn_line(self) -> None:
        end = os.lseek(self._file, 0, os.SEEK_END)
        while end:
            start = max(0, end - 4096)
            part = os.pread(self._file, end - start, start)
            newline = part.rfind(b"\n")
            if newline >= 0:
                end = start + newline + 1
                break
            end = start
        os.ftruncate(self._file, end)
