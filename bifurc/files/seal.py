"""The seal of a file: a checksum of all its bytes, behind them.

The libraries that read NetCDF may crash on damaged files; the seal is looked at before
they are asked. They pass over what stands behind the end of the data, and drop it when
they write on the file.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

MARK = b"bifurc seal "
SEAL = struct.Struct(f"<{len(MARK)}sI")


def append_seal(path: Path) -> None:
    """Write the seal behind the bytes of the file ``path``."""
    content = path.read_bytes()
    with path.open("ab") as file:
        file.write(SEAL.pack(MARK, zlib.crc32(content)))


def is_seal_broken(path: Path) -> bool:
    """Whether the file ``path`` has a seal, and its bytes are not those that were
    sealed."""
    whole = path.read_bytes()
    content, end = whole[: -SEAL.size], whole[-SEAL.size :]
    if len(end) < SEAL.size:
        return False
    mark, expected = SEAL.unpack(end)
    has_seal = bool(mark == MARK)
    return has_seal and zlib.crc32(content) != expected
