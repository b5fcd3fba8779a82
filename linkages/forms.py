"""Recognising and naming the forms of a linkage from samples along them.

A name comes, in this order, from the source's own equations (`FormPattern`), from the
joints that stand still while the others turn as a smaller linkage, or from the order of
the forms. None of it depends on where on a closed form the samples begin, on their
direction, or on whether the angles are wrapped.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bifurc import torus
from bifurc.decisions import Decision, unit_over_rounding
from bifurc.search.canonical_order import order_rows
from linkages.axes import loop_from_axes
from linkages.decisions import (
    has_symmetry,
    is_alike_in_geometry,
    is_same_length,
    is_symmetric_to_rounding,
    keeps_angle,
    matches_pattern,
)
from linkages.entry import FormPattern
from linkages.families.four_bar import form_patterns
from linkages.labels import FormLabels, Symmetry
from linkages.loop import Loop
from linkages.values import GeometryError

OF_SAMPLES = 1e-4  # what the choice of samples makes of a mean along a form
FEW = 8  # samples at which an equation is tried first: most do not hold there
LETTERS = "abcdefghijklmnopqrstuvwxyz"


@dataclass(frozen=True)
class FormIdentity:
    """What a form is: its ``name``, empty where nothing is recognised, its ``labels``, in
    which the closure error is left open, and its ``asymmetry``: the largest sine of half
    of what angles miss of the symmetry in the labels, 0 where that is rounding."""

    name: str
    labels: FormLabels
    asymmetry: float = 0.0


@dataclass(frozen=True)
class FourBarKind:
    """Which 4R four joints make, such as "Bennett", and its ``setup`` where it has
    two; empty words where it is none with a name."""

    word: str = ""
    setup: str = ""

    def form_name(self, inactive: str) -> str:
        """The name of a form that moves as this 4R, ``inactive`` being the words for
        the joints that stand still."""
        kind = f"{self.word} 4R" if self.word else "4R"
        name = f"{kind} form ({inactive})"
        return f"{name} {self.setup}" if self.setup else name


def identify_form(
    samples: np.ndarray,
    loop: Loop,
    patterns: Sequence[FormPattern] = (),
    by_rounding: float = 0.0,
) -> FormIdentity:
    """The identity of the form that passes through ``samples`` (m, n), rad.

    ``patterns`` are those of the catalogue entry, in order of preference; one matches
    when its residual stays below 1e-4 at every sample. A joint stands still if its
    angle changes by less than 1e-8, or than what may come ``by_rounding`` where that is
    more. Raises `GeometryError` for samples of another shape.
    """
    theta = np.asarray(samples, dtype=float)
    if theta.ndim != 2 or theta.shape[1] != loop.n or not len(theta):
        allowed = f"(m, {loop.n}) with m >= 1"
        raise GeometryError("shape of the samples", theta.shape, allowed)
    symmetry, asymmetry = _symmetry(theta, by_rounding)
    labels = replace(_labels(theta, by_rounding), symmetry=symmetry)
    name = _name_by_pattern(theta, (*patterns, *_planar_patterns(loop)))
    if not name:
        name = _name_by_inactive_joints(theta, loop, labels.inactive_joints)
    return FormIdentity(name, labels, asymmetry)


def name_forms(
    forms: Sequence[np.ndarray],
    loop: Loop,
    patterns: Sequence[FormPattern] = (),
    by_rounding: Sequence[float] = (),
) -> list[FormIdentity]:
    """The identities of several forms (each (m, n), rad), in their order, with names
    that are all different.

    Forms that share a name get letters, "Form I a (original)" and so on, forms without
    a name "Form 1", "Form 2"; letters and numbers follow the mean directions of the
    joint angles along the form, and between forms that these do not tell apart the
    order in which they stand. ``by_rounding`` are the changes of an angle along the
    forms that rounding may make, none if they are not given.
    """
    changes = by_rounding or [0.0] * len(forms)
    identities = [
        identify_form(samples, loop, patterns, change)
        for samples, change in zip(forms, changes, strict=True)
    ]
    names = [identity.name for identity in identities]
    in_order = list(range(len(forms)))
    if len(set(names)) < len(names):
        in_order = _in_order(forms)
    distinct = list(identities)
    for name in set(names):
        alike = [i for i in in_order if names[i] == name]
        for rank, i in enumerate(alike):
            own = _distinct_name(name, rank, len(alike))
            distinct[i] = replace(identities[i], name=own)
    return distinct


def _distinct_name(name: str, rank: int, count: int) -> str:
    """The name of form number ``rank`` (from 0) of the ``count`` that share ``name``:
    with a letter, or with a number where it is empty."""
    if not name:
        return f"Form {rank + 1}"
    if count == 1:
        return name
    letter = LETTERS[rank] if rank < len(LETTERS) else str(rank + 1)
    head, bracket, tail = name.partition(" (")
    return f"{head} {letter}{bracket}{tail}"


# --- labels ---------------------------------------------------------------------------


def _labels(theta: np.ndarray, by_rounding: float) -> FormLabels:
    """The joints that keep their angle modulo 2 pi, and these angles in (-pi, pi]."""
    full_turns = _full_turns(theta)
    mean = np.arctan2(np.sin(theta).mean(axis=0), np.cos(theta).mean(axis=0))
    deviation = np.abs(torus.difference(theta, mean, full_turns))
    unit = unit_over_rounding(keeps_angle, by_rounding)
    is_still = keeps_angle(deviation.max(axis=0), unit)
    still = np.flatnonzero(is_still)
    angles = torus.wrap(mean, full_turns)[still]
    return FormLabels(
        inactive_joints=tuple(int(i) + 1 for i in still),
        inactive_angles=tuple(float(angle) for angle in angles),
    )


def _full_turns(theta: np.ndarray) -> np.ndarray:
    """The periods (n,) of joint angles (..., n)."""
    return np.full(theta.shape[-1], 2 * np.pi)


def _symmetry(theta: np.ndarray, by_rounding: float) -> tuple[Symmetry, float]:
    """The equation between all angles and those some joints further on, half the loop
    first, and what the angles miss of it, 0 where that is rounding."""
    n = theta.shape[1]
    unit = unit_over_rounding(is_symmetric_to_rounding, by_rounding)
    for step in range(n // 2, 0, -1):
        if n % step:
            continue
        further = np.roll(np.arange(n), -step)
        for sign in (1, -1):
            difference = partial(_half_sines, further, sign)
            if not _holds_along(difference, theta, has_symmetry):
                continue
            missed = float(np.abs(difference(theta)).max())
            is_exact = is_symmetric_to_rounding(missed, unit)
            return Symmetry.of_step(step, sign), 0.0 if is_exact else missed
    return Symmetry.NONE, 0.0


def _half_sines(further: np.ndarray, sign: int, theta: np.ndarray) -> np.ndarray:
    """Sines (m, n) of half of what theta (m, n) differ by from ``sign`` times those of
    the joints ``further`` (n,) on."""
    sines: np.ndarray = np.sin((theta - sign * theta[:, further]) / 2)
    return sines


def _holds_along(
    residual: Callable[[np.ndarray], np.ndarray], theta: np.ndarray, is_zero: Decision
) -> bool:
    """Whether an equation holds at all samples theta (m, n): the largest entry of its
    ``residual`` there ``is_zero``."""
    few = theta[:: max(1, len(theta) // FEW)]
    return all(
        is_zero(float(np.abs(residual(samples)).max())) for samples in (few, theta)
    )


# --- names ----------------------------------------------------------------------------


def _name_by_pattern(theta: np.ndarray, patterns: Sequence[FormPattern]) -> str:
    for pattern in patterns:
        if _holds_along(pattern.residual, theta, matches_pattern):
            return pattern.name
    return ""


def _planar_patterns(loop: Loop) -> tuple[FormPattern, ...]:
    """Patterns that need no catalogue entry: those of a planar four-bar with lengths
    alike in pairs."""
    lengths, twists, offsets = loop.arrays
    if loop.n != 4 or np.any(twists != 0) or np.any(offsets != 0):
        return ()
    a, b, c, d = _with_equals(lengths / lengths.mean())
    return form_patterns(a, b, c, d)


def _with_equals(ratios: np.ndarray) -> list[float]:
    """Ratios (k,), each that is equal to an earlier one but for rounding replaced by
    it."""
    values: list[float] = []
    for ratio in ratios:
        alike = [one for one in values if is_same_length(abs(one - float(ratio)))]
        values.append(alike[0] if alike else float(ratio))
    return values


def _name_by_inactive_joints(
    theta: np.ndarray, loop: Loop, inactive: tuple[int, ...]
) -> str:
    if not inactive:
        return ""
    moving = loop.n - len(inactive)
    if moving == 0:
        return "rigid assembly"
    noun = "joint" if len(inactive) == 1 else "joints"
    numbers = ",".join(str(joint) for joint in inactive)
    words = f"{noun} {numbers} inactive"
    if moving != 4:
        return f"{moving}R form ({words})"
    return _four_bar_kind(theta, loop, inactive).form_name(words)


def _four_bar_kind(
    theta: np.ndarray, loop: Loop, inactive: tuple[int, ...]
) -> FourBarKind:
    """Which 4R the four moving joints make."""
    frames = loop.frames(theta[0])[:-1]
    active = [i for i in range(loop.n) if i + 1 not in inactive]
    try:
        four_bar, _ = loop_from_axes(frames[active, :3, 3], frames[active, :3, 2])
    except GeometryError:  # two of the axes coincide
        return FourBarKind()
    lengths, twists, offsets = four_bar.arrays
    unit = loop.characteristic_length
    if np.all(is_alike_in_geometry(np.abs(np.sin(twists)))):
        return FourBarKind("planar")
    if np.all(is_alike_in_geometry(np.abs(np.concatenate([lengths, offsets])), unit)):
        return FourBarKind("spherical")
    directions = np.exp(1j * twists)
    between_lengths = np.abs(lengths[:2] - lengths[2:])
    between_twists = np.abs(directions[:2] - directions[2:])
    has_opposite_lengths = np.all(is_alike_in_geometry(between_lengths, unit))
    has_opposite_twists = np.all(is_alike_in_geometry(between_twists))
    has_no_offsets = np.all(is_alike_in_geometry(np.abs(offsets), unit))
    if not (has_opposite_lengths and has_opposite_twists and has_no_offsets):
        return FourBarKind()
    # the condition of Bennett (1903): a12 sin(alpha23) = +-a23 sin(alpha12)
    first = lengths[1] * np.sin(twists[0])
    second = lengths[0] * np.sin(twists[1])
    if is_alike_in_geometry(float(abs(first - second)), unit):
        return FourBarKind("Bennett", "asymmetric")
    if is_alike_in_geometry(float(abs(first + second)), unit):
        return FourBarKind("Bennett", "line-symmetric")
    return FourBarKind()


def _in_order(forms: Sequence[np.ndarray]) -> list[int]:
    """Numbers of the forms, the one with the largest means first."""
    if not len(forms):
        return []
    means = [_means(np.asarray(samples, dtype=float)) for samples in forms]
    return [int(k) for k in order_rows(-np.array(means), OF_SAMPLES)]


def _means(theta: np.ndarray) -> np.ndarray:
    """Means (2 n,) of cosines and sines along the closed form, weighted by arc
    length."""
    following = np.roll(theta, -1, axis=0)
    step = np.linalg.norm(
        torus.difference(following, theta, _full_turns(theta)), axis=1
    )
    weight = step + np.roll(step, 1)
    total = weight.sum()
    share = weight / total if total > 0 else np.full(len(theta), 1 / len(theta))
    return np.concatenate([share @ np.cos(theta), share @ np.sin(theta)])
