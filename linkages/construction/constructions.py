"""Construction methods: new overconstrained loops from old ones.

Every method of the sources is made of two steps. Two loops are laid on each other along
links that they share, and the shared links are removed (`superpose`); this needs the
shared joints, if any, to turn alike in both loops. Then a joint that has become free is
locked at a kink angle, and its two links are replaced by the one link between the outer
axes (`lock`, by the spatial triangle of `composite_link`).

summation and subtraction: `superpose` along one link, `lock` straight or folded
common link-pair: `superpose` along two links
common Bennett-linkage: `superpose` with links exchanged
kink angle: `lock` at any angle
hybrid on a common joint axis: `share_joint`

Sources: Goldberg (1943); Waldron (1968); Wohlhart (1991a, 1991b); Baker (1993a); Song
and Chen (2012).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkages.construction.conditions import decided, require_equal
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, sin
from linkages.construction.spatial_triangle import Kink, KinkAngle, composite_link
from linkages.loop import Loop
from linkages.values import GeometryError

EQUAL = 1e-9  # relative difference up to which two links count as the same one


def lock(loop: Loop, joint: int, kink: KinkAngle = Kink.STRAIGHT) -> Loop:
    """``loop`` with ``joint`` (1 to n) locked at ``kink``: one joint fewer, the pair of
    links now one.

    The new loop keeps the order of the other joints; joint 1 is the first that is left.
    """
    links = _links(loop)
    offsets = list(loop.offsets)
    i = _index(loop, joint)
    new = composite_link(links[i - 1], links[i], kink, offsets[i])
    offsets[i - 1] += new.before.offset
    offsets[(i + 1) % loop.n] += new.after.offset
    links[i - 1] = new.link
    del links[i], offsets[i]
    return _loop(links, offsets, loop)


def locked_angles(
    loop: Loop, joint: int, kink: KinkAngle, theta: np.ndarray
) -> np.ndarray:
    """Joint angles (..., n - 1) of ``lock(loop, joint, kink)`` for configurations
    ``theta`` (..., n), rad.

    The entry of the locked joint is not read.
    """
    links = _links(loop)
    i = _index(loop, joint)
    new = composite_link(links[i - 1], links[i], kink, loop.offsets[i])
    out = np.array(theta, dtype=float)
    out[..., i - 1] += float(new.before.angle)
    out[..., (i + 1) % loop.n] += float(new.after.angle)
    return np.delete(out, i, axis=-1)


def ending_with(loop: Loop, *links: Link) -> Loop:
    """``loop`` relabelled, and read the other way round if need be, so that its last
    links are these.

    Raises `GeometryError` when they do not follow each other in the loop.
    """
    for direction in (loop, loop.reversed()):
        for shift in range(loop.n):
            reading = direction.relabelled(shift)
            last = _links(reading)[-len(links) :]
            if len(last) == len(links) and all(map(_is_same, last, links)):
                return reading
    names = ", ".join(f"{link.length}/{link.twist}" for link in links)
    raise GeometryError(
        "shared links",
        names,
        "neighbouring links of the loop, in this order or reversed",
    )


def superpose(first: Loop, second: Loop, shared: int = 1) -> Loop:
    """The loop left of two loops that lie on each other with their last ``shared``
    links, removed.

    Relabel the loops so that the common links are the last ones of both, in the same
    order. The result follows ``first`` from its joint 1, and comes back along
    ``second``; it has n + m - 2 shared joints, the first and the last common axis being
    joints 1 and n - shared + 1. With one common link it has two degrees of freedom
    until one of these is locked; with more, the common inner joints must turn alike.
    `ending_with` reads a loop so that given links come last. Raises `GeometryError`
    when the common links or the offsets of their inner joints differ.
    """
    a = _links(first)
    b = _links(second)
    n = first.n - shared
    m = second.n - shared
    for k in range(1, shared + 1):
        _refuse_different(a[-k], b[-k], f"shared link {first.n + 1 - k}")
    for k in range(1, shared):
        gap = first.offsets[-k] - second.offsets[-k]
        name = f"offset of shared joint {first.n + 1 - k}, difference"
        _refuse_offset(gap, name, first)
    start = first.offsets[0] - second.offsets[0]
    end = first.offsets[n] - second.offsets[m]
    back = [-offset for offset in second.offsets[m - 1 : 0 : -1]]
    offsets = [start, *first.offsets[1:n], end, *back]
    return _loop([*a[:n], *b[:m][::-1]], offsets, first, second)


def share_joint(
    first: Loop,
    second: Loop,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
    shift: Number = 0,
) -> Loop:
    """The hybrid of two loops with a common axis, joint 1 of both: n + m - 2 joints.

    The last link of ``first`` and the first of ``second`` are locked at ``kink_1``
    (rad, or a `Kink`), the last of ``second`` and the first of ``first`` at ``kink_2``;
    ``shift`` leads along the axis from the last link of ``first`` to the first link of
    ``second``. The result starts with joint 2 of ``first``. On a configuration the
    angles of the two joints 1 add up to the sum of the kinks. Source: Waldron (1968).
    """
    a = _links(first)
    b = _links(second)
    n = first.n
    rest = first.offsets[0] + second.offsets[0] - shift
    forth = composite_link(a[-1], b[0], kink_1, shift)
    back = composite_link(b[-1], a[0], kink_2, rest)
    offsets = [*first.offsets[1:], *second.offsets[1:]]
    offsets[n - 2] += forth.before.offset
    offsets[n - 1] += forth.after.offset
    offsets[-1] += back.before.offset
    offsets[0] += back.after.offset
    links = [*a[1:-1], forth.link, *b[1:-1], back.link]
    return _loop(links, offsets, first, second)


def _links(loop: Loop) -> list[Link]:
    return [Link(a, alpha) for a, alpha in zip(loop.lengths, loop.twists, strict=True)]


def _loop(links: list[Link], offsets: list[Number], *sources: Loop) -> Loop:
    """The loop of these links, known as well as the loops that they come from are."""
    rounding = max(loop.rounding for loop in sources)
    return replace(closed_chain(*links, offsets=offsets), rounding=rounding)


def _index(loop: Loop, joint: int) -> int:
    if not 1 <= joint <= loop.n:
        raise GeometryError("joint", joint, f"from 1 to {loop.n}")
    return joint - 1


def _is_same(one: Link, other: Link) -> bool:
    try:
        _refuse_different(one, other, "link")
    except GeometryError:
        return False
    return True


def _refuse_different(one: Link, other: Link, name: str) -> None:
    require_equal(
        f"length of {name}", other.length, one.length, "its length in the other loop"
    )
    gap = decided(sin((one.twist - other.twist) / 2))
    if gap is not None and abs(gap) > EQUAL:
        raise GeometryError(f"twist of {name}, difference", f"{2 * gap:.6g} rad", "0")


def _refuse_offset(value: Number, name: str, loop: Loop) -> None:
    amount = decided(value)
    if amount is not None and abs(amount) > EQUAL * loop.characteristic_length:
        raise GeometryError(name, f"{amount:.6g}", "0")
