"""How large the disk of a chart may be: as far as the surface stays close to its tangent
plane, on the sheet through the centre."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Fit(NamedTuple):
    """How closely charts follow a component: the largest height of it above a disk,
    over the radius, ``bend``, and the smallest cosines between tangent planes of a disk
    and above its rim, ``flat``, of a chart and the next one on its sheet, ``smooth``, and
    of charts that may be neighbours, ``agree``."""

    bend: float
    flat: float
    smooth: float
    agree: float


# Those of surfaces are measured; of other components there are to be few.
OF_SURFACES = Fit(bend=0.16, flat=0.92, smooth=0.85, agree=0.8)
OF_OTHERS = Fit(bend=0.25, flat=0.85, smooth=0.75, agree=0.7)


class TangentPlane(NamedTuple):
    """The plane ``basis`` (n, d) at a solution ``center`` (n,), and the unit vector
    ``normal`` (n,) across the surface along which F' is the weakest: another sheet may
    be near there. It is zero where no equation is left. Where the null space is larger, at
    singular points, the plane is the part of it that is turned as little as possible
    against that of the chart from which it was reached."""

    center: np.ndarray
    basis: np.ndarray
    normal: np.ndarray


class Disk(NamedTuple):
    """The ``radius`` of a chart, whether other sheets are far from it, and the ``height``
    of the surface above it, over the radius, 0 where it was not looked at.

    The surface stays close to it, and tangent planes agree. Other sheets are far from it
    where solutions straight above the rim are those to which the sheet leads from the
    centre: where Newton's method comes back to the centre, from beside it, and at once,
    as everywhere, and F' across the plane is all along the rim much what it is at the
    centre. Where another sheet crosses, it changes its sign.
    """

    radius: float
    is_clear: bool
    height: float = 0.0
