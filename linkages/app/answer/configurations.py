"""Configurations of an atlas for the screen and for JSON: joint angles of a loop, joint
variables of a mechanism."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas
from bifurc.isometry import Isometry
from bifurc.torus import wrap
from linkages.app.texts.numbers import in_degrees, in_lengths

if TYPE_CHECKING:
    from linkages.networks.mechanism import NetworkMechanism
    from linkages.readout.readout import Readout

# what unknowns are shown in, by the units of an atlas
UNITS = {"rad": "deg", "size": "lengths", "": "entries ax to bz of rotation matrices"}
SHOWN_SHARE = 0.5e-4 / 360  # of a turn, that four digits of a degree do not show


@lru_cache(maxsize=2)
def readout_of(atlas: Atlas) -> Readout | None:
    """What reads the joint variables from the atlas of a mechanism; None for that of a
    loop. Raises `NoLinkageError` for a damaged one."""
    if "mechanism" not in atlas.subject:
        return None
    from linkages.mechanisms.subject import mechanism_of
    from linkages.readout.readout import Readout

    mechanism = mechanism_of(atlas)
    return None if mechanism is None else Readout(mechanism)


@lru_cache(maxsize=2)
def network_at(atlas: Atlas) -> NetworkMechanism | None:
    """The network that an atlas is of; None for anything else."""
    if "network" not in atlas.subject:
        return None
    from linkages.networks.mechanism import network_of

    return network_of(atlas)


def unknown_factors(atlas: Atlas) -> NDArray[np.float64]:
    """What the unknowns (n,) of an atlas are multiplied with to be in rad and in the
    user's unit of length."""
    readout = readout_of(atlas)
    return np.ones(len(atlas.names)) if readout is None else readout.structure.scales


@lru_cache(maxsize=2)
def loop_angles_of(atlas: Atlas) -> Isometry:
    """From the unknowns of an atlas to the joint angles of the loop that a mechanism
    is; to the unknowns as they are where it is none, or the atlas is of a loop."""
    readout = readout_of(atlas)
    if readout is None:
        return Isometry.identity(len(atlas.names))
    from linkages.readout.loop_atlas import to_loop_angles

    return to_loop_angles(readout)


def numbers_at(atlas: Atlas, point: NDArray[np.float64]) -> list[float]:
    """The unknowns (n,) of an atlas, angles between -pi and pi, lengths in the user's
    unit; of a mechanism that is a single loop the joint angles of this loop."""
    to_angles = loop_angles_of(atlas)
    periods = atlas.periods[to_angles.columns]
    factors = unknown_factors(atlas)[to_angles.columns]
    numbers = wrap(to_angles.points(point), periods) * factors
    return [float(number) for number in numbers]


def joint_names(atlas: Atlas) -> list[str]:
    """What the unknowns are called on the screen: the numbers of the joints of a loop,
    the variables of a mechanism."""
    readout = readout_of(atlas)
    if readout is None:
        return [str(number + 1) for number in range(len(atlas.names))]
    return [readout.label_of_unknown(index) for index in range(len(atlas.names))]


def heading(atlas: Atlas) -> str:
    """What stands above configurations."""
    if readout_of(atlas) is None:
        return "joint angles (deg)"
    units = [words for unit, words in UNITS.items() if unit in atlas.units]
    return f"{', '.join(joint_names(atlas))} ({', '.join(units)})"


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
    readout = readout_of(atlas)
    size = 1.0 if readout is None else readout.structure.unit
    lengths = f"lengths over {size:.4g}"
    return f"rad, {lengths}" if "rad" in atlas.units else lengths


def show_configuration(atlas: Atlas, point: NDArray[np.float64]) -> str:
    """The unknowns (n,) as text: angles in degrees, above -180 and up to 180, lengths
    in the user's unit; those of a mechanism from its reference configuration."""
    angles = wrap(point, atlas.periods, within=SHOWN_SHARE)
    return " ".join(f"{text:>9}" for text in show_travel(atlas, angles))


def show_travel(atlas: Atlas, point: NDArray[np.float64], digits: int = 4) -> list[str]:
    """The unknowns (n,) as texts, as they stand, with so many digits of a degree."""
    is_angle = [unit == "rad" for unit in atlas.units]
    texts = []
    for value, factor, angle in zip(
        point, unknown_factors(atlas), is_angle, strict=True
    ):
        if angle:
            texts.append(in_degrees(value, digits))
        else:
            texts.append(in_lengths(factor * value, factor))
    return texts
