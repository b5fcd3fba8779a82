"""Joint variables along a form as a table of text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def make_angle_table(
    arclength: np.ndarray, variables: np.ndarray, names: Sequence[str]
) -> str:
    """A line for every configuration of a motion, with all digits: its arclength (k,)
    and the joint variables (k, v), below a line of their ``names``."""
    heads = [_cell(name) for name in ("arclength", *names)]
    lines = [",".join(heads)]
    rows = np.column_stack([arclength, variables])
    for row in rows:
        lines.append(",".join(repr(float(value)) for value in row))
    return "\n".join(lines) + "\n"


def _cell(name: str) -> str:
    """A name as a cell; joints may be called anything (RFC 4180)."""
    if not set(name) & set(',"\r\n'):
        return name
    return '"' + name.replace('"', '""') + '"'
