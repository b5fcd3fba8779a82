"""The plane hexagons into which a table of the doubly collapsible octahedron may
fold."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

__all__ = ["collapsible_hexagons"]

LOOSE = 0.05  # of the perimeter: a hexagon that misses itself by more is not one


def collapsible_hexagons(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Corners and radii for `linkages.families.bricard_collapsible`, from a table (3,
    6) in normal form without lengths.

    The offsets are the sides of the hexagon C' A B C A' B', the twists its turns,
    modulo pi and in either sense; of all choices those are laid out that close. The
    centre of the circles lies on a bisector of the sides that meet at A and one of
    those that meet at A'.
    """
    lengths, twists, sides = form
    sides = np.abs(sides)
    if lengths.max() > 1e-3 * sides.max() or sides.min() == 0:
        return
    choices = np.array(
        list(itertools.product(*([t, t - np.pi, -t, np.pi - t] for t in twists[:5])))
    )
    heading = np.concatenate(
        [np.zeros((len(choices), 1)), np.cumsum(choices, axis=1)], axis=1
    )
    steps = sides * np.exp(1j * heading)
    gaps = np.abs(steps.sum(axis=1)) / sides.sum()
    nearest = np.argsort(gaps)[:8]
    for k in nearest[gaps[nearest] < LOOSE]:
        corners = np.concatenate([[0], np.cumsum(steps[k])[:5]])  # C', A, B, C, A', B'
        yield from _circles(corners)


def _circles(corners: np.ndarray) -> Iterator[dict[str, float]]:
    a, b, c, a_opposite, b_opposite = corners[1:]
    for sign, sign_opposite in itertools.product((1, 1j), repeat=2):
        # bisectors of the angle at A between AB and AB', and at A' between A'B and A'B'
        first = sign * _bisector(b - a, b_opposite - a)
        second = sign_opposite * _bisector(b - a_opposite, b_opposite - a_opposite)
        cross = (np.conj(first) * second).imag
        if abs(cross) < 1e-9:
            continue
        centre = a + first * (np.conj(a_opposite - a) * second).imag / cross
        radii = [_distance(centre, a, b), _distance(centre, a, c)]
        for mirror in (1, -1):
            p, q = a - centre, a_opposite - centre
            yield {
                "x1": float(p.real),
                "y1": mirror * float(p.imag),
                "x2": float(q.real),
                "y2": mirror * float(q.imag),
                "radius_1": radii[0],
                "radius_2": radii[1],
            }


def _bisector(u: complex, v: complex) -> complex:
    total = u / abs(u) + v / abs(v)
    return total / abs(total) if abs(total) > 1e-9 else 1j * u / abs(u)


def _distance(point: complex, first: complex, second: complex) -> float:
    """Distance of a point from the line through two others."""
    side = second - first
    return float(abs((np.conj(side) * (point - first)).imag) / abs(side))
