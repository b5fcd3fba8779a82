"""Boxes along a curve, each as long as the check allows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from flint import arb

from bifurc.limits import is_time_over
from linkages.rigorous import check
from linkages.rigorous.check import DoesNotHold
from linkages.rigorous.courses import Course
from linkages.rigorous.refinement import refined_piece
from linkages.rigorous.selection import best_rows, floats_of

ALONG, ACROSS = 0.7, 0.1  # of a contraction of 1 that a box takes along and across
# How far boxes overlap, in lengths: by more than the slack of a reach, which is an eighth
# of a length at most.
BEFORE, BEHIND = 2.0**-5, 2.0**-7
LONGEST = 0.5  # box, in arclength
SHORTEST = 2.0**-12  # box, in the length that it may have to first order
LONGER = 1.2  # by so much in first order after one that holds
MOST_LONGER = 16.0  # than the box before: they have to overlap
MOST = 0.9  # contraction of a box: closer to 1 the enclosure is wide
DIGITS = 14  # that the remainder of a series on a box is to leave out
LOWEST, HIGHEST = 4, 16  # orders of such a series
FINE = 1e-13  # F where a curve in doubles passes: a reach has to be larger by F'^-1
FINE_ORDER = 40  # of the series on refined pieces
SETTLED = 1.5  # so much larger an inverse may be for the same equations to be solved


@dataclass
class Cover:
    """Boxes from the begin of a part of a curve on: their ``values`` in the certificate,
    the arclengths at which they end, the last one, and why they end there if that is not the end."""

    begin: float
    values: list[check.Json] = field(default_factory=list)
    boxes: list[check.Box] = field(default_factory=list)
    ends: list[float] = field(default_factory=list)
    reached: float = 0.0
    reason: str = ""

    def add(self, values: check.Json, box: check.Box, reached: float) -> None:
        """Add a box that holds, up to an arclength."""
        self.values.append(values)
        self.boxes.append(box)
        self.ends.append(reached)
        self.reached = reached
        self.reason = ""


def cover(loop: check.Loop, course: Course, begin: float, end: float) -> Cover:
    """Boxes from one arclength of a curve to another, as far as they hold."""
    made = Cover(begin, reached=begin)
    rows: list[int] = []
    last = 0.0  # length: a closed curve may end narrowly
    shorter = 1.0  # than they may be to first order
    while made.reached < end:
        if is_time_over():
            made.reason = "the time was over"
            break
        piece, _ = course.piece_at(made.reached)
        goal = min(end, float(course.branch.breaks[piece + 1]))
        rest = goal - made.reached
        sizes = _sizes(loop, course, made.reached, rows)
        length = shorter * min(sizes.length, LONGEST, MOST_LONGER * (last or LONGEST))
        step = rest if rest <= length else min(length, rest / 2)
        try:
            values, box = _make(loop, course, made.reached, step, last, sizes)
            check.require(box.contraction < MOST, "the left inverse hardly contracts")
            _require_joint(made, box)
        except DoesNotHold as reason:
            made.reason = str(reason)
            shorter = shorter * step / length / 2
            if shorter < SHORTEST:
                break
            continue
        made.add(values, box, goal if step == rest else made.reached + step)
        rows, last = sizes.rows, step
        shorter = min(1.0, LONGER * shorter)
    return made


def _require_joint(made: Cover, box: check.Box) -> None:
    if made.boxes:
        nowhere = [arb(0)] * len(box.normal)
        overlap = check.do_overlap(made.boxes[-1], box, nowhere)
        check.require(overlap, "boxes do not overlap")


@dataclass(frozen=True)
class _Sizes:
    """How large a box at a place may be, to first order: the equations that are solved,
    its length and its reach; whether that ``is_fine`` beside what doubles leave."""

    rows: list[int]
    length: float
    reach: float
    is_fine: bool


def _sizes(loop: check.Loop, course: Course, s: float, rows: Sequence[int]) -> _Sizes:
    """Sizes at an arclength, where the equations in ``rows`` were solved before it."""
    at_place = loop.at(check.arb_vector(course.branch(s)))
    slope = course.branch(s, 1)
    jacobian = at_place.jacobian
    chosen = best_rows(floats_of(jacobian), slope[None], rows, SETTLED)
    normal = check.arb_vector(slope)
    matrix = check.stacked(check.rows_of(jacobian, chosen), normal)
    inverse = check.approximate_inverse(matrix)
    frame = check.Frame(inverse)
    rates = []
    for direction in (normal, [check.ball(arb(1))] * loop.n):
        bend = check.rows_of(at_place.second(direction), chosen)
        change = inverse * check.stacked(bend, [arb(0)] * loop.n)
        rates.append(max(float(frame.norm(change)), 1e-300))
    length, reach = 2 * ALONG / rates[0], ACROSS / rates[1]
    if reach > FINE * float(check.norm(inverse)):
        return _Sizes(chosen, length, reach, is_fine=False)
    return _Sizes(chosen, length / 2, reach, is_fine=True)


def _make(
    loop: check.Loop,
    course: Course,
    begin: float,
    step: float,
    last: float,
    sizes: _Sizes,
) -> tuple[check.Json, check.Box]:
    """A box of a length, after one of the ``last`` length, as it stands in the
    certificate and as it is checked."""
    first = begin - BEFORE * min(step, last)
    end = begin + (1 + BEHIND) * step
    reach = min(sizes.reach, step / 8)
    rows = sizes.rows
    if sizes.is_fine:
        piece = refined_piece(loop, course, (first + end) / 2, (end - first) / 2)
        low, high, order = -1.0, 1.0, FINE_ORDER
    else:
        piece, _ = course.piece_at(begin)
        low, high = course.coordinate(piece, first), course.coordinate(piece, end)
        half = min((high - low) / 2, 0.5)
        order = min(max(math.ceil(-DIGITS / math.log10(half)), LOWEST), HIGHEST)
    polynomial = course.polynomials[piece]
    place = check.Piece(polynomial, arb(low), arb(high), arb(reach), rows, order)
    box = check.make_box(loop, place)
    return [piece, low.hex(), high.hex(), reach.hex(), rows, order], box
