"""Closed forms cut at the singular points that they pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_poly

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from linkages.rigorous import check


@dataclass(frozen=True)
class Pass:
    """Where a curve passes a singular point of an atlas, by its index: the arclength, and
    whole turns (n,) from the point to the curve."""

    point: int
    s: float
    turns: np.ndarray


@dataclass(frozen=True)
class Course:
    """A closed form that begins at its first singular point, with all its passes, the
    first one again at its end; none where it passes no such point."""

    name: str
    branch: Branch
    passes: list[Pass]
    texts: list[list[list[str]]]  # coefficients of the pieces, and of refined ones
    polynomials: list[list[arb_poly]]

    def piece_at(self, s: float) -> tuple[int, float]:
        """The piece that is used at an arclength, and the coordinate on it."""
        breaks = self.branch.breaks
        piece = int(np.searchsorted(breaks, s, side="right")) - 1
        piece = min(max(piece, 0), len(breaks) - 2)
        return piece, self.coordinate(piece, s)

    def coordinate(self, piece: int, s: float) -> float:
        """The coordinate of an arclength on a piece."""
        return float((s - self.branch.centers[piece]) / self.branch.radii[piece])

    def point(self, piece: int, x: arb) -> check.Vector:
        """The point at a coordinate of a piece."""
        return [angle(x) for angle in self.polynomials[piece]]

    def add_piece(self, texts: list[list[str]]) -> int:
        """Add a refined piece, its coefficients as they are written: its number."""
        self.texts.append(texts)
        self.polynomials.append([arb_poly(check.numbers(angle)) for angle in texts])
        return len(self.texts) - 1

    def values(self, used: set[int]) -> check.Json:
        """The curve in a certificate, the pieces that are not ``used`` there empty."""
        pieces = [text if k in used else [] for k, text in enumerate(self.texts)]
        return {"name": self.name, "pieces": pieces}


def course_of(atlas: Atlas, number: int) -> Course:
    """A form of an atlas, by its index, as a course; one that ends somewhere has no
    passes, and cannot be covered through the points on it."""
    form = atlas.forms[number]
    places = []
    for k, meeting in enumerate(atlas.points):
        places += [(s, k) for passing, s in meeting.passes if passing == number]
    places.sort()
    branch = form.branch
    passes = []
    if places and branch.closed:
        first, point = places[0]
        branch = branch.begun_at(first)
        for s, k in places:
            passes.append(_pass_at(atlas, k, s - first, branch(s - first)))
        passes.append(_pass_at(atlas, point, branch.length, branch.ends[1]))
    course = Course(form.name, branch, passes, [], [])
    for piece in np.swapaxes(branch.pieces, 1, 2).tolist():
        course.add_piece([[x.hex() for x in angle] for angle in piece])
    return course


def _pass_at(atlas: Atlas, point: int, s: float, u: np.ndarray) -> Pass:
    away = u - atlas.points[point].point.u
    return Pass(point, s, np.rint(away / (2 * np.pi)).astype(int))
