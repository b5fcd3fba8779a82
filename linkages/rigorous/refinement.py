"""A part of a curve in more digits than doubles have, where its derivative nearly loses
rank: there a tube is narrower than doubles are exact."""

from __future__ import annotations

import numpy as np
from flint import arb, arb_mat, arb_poly

from linkages.rigorous import check
from linkages.rigorous.courses import Course
from linkages.rigorous.selection import best_rows, floats_of

ORDER = 24  # of the polynomial
DIGITS = 32  # of its coefficients
MOST_STEPS = 80
SOLVED = 1e-28


def refined_piece(loop: check.Loop, course: Course, s: float, half: float) -> int:
    """A new piece of a course about an arclength, from -1 to 1 over twice the ``half``
    length: its number. F(c(x)) vanishes on it as far as its order lets it, by the chord
    method in series in x."""
    number, x = course.piece_at(s)
    scale = half / float(course.branch.radii[number])
    local = [angle(arb_poly([x, scale])) for angle in course.polynomials[number]]
    curve = [_coefficients(angle) for angle in local]
    curve = _solved(loop, curve, course.branch(s, 1))
    return course.add_piece(
        [[c.str(DIGITS, radius=False) for c in angle] for angle in curve]
    )


def _solved(
    loop: check.Loop, curve: list[check.Vector], slope: np.ndarray
) -> list[check.Vector]:
    """The coefficients of a curve with a direction, corrected."""
    jacobian = loop.at([angle[0] for angle in curve]).jacobian
    rows = best_rows(floats_of(jacobian), slope[None])
    matrix = check.stacked(check.rows_of(jacobian, rows), check.arb_vector(slope))
    inverse = check.approximate_inverse(matrix).tolist()
    of_rows = arb_mat([line[:-1] for line in inverse])
    for _ in range(MOST_STEPS):
        series = loop.series([arb_poly(angle) for angle in curve], ORDER)
        values = arb_mat([series[row] for row in rows])
        step = (of_rows * values).tolist()
        curve = [
            [(c - dc).mid() for c, dc in zip(angle, change, strict=True)]
            for angle, change in zip(curve, step, strict=True)
        ]
        if check.norm(values) < SOLVED:
            break
    return curve


def _coefficients(angle: arb_poly) -> check.Vector:
    coefficients = [c.mid() for c in angle.coeffs()][: ORDER + 1]
    return coefficients + [arb(0)] * (ORDER + 1 - len(coefficients))
