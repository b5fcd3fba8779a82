"""Where branches are traced from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.singular.point import SingularPoint


class Start(NamedTuple):
    """A solution (n,) to trace a branch from, first to the side of ``direction`` (n,)
    where there is one."""

    point: np.ndarray
    direction: np.ndarray | None = None


def half_branch_starts(point: SingularPoint) -> list[Start]:
    """Starts on all half-branches of a singular point, a little off it."""
    directions = point.half_branches
    return [Start(point.u + point.radius * along, along) for along in directions]
