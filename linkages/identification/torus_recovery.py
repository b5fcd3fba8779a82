"""Parameters of the 5R of two pairs of tori, read off the table of a generalized
Goldberg 5R.

The shift along the axis of S is a redundant parameter: it is chosen so that the ratio
s/r lies on the side of 1 that the variant asks for.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import atan2, cos, hypot, pi, sin, tan
from typing import Any

import numpy as np

from linkages.families.tori import companion, torus_link
from linkages.identification.recovery_angles import kinks
from linkages.loop import GeometryError

__all__ = ["torus_hint"]

SHIFTS = (0.0, 0.3, 0.6, 1.0, 1.7, 3.0)  # in units of the first length, either sign
MARGIN, LOOSE = 1.01, 0.05


def torus_hint(
    variant: Mapping[str, Any],
) -> Callable[[np.ndarray], Iterator[dict[str, float]]]:
    """The hint for `linkages.families.tori.torus_5r` with the keywords ``variant``."""
    return partial(_hint, variant)


def _hint(variant: Mapping[str, Any], form: np.ndarray) -> Iterator[dict[str, float]]:
    if not _is_goldberg_like(form):
        return
    for shift, supplement in itertools.product(SHIFTS, (False, True)):
        found = False
        for sign in (1, -1) if shift else (1,):
            for parameters in _at_shift(
                variant, form, sign * shift * form[0, 0], supplement
            ):
                found = True
                yield parameters
        if found and supplement:
            return


def _is_goldberg_like(form: np.ndarray) -> bool:
    """Whether links 12 and 45 are alike, link 23 has their Bennett ratio, and joints 2,
    3, 4 no offset, nearly."""
    (a, t, offsets), unit = form, form[0].mean()
    gaps = (a[0] - a[3], a[1] * sin(t[0]) - a[0] * sin(t[1]), *offsets[1:4])
    return bool(
        min(a[:4]) > 0
        and max(map(abs, gaps)) < LOOSE * unit
        and abs(sin(t[0] - t[3])) < LOOSE
    )


def _at_shift(
    variant: Mapping[str, Any], form: np.ndarray, shift: float, supplement: bool
) -> Iterator[dict[str, float]]:
    (a, t, _), first = form, variant["first"]
    main, side = (1, 0) if first == 1 else (0, 1)
    length, twist = a[main], pi - t[main] if supplement else t[main]
    radius = hypot(length, shift * sin(twist))
    pin = shift / abs(cos(t[side])) if abs(cos(t[side])) > 1e-9 else 0.0
    ratio = hypot(a[2], pin * tan(t[2])) / hypot(a[0], pin * sin(t[0]))
    if (ratio > 1 / MARGIN) if variant["second"] == 3 else (ratio < MARGIN):
        return
    parameters = {
        "r1": radius,
        "s1": hypot(a[side], pin * sin(t[side])),
        "chi1": atan2(length * sin(twist), radius * cos(twist)),
        "theta1": float(np.arcsin(shift * sin(twist) ** 2 / radius)),
        "ratio": ratio,
    }
    try:
        zero, sense = _kink_without_turn(parameters, **variant)
    except (GeometryError, ArithmeticError):
        return
    for kink, turn in itertools.product(kinks(t[2], t[1], t[4]), (0.0, pi)):
        yield {
            **parameters,
            "delta": (sense * (kink + turn - zero) + pi) % (2 * pi) - pi,
        }


def _kink_without_turn(
    parameters: Mapping[str, float],
    first: int,
    second: int,
    z_sign: int,
    u_sign: int,
    mirrored: bool,
) -> tuple[float, int]:
    """The kink (rad) that `torus_5r` gives to its composite link at delta = 0, and its
    derivative by delta."""
    torus = torus_link(parameters["r1"], parameters["chi1"], parameters["theta1"])
    pin, other, other_pin = companion(torus, parameters["s1"])
    if first == 2:
        torus, pin = other, other_pin
    carried = pin if u_sign > 0 else pin.second_reversed()
    if z_sign < 0:
        carried = carried.first_reversed()
    _, other_j, _ = companion(carried, parameters["ratio"] * pin.radius, mirrored)
    if z_sign < 0:
        return torus.normal_at_end + pi + other_j.normal, 1
    return torus.normal_at_end - other_j.normal, -1
