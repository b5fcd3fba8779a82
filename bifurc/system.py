"""What is solved: a system F(u) = 0 of any number of equations, and the pieces of its
curves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from bifurc.decisions import is_solution
from bifurc.domain import Domain

if TYPE_CHECKING:
    import mpmath

    # SciPy takes a second to import, and only sparse problems need it
    from scipy.sparse import sparray


# Maps a right-hand side to the solution (n,) of one linear system.
Solver: TypeAlias = Callable[[np.ndarray], np.ndarray]


class CurveNodes(NamedTuple):
    """Where points of a curve are wanted: at ``offsets`` (k,), from 0 on, along a unit
    ``heading`` (n,) from the point ``start`` (n,).

    Row i of ``predictors`` (k, k) has the weights by which the points before number i
    predict it. A correction of a length of at most ``enough`` is the last one, and no
    point may miss by more than ``most``, relative to the magnitude.
    """

    start: np.ndarray
    heading: np.ndarray
    offsets: np.ndarray
    predictors: np.ndarray
    enough: float
    most: float


# Gives the points (k, n) at nodes; None where one of them cannot be corrected.
NodeCorrector: TypeAlias = Callable[[CurveNodes], np.ndarray | None]

PreciseResidual: TypeAlias = "Callable[[Sequence[mpmath.mpf]], Sequence[mpmath.mpf]]"


class MarchStatus(IntEnum):
    """Why a march of pieces ended. Compiled kernels return the numbers."""

    # All pieces that were asked for are made.
    RAN = 0
    # No trusted step is left.
    STALLED = 1
    # There is no solution at the start.
    OPEN = 2


class Anchor(NamedTuple):
    """A ``point`` (n,) of a curve and its unit ``tangent`` (n,) there, and the distance
    ``within`` which the curve is there again."""

    point: np.ndarray
    tangent: np.ndarray
    within: float


@dataclass(frozen=True, eq=False)
class MarchSettings:
    """How pieces of a curve are made. Lengths are in the unit of the unknowns.

    ``order`` of the pieces and the ``tolerance`` to which they meet the curve, the
    ``shortest`` and ``longest`` trusted radius, the largest number, ``count``, of
    pieces in one march. ``closing``: there is no curve where the least relative residual
    across it is larger; ``misclosure``: how large it is known to be elsewhere on the
    curve. With an ``anchor`` the march may end early: where the curve is there again,
    leaves the bounds, or is longer than ``length``. ``first``: width of the first piece
    that is tried, where pieces are made by trial.
    """

    order: int
    tolerance: float
    shortest: float
    longest: float
    count: int
    closing: float = is_solution.threshold
    misclosure: float = 0.0
    anchor: Anchor | None = None
    length: float = np.inf
    first: float = np.inf


@dataclass(frozen=True)
class Piece:
    """One polynomial piece of a curve.

    ``coefficients`` (order + 1, n) are those of the powers of x, which goes from -1 to
    1 in proportion to the arclength; ``residual`` is the largest relative residual seen
    on the piece.
    """

    coefficients: np.ndarray
    length: float
    residual: float


@dataclass(frozen=True, repr=False)
class March:
    """Consecutive polynomial pieces of a curve.

    ``pieces`` (k, order + 1, n) are coefficients in (s - centre) / radius, trusted from
    -1 to 1, s the arclength; ``steps`` (k,) the arclength to each centre from the one
    before it (from the start, for the first), ``radii`` (k,), ``residuals`` (k,) the
    largest residual seen on each piece relative to the problem's magnitude, or the gap
    at the start alone when the status is OPEN.
    """

    status: MarchStatus
    pieces: np.ndarray
    steps: np.ndarray
    radii: np.ndarray
    residuals: np.ndarray

    @staticmethod
    def of_pieces(
        status: MarchStatus, pieces: Sequence[Piece], order: int, n: int
    ) -> March:
        """The march of pieces that lie end to end, each of the given ``order`` in ``n``
        unknowns."""
        coefficients = np.array([piece.coefficients for piece in pieces])
        radii = np.array([piece.length / 2 for piece in pieces])
        steps = radii.copy()
        steps[1:] += radii[:-1]
        return March(
            status=status,
            pieces=coefficients.reshape(-1, order + 1, n),
            steps=steps,
            radii=radii,
            residuals=np.array([piece.residual for piece in pieces]),
        )

    @staticmethod
    def without_solution(gap: float, order: int, n: int) -> March:
        """The march of no pieces from a start at which the relative residual ``gap`` is
        left."""
        nothing = March.of_pieces(MarchStatus.OPEN, [], order, n)
        return replace(nothing, residuals=np.array([gap]))

    def __repr__(self) -> str:
        count, powers, n = self.pieces.shape
        last_radius = self.radii[-1] if count else 0.0
        arclength = self.steps.sum() + last_radius
        residual = self.residuals.max(initial=0.0)
        return (
            f"<March {self.status.name}: {count} pieces of order {powers - 1} in "
            f"{n} unknowns, arclength {arclength:.6g}, largest residual {residual:.2g}>"
        )


def compiled_march(
    march: Callable[..., tuple[Any, ...]],
    settings: MarchSettings,
    domain: Domain,
    unit: float = 1.0,
    magnitude: float = 1.0,
    **system: Any,
) -> March:
    """The pieces that compiled code makes of a ``system``, by the names of its
    arguments, which counts unknowns in a ``unit`` and residuals in ``magnitude`` times
    that unit."""
    anchor, within = np.empty((0, len(domain.names))), 0.0
    if settings.anchor is not None:
        place, heading, within = settings.anchor
        anchor = np.array([place / unit, heading])
    status, pieces, steps, radii, residuals, _ = march(
        **system,
        order=settings.order,
        tolerance=settings.tolerance,
        shortest=settings.shortest / unit,
        longest=settings.longest / unit,
        count=settings.count,
        closing=settings.closing / (magnitude * unit),
        misclosure=settings.misclosure / (magnitude * unit),
        anchor=anchor,
        within=within / unit,
        periods=domain.periods / unit,
        bounds=domain.bounds / unit,
        length=settings.length / unit,
    )
    return March(
        status=MarchStatus(status),
        pieces=unit * pieces,
        steps=unit * steps,
        radii=unit * radii,
        residuals=magnitude * unit * residuals,
    )


class SphereProjection(NamedTuple):
    """Solutions on a small sphere: ``points`` (k, n), the relative residuals ``gaps``
    (k,) and the lengths of the ``last_steps`` (k,) taken to them."""

    points: np.ndarray
    gaps: np.ndarray
    last_steps: np.ndarray


@dataclass(frozen=True, eq=False)
class Accuracy:
    """How exactly a system F = 0 is known.

    ``derivatives`` says how F' was made, ``equations`` whether a function was recorded,
    and why not. ``is_exact``: its equations are what is meant, and not made of numbers
    that are rounded. ``data_rounding``: how far off F may be, over the magnitude and the
    scale, as those numbers are rounded; 0 where that is not known. ``coefficient_rounding``
    gives how far off F (m,) is at a point (n,) where the numbers in it are rounded;
    by the rounding of the data where it is None. ``hessian_error`` is how far off F'' may
    be, over a bound on it. ``noise``: how noisy F is, over what it changes by within the
    bounds; 0 where that is no more than rounding. Within it `System.residuals` are zero.
    """

    derivatives: str = "exact"
    equations: str = ""
    is_exact: bool = False
    data_rounding: float = 0.0
    coefficient_rounding: Callable[[np.ndarray], np.ndarray] | None = None
    hessian_error: float = 1e-6
    noise: float = 0.0


class Curvature(NamedTuple):
    """Bounds on F'', over the magnitude.

    ``bound`` is a constant K with |F'(x) - F'(y)| <= K |x - y|. ``at_complex_points``
    gives bounds (k,) on |F''| at all complex points no farther than so much (k,) from a
    real point within the bounds; F is taken as the analytic function that it is next to a
    solution. Both need hold only where the relative residual is at most ``residual``.
    """

    bound: float
    at_complex_points: Callable[[np.ndarray], np.ndarray]
    residual: float = np.inf


class Shortcuts(NamedTuple):
    """What a system does in one call, where others go step by step; None where it has
    no way of its own.

    ``jacobian`` gives F' (m, n) at one point (n,), as a sparse matrix. ``bordered_solver``
    gives what solves systems with F' (m, n) at a point (n,), over the magnitude, and
    under it a row ``tangent`` (n,), or None where that matrix is to be factored; ``m`` is
    its number of equations. ``equations`` hands F and F', over a magnitude, to the
    compiled methods that are the same for all systems. ``valley_corrector`` corrects all points at the nodes of a
    piece of the valley along which the system is nearly solved
    (`bifurc.curves.valley_problem`). ``smallest_value`` gives the smallest singular value of F', over the
    magnitude, across the unit ``tangent`` (n,) of the curve through a point (n,), about.
    """

    m: int = 0
    jacobian: Callable[[np.ndarray], np.ndarray | sparray] | None = None
    bordered_solver: Callable[[np.ndarray, np.ndarray], Solver | None] | None = None
    valley_corrector: NodeCorrector | None = None
    equations: Callable[[float], object] | None = None
    smallest_value: Callable[[np.ndarray, np.ndarray], float] | None = None


NO_SHORTCUTS = Shortcuts()


class System(ABC):
    """F: R^n -> R^m with any m; the curves are where rank F' = n - 1 and F = 0.

    Redundant equations are normal: a spatial loop has six for five or fewer that are
    independent. ``domain`` says what the unknowns are and where solutions are looked for,
    ``magnitude`` is the typical size of F', by which residuals and singular values are
    divided, ``accuracy`` says how exactly F is known.
    """

    domain: Domain
    magnitude: float = 1.0
    accuracy: Accuracy = Accuracy()

    @cached_property
    def n(self) -> int:
        """Number of unknowns."""
        return len(self.domain.names)

    @property
    def curvature(self) -> Curvature | None:
        """Bounds on F''; None where none are known."""
        return None

    @property
    def shortcuts(self) -> Shortcuts:
        """What is done in one call."""
        return NO_SHORTCUTS

    @abstractmethod
    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""

    @abstractmethod
    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""

    @abstractmethod
    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""

    def precise_residual(self) -> PreciseResidual | None:
        """F over mpmath numbers, n of them in and m out, right to whatever precision
        is set when it is called; None where F is known in doubles only."""
        return None


def relative_residuals(system: System, points: np.ndarray) -> np.ndarray:
    """F over the magnitude (k, m) at points (k, n)."""
    return _over(system.magnitude, system.residuals(points))


def relative_jacobians(system: System, points: np.ndarray) -> np.ndarray:
    """F' over the magnitude (k, m, n) at points (k, n)."""
    return _over(system.magnitude, system.jacobians(points))


def _over(magnitude: float, values: np.ndarray) -> np.ndarray:
    """``values`` over the magnitude, which of many a system is 1."""
    return values if magnitude == 1.0 else values / magnitude


def relative_gaps(system: System, points: np.ndarray) -> np.ndarray:
    """|F| over the magnitude (k,) at points (k, n)."""
    sizes: np.ndarray = np.linalg.norm(system.residuals(points), axis=1)
    return sizes / system.magnitude


def jacobian_at(system: System, point: np.ndarray) -> np.ndarray | sparray:
    """F' (m, n) at one point (n,), sparse where that is how it is made."""
    jacobian = system.shortcuts.jacobian
    return system.jacobians(point[None])[0] if jacobian is None else jacobian(point)


def hessian_at(system: System, point: np.ndarray) -> np.ndarray:
    """F'' (m, n, n) at one point (n,)."""
    hessian: np.ndarray = system.hessians(point[None])[0]
    return hessian
