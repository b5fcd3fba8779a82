"""What a route shall avoid, pass and keep small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from bifurc.atlas import Atlas
from bifurc.errors import RouteError


class Cost(StrEnum):
    """What is smallest of the best route: its length in joint space, the number of
    singular points on the way, or the travel of the unknown that travels farthest."""

    LENGTH = "length"
    BIFURCATIONS = "bifurcations"
    TRAVEL = "travel"


@dataclass(frozen=True)
class Wishes:
    """Names of singular points, forms and surfaces that a route shall ``avoid``, and
    that it shall pass ``through``, in any order; and the ``cost`` of a route."""

    avoid: Sequence[str] = ()
    through: Sequence[str] = ()
    cost: Cost = Cost.LENGTH

    def resolved(self, atlas: Atlas) -> Wishes:
        """The same with full names; raises `RouteError` for a name that is not there,
        or that is both avoided and passed."""
        avoid = tuple(_full_name(atlas, name) for name in self.avoid)
        through = tuple(_full_name(atlas, name) for name in self.through)
        both = sorted(set(avoid) & set(through))
        if both:
            raise RouteError(f"{both[0]!r} cannot be avoided and passed")
        return Wishes(avoid, tuple(dict.fromkeys(through)), Cost(self.cost))


NONE = Wishes()


def _full_name(atlas: Atlas, name: str) -> str:
    """The name of a singular point as it is; of a form or a surface in full."""
    points = [point.name for point in atlas.points]
    if name in points:
        return name
    try:
        return atlas.full_name(name)
    except RouteError as error:
        known = ", ".join(points) or "none"
        raise RouteError(f"{error}, or a singular point: {known}") from None
