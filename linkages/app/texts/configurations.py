"""Configurations and arclengths of an atlas in the units of the screen."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas
from bifurc.torus import wrap
from linkages.app.texts.numbers import in_degrees, in_lengths
from linkages.subject import MOST_SHOWN, subject_at

SHOWN_SHARE = 0.5e-4 / 360  # of a turn, that four digits of a degree do not show
LARGEST_SHOWN = 6  # of more unknowns than a table shows all of


def numbers_at(atlas: Atlas, point: NDArray[np.float64]) -> list[float]:
    """The unknowns (n,) of an atlas, angles between -pi and pi, lengths in the user's
    unit; of a mechanism that is a single loop the joint angles of this loop."""
    subject = subject_at(atlas)
    to_angles = subject.to_angles
    periods = atlas.periods[to_angles.columns]
    factors = subject.factors[to_angles.columns]
    numbers = wrap(to_angles.points(point), periods) * factors
    return [float(number) for number in numbers]


class ArclengthUnit(NamedTuple):
    """How arclengths are shown: times ``factor``, with ``name`` behind."""

    factor: float
    name: str


def arclength_unit(atlas: Atlas) -> ArclengthUnit:
    """The unit of arclengths on the screen: degrees, where all unknowns are angles;
    else that of the unknowns, in which lengths are over the characteristic length."""
    if set(atlas.units) == {"rad"}:
        return ArclengthUnit(float(np.degrees(1.0)), "deg")
    return ArclengthUnit(1.0, unit_of_arclengths(atlas))


def unit_of_arclengths(atlas: Atlas) -> str:
    """What arclengths count as they are in the atlas and in files: rad, lengths over
    the characteristic length, or both."""
    if set(atlas.units) == {"rad"}:
        return "rad"
    lengths = f"lengths over {subject_at(atlas).size:.4g}"
    return f"rad, {lengths}" if "rad" in atlas.units else lengths


def show_configuration(atlas: Atlas, point: NDArray[np.float64]) -> str:
    """The unknowns (n,) as text: angles in degrees, above -180 and up to 180, lengths
    in the user's unit; those of a mechanism from its reference configuration. Of many
    unknowns the largest are shown."""
    angles = wrap(point, atlas.periods, within=SHOWN_SHARE)
    texts = show_travel(atlas, angles)
    if len(texts) <= MOST_SHOWN:
        return " ".join(f"{text:>9}" for text in texts)
    labels = subject_at(atlas).labels
    largest = np.argsort(-np.abs(angles), kind="stable").tolist()
    moved = [k for k in largest if float(texts[k]) != 0.0]
    shown = [f"{labels[k]} {texts[k]}" for k in moved[:LARGEST_SHOWN]]
    if len(moved) > LARGEST_SHOWN:
        shown.append(f"{len(moved) - LARGEST_SHOWN} more")
    return ", ".join(shown) or "all 0"


def show_travel(atlas: Atlas, point: NDArray[np.float64], digits: int = 4) -> list[str]:
    """The unknowns (n,) as texts, as they stand, with so many digits of a degree."""
    is_angle = [unit == "rad" for unit in atlas.units]
    texts = []
    for value, factor, angle in zip(
        point, subject_at(atlas).factors, is_angle, strict=True
    ):
        if angle:
            texts.append(in_degrees(value, digits))
        else:
            texts.append(in_lengths(factor * value, factor))
    return texts
