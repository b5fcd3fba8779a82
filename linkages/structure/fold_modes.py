"""All ways out of the flat state of a sheet of vertices of four creases or fewer, to
leading order.

The equations of leading order about such a vertex (`linkages.structure.flat_sheet`) hold
along at most two lines of fold angles, its modes. A sheet takes one mode, or rests, at
each vertex, such that the angles of every crease agree at both ends. What folds together
with one freedom is a way; others are made of several that have no crease in common.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bifurc.limits import is_time_over
from linkages.decisions import is_no_fold
from linkages.structure.flat_sheet import FlatVertex, forms_of

MOST_WAYS = 1000
MOST_ANGLES = 5_000_000  # that are written down on the way to them


class _State(NamedTuple):
    """The ``angles`` of creases so far, by number; the vertices that are ``decided``,
    and those that are ``waiting``, as one of their creases folds."""

    angles: dict[int, float]
    decided: frozenset[int]
    waiting: tuple[int, ...]


def ways_by_modes(
    vertices: Sequence[FlatVertex], signs: np.ndarray
) -> np.ndarray | None:
    """Fold angles (w, v) of all ways, the largest 1 in size, each crease of the ``signs``
    (v,) or free; None where a vertex has more creases or no modes that are told apart,
    and where there are too many ways."""
    modes = [_modes(vertex) for vertex in vertices]
    if any(lines is None for lines in modes):
        return None
    choice = _Choice(vertices, [lines for lines in modes if lines is not None], signs)
    ways: list[np.ndarray] = []
    written = 0
    for first in range(len(vertices)):
        states = [_State({}, frozenset(), (first,))]
        while states:
            state = states.pop()
            written += 1 + len(state.angles)
            if len(ways) > MOST_WAYS or written > MOST_ANGLES:
                return None
            if is_time_over():
                return None
            if state.waiting:
                states += choice.continued(state, first)
            else:
                ways.append(choice.angles(state))
    return np.array(ways).reshape(-1, len(signs))


class _Choice:
    """Which of the ``modes`` (r, d) is chosen at each of the ``vertices``."""

    def __init__(
        self,
        vertices: Sequence[FlatVertex],
        modes: Sequence[np.ndarray],
        signs: np.ndarray,
    ):
        self.vertices, self.modes, self.signs = vertices, modes, signs
        self.ends: dict[int, list[int]] = {}
        for k, vertex in enumerate(vertices):
            for number in vertex.variables:
                self.ends.setdefault(number, []).append(k)

    def continued(self, state: _State, first: int) -> Iterator[_State]:
        """The states with a mode more, at the first of the vertices that wait; none
        where that is one of those before the ``first``, which rest."""
        at, *waiting = state.waiting
        if at < first:
            return
        if at in state.decided:
            yield state._replace(waiting=tuple(waiting))
            return
        numbers = self.vertices[at].variables
        known = np.array([state.angles.get(number, np.nan) for number in numbers])
        for mode in self.modes[at]:
            scale = _scale(mode, known)
            if scale is None:
                continue
            angles = state.angles | dict(
                zip(numbers, (scale * mode).tolist(), strict=True)
            )
            if not self._is_of_one_sense(angles):
                continue
            moving = [number for number in numbers if angles[number] != 0.0]
            others = {end for number in moving for end in self.ends[number]} - {at}
            decided = state.decided | {at}
            yield _State(angles, decided, (*waiting, *sorted(others)))

    def angles(self, state: _State) -> np.ndarray:
        """Those of all creases (v,), of the signs."""
        angles = np.zeros(len(self.signs))
        angles[list(state.angles)] = list(state.angles.values())
        sense = -1.0 if (angles * self.signs < 0.0).any() else 1.0
        folds: np.ndarray = sense * angles / np.abs(angles).max()
        return folds

    def _is_of_one_sense(self, angles: dict[int, float]) -> bool:
        senses = np.array(list(angles.values())) * self.signs[list(angles)]
        return not senses.min(initial=0.0) < 0.0 < senses.max(initial=0.0)


def _scale(mode: np.ndarray, known: np.ndarray) -> float | None:
    """What a mode (d,) is multiplied with to have the angles (d,) that are ``known``,
    others NaN; 1 where none is, None where nothing does."""
    is_known = ~np.isnan(known)
    if not np.array_equal(mode[is_known] == 0.0, known[is_known] == 0.0):
        return None
    moves = is_known & (mode != 0.0)
    if not moves.any():
        return 1.0
    scales = known[moves] / mode[moves]
    if not is_no_fold(float(np.ptp(scales) / np.abs(scales).max())):
        return None
    return float(scales[0])


def _modes(vertex: FlatVertex) -> np.ndarray | None:
    """The modes (r, d) of a vertex; None where they are more than lines, or one of them
    is double."""
    directions = vertex.directions
    _, sizes, right = np.linalg.svd(directions.T)
    basis = right[int(np.count_nonzero(~is_no_fold(sizes))) :]
    forms = forms_of(directions, basis, basis)
    if len(basis) < 2:
        single: np.ndarray = basis[forms.diagonal() == 0.0]
        return single
    if len(basis) > 2:
        return None
    first, mixed, last = forms[0, 0], forms[0, 1], forms[1, 1]
    discriminant = mixed**2 - first * last
    if is_no_fold(abs(discriminant)):
        return None
    if discriminant < 0.0:
        return np.empty((0, len(directions)))
    root = -mixed - np.copysign(np.sqrt(discriminant), mixed)
    lines = np.array([[root, first], [last, root]]) @ basis
    lines /= np.abs(lines).max(axis=1, keepdims=True)
    modes: np.ndarray = np.where(is_no_fold(np.abs(lines)), 0.0, lines)
    return modes
