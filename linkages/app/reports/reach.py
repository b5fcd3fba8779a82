"""How far joints reach along a form, and what ends their ranges.

An extreme value of a joint variable is where its rate is zero on the polynomials of a
form, or where the form ends. Within narrower limits a form falls into stretches.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.decisions import is_same_point
from bifurc.diagrams.zeros import zeros_along
from linkages.decisions import keeps_angle
from linkages.readout.ranges import turns_of_middles
from linkages.subject import Subject, subject_at

SAMPLES = 400  # of a form, by which it is seen what stands still
FULL_TURN = 2.0 * np.pi


class EndKind(Enum):
    """What ends the range of a joint variable."""

    # It turns back, and goes on the other way.
    DEAD_POINT = "dead point"
    # It turns back at a singular point, or the form ends there.
    SINGULAR_POINT = "singular point"
    # A joint variable comes to its limit.
    LIMIT = "limit"
    # The form was followed no further.
    NOT_FOLLOWED = "not followed further"


@dataclass(frozen=True)
class RangeEnd:
    """The ``value`` of a joint variable (rad, the user's unit) where its range ends, at
    arclength ``s``; ``by`` names the singular point or the variable at its limit."""

    value: float
    s: float
    kind: EndKind
    by: str = ""


@dataclass(frozen=True)
class JointReach:
    """From where to where a joint variable goes on a stretch of a form; no ends where it
    turns fully, so many ``turns``, or stands still at a ``value``."""

    label: str
    is_angle: bool
    low: RangeEnd | None = None
    high: RangeEnd | None = None
    turns: int = 0
    value: float | None = None


@dataclass(frozen=True)
class Stretch:
    """A part of a form, from arclength ``first`` to ``last``, or all of it, with what each
    joint variable reaches."""

    form: int
    first: float
    last: float
    reaches: tuple[JointReach, ...]


class _Variable(NamedTuple):
    """A joint variable: ``rate`` times the unknown of this ``column``, plus ``offset``,
    in rad and the user's unit."""

    label: str
    column: int
    rate: float
    offset: float
    is_angle: bool

    def at(self, unknown: float) -> float:
        """Its value where the unknown has this one."""
        return self.rate * unknown + self.offset

    def of(self, value: float) -> float:
        """The unknown where it has this value."""
        return (value - self.offset) / self.rate


def reach_along(
    atlas: Atlas, form: int, limits: Mapping[str, tuple[float, float]]
) -> list[Stretch]:
    """The stretches of a form, by index, on which variables stay within ``limits``, by
    label, angles (rad) up to whole turns; all of it without any."""
    return _FormReach(atlas, form, limits).stretches()


def variable_labels(atlas: Atlas) -> dict[str, bool]:
    """What joint variables are called, and whether each is an angle."""
    return {one.label: one.is_angle for one in _variables(subject_at(atlas))}


def _variables(subject: Subject) -> list[_Variable]:
    """The joint variables that unknowns are or lead."""
    readout = subject.readout
    if readout is None:
        return [
            _Variable(label, k, 1.0, 0.0, True)
            for k, label in enumerate(subject.labels)
        ]
    structure = readout.structure
    variables = []
    for number, one in enumerate(readout.mechanism.variables):
        share = structure.share(number)
        if share is not None:
            unit = 1.0 if one.motion.is_turn else structure.unit
            rate, offset = unit * share.rate, unit * share.offset
            is_angle = one.motion.is_turn
            variables.append(_Variable(one.label, share.column, rate, offset, is_angle))
    return variables


class _Cut(NamedTuple):
    """Where a stretch begins or ends, and why."""

    s: float
    kind: EndKind
    by: str


class _FormReach:
    """A form with what cuts it."""

    def __init__(
        self, atlas: Atlas, form: int, limits: Mapping[str, tuple[float, float]]
    ):
        self.atlas, self.form, self.limits = atlas, form, limits
        self.branch: Branch = atlas.forms[form].branch
        self.subject = subject_at(atlas)
        self.variables = _variables(self.subject)

    def stretches(self) -> list[Stretch]:
        """The stretches, in order."""
        if self.branch.closed:
            cuts = sorted(self._limit_cuts())
            if not cuts:
                inside = self._is_inside(0.0)
                return [self._stretch(None, None)] if inside else []
            again = cuts[0]._replace(s=cuts[0].s + self.branch.length)
            cuts = [*cuts, again]
        else:
            first, last = (self._end(s) for s in (0.0, self.branch.length))
            cuts = [first, *sorted(self._limit_cuts()), last]
        return [
            self._stretch(before, after)
            for before, after in pairwise(cuts)
            if after.s > before.s and self._is_inside(0.5 * (before.s + after.s))
        ]

    # --- where it is cut --------------------------------------------------------------

    def _limit_cuts(self) -> list[_Cut]:
        """Where variables come to the limits."""
        cuts = []
        for one in self.variables:
            if one.label not in self.limits:
                continue
            for value in self.limits[one.label]:
                for s in self._at_value(one, value):
                    cuts.append(_Cut(s, EndKind.LIMIT, one.label))
        return cuts

    def _at_value(self, one: _Variable, value: float) -> list[float]:
        """The arclengths at which a variable has a value, an angle up to whole turns."""

        def gap(s: np.ndarray) -> np.ndarray:
            away = one.rate * self.branch(s)[:, one.column] + one.offset - value
            return np.sin(0.5 * away) if one.is_angle else away

        zeros = zeros_along(self.branch, gap, is_measured=False).zeros
        return [zero.s for zero in zeros]

    def _is_inside(self, s: float) -> bool:
        """Whether all variables are within the limits."""
        point = self.branch(s)
        for one in self.variables:
            low, high = self.limits.get(one.label, (-np.inf, np.inf))
            value = one.at(float(point[one.column]))
            if one.is_angle and np.isfinite(low):
                value = low + (value - low) % FULL_TURN
            if not low <= value <= high:
                return False
        return True

    def _end(self, s: float) -> _Cut:
        """Why an open form ends at an arclength."""
        name = self._singular_point(s)
        if name:
            return _Cut(s, EndKind.SINGULAR_POINT, name)
        point, scale = (
            self.branch(s),
            float(np.ptp(self.branch.ends, axis=0).max()) or 1.0,
        )
        bounds = self.subject.closure.domain.bounds
        for one in self.variables:
            gaps = np.abs(point[one.column] - bounds[one.column])
            if is_same_point(float(gaps.min()), scale):
                return _Cut(s, EndKind.LIMIT, one.label)
        return _Cut(s, EndKind.NOT_FOLLOWED, self.branch.outcome.value)

    def _singular_point(self, s: float) -> str:
        """The name of the singular point that the form passes at an arclength; empty
        where it passes none."""
        length = self.branch.length
        for point in self.atlas.points:
            for form, at in point.passes:
                gap = abs(at - s)
                if self.branch.closed:
                    gap = min(gap % length, -gap % length)
                if form == self.form and is_same_point(gap, length):
                    return point.name
        return ""

    # --- what is reached --------------------------------------------------------------

    def _stretch(self, first: _Cut | None, last: _Cut | None) -> Stretch:
        begin = 0.0 if first is None else first.s
        end = self.branch.length if last is None else last.s
        ends = [cut for cut in (first, last) if cut is not None]
        reaches = [self._reach(one, begin, end, ends) for one in self.variables]
        return Stretch(self.form, begin, end, tuple(reaches))

    def _reach(
        self, one: _Variable, begin: float, end: float, cuts: Sequence[_Cut]
    ) -> JointReach:
        """What a variable reaches from an arclength to another one."""
        samples = self.branch(np.linspace(begin, end, SAMPLES))[:, one.column]
        if keeps_angle(float(np.ptp(samples))):
            value = one.at(float(samples[0]))
            return JointReach(one.label, one.is_angle, value=value)
        turns = round(one.rate * float(self.branch.winding[one.column]))
        if turns and not cuts:
            return JointReach(one.label, one.is_angle, turns=abs(turns))
        ends = [self._at_cut(one, cut) for cut in cuts]
        ends += self._turnings(one, begin, end)
        ends.sort(key=lambda each: each.value)
        low, high = ends[0], ends[-1]
        if one.is_angle:
            middle = np.array([0.5 * (low.value + high.value)])
            away = float(turns_of_middles(middle, np.array([FULL_TURN]))[0])
            low, high = (_turned_back(each, away) for each in (low, high))
        return JointReach(one.label, one.is_angle, low, high)

    def _turnings(self, one: _Variable, begin: float, end: float) -> list[RangeEnd]:
        """Where a variable turns back between two arclengths, of which the last may be
        beyond the end of a closed form."""
        laps = (0.0, self.branch.length) if self.branch.closed else (0.0,)
        return [
            self._turning(one, s + lap)
            for s in self.branch.turning_points(one.column).tolist()
            for lap in laps
            if begin < s + lap < end
        ]

    def _value(self, one: _Variable, s: float) -> float:
        # beyond the end of a closed form it goes on by whole turns
        return one.at(float(self.branch(s)[one.column]))

    def _at_cut(self, one: _Variable, cut: _Cut) -> RangeEnd:
        return RangeEnd(self._value(one, cut.s), cut.s, cut.kind, cut.by)

    def _turning(self, one: _Variable, s: float) -> RangeEnd:
        name = self._singular_point(s % self.branch.length)
        kind = EndKind.SINGULAR_POINT if name else EndKind.DEAD_POINT
        return RangeEnd(self._value(one, s), s, kind, name)


def _turned_back(end: RangeEnd, turns: float) -> RangeEnd:
    value = end.value - turns * FULL_TURN
    return RangeEnd(value, end.s, end.kind, end.by)
