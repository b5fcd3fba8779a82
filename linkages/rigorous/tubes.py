"""Boxes along a curve, each as long as the check allows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from flint import arb

from bifurc.limits import is_time_over
from linkages.rigorous import check
from linkages.rigorous.check import DoesNotHold
from linkages.rigorous.courses import Course
from linkages.rigorous.selection import best_rows, floats_of

REACH = 1 / 16  # of a box across, in its length
OVERLAP = 1 / 32  # of neighbouring boxes, in their length
LONGEST, SHORTEST = 0.5, 1e-7  # boxes, in arclength
MOST = 0.9  # contraction of a box: closer to 1 the enclosure is wide
EASY = 0.5  # contraction below which the next box may be longer
SETTLED = 1.5  # so much larger an inverse may be for the same equations to be solved


@dataclass
class Cover:
    """Boxes from the begin of a part of a curve on: their ``values`` in the certificate,
    the arclength that they reach, and why they end there if that is not the end."""

    values: list[check.Json] = field(default_factory=list)
    boxes: list[check.Box] = field(default_factory=list)
    reached: float = 0.0
    reason: str = ""


def cover(
    loop: check.Loop, course: Course, begin: float, end: float, order: int
) -> Cover:
    """Boxes from one arclength of a curve to another, as far as they hold."""
    made = Cover(reached=begin)
    length = LONGEST
    rows: list[int] = []
    while made.reached < end:
        if is_time_over():
            made.reason = "the time was over"
            break
        piece, _ = course.piece_at(made.reached)
        goal = min(end, float(course.branch.breaks[piece + 1]))
        rest = goal - made.reached
        step = rest if rest <= length else min(length, rest / 2)
        try:
            values, box = _make(loop, course, piece, made.reached, step, rows, order)
            check.require(box.contraction < MOST, "the left inverse hardly contracts")
            _require_joint(made, box)
        except DoesNotHold as reason:
            length = step / 2
            made.reason = str(reason)
            if length < SHORTEST:
                break
            continue
        made.reason = ""
        made.values.append(values)
        made.boxes.append(box)
        made.reached = goal if step == rest else made.reached + step
        rows = values[4]
        if box.contraction < EASY:
            length = min(LONGEST, max(length, 1.5 * step))
    return made


def _require_joint(made: Cover, box: check.Box) -> None:
    if made.boxes:
        nowhere = [arb(0)] * len(box.normal)
        overlap = check.do_overlap(made.boxes[-1], box, nowhere)
        check.require(overlap, "boxes do not overlap")


def _make(
    loop: check.Loop,
    course: Course,
    piece: int,
    begin: float,
    step: float,
    rows: list[int],
    order: int,
) -> tuple[check.Json, check.Box]:
    """A box, as it stands in the certificate and as it is checked."""
    low = course.coordinate(piece, begin - OVERLAP * step)
    high = course.coordinate(piece, begin + (1 + OVERLAP) * step)
    reach = REACH * step
    middle = course.branch(begin + step / 2)
    slope = course.branch(begin + step / 2, 1)
    jacobian = floats_of(loop.at([arb(x) for x in middle]).jacobian)
    rows = best_rows(jacobian, slope[None], rows, SETTLED)
    polynomial = course.polynomials[piece]
    place = check.Piece(polynomial, arb(low), arb(high), arb(reach), rows)
    box = check.make_box(loop, place, order)
    return [piece, low.hex(), high.hex(), reach.hex(), rows], box
