"""What the closure of a subject is made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from bifurc.domain import Domain
from bifurc.equations.system import CompiledSystem
from bifurc.system import Accuracy, Curvature

if TYPE_CHECKING:
    # it imports networkx, which a loop does not need
    from linkages.structure.structure import Structure

NEARLY_CLOSED = 0.2  # the largest residual at which bounds on F'' hold


class ClosureParts(NamedTuple):
    """What is chosen once for a subject: the equations as compiled code, the
    ``bounds`` on F'' from the geometry, worked out when they are asked for. A mechanism
    has a ``structure``, and the ``rows`` of the equations that belong to each of its
    closures. The ``magnitude`` of many equations is larger, as their roundings are
    together."""

    domain: Domain
    accuracy: Accuracy
    compiled: CompiledSystem
    bounds: Callable[[], Curvature]
    structure: Structure | None = None
    rows: tuple[slice, ...] = ()
    magnitude: float = 1.0
