"""What slices prove about the motions that were found: whether there is room for one
more.

In: the complete slices of every joint, and the traced motions. Out: how sure it is that
no motion is missing, why, and configurations from which a missing one might be reached.

The configurations with joint j at a given angle, real or not, number the same D_j at
all but finitely many angles: they lie on complex curves on which the joint moves, and
at an exceptional angle some of them meet or run to infinity. The slices count them. R_j
of them, a number that depends on the angle, lie on traced motions. A motion that is not
traced takes one more at every angle that joint j passes on it, so that joint j stays
where R_j < D_j: there is *room*. And it moves at least four joints: a chain of three
revolute joints closes rigidly unless two of its axes are one line, and two joints on
one line turn all the way round, through every slice. With room for at most three joints
no motion is missing.

Where there is room, the configurations that are not real can be followed from slice to
slice (`linkages.slices.nonreal_tracking`): no motion appears as long as none of them
becomes real but at the dead points of traced motions.

All this is checked in doubles, without interval arithmetic. It is about motions: an
assembly that cannot move shows in no slice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import dead_points
from bifurc.limits import Deadline
from bifurc.seeds import Audit
from linkages.loop import Loop
from linkages.slices.elimination import Slice, slice_configurations
from linkages.slices.nonreal_tracking import Fold, find_fold, follow_sheets

__all__ = ["SliceAudit"]

FEWEST = 4  # joints that move on a motion, at least
SAME = 1e-7  # rad: dead points at angles that agree to this are taken together
CUT = 0.3819660112501051  # of its length: where a curve without dead points is cut
TURN = 2 * np.pi


@dataclass(frozen=True)
class SliceAudit:
    """Slices of every joint of a loop, in order, to be held against the motions that
    were found."""

    loop: Loop
    slices: tuple[Slice, ...]

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """How sure it is that ``branches`` are all motions; where numbers leave room,
        the configurations that are not real are followed for about ``seconds``, so 0 is
        for numbers alone."""
        deadline = Deadline(seconds)
        nowhere = np.empty((0, self.loop.n))
        degenerate = sum(int(np.count_nonzero(s.degenerate)) for s in self.slices)
        if degenerate:
            reason, total = (
                next(s.reason for s in self.slices if s.reason),
                sum(len(s.angles) for s in self.slices),
            )
            text = (
                f"{degenerate} of {total} slices could not be made complete ({reason})"
            )
            return Audit("estimated", text, nowhere)
        dead = [dead_points(branch) for branch in branches]
        passes = [
            _Passes.of(joint, branches, [d[joint] for d in dead])
            for joint in range(self.loop.n)
        ]
        unlike = [
            j
            for j, s in enumerate(self.slices)
            if np.any(passes[j].count(s.angles) != _real(s))
        ]
        if unlike:
            text = f"at some angles of {_joints(unlike)} the slices and the motions hold different configurations"
            return Audit("estimated", text, nowhere)
        width = [p.room(_number(s)) for p, s in zip(passes, self.slices, strict=True)]
        room = sorted(
            (j for j in range(self.loop.n) if width[j] > 0), key=lambda j: (width[j], j)
        )
        starts, closed, open_still = [nowhere], [], 0
        while len(room) >= FEWEST and open_still < FEWEST and not deadline.passed:
            joint = room.pop(0)
            halted = _follow(
                self.loop, self.slices[joint], passes[joint], deadline.left
            )
            if halted is None or len(halted):
                room.append(joint)
                open_still += 1
                starts += [] if halted is None else [halted]
            else:
                closed.append(joint)
        if not branches and not any(_number(s) for s in self.slices):
            return Audit(
                "proved",
                "there is no motion: no angle of any joint but a few has a configuration",
                nowhere,
            )
        return Audit(
            "certified" if len(room) >= FEWEST else "proved",
            self._says(room, closed),
            np.concatenate(starts),
        )

    def _says(self, room: list[int], closed: list[int]) -> str:
        """What is proved when there is room for the joints ``room``, after others were
        ``closed`` by following."""
        degrees = 360 // min(len(s.angles) for s in self.slices)
        if len(room) >= FEWEST:
            return (
                f"complete slices of all {self.loop.n} joints every {degrees} degrees: every motion in which some "
                f"joint turns by more than {degrees} degrees is here; a smaller one has room in {_joints(sorted(room))}"
            )
        counted = [j for j in range(self.loop.n) if j not in room and j not in closed]
        parts = []
        if counted:
            parts.append(
                f"of {_joints(counted)} all configurations, real or not, lie on motions listed here"
            )
        if closed:
            parts.append(
                f"of {_joints(sorted(closed))} those that do not lie on one never become real"
            )
        rest = f"; no motion turns {_joints(sorted(room))} alone" if room else ""
        return f"no motion is missing: at every angle {', and '.join(parts)}{rest}"


@dataclass(frozen=True)
class _Passes:
    """How the traced motions pass the angles of one joint: stretches from ``low`` to
    ``high`` (k,), rad, between ``folds``, the configurations (q, n) at the dead
    points."""

    joint: int
    low: np.ndarray
    high: np.ndarray
    folds: np.ndarray

    @classmethod
    def of(
        cls, joint: int, branches: Sequence[Branch], turning: Sequence[np.ndarray]
    ) -> _Passes:
        """From the motions and the arclengths ``turning`` of their dead points in the
        joint."""
        low, high, folds = [], [], [np.empty((0, branches[0].n if branches else 0))]
        for branch, dead in zip(branches, turning, strict=True):
            if np.ptp(branch.sample(64)[:, joint]) < SAME:
                continue
            # a closed curve is cut at its dead points alone: its start is on a slice,
            # as a rule
            first = dead if len(dead) else np.array([CUT * branch.length])
            ends = (
                np.append(first, first[0] + branch.length)
                if branch.closed
                else [0.0, *dead, branch.length]
            )
            angles = branch(np.asarray(ends))[:, joint]
            low.append(np.minimum(angles[1:], angles[:-1]))
            high.append(np.maximum(angles[1:], angles[:-1]))
            folds.append(branch(dead))
        return cls(
            joint,
            np.concatenate([[], *low]),
            np.concatenate([[], *high]),
            np.concatenate(folds),
        )

    def count(self, angles: np.ndarray) -> np.ndarray:
        """Number (m,) of configurations on the motions at each of ``angles`` (m,)."""
        at = np.asarray(angles)[:, None]
        times = np.floor((self.high - at) / TURN) - np.ceil((self.low - at) / TURN) + 1
        return times.sum(axis=1).astype(int)

    @property
    def critical(self) -> np.ndarray:
        """Angles in [0, 2 pi) between which the number is constant, in order."""
        angles = np.sort(np.concatenate([self.low, self.high]) % TURN)
        return (
            angles[np.diff(angles, prepend=angles[-1:] - TURN) > SAME]
            if len(angles) > 1
            else angles
        )

    def room(self, number: int) -> float:
        """Total width (rad) of the arcs in which fewer than ``number`` configurations
        lie on the motions."""
        ends = self.critical if len(self.critical) else np.zeros(1)
        after = np.append(ends[1:], ends[0] + TURN)
        return float((after - ends)[self.count(0.5 * (ends + after)) < number].sum())


def _follow(
    loop: Loop, cut: Slice, passes: _Passes, seconds: float
) -> np.ndarray | None:
    """Where (k, n) the followed configurations that are not real come to a halt,
    besides the known dead points.

    From every slice they are followed to the next one, or from both sides to the dead
    points in between. None where the slices do not hold equal numbers, so that some
    came from infinity.
    """
    critical = passes.critical
    cuts = [
        cut,
        slice_configurations(loop, cut.joint, _between(critical, cut.angles % TURN)),
    ]
    if any(np.any(s.n_complex != _number(cut)) for s in cuts):
        return None
    angles = np.concatenate([s.angles for s in cuts]) % TURN
    index = np.concatenate(
        [cuts[0].nonreal_index, len(cut.angles) + cuts[1].nonreal_index]
    )
    nonreal = np.concatenate([s.nonreal for s in cuts])
    largest = np.take_along_axis(
        nonreal, np.abs(nonreal.imag).argmax(axis=1)[:, None], axis=1
    )[:, 0]
    index, nonreal = (
        index[largest.imag > 0],
        nonreal[largest.imag > 0],
    )  # of every conjugate pair one is enough
    order = np.argsort(angles)
    edges = np.append(angles[order], angles[order[0]] + TURN)
    found = [find_fold(loop, passes.joint, u) for u in passes.folds]
    starts: list[np.ndarray] = []
    ends: list[float] = []
    folds: list[list[Fold]] = []
    for number, (a, b) in enumerate(pairwise(edges)):
        inside = critical[(critical - a) % TURN < b - a]
        stop = a + (inside[0] - a) % TURN if len(inside) else b
        near, sides = [], [(order[number], a)]
        if len(inside):
            near = [
                f
                for f in found
                if f is not None and _apart(f.configuration[passes.joint], stop) < SAME
            ]
            sides.append((order[(number + 1) % len(order)], b))
        for which, edge in sides:
            for z in nonreal[index == which]:
                z = z.copy()
                z[passes.joint] = edge
                starts.append(z)
                ends.append(stop)
                folds.append(near)
    begun = np.array(starts).reshape(-1, loop.n)
    cleared, last = follow_sheets(
        loop, passes.joint, begun, np.array(ends), folds, seconds
    )
    return last[~cleared].real


def _between(critical: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Angles that, with ``angles``, keep the ``critical`` ones apart."""
    if len(critical) < 2:
        return np.empty(0)
    after = np.append(critical[1:], critical[0] + TURN)
    apart = [
        not np.any((angles - a) % TURN < b - a)
        for a, b in zip(critical, after, strict=True)
    ]
    return (0.5 * (critical + after))[apart]


def _apart(a: float, b: float) -> float:
    """Distance of two angles."""
    return abs((a - b + np.pi) % TURN - np.pi)


def _real(cut: Slice) -> np.ndarray:
    """Number (m,) of real configurations at each angle of a slice."""
    return np.bincount(cut.index, minlength=len(cut.angles))


def _number(cut: Slice) -> int:
    """Number of configurations, real or not, at almost every angle."""
    return int(cut.n_complex.max(initial=0))


def _joints(numbers: Sequence[int]) -> str:
    """Joints, counted from 0, in words."""
    names = [str(j + 1) for j in numbers]
    return (
        f"joint {names[0]}"
        if len(names) == 1
        else f"joints {', '.join(names[:-1])} and {names[-1]}"
    )
