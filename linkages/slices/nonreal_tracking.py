"""Non-real configurations followed from slice to slice, with a proof at every step that
they stay non-real.

In: configurations of a loop with one joint angle given, that are not real, and the
angles to follow them to. Out: which of them get there without becoming real, and where
the others come to a halt.

At a closed configuration z the closure is ``F(z + d) = 2 vec(exp(d_1 s_1 / 2) ...
exp(d_n s_n / 2))`` with the joint screws s_i at z as dual quaternions, for complex
angles as for real ones. Its first derivatives are the screws, its second ones half
their brackets, and at a distance of at most r its second derivatives differ from those
at z by at most ``2 m_i m_j (exp(m r) - 1)``, where m_i bounds the multiplication by s_i
/ 2 and m is the norm of the m_i. Let a be a row that singles out one solution for every
value t of a.d, and P what the first six columns of the pseudo-inverse of [F'; a] are.
All that bounds the second derivative of P F by a number w. In the ball of radius rho, w
rho <= 1/2, there is at most one solution for every t, and it stays within ``w |d|^2 /
2`` of the tangent, in a norm that weighs the joints (the theorem of Newton and
Kantorovich for an implicit function: Ortega and Rheinboldt 1970, 12.6; Deuflhard 2004,
4.4). With the angle of the given joint as t, no configuration on the way is real where
the imaginary part of one joint is larger than that.

A pair of conjugate configurations becomes real at a fold, where the joint has a dead
point. Around a fold that is known the complex solutions in a ball are one curve, t
along its tangent, on which one pair meets: a sheet that comes so close is of that pair.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkages import _core
from linkages.loop import Loop
from linkages.values import GeometryError

SHORTEST, LONGEST = 4, 6  # joints of a loop whose sheets are followed


@dataclass(frozen=True)
class Fold:
    """A dead point of a joint on a known motion, and the neighbourhood in which only
    its own pair of sheets meets.

    A configuration that is less than ``along`` from it in the direction of ``tangent``
    (n,), less than ``away`` in all, each joint divided by its ``weight`` (n,), and less
    than ``across`` in the angle of the joint is one of the pair.
    """

    configuration: np.ndarray
    tangent: np.ndarray
    weight: np.ndarray
    away: float
    along: float
    across: float


def follow_sheets(
    loop: Loop,
    joint: int,
    starts: np.ndarray,
    ends: np.ndarray,
    folds: Sequence[Sequence[Fold]],
    seconds: float = np.inf,
) -> tuple[np.ndarray, np.ndarray]:
    """Follow the closed configurations ``starts`` (k, n), complex, as joint ``joint``
    (from 0) turns to ``ends`` (k,).

    The joint's own angle is real. A sheet ends well where it gets to its end without
    becoming real or joins one of its ``folds``. Returns which do (k,), and where each
    one stopped (k, n): all do when the ``seconds`` are over. Raises `GeometryError` for
    a loop of another number of joints than 4, 5 or 6.
    """
    _check(loop, joint)
    of_sheets = [fold for of_sheet in folds for fold in of_sheet]
    shapes = [(one.configuration, one.tangent, one.weight) for one in of_sheets]
    limits = [(one.away, one.along, one.across) for one in of_sheets]
    cleared, last = _core.follow_sheets(
        geometry=loop.link_geometry,
        joint=joint,
        starts=np.asarray(starts, dtype=complex),
        ends=np.asarray(ends, dtype=float),
        shapes=np.array(shapes).reshape(-1, 3, loop.n),
        limits=np.array(limits).reshape(-1, 3),
        # sheet k may join the folds from number first[k] to first[k + 1]
        near=np.arange(len(of_sheets)),
        first=np.cumsum([0, *map(len, folds)]),
        seconds=seconds,
    )
    return cleared, last


def find_fold(loop: Loop, joint: int, configuration: np.ndarray) -> Fold | None:
    """The neighbourhood of a dead point (n,) of joint ``joint`` (from 0); None where
    none can be proved.

    Where the second term of the series of the angle exceeds the rest by m on a circle,
    every angle nearer than m to that of the dead point is taken twice within (Rouche).
    Raises `GeometryError` as `follow_sheets` does.
    """
    _check(loop, joint)
    fold = _core.find_fold(loop.link_geometry, joint, configuration)
    if fold is None:
        return None
    return Fold(np.array(configuration, dtype=float), *fold)


def _check(loop: Loop, joint: int) -> None:
    if not SHORTEST <= loop.n <= LONGEST:
        raise GeometryError("number of joints of a followed loop", loop.n, "4, 5 or 6")
    if not 0 <= joint < loop.n:
        raise GeometryError("joint", joint, f"from 0 to {loop.n - 1}")
