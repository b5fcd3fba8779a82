"""The checksum of a dataset, by which a damaged file is told from a whole one."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping

import numpy as np


def checksum(
    values: Mapping[str, np.ndarray],
    attributes: Mapping[str, object],
    names: Iterable[str],
) -> int:
    """CRC-32 of the values of all variables and of the attributes called ``names``.

    It is the same before a dataset is written and after it is read.
    """
    total = 0
    for name in sorted(values):
        total = zlib.crc32(name.encode(), total)
        total = zlib.crc32(_content(values[name]), total)
    for name in names:
        total = zlib.crc32(str(attributes.get(name)).encode(), total)
    return total


def _content(values: np.ndarray) -> bytes:
    """Numbers as they are; texts, which change their type in a file, in UTF-8."""
    if values.dtype.kind in "biuf":
        return values.tobytes()
    return "\0".join(map(str, values.ravel().tolist())).encode()
