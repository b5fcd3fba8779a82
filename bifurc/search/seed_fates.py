"""What the seeds of a search turned out to lie on."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Fate(Enum):
    """Where a seed lies."""

    # It lies on a traced branch.
    ON_FORM = "on a form"
    # It is a singular point, or as near to one as its digits tell.
    AT_SINGULAR_POINT = "at a singular point"
    # It is a solution without motion.
    RIGID = "rigid assembly"
    # It lies on a curve along which the system is nearly solved.
    ON_NEAR_MOTION = "on a near motion"
    # The solutions about it are of dimension 2 or more.
    ON_COMPONENT = "on a component of higher dimension"
    # It only nearly solves the equations.
    NO_SOLUTION = "no solution"


@dataclass(frozen=True)
class SeedFate:
    """What one seed lies on, and which one of these.

    ``number`` counts the branches, the near motions, the singular points or the rigid
    assemblies in the order in which they were found. Of a component it is the dimension.
    """

    fate: Fate
    number: int = 0
