"""Joint angles along a form as a table of text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkages.export.motion import Motion

__all__ = ["make_angle_table"]


def make_angle_table(motion: Motion, names: Sequence[str]) -> str:
    """A line for every configuration of a motion, with all digits: its arclength and
    the joint angles, rad, without jumps, below a line of their names."""
    heads = ["arclength", *names]
    lines = [",".join(heads)]
    rows = np.column_stack([motion.arclength, motion.configurations])
    for row in rows:
        lines.append(",".join(repr(float(value)) for value in row))
    return "\n".join(lines) + "\n"
