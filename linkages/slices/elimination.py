"""Complete slices: every real configuration of a closed 4R, 5R or 6R loop with one
joint angle given.

The elimination. With joint k held, n - 1 joints remain, with fixed links G between
their axes (one of them is the pair of links at joint k). In unit dual quaternions the
closure reads ``Z_1 G_1 ... Z_m G_m = +-1``, Z = cos(theta/2) + k sin(theta/2), m = n -
1. Split it as

    Z_a G_a Z_b  =  +- conj(G_v) conj(Z_v)
                       [conj(G_d) conj(Z_d) conj(G_c) conj(Z_c) conj(G_b)]

Either side runs through a space of only four dimensions (of eight): with G = G' + G'',
the parts that commute and anticommute with k, ``Z_a G Z_b = exp(k (a + b)/2) G' + exp(k
(a - b)/2) G''`` is ``x G' + y G''`` with complex x, y (k the imaginary unit) and |x| =
|y|. Projecting the right side on what the left one cannot reach leaves ``(cos(v/2) M_0
+ sin(v/2) M_1) y = 0``, a 4 x 4 eigenvalue problem for the joint v: at most four
values, real or complex. Its null vectors with |x| = |y| on both sides are all
configurations of the slice. That is the dialytic elimination of Raghavan and Roth
(1993) with the linear spaces of 2R chains of Husty, Pfurner and Schrocker (2007) in
place of the 14 equations. There are five choices of v: a symmetric geometry makes some
of them singular for every slice, so the most regular one is taken. A 5R loop needs no
v, a 4R loop has a single joint on the right.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from linkages import _core
from linkages.loop import Loop
from linkages.values import GeometryError

SHORTEST = 4  # joints of a loop that is sliced
LONGEST = 6


class _Status(IntEnum):
    """What came of one slice. The compiled elimination returns the numbers."""

    COMPLETE = 0
    CONTINUUM = 1
    UNDECIDED = 2


REASONS = {
    _Status.CONTINUUM: (
        "a whole motion lies in the slice; some of its configurations are returned"
    ),
    _Status.UNDECIDED: (
        "every elimination is singular (axes all parallel, concurrent or coincident, "
        "or a whole motion in the slice); what Gauss-Newton found is returned"
    ),
}


@dataclass(frozen=True)
class Slice:
    """Configurations of a loop in which joint ``joint`` (from 1) has one of the
    ``angles`` (m,), rad.

    ``configurations`` (p, n) rad in (-pi, pi]; ``index`` (p,): the entry of ``angles``
    each belongs to; ``closure`` (p,): largest entry of T_1 ... T_n - I, lengths in
    characteristic lengths; ``n_complex`` (m,): number of finite configurations, real or
    complex, or -1 where ``degenerate`` (m,): there the list is not complete, and
    ``reason`` says why (empty if there is none). ``nonreal`` (q, n), complex, are the
    finite configurations that are not real, conjugates included, ``nonreal_index`` (q,)
    their entries of ``angles``.
    """

    joint: int
    angles: np.ndarray
    configurations: np.ndarray
    index: np.ndarray
    closure: np.ndarray
    n_complex: np.ndarray
    degenerate: np.ndarray
    reason: str
    nonreal: np.ndarray
    nonreal_index: np.ndarray

    @property
    def is_complete(self) -> bool:
        """True when no slice is degenerate: no configuration with these angles is
        missing."""
        return not np.any(self.degenerate)

    def at(self, i: int) -> np.ndarray:
        """Configurations (q, n), rad, of ``angles[i]``."""
        of_angle: np.ndarray = self.configurations[self.index == i]
        return of_angle


def slice_configurations(loop: Loop, joint: int, angles: np.ndarray) -> Slice:
    """All real configurations of ``loop`` with joint ``joint`` (from 1) at each of
    ``angles`` (m,), rad.

    Raises `GeometryError` for a loop of more than six joints, a joint that it does not
    have, and angles that are not a list of finite numbers.
    """
    angles = np.atleast_1d(np.asarray(angles, dtype=float))
    _check(loop, joint, angles)
    configurations, index, closure, nonreal, nonreal_index, statuses = (
        _core.slice_configurations(loop.link_geometry, joint - 1, angles)
    )
    is_complete = statuses == _Status.COMPLETE
    numbers = np.bincount(index, minlength=len(angles))
    nonreal_numbers = np.bincount(nonreal_index, minlength=len(angles))
    return Slice(
        joint=joint,
        angles=angles,
        configurations=configurations,
        index=index,
        closure=closure,
        n_complex=np.where(is_complete, numbers + nonreal_numbers, -1),
        degenerate=~is_complete,
        reason=_reason(statuses),
        nonreal=nonreal,
        nonreal_index=nonreal_index,
    )


def _check(loop: Loop, joint: int, angles: np.ndarray) -> None:
    if not SHORTEST <= loop.n <= LONGEST:
        raise GeometryError("number of joints of a sliced loop", loop.n, "4, 5 or 6")
    if not 1 <= joint <= loop.n:
        raise GeometryError("joint", joint, f"from 1 to {loop.n}")
    if angles.ndim != 1 or not np.all(np.isfinite(angles)):
        raise GeometryError("angles", angles, "a list of finite numbers")


def _reason(statuses: np.ndarray) -> str:
    """Why slices are not complete, and how many; empty where all are."""
    reasons: list[str] = []
    if (statuses == _Status.COMPLETE).all():
        return ""
    for status, text in REASONS.items():
        count = np.sum(statuses == status)
        if count:
            reasons.append(f"{count} of {len(statuses)} slices: {text}")
    return "; ".join(reasons)
