"""Recognising and naming the forms of a linkage from samples along them.

A name comes, in this order, from the source's own equations (`FormPattern`), from the
joints that stand still while the others turn as a smaller linkage, or from the order of
the forms. None of it depends on where on a closed form the samples begin, on their
direction, or on whether the angles are wrapped.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkages.entry import FormPattern
from linkages.families.four_bar import form_patterns
from linkages.loop import GeometryError, Loop, loop_from_axes

__all__ = ["FormIdentity", "identify_form", "name_forms"]

RESIDUAL_TOLERANCE = 1e-8
ANGLE_TOLERANCE = 1e-7  # rad
GEOMETRY_TOLERANCE = 1e-7  # relative to the characteristic length


@dataclass(frozen=True)
class FormIdentity:
    """What a form is: its name, the joints that stand still (from 1) and their angles
    (rad), its symmetry.

    ``name`` is empty where nothing is recognised; ``symmetry`` is an equation such as
    "theta_i = theta_{i+3}", or empty.
    """

    name: str
    inactive_joints: tuple[int, ...]
    inactive_angles: tuple[float, ...]
    symmetry: str


def identify_form(
    samples: np.ndarray, loop: Loop, patterns: Sequence[FormPattern] = ()
) -> FormIdentity:
    """The identity of the form that passes through ``samples`` (m, n), rad.

    ``patterns`` are those of the catalogue entry, in order of preference; one matches
    when its residual stays below 1e-8 at every sample. Raises `GeometryError` for
    samples of another shape.
    """
    theta = np.asarray(samples, dtype=float)
    if theta.ndim != 2 or theta.shape[1] != loop.n or not len(theta):
        raise GeometryError(
            "shape of the samples", theta.shape, f"(m, {loop.n}) with m >= 1"
        )
    inactive, angles = _inactive_joints(theta)
    name = _name_by_pattern(theta, (*patterns, *_planar_patterns(loop)))
    return FormIdentity(
        name or _name_by_inactive_joints(theta, loop, inactive),
        inactive,
        angles,
        _symmetry(theta),
    )


def name_forms(
    forms: Sequence[np.ndarray], loop: Loop, patterns: Sequence[FormPattern] = ()
) -> list[FormIdentity]:
    """The identities of several forms (each (m, n), rad), in their order, with names
    that are all different.

    Forms that share a name get letters, "Form I a (original)" and so on, forms without
    a name "Form 1", "Form 2"; letters and numbers follow the mean directions of the
    joint angles along the form.
    """
    found = [identify_form(samples, loop, patterns) for samples in forms]
    keys = [_signature(np.asarray(samples, dtype=float)) for samples in forms]
    for name in {identity.name for identity in found}:
        members = sorted(
            (i for i, f in enumerate(found) if f.name == name), key=lambda i: keys[i]
        )
        for rank, i in enumerate(members):
            if not name:
                found[i] = replace(found[i], name=f"Form {rank + 1}")
            elif len(members) > 1:
                found[i] = replace(found[i], name=_lettered(name, rank))
    return found


def _lettered(name: str, rank: int) -> str:
    letter = chr(ord("a") + rank) if rank < 26 else str(rank + 1)
    head, bracket, tail = name.partition(" (")
    return f"{head} {letter}{bracket}{tail}"


def _wrapped(angle: np.ndarray) -> np.ndarray:
    """``angle`` in (-pi, pi], with -pi and its rounding errors turned to pi."""
    out = np.arctan2(np.sin(angle), np.cos(angle))
    return np.where(out < -np.pi + 1e-9, out + 2 * np.pi, out)


def _inactive_joints(theta: np.ndarray) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Joints (from 1) that keep their angle modulo 2 pi, and these angles in (-pi,
    pi]."""
    mean = np.angle(np.exp(1j * theta).mean(axis=0))
    still = np.all(np.abs(_wrapped(theta - mean)) < ANGLE_TOLERANCE, axis=0)
    at = _wrapped(mean)
    return tuple(int(i) + 1 for i in np.flatnonzero(still)), tuple(
        float(at[i]) for i in np.flatnonzero(still)
    )


def _symmetry(theta: np.ndarray) -> str:
    """The equation between all angles and those some joints further on, or nothing;
    half the loop first."""
    n = theta.shape[1]
    shifts = [k for k in range(n // 2, 0, -1) if n % k == 0 or 2 * k == n]
    for k in shifts:
        for sign, mark in ((1, ""), (-1, "-")):
            difference = np.sin((theta - sign * np.roll(theta, -k, axis=1)) / 2)
            if np.abs(difference).max() < ANGLE_TOLERANCE:
                return f"theta_i = {mark}theta_{{i+{k}}}"
    return ""


def _name_by_pattern(theta: np.ndarray, patterns: Sequence[FormPattern]) -> str:
    for pattern in patterns:
        if np.abs(pattern.residual(theta)).max() < RESIDUAL_TOLERANCE:
            return pattern.name
    return ""


def _planar_patterns(loop: Loop) -> tuple[FormPattern, ...]:
    """Patterns that need no catalogue entry: those of a planar four-bar with lengths
    alike in pairs."""
    lengths, twists, offsets = loop.arrays
    if loop.n != 4 or np.any(twists != 0) or np.any(offsets != 0):
        return ()
    mean = lengths.mean()
    a, b, c, d = (float(x) for x in np.round(lengths / mean, 9))
    return form_patterns(a, b, c, d)


def _name_by_inactive_joints(
    theta: np.ndarray, loop: Loop, inactive: tuple[int, ...]
) -> str:
    moving = loop.n - len(inactive)
    if not inactive:
        return ""
    if not moving:
        return "rigid assembly"
    where = f"joint{'s' * (len(inactive) > 1)} {','.join(map(str, inactive))} inactive"
    if moving != 4:
        return f"{moving}R form ({where})"
    kind, set_up = _four_bar_kind(theta, loop, inactive)
    return f"{kind}4R form ({where}){set_up}"


def _four_bar_kind(
    theta: np.ndarray, loop: Loop, inactive: tuple[int, ...]
) -> tuple[str, str]:
    """Which 4R the four moving joints make, ("Bennett ", " asymmetric") for one, or two
    empty words."""
    frames = loop.frames(theta[0])[:-1]
    active = [i for i in range(loop.n) if i + 1 not in inactive]
    try:
        reduced, _ = loop_from_axes(
            frames[active, :3, 3].tolist(), frames[active, :3, 2].tolist()
        )
    except GeometryError:  # two of the axes coincide
        return "", ""
    lengths, twists, offsets = reduced.arrays
    small = GEOMETRY_TOLERANCE * loop.characteristic_length
    if np.all(np.abs(np.sin(twists)) < GEOMETRY_TOLERANCE):
        return "planar ", ""
    if np.all(np.abs(np.concatenate([lengths, offsets])) < small):
        return "spherical ", ""
    opposite = [np.abs(v[:2] - v[2:]).max() for v in (lengths, np.exp(1j * twists))]
    if (
        np.abs(offsets).max() > small
        or opposite[0] > small
        or opposite[1] > GEOMETRY_TOLERANCE
    ):
        return "", ""
    cross = lengths[1] * np.sin(twists[0]), lengths[0] * np.sin(twists[1])
    for sign, set_up in ((1, " asymmetric"), (-1, " line-symmetric")):
        if abs(cross[0] - sign * cross[1]) < small:
            return "Bennett ", set_up
    return "", ""


def _signature(theta: np.ndarray) -> tuple[float, ...]:
    """Means of cosines and sines along the closed form, weighted by arc length, to four
    decimals."""
    step = np.linalg.norm(_wrapped(np.roll(theta, -1, axis=0) - theta), axis=1)
    weight = step + np.roll(step, 1)
    weight = (
        weight / weight.sum()
        if weight.sum() > 0
        else np.full(len(theta), 1 / len(theta))
    )
    means = np.concatenate([weight @ np.cos(theta), weight @ np.sin(theta)])
    return tuple(float(-x) + 0.0 for x in np.round(means, 4))
