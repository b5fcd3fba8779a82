"""All zeros of a function along a curve, with what rounding hides of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_event
from bifurc.diagrams.cells import NARROWEST, AlongCurve, Cell, CellKind, cells_along
from bifurc.numerics.roots import bracketed_roots

BESIDE = 1e-9  # of the length: how far from a zero of a steep function it is compared


class ZeroKind(Enum):
    """What a function does at a zero."""

    CROSSING = "crossing"  # it changes sign
    TOUCH = "touch"  # it does not
    END = "end"  # the curve ends there
    JUMP = "jump"  # it changes sign, and is none


class Zero(NamedTuple):
    """A zero at arclength ``s``; from ``low`` to ``high`` the function is zero as far as
    rounding tells, and has the sign ``after`` beyond (0 at the end of a curve)."""

    s: float
    kind: ZeroKind
    low: float
    high: float
    after: float


@dataclass(frozen=True)
class Zeros:
    """The zeros of a function along a curve, in order.

    ``jumps`` are places at which it changes sign and is not zero, ``held`` stretches on
    which it is exactly zero. ``is_resolved`` is False where the limit of parts was
    reached before all was plain.
    """

    zeros: tuple[Zero, ...]
    jumps: tuple[Zero, ...]
    held: tuple[tuple[float, float], ...]
    is_resolved: bool


class _Knot(NamedTuple):
    """The ``sign`` of a function at ``s``, 0 where ``rounding`` hides it, NaN where it is
    not defined; ``is_held`` in a part on which it is exactly zero, ``is_rough`` in one
    that nodes do not show."""

    s: float
    sign: float
    rounding: float = 0.0
    is_held: bool = False
    is_rough: bool = False


class _Gap(NamedTuple):
    """What lies between two knots with signs: knots of sign 0, or nothing."""

    before: _Knot | None
    zeros: tuple[_Knot, ...]
    after: _Knot | None

    @property
    def is_rough(self) -> bool:
        ends = [knot for knot in (self.before, self.after) if knot is not None]
        return any(knot.is_rough for knot in (*ends, *self.zeros))

    @property
    def is_held(self) -> bool:
        return any(knot.is_held for knot in self.zeros)

    @property
    def rounding(self) -> float:
        ends = [knot for knot in (self.before, self.after) if knot is not None]
        return min(knot.rounding for knot in ends)

    @property
    def changes_sign(self) -> bool:
        if self.before is None or self.after is None:
            return False
        return self.before.sign * self.after.sign < 0.0


def zeros_along(
    branch: Branch,
    function: AlongCurve,
    rounding: float = 0.0,
    *,
    is_measured: bool = True,
) -> Zeros:
    """The zeros along a curve of a function that maps arclengths (k,) to values (k,),
    known to ``rounding``.

    ``is_measured``: whether the stretch on which rounding hides a crossing is wanted.
    What shows at none of the nodes of a piece, some 20, is not seen.
    """
    if not len(branch.pieces):
        return Zeros((), (), (), True)
    cells = cells_along(branch.breaks, function, rounding)
    knots = [knot for cell in cells for knot in _knots_of(cell)]
    if branch.closed:
        knots = _round_about(knots, branch, function)
    gaps = _gaps(knots)
    changing = [gap for gap in gaps if gap.changes_sign and not gap.is_held]
    places, is_zero = _places(branch, function, changing)
    zeros: list[Zero] = []
    jumps: list[Zero] = []
    for gap, s, holds in zip(changing, places.tolist(), is_zero, strict=True):
        kind = ZeroKind.CROSSING if holds else ZeroKind.JUMP
        sign = 0.0 if gap.after is None else gap.after.sign
        (zeros if holds else jumps).append(Zero(s, kind, s, s, sign))
    if is_measured:
        crossing = [gap for gap, holds in zip(changing, is_zero, strict=True) if holds]
        zeros = _with_stretches(function, crossing, zeros, branch.length)
    zeros += [
        zero for gap in gaps if not gap.changes_sign for zero in _touches(gap, branch)
    ]
    if branch.closed:
        zeros = [_within_a_turn(zero, branch.length) for zero in zeros]
        jumps = [_within_a_turn(jump, branch.length) for jump in jumps]
    zeros.sort(key=lambda zero: zero.s)
    return Zeros(
        zeros=tuple(zeros),
        jumps=tuple(jumps),
        held=tuple((gap.zeros[0].s, gap.zeros[-1].s) for gap in gaps if gap.is_held),
        is_resolved=all(cell.kind is not CellKind.OPEN for cell in cells),
    )


# --- signs ----------------------------------------------------------------------------


def _knots_of(cell: Cell) -> list[_Knot]:
    """The signs that a part of the curve shows."""
    if cell.kind in (CellKind.UNDEFINED, CellKind.OPEN):
        return [_Knot(cell.low, np.nan), _Knot(cell.high, np.nan)]
    if cell.kind in (CellKind.FLAT, CellKind.ZERO):
        is_held = cell.kind is CellKind.ZERO
        ends = (cell.low, cell.high)
        return [_Knot(s, 0.0, cell.rounding, is_held) for s in ends]
    signs = np.sign(cell.values)
    signs[np.abs(cell.values) <= cell.rounding] = 0.0
    if cell.kind in (CellKind.CLEAR, CellKind.MONOTONE):
        first, last = float(signs[0]), float(signs[-1])
        return [
            _Knot(cell.low, first, cell.rounding),
            _Knot(cell.high, last, cell.rounding),
        ]
    is_rough = cell.kind is not CellKind.NOISY
    pairs = zip(cell.places.tolist(), signs.tolist(), strict=True)
    return [_Knot(s, sign, cell.rounding, is_rough=is_rough) for s, sign in pairs]


def _round_about(
    knots: Sequence[_Knot], branch: Branch, function: AlongCurve
) -> list[_Knot]:
    """The knots of a closed curve from the first one with a sign round to this one.

    A function may have the other sign after a turn, as the sine of half an angle has.
    """
    for k, knot in enumerate(knots):
        if abs(knot.sign) != 1.0:
            continue
        once_more = float(function(np.array([knot.s + branch.length]))[0])
        factor = float(np.sign(once_more)) * knot.sign
        again = [
            one._replace(s=one.s + branch.length, sign=factor * one.sign)
            for one in knots[: k + 1]
        ]
        return [*knots[k:], *again]
    return list(knots)


def _gaps(knots: Sequence[_Knot]) -> list[_Gap]:
    """What lies between the signs, where that may be a zero."""
    gaps = []
    before: _Knot | None = None
    zeros: list[_Knot] = []
    for knot in knots:
        if knot.sign == 0.0:
            zeros.append(knot)
            continue
        after = knot if abs(knot.sign) == 1.0 else None
        gap = _Gap(before, tuple(zeros), after)
        if zeros or gap.changes_sign:
            gaps.append(gap)
        before, zeros = after, []
    if zeros:
        gaps.append(_Gap(before, tuple(zeros), None))
    return gaps


# --- zeros ----------------------------------------------------------------------------


def _places(
    branch: Branch, function: AlongCurve, gaps: Sequence[_Gap]
) -> tuple[np.ndarray, np.ndarray]:
    """Where the function changes sign in each gap (k,), and whether it is zero there
    (k,): it may jump where nodes do not show it."""
    if not gaps:
        return np.empty(0), np.empty(0, dtype=bool)
    low, high = _ends_of(gaps)
    places = bracketed_roots(function, low, high)
    step = BESIDE * branch.length
    before, after = places - step, places + step
    if not branch.closed:
        before, after = np.maximum(before, 0.0), np.minimum(after, branch.length)
    beside = np.maximum(np.abs(function(before)), np.abs(function(after)))
    is_smooth = np.array([not gap.is_rough for gap in gaps])
    return places, is_smooth | is_event(np.abs(function(places)), beside)


def _ends_of(gaps: Sequence[_Gap]) -> tuple[np.ndarray, np.ndarray]:
    """Where the signs before and after each gap (k,) stand."""
    before = [gap.before.s for gap in gaps if gap.before is not None]
    after = [gap.after.s for gap in gaps if gap.after is not None]
    return np.array(before), np.array(after)


def _with_stretches(
    function: AlongCurve, gaps: Sequence[_Gap], zeros: Sequence[Zero], length: float
) -> list[Zero]:
    """The zeros in gaps, each with the stretch on which rounding hides the sign."""
    if not gaps:
        return []
    hidden = np.array([gap.rounding for gap in gaps])
    places = np.array([zero.s for zero in zeros])
    before, after = _ends_of(gaps)
    can_tell = np.abs(function(places)) < hidden
    low, high = places.copy(), places.copy()
    if np.any(can_tell):

        def beyond(s: np.ndarray) -> np.ndarray:
            excess: np.ndarray = np.abs(function(s)) - hidden[can_tell]
            return excess

        inner, precision = places[can_tell], NARROWEST * length
        low[can_tell] = bracketed_roots(beyond, before[can_tell], inner, precision)
        high[can_tell] = bracketed_roots(beyond, inner, after[can_tell], precision)
    return [
        zero._replace(low=float(first), high=float(last))
        for zero, first, last in zip(zeros, low, high, strict=True)
    ]


def _touches(gap: _Gap, branch: Branch) -> list[Zero]:
    """The zero in a gap without a change of sign; none where the function keeps zero."""
    low, high = gap.zeros[0].s, gap.zeros[-1].s
    begins_here = not branch.closed and low == 0.0
    ends_here = not branch.closed and high == branch.length
    if gap.is_held or (begins_here and ends_here):
        return []
    if begins_here:
        return [Zero(0.0, ZeroKind.END, low, high, 0.0)]
    if ends_here:
        return [Zero(branch.length, ZeroKind.END, low, high, 0.0)]
    if gap.before is None or gap.after is None:
        return []
    middle = 0.5 * (low + high)
    return [Zero(middle, ZeroKind.TOUCH, low, high, gap.after.sign)]


def _within_a_turn(zero: Zero, length: float) -> Zero:
    """The same zero of a closed curve with an arclength below its length."""
    s = zero.s % length
    shift = s - zero.s
    return zero._replace(s=s, low=zero.low + shift, high=zero.high + shift)
