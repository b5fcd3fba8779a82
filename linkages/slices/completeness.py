"""What slices prove about the motions that were found: whether there is room for one
more; and the isolated assemblies.

In: the complete slices of every joint, and the traced motions. Out: how sure it is that
nothing is missing, why, and configurations from which what is missing might be reached.

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

An assembly that cannot move shows in no slice. The isolated ones are ends of 16 paths
(`linkages.slices.assemblies`), and what the paths lead to is handed on as starts.

All this is checked in doubles, without interval arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.completeness import Claim, Level, Scope
from bifurc.curves.monitor import dead_points
from bifurc.decisions import is_start_solved, is_tied
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.search.canonical_order import order_values
from bifurc.seeding import random_seeds
from bifurc.seeds import Audit, Seeds
from linkages.decisions import is_same_dead_point
from linkages.loop import Loop
from linkages.slices.assemblies import Assemblies, isolated_assemblies
from linkages.slices.elimination import LONGEST, Slice, slice_configurations
from linkages.slices.nonreal_tracking import Fold, find_fold, follow_sheets
from linkages.statements import (
    LinkageClaim,
    estimated,
    joint_names,
    random_assemblies,
)

# of every joint: any motion in which a joint turns by more than 15 degrees meets one
SLICES = 24
NEARLY_REAL = 0.2  # rad: imaginary parts of configurations whose real part is a start
FEWEST = 4  # joints that move on a motion, at least
CUT = 0.3819660112501051  # of its length: where a curve without dead points is cut
TURN = 2 * np.pi
SAMPLES = 64  # of a motion, to see whether it turns a joint


def slice_all_joints(loop: Loop, rng: np.random.Generator) -> SliceAudit | None:
    """Complete slices of every joint of a loop at evenly spaced angles, the first one
    drawn; None where it has too many joints for them."""
    if loop.n > LONGEST:
        return None
    first = rng.uniform(-np.pi, np.pi, loop.n)
    angles = first[:, None] + TURN / SLICES * np.arange(SLICES)
    slices = [
        slice_configurations(loop, joint, own) for joint, own in enumerate(angles, 1)
    ]
    return SliceAudit(loop, tuple(slices))


def sliced_seeds(
    loop: Loop,
    problem: Problem,
    rng: np.random.Generator,
    count: int,
    deadline: Deadline | None = None,
) -> Seeds:
    """Closed configurations to start from: complete slices of every joint of a 4R,
    5R or 6R loop, and what is reached from ``count`` random starts."""
    drawn = random_seeds(problem, rng, count, deadline=deadline)
    slices = slice_all_joints(loop, rng)
    if slices is None:
        return drawn
    near, gaps = problem.project(slices.nearly_real)
    closed = near[is_start_solved(gaps)]
    constructed = np.concatenate([slices.configurations, closed])
    is_random = np.zeros(len(constructed), dtype=bool)
    return replace(
        drawn,
        points=np.concatenate([constructed, drawn.points]),
        random=np.concatenate([is_random, drawn.random]),
        audit=slices,
    )


@dataclass(frozen=True)
class SliceAudit:
    """Slices of every joint of a loop, in order, to be held against the motions that
    were found."""

    loop: Loop
    slices: tuple[Slice, ...]

    @property
    def configurations(self) -> np.ndarray:
        """All real configurations (k, n) in the slices."""
        return np.concatenate([cut.configurations for cut in self.slices])

    @property
    def nearly_real(self) -> np.ndarray:
        """The real parts (k, n) of configurations in the slices that are nearly real: a
        small motion may be near."""
        nonreal = np.concatenate([cut.nonreal for cut in self.slices])
        largest = np.abs(nonreal.imag).max(axis=1, initial=0.0)
        nearly_real: np.ndarray = nonreal[largest < NEARLY_REAL].real
        return nearly_real

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """How sure it is that ``branches`` are all motions, and the isolated assemblies
        as starts.

        Where numbers leave room, the configurations that are not real are followed for
        about ``seconds``, and so are the paths to isolated assemblies: 0 is for numbers
        alone.
        """
        deadline = Deadline(seconds)
        motions = self._judge_motions(branches, deadline)
        if deadline.passed:
            return replace(motions, claims=(*motions.claims, random_assemblies()))
        assemblies = isolated_assemblies(self.loop, deadline.left)
        return _with_assemblies(motions, assemblies)

    def _judge_motions(self, branches: Sequence[Branch], deadline: Deadline) -> Audit:
        """How sure it is that ``branches`` are all motions."""
        nowhere = np.empty((0, self.loop.n))
        if not all(cut.is_complete for cut in self.slices):
            return Audit((self._incompleteness(),), nowhere)
        passes = self._passes(branches)
        differing = self._differing_joints(passes)
        if differing:
            joints = joint_names(differing)
            claim = estimated(LinkageClaim.SLICES_DIFFER, joints=joints)
            return Audit((claim,), nowhere)
        if not branches and not any(_number(cut) for cut in self.slices):
            claim = LinkageClaim.NO_MOTION.claim(Scope.MOTIONS, Level.COUNTED)
            return Audit((claim,), nowhere)
        room = self._room(passes)
        following = self._follow_nonreal(passes, room, deadline)
        starts = np.concatenate([nowhere, *following.halts])
        if len(following.room) >= FEWEST:
            return Audit((self._what_is_certified(following.room),), starts)
        return Audit((self._what_is_proved(following),), starts)

    def _passes(self, branches: Sequence[Branch]) -> list[Passes]:
        """How the motions pass the angles of every joint."""
        dead = [dead_points(branch) for branch in branches]
        extents = [np.ptp(branch.sample(SAMPLES), axis=0) for branch in branches]
        passes = []
        for joint in range(self.loop.n):
            motions = [
                (branch, of_branch[joint])
                for branch, of_branch, extent in zip(
                    branches, dead, extents, strict=True
                )
                if not is_same_dead_point(float(extent[joint]))
            ]
            passes.append(Passes.of_motions(self.loop.n, joint, motions))
        return passes

    def _differing_joints(self, passes: Sequence[Passes]) -> list[int]:
        """Joints (from 0) at some of whose angles the motions hold another number of
        configurations than the slices."""
        joints = []
        for of_joint, cut in zip(passes, self.slices, strict=True):
            if np.any(of_joint.count(cut.angles) != _real_numbers(cut)):
                joints.append(of_joint.joint)
        return joints

    def _room(self, passes: Sequence[Passes]) -> list[int]:
        """Joints (from 0) with room for one more motion, those with the narrowest room
        first."""
        widths = []
        for of_joint, cut in zip(passes, self.slices, strict=True):
            widths.append(of_joint.room(_number(cut)))
        joints = [joint for joint, width in enumerate(widths) if width > 0]
        room = np.array([widths[joint] for joint in joints])
        # a symmetry makes widths equal, and then rounding would decide
        return [joints[k] for k in order_values(room, is_tied.threshold)]

    def _follow_nonreal(
        self, passes: Sequence[Passes], room: Sequence[int], deadline: Deadline
    ) -> Following:
        """What following the configurations that are not real says of the joints with
        ``room``, one joint after the other, until too few are left for a motion, too
        many stay open or the time is over."""
        waiting = list(room)
        closed: list[int] = []
        halts: list[np.ndarray] = []
        open_count = 0
        while len(waiting) >= FEWEST and open_count < FEWEST and not deadline.passed:
            joint = waiting.pop(0)
            halted = _follow(self.loop, self.slices[joint], passes[joint], deadline)
            if halted is not None and not len(halted):
                closed.append(joint)
                continue
            waiting.append(joint)
            open_count += 1
            if halted is not None:
                halts.append(halted)
        return Following(room=sorted(waiting), closed=sorted(closed), halts=halts)

    # --- claims -----------------------------------------------------------------------

    def _incompleteness(self) -> Claim:
        degenerate = sum(int(np.count_nonzero(cut.degenerate)) for cut in self.slices)
        total = sum(len(cut.angles) for cut in self.slices)
        reason = next(cut.reason for cut in self.slices if cut.reason)
        kind = LinkageClaim.SLICES_INCOMPLETE
        return estimated(kind, degenerate=degenerate, slices=total, reason=reason)

    def _what_is_certified(self, room: Sequence[int]) -> Claim:
        degrees = 360 // min(len(cut.angles) for cut in self.slices)
        data = {
            "joints": self.loop.n,
            "degrees": degrees,
            "room": joint_names(room),
        }
        return LinkageClaim.SLICES.claim(Scope.MOTIONS, Level.CERTIFIED, **data)

    def _what_is_proved(self, following: Following) -> Claim:
        decided = {*following.room, *following.closed}
        counted = [joint for joint in range(self.loop.n) if joint not in decided]
        parts = []
        if counted:
            parts.append(
                f"of {joint_names(counted)} all configurations, real or not, lie on "
                "motions listed here"
            )
        if following.closed:
            parts.append(
                f"of {joint_names(following.closed)} those that do not lie on one "
                "never become real"
            )
        rest = ""
        if following.room:
            rest = f"; no motion turns {joint_names(following.room)} alone"
        counts = f"{', and '.join(parts)}{rest}"
        return LinkageClaim.COUNTED.claim(Scope.MOTIONS, Level.COUNTED, counts=counts)


def _with_assemblies(motions: Audit, assemblies: Assemblies) -> Audit:
    """The audit of motions with what is known of isolated assemblies."""
    claim = LinkageClaim.ALL_FOLLOWED.claim(Scope.ASSEMBLIES, Level.COUNTED)
    if not assemblies.complete:
        ends = assemblies.statement
        lost = LinkageClaim.PATHS_LOST
        claim = lost.claim(Scope.ASSEMBLIES, Level.CERTIFIED, ends=ends)
    starts = np.concatenate([motions.starts, assemblies.configurations])
    return Audit((*motions.claims, claim), starts)


class Following(NamedTuple):
    """What came of following configurations that are not real.

    ``room``: joints (from 0) that still have room for one more motion; ``closed``:
    joints of which it is proved that they have none; ``halts``: configurations (k, n)
    at which those of the others came to a halt.
    """

    room: list[int]
    closed: list[int]
    halts: list[np.ndarray]


# --- the motions that were traced -----------------------------------------------------


@dataclass(frozen=True)
class Passes:
    """How the traced motions pass the angles of one joint: stretches from ``low`` to
    ``high`` (k,), rad, between ``folds``, the configurations (q, n) at the dead
    points."""

    joint: int
    low: np.ndarray
    high: np.ndarray
    folds: np.ndarray

    @classmethod
    def of_motions(
        cls, n: int, joint: int, motions: Sequence[tuple[Branch, np.ndarray]]
    ) -> Passes:
        """From the motions of a loop of ``n`` joints that turn the joint, and the
        arclengths of their dead points in it."""
        low = [np.empty(0)]
        high = [np.empty(0)]
        folds = [np.empty((0, n))]
        for branch, dead in motions:
            angles = branch(_ends_of_stretches(branch, dead))[:, joint]
            low.append(np.minimum(angles[1:], angles[:-1]))
            high.append(np.maximum(angles[1:], angles[:-1]))
            folds.append(branch(dead))
        return cls(
            joint, np.concatenate(low), np.concatenate(high), np.concatenate(folds)
        )

    def count(self, angles: np.ndarray) -> np.ndarray:
        """Number (m,) of configurations on the motions at each of ``angles`` (m,)."""
        at = np.asarray(angles)[:, None]
        last = np.floor((self.high - at) / TURN)
        first = np.ceil((self.low - at) / TURN)
        times: np.ndarray = (last - first + 1).sum(axis=1).astype(int)
        return times

    @cached_property
    def critical(self) -> np.ndarray:
        """Angles in [0, 2 pi) between which the number is constant, in order."""
        angles = np.sort(np.concatenate([self.low, self.high]) % TURN)
        if len(angles) < 2:
            return angles
        steps = np.diff(angles, prepend=angles[-1:] - TURN)
        return angles[~is_same_dead_point(steps)]

    def room(self, number: int) -> float:
        """Total width (rad) of the arcs in which fewer than ``number`` configurations
        lie on the motions."""
        ends = self.critical if len(self.critical) else np.zeros(1)
        after = _following_angles(ends)
        counts = self.count(0.5 * (ends + after))
        return float((after - ends)[counts < number].sum())


def _ends_of_stretches(branch: Branch, dead: np.ndarray) -> np.ndarray:
    """Arclengths (k + 1,) between which a motion passes every angle of a joint once:
    its ``dead`` points and its ends."""
    if not branch.closed:
        return np.array([0.0, *dead, branch.length])
    # a closed curve is cut at its dead points alone: its start is on a slice, as a rule
    first = dead if len(dead) else np.array([CUT * branch.length])
    return np.concatenate([first, first[:1] + branch.length])


# --- following configurations that are not real ---------------------------------------


class Nonreal(NamedTuple):
    """The ``configurations`` (k, n) with a joint at an ``angle`` in [0, 2 pi) that are
    not real, one of every conjugate pair."""

    angle: float
    configurations: np.ndarray

    def at(self, joint: int, angle: float) -> np.ndarray:
        """The configurations with the joint at an ``angle`` full turns away."""
        configurations = self.configurations.copy()
        configurations[:, joint] = angle
        return configurations


def _nonreal(slices: Sequence[Slice]) -> list[Nonreal]:
    """Those of all slices of one joint, by their angles."""
    cuts = []
    for cut in slices:
        # of every conjugate pair one is enough
        is_upper = _largest_imaginary_parts(cut.nonreal) > 0
        for i, angle in enumerate((cut.angles % TURN).tolist()):
            own = is_upper & (cut.nonreal_index == i)
            cuts.append(Nonreal(angle, cut.nonreal[own]))
    return sorted(cuts, key=lambda one: one.angle)


def _follow(
    loop: Loop, cut: Slice, passes: Passes, deadline: Deadline
) -> np.ndarray | None:
    """Where (k, n) the followed configurations that are not real come to a halt,
    besides the known dead points.

    From every slice they are followed to the next one, or from both sides to the dead
    points in between. None where the slices do not hold equal numbers, so that some
    came from infinity.
    """
    more = _angles_between(passes.critical, cut.angles % TURN)
    slices = [cut, slice_configurations(loop, cut.joint, more)]
    number = _number(cut)
    if any(np.any(each.n_complex != number) for each in slices):
        return None
    folds = _known_folds(loop, passes)
    starts = [np.empty((0, loop.n), dtype=complex)]
    ends: list[float] = []
    near: list[list[Fold]] = []
    for sheets, end in _sheets(_nonreal(slices), passes):
        starts.append(sheets)
        ends += [end] * len(sheets)
        near += [_folds_at(end, passes.joint, folds)] * len(sheets)
    cleared, last = follow_sheets(
        loop, passes.joint, np.concatenate(starts), np.array(ends), near, deadline.left
    )
    halts: np.ndarray = last[~cleared].real
    return halts


def _known_folds(loop: Loop, passes: Passes) -> list[Fold]:
    """The folds of the traced motions whose neighbourhood is proved."""
    folds = []
    for configuration in passes.folds:
        fold = find_fold(loop, passes.joint, configuration)
        if fold is not None:
            folds.append(fold)
    return folds


def _sheets(cuts: list[Nonreal], passes: Passes) -> Iterator[tuple[np.ndarray, float]]:
    """Configurations (k, n), and the angle to which they are to be followed: from every
    one of the ``cuts`` to the next one, or from both sides to the critical angle in
    between."""
    joint = passes.joint
    after = [*cuts[1:], cuts[0]._replace(angle=cuts[0].angle + TURN)]
    for one, other in zip(cuts, after, strict=True):
        low, high = one.angle, other.angle
        is_inside = (passes.critical - low) % TURN < high - low
        if not np.any(is_inside):
            yield one.at(joint, low), high
            continue
        critical = low + (passes.critical[is_inside][0] - low) % TURN
        yield one.at(joint, low), critical
        yield other.at(joint, high), critical


def _folds_at(angle: float, joint: int, folds: Sequence[Fold]) -> list[Fold]:
    """The folds at which the joint has the ``angle``."""
    gaps = [fold.configuration[joint] - angle for fold in folds]
    return [
        fold
        for fold, gap in zip(folds, gaps, strict=True)
        if is_same_dead_point(abs(math.remainder(gap, TURN)))
    ]


def _angles_between(critical: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Angles that, with ``angles``, keep the ``critical`` ones apart."""
    if len(critical) < 2:
        return np.empty(0)
    middles = []
    for low, high in zip(critical, _following_angles(critical), strict=True):
        if not np.any((angles - low) % TURN < high - low):
            middles.append(0.5 * (low + high))
    return np.array(middles)


# --- small questions ------------------------------------------------------------------


def _following_angles(angles: np.ndarray) -> np.ndarray:
    """The next one (m,) of every one of the ``angles`` (m,) on the circle, in order."""
    return np.concatenate([angles[1:], angles[:1] + TURN])


def _largest_imaginary_parts(configurations: np.ndarray) -> np.ndarray:
    """Of every configuration (q, n) the imaginary part (q,) that is largest in size."""
    which = np.abs(configurations.imag).argmax(axis=1)[:, None]
    return np.take_along_axis(configurations.imag, which, axis=1)[:, 0]


def _real_numbers(cut: Slice) -> np.ndarray:
    """Number (m,) of real configurations at each angle of a slice."""
    return np.bincount(cut.index, minlength=len(cut.angles))


def _number(cut: Slice) -> int:
    """Number of configurations, real or not, at almost every angle."""
    return int(cut.n_complex.max(initial=0))
