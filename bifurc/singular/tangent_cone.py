"""The lines on which quadratic forms vanish together: along these the branches leave
a singular point that second order decides.

The real ones that random starts come to are all where there are as many as Bezout
allows; else every complex one is the end of a path.
"""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_same_half_branch
from bifurc.limits import current_deadline
from bifurc.paths.homogeneous import Exponents
from bifurc.paths.sparse import paths_from_powers
from bifurc.singular.second_order import independent_forms

# Steps of an iteration onto zeros of quadratic forms, its least damping, and the values
# of forms of size 1 that are zero.
STEPS_OF_FORMS, LEAST_DAMPING, ZERO_OF_FORMS = 15, 1e-14, 1e-9
# Of a zero that is isolated: the least singular value of the rates of the forms, and what
# these may be over its square, which is a quarter next to a double zero.
LONE, CLOSE = 1e-5, 1e-3
MORE_STARTS = 10  # times as many, where half of the lines are known to be real
MOST_PATHS = 128  # to complex lines, which take a second
SOLVES = 1e-6  # what forms of length 1 may be at the end of a path that is double
SEED = 10  # of the coordinates, the combinations of forms and the paths
# Times the gap of points that are one: those are looked at as well.
BESIDE = 1e3


class TangentCone(NamedTuple):
    """The zeros of quadratic forms in k unknowns.

    ``lone`` (d, k) are unit vectors, both of each line, that are isolated to first
    order, so that one half-branch leaves along each; the ``others`` (s, k) are starts
    that came to no such zero. ``is_whole`` says that there is nothing but the lone ones.
    """

    lone: np.ndarray
    others: np.ndarray
    is_whole: bool = False


def tangent_cone(forms: np.ndarray, starts: np.ndarray) -> TangentCone:
    """The zeros of quadratic ``forms`` (w, k, k), from unit vectors ``starts`` (s, k), of
    which the opposites are starts as well."""
    size = starts.shape[1]
    if not np.all(np.isfinite(forms)):
        return TangentCone(starts[:0], starts)
    rows = independent_forms(forms.reshape(-1, size * size))
    forms = rows.reshape(-1, size, size)
    cone, are_alone = _from_starts(forms, starts)
    needed = size - 1
    lines = 2**needed
    if not are_alone or len(forms) < max(needed, 1):
        return cone
    if len(forms) == needed:
        rng = np.random.default_rng(SEED)
        for _ in range(MORE_STARTS):
            if len(cone.lone) == 2 * lines:
                return cone._replace(is_whole=True)
            if len(cone.lone) < lines:
                break  # many lines are not real
            more, _ = _from_starts(forms, spread_directions(size, rng))
            both = without_duplicates(np.concatenate([cone.lone, more.lone]), 1.0)
            cone = cone._replace(lone=both)
    return _along_paths(forms, cone) if lines <= MOST_PATHS else cone


def spread_directions(k: int, rng: np.random.Generator) -> np.ndarray:
    """Unit vectors (200 (k - 1), k) at random, half of them the opposites of the
    others."""
    half = rng.normal(size=(100 * (k - 1), k))
    half /= np.linalg.norm(half, axis=1)[:, None]
    return np.concatenate([half, -half])


def _from_starts(forms: np.ndarray, starts: np.ndarray) -> tuple[TangentCone, bool]:
    """The zeros of independent ``forms`` to which ``starts`` are moved, these as they were
    where they came to none; and whether all of these are isolated.

    The damping is that of Fan and Yuan (2005), for zeros that are not isolated.
    """
    if not len(forms):
        return TangentCone(starts[:0], starts), False
    x, is_zero, is_lone = _led_to_zeros(forms, starts)
    is_late = is_zero & ~is_lone  # beside another one, or not isolated
    x[is_late], is_zero[is_late], is_lone[is_late] = _led_to_zeros(forms, x[is_late])
    others = np.where(is_zero[:, None], x, starts)[~is_lone]
    lone = without_duplicates(x[is_lone], 1.0)
    return TangentCone(lone, others), bool(np.array_equal(is_lone, is_zero))


def _led_to_zeros(
    forms: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where unit vectors (d, k) are led, and whether each of these is a zero (d,), and one
    that is isolated to first order (d,)."""
    for _ in range(STEPS_OF_FORMS):
        x, gaps, normal = _nearer_to_zeros(forms, x)
    is_zero = gaps < ZERO_OF_FORMS
    least = np.linalg.eigvalsh(normal)[:, 0]
    return x, is_zero, is_zero & (least > LONE**2) & (gaps < CLOSE * least)


def _nearer_to_zeros(
    forms: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit vectors (d, k) after one step towards zeros of forms (w, k, k), and the sizes
    (d,) of the forms and the normal equations (d, k, k) before it."""
    halves = np.tensordot(x, forms, axes=(1, 1))  # (d, w, k), of the rates
    values = (halves @ x[:, :, None])[:, :, 0]
    normal = 4 * np.swapaxes(halves, 1, 2) @ halves + x[:, :, None] * x[:, None]
    gaps = np.linalg.norm(values, axis=1)
    damping = (gaps**2 + LEAST_DAMPING)[:, None, None] * np.eye(x.shape[1])
    down = 2 * values[:, None] @ halves  # (d, 1, k)
    x = x - np.linalg.solve(normal + damping, np.swapaxes(down, 1, 2))[:, :, 0]
    return x / np.linalg.norm(x, axis=1)[:, None], gaps, normal


def _along_paths(forms: np.ndarray, cone: TangentCone) -> TangentCone:
    """The ``cone`` of independent forms (w, k, k), k - 1 of them at least, whole where
    every path to a complex line ends, each real one at a line that is isolated."""
    lines = _complex_lines(forms)
    if lines is None:
        return cone
    real = lines[np.linalg.norm(lines.imag, axis=1) < LONE].real
    led = _from_starts(forms, np.concatenate([real, -real]))[0].lone
    both = without_duplicates(np.concatenate([led, cone.lone]), 1.0)
    is_whole = len(both) == len(led) == 2 * len(real)
    return TangentCone(both, cone.others, is_whole)


def _complex_lines(forms: np.ndarray) -> np.ndarray | None:
    """Unit vectors (c, k) along the complex lines on which forms (w, k, k) vanish; None
    where a path to them is lost or one of them is not isolated to first order."""
    rng = np.random.default_rng(SEED)
    count, size, _ = forms.shape
    axes = np.linalg.qr(rng.normal(size=(size, size)))[0]  # none at infinity
    mix = np.linalg.qr(rng.normal(size=(count, size - 1)))[0]
    mixed = np.tensordot(mix.T, axes.T @ forms @ axes, axes=1)
    paths = paths_from_powers([*map(_affine, mixed)], rng, current_deadline())
    if paths.lost or not np.all(paths.is_finite):
        return None
    lines = np.hstack([np.ones((len(paths.points), 1)), paths.points]) @ axes.T
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    values = np.einsum("di,wij,dj->dw", lines, forms, lines)
    solves_all = np.linalg.norm(values, axis=1) < SOLVES
    if np.any(solves_all & ~paths.is_regular):
        return None
    found: np.ndarray = lines[solves_all]
    return found


def _affine(form: np.ndarray) -> dict[Exponents, complex]:
    """The terms of a quadratic form (k, k) where the first unknown is 1."""
    size = len(form)
    terms = {}
    for i, j in combinations_with_replacement(range(size), 2):
        exponents = np.bincount([i, j], minlength=size)[1:]
        terms[tuple(exponents.tolist())] = form[i, j] * (1.0 if i == j else 2.0)
    return terms


def without_duplicates(points: np.ndarray, radius: float) -> np.ndarray:
    """One of every cluster of points (k, n) on a sphere of ``radius`` that are joined by
    small gaps, the first."""
    within = BESIDE * is_same_half_branch.threshold * radius
    is_left = np.ones(len(points), dtype=bool)
    first = []
    for number in range(len(points)):
        if not is_left[number]:
            continue
        first.append(number)
        is_left[number] = False
        waiting = [number]
        while waiting:
            left = np.flatnonzero(is_left)
            gaps = np.linalg.norm(points[left] - points[waiting.pop()], axis=1)
            near = left[gaps < within]
            joined = near[is_same_half_branch(gaps[gaps < within], radius)]
            is_left[joined] = False
            if len(joined) < len(near):
                waiting += joined.tolist()
    return points[first]
