"""An atlas that was found in units of the search, stated in the user's units.

Points and tangents are restated one by one. A curve is a polynomial of its arclength,
which is another one where the unknowns change by different factors: its pieces are made
again, short enough for the new arclength.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion, Surface
from bifurc.branch import Branch
from bifurc.curves.certificate import Certificate
from bifurc.problem import Problem
from bifurc.singular.point import SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.units import Units

ORDER, FINE = 16, 48  # of a piece, and of its speed
EXACT = (
    1e-12  # error of a piece, over the length of the curve, in the units of the search
)
DEPTH = 60  # halvings of a piece
NEWTON_STEPS, LAST_STEP = 60, 1e-14
TINY = 1e-300  # keeps a length of zero from being divided by
# Chebyshev points and terms there, and the powers that the terms are made of.
NODES, FINE_NODES = chebyshev.chebpts1(ORDER + 1), chebyshev.chebpts1(FINE)
BETWEEN = np.linspace(-1.0, 1.0, 2 * ORDER)
POWERS = np.array(
    [
        np.pad(chebyshev.cheb2poly(row[: k + 1]), (0, ORDER - k))
        for k, row in enumerate(np.eye(ORDER + 1))
    ]
)


def restated(
    atlas: Atlas, problem: Problem, units: Units, multiplicities: Sequence[int]
) -> Atlas:
    """An atlas in ``units`` as one of the ``problem``, which is the user's, with the
    forms of these ``multiplicities``."""
    courses = [restated_branch(f.branch, units, problem.periods) for f in atlas.forms]
    forms = [
        _form(form, course, units, multiplicity)
        for form, course, multiplicity in zip(
            atlas.forms, courses, multiplicities, strict=True
        )
    ]
    return replace(
        atlas,
        names=problem.names,
        units=problem.units,
        periods=problem.periods,
        forms=tuple(forms),
        points=tuple(_meeting_point(p, courses, units) for p in atlas.points),
        near_misses=tuple(_event(e, courses, units) for e in atlas.near_misses),
        dead_points=tuple(_event(e, courses, units) for e in atlas.dead_points),
        rigid=units.outwards(atlas.rigid),
        surfaces=tuple(_surface(s, units, problem.periods) for s in atlas.surfaces),
        near_motions=tuple(_near_motion(near, units) for near in atlas.near_motions),
    )


# --- curves ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Course:
    """A branch restated, and what its arclengths were: from ``breaks`` (p + 1,) of the
    former arclength on, the new one is ``starts`` (p,) and what the Chebyshev series
    ``gains`` (p, k) add."""

    branch: Branch
    breaks: np.ndarray
    starts: np.ndarray
    gains: np.ndarray

    def arclengths(self, s: np.ndarray) -> np.ndarray:
        """The new arclengths (...) of the former ones (...)."""
        flat = np.ravel(s)
        numbers = np.searchsorted(self.breaks, flat, side="right") - 1
        numbers = np.clip(numbers, 0, len(self.starts) - 1)
        low, high = self.breaks[numbers], self.breaks[numbers + 1]
        x = (2 * flat - low - high) / (high - low)
        terms = chebyshev.chebvander(x, self.gains.shape[1] - 1)
        gains = np.einsum("ik,ik->i", terms, self.gains[numbers])
        return np.asarray(self.starts[numbers] + gains).reshape(np.shape(s))


def restated_branch(branch: Branch, units: Units, periods: np.ndarray) -> Course:
    """A branch in ``units`` as one of the user's unknowns with ``periods`` (n,)."""
    if units.is_uniform or not len(branch.pieces):
        return _scaled_course(branch, units, periods)
    pieces: list[_Piece] = []
    for low, high in zip(branch.breaks[:-1], branch.breaks[1:], strict=True):
        pieces += _pieces_between(branch, units, float(low), float(high))
    lengths = np.array([piece.length for piece in pieces])
    ends = np.cumsum(lengths)
    starts = ends - lengths
    numbers = np.searchsorted(branch.breaks, [piece.low for piece in pieces], "right")
    restated_pieces = Branch(
        pieces=np.array([piece.coefficients for piece in pieces]),
        centers=starts + 0.5 * lengths,
        radii=0.5 * lengths,
        breaks=np.concatenate([[0.0], ends]),
        residuals=branch.residuals[numbers - 1],
        periods=periods,
        outcome=branch.outcome,
        gap=branch.gap,
    )
    former = np.array([piece.low for piece in pieces] + [branch.length])
    gains = np.array([piece.gains for piece in pieces])
    return Course(restated_pieces, former, starts, gains)


def _scaled_course(branch: Branch, units: Units, periods: np.ndarray) -> Course:
    """The same where all unknowns change by one factor, and arclengths with them."""
    size = float(units.sizes[0])
    pieces = size * branch.pieces
    if len(pieces):
        pieces[:, 0] += units.origin
    scaled = replace(
        branch,
        pieces=pieces,
        centers=size * branch.centers,
        radii=size * branch.radii,
        breaks=size * branch.breaks,
        periods=periods,
    )
    half = 0.5 * size * branch.length
    breaks = np.array([0.0, branch.length])
    return Course(scaled, breaks, np.zeros(1), np.array([[half, half]]))


class _Piece(NamedTuple):
    """A piece from the former arclength ``low`` on: monomial ``coefficients`` (order +
    1, n) in the new arclength on [-1, 1], its ``length``, and the Chebyshev series of
    the ``gains`` in arclength."""

    low: float
    coefficients: np.ndarray
    length: float
    gains: np.ndarray


def _pieces_between(
    branch: Branch, units: Units, low: float, high: float, depth: int = 0
) -> list[_Piece]:
    """Pieces of a branch between two of its arclengths, halved until they are exact."""
    piece, error = _piece_between(branch, units, low, high)
    if error <= EXACT * branch.length or depth >= DEPTH:
        return [piece]
    middle = 0.5 * (low + high)
    return [
        *_pieces_between(branch, units, low, middle, depth + 1),
        *_pieces_between(branch, units, middle, high, depth + 1),
    ]


def _piece_between(
    branch: Branch, units: Units, low: float, high: float
) -> tuple[_Piece, float]:
    """One piece between two arclengths of a branch, and its error in the units of the
    search."""
    half = 0.5 * (high - low)
    velocity = units.sizes * branch(low + half * (1.0 + FINE_NODES), 1)
    speed = half * _series(np.linalg.norm(velocity, axis=1))
    gains = chebyshev.chebint(speed, lbnd=-1)
    length = float(gains.sum())
    targets = 0.5 * length * (1.0 + np.append(NODES, BETWEEN))
    places = _places(speed, gains, targets)
    points = branch(np.clip(low + half * (1.0 + places), low, high))
    series = _series(points[: ORDER + 1])
    missed = _terms(BETWEEN, ORDER + 1) @ series - points[ORDER + 1 :]
    monomials = (POWERS.T @ series) * units.sizes
    monomials[0] += units.origin
    return _Piece(low, monomials, length, gains), float(np.abs(missed).max())


def _terms(x: np.ndarray, count: int) -> np.ndarray:
    """The first Chebyshev polynomials (k, count) at x (k,) in [-1, 1]."""
    terms: np.ndarray = np.cos(
        np.arccos(np.clip(x, -1.0, 1.0))[:, None] * np.arange(count)
    )
    return terms


def _series(values: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (k, ...) of values (k, ...) at the Chebyshev points."""
    count = len(values)
    terms = _terms(FINE_NODES if count == FINE else NODES, count)
    weights = np.full(count, 2.0 / count)
    weights[0] = 1.0 / count
    series: np.ndarray = (terms * weights).T @ values
    return series


def _places(speed: np.ndarray, gains: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Where on [-1, 1] the arclength is that of the targets (k,), by Newton's method
    kept within a bracket."""
    low, high = np.full(len(targets), -1.0), np.full(len(targets), 1.0)
    x = np.clip(2 * targets / max(float(gains.sum()), TINY) - 1.0, -1.0, 1.0)
    for _ in range(NEWTON_STEPS):
        terms = _terms(x, len(gains))
        error = terms @ gains - targets
        low = np.where(error < 0, x, low)
        high = np.where(error > 0, x, high)
        newton = x - error / np.maximum(terms[:, :-1] @ speed, TINY)
        is_inside = (newton > low) & (newton < high)
        following = np.where(is_inside, newton, 0.5 * (low + high))
        following = np.where(np.abs(newton - x) < LAST_STEP, x, following)
        if np.array_equal(following, x):
            break
        x = following
    return x


# --- forms and points -----------------------------------------------------------------


def _form(form: Form, course: Course, units: Units, multiplicity: int) -> Form:
    arclength = course.arclengths(form.profile.arclength)
    certificate = form.certificate
    if certificate is not None:
        certificate = _certificate(certificate, course, units)
    return replace(
        form,
        branch=course.branch,
        profile=replace(form.profile, arclength=arclength),
        certificate=certificate,
        multiplicity=multiplicity,
    )


def _certificate(certificate: Certificate, course: Course, units: Units) -> Certificate:
    """A certificate; a bound is known in units of one size only."""
    return replace(
        certificate,
        gaps=course.arclengths(certificate.gaps),
        blurred=course.arclengths(certificate.blurred),
        bound=certificate.bound / float(units.sizes[0]),
    )


def _event(event: Event, courses: list[Course], units: Units) -> Event:
    s = float(courses[event.form].arclengths(np.array(event.s)))
    return replace(event, s=s, u=units.outwards(event.u))


def _meeting_point(
    point: MeetingPoint, courses: list[Course], units: Units
) -> MeetingPoint:
    passes = [
        (form, float(courses[form].arclengths(np.array(s)))) for form, s in point.passes
    ]
    return replace(
        point,
        point=_singular_point(point.point, units),
        passes=tuple(passes),
        tangents=units.directions(point.tangents),
    )


def _singular_point(point: SingularPoint, units: Units) -> SingularPoint:
    largest = float(units.sizes.max())
    null_space = point.null_space
    if not units.is_uniform:
        null_space = np.linalg.qr(units.sizes[:, None] * null_space)[0]
    return replace(
        point,
        u=units.outwards(point.u),
        null_space=null_space,
        error=largest * point.error,
        half_branches=units.directions(point.half_branches),
        tangents=units.directions(point.tangents),
        radius=largest * point.radius,
    )


# --- surfaces and near motions --------------------------------------------------------


def _surface(surface: Surface, units: Units, periods: np.ndarray) -> Surface:
    """A surface in units of one size."""
    charts = surface.charts
    if charts is not None:
        charts = _charts(charts, units, periods)
    return replace(surface, samples=units.outwards(surface.samples), charts=charts)


def _charts(charts: ChartAtlas, units: Units, periods: np.ndarray) -> ChartAtlas:
    return replace(
        charts,
        centers=units.outwards(charts.centers),
        radii=float(units.sizes[0]) * charts.radii,
        vertices=units.outwards(charts.vertices),
        periods=periods,
    )


def _near_motion(near: NearMotion, units: Units) -> NearMotion:
    """A near motion in units of one size."""
    length = float(units.sizes[0]) * near.length
    return replace(near, length=length, sample=units.outwards(near.sample))
