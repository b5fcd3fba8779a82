"""What an axis of a diagram shows: an unknown, a norm, or a function of the unknowns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias, cast

import numpy as np

from bifurc.atlas import Atlas
from bifurc.checks import UnknownName, index_of_unknown, name_of
from bifurc.errors import ProblemError
from bifurc.torus import wrap

AxisRequest: TypeAlias = "UnknownName | Callable[[np.ndarray], float]"
NORM = "|u|"
MOST_NAMED = 4  # unknowns of a norm that are named in its label
SIZE = "size"  # the unit of an unknown that counts characteristic lengths
LENGTHS = "lengths"  # what stands for the user's unit of length
SAMPLES = 64  # of a form at which it is seen what an axis shows
ROOM = 0.05  # of a period: how much of it is to be empty where a form is not cut


class ShownUnit(NamedTuple):
    """In what an unknown is shown: times ``factor`` it counts ``name``."""

    factor: float
    name: str


def shown_unit(atlas: Atlas, index: int) -> ShownUnit:
    """In what the unknown of this index is shown: as it is, or, where it counts
    characteristic lengths and the subject of the atlas has its ``scale``, in the
    user's unit of length."""
    unit = atlas.units[index]
    scales = atlas.subject.get("scale")
    if unit != SIZE or scales is None:
        return ShownUnit(1.0, unit)
    return ShownUnit(float(scales[index]), LENGTHS)


@dataclass(frozen=True)
class Quantity:
    """A number for every point, with the ``label`` of its axis; ``period`` is where it
    begins again, inf where it does not: it is shown within half of it of ``middle``."""

    label: str
    function: Callable[[np.ndarray], np.ndarray]
    period: float = np.inf
    middle: float = 0.0

    def values(self, points: np.ndarray) -> np.ndarray:
        """Values (k,) at points (k, n)."""
        values = self.function(points)
        if np.isfinite(self.period):
            turns = np.round((values - self.middle) / self.period)
            values = values - self.period * turns
        return values


def quantity_of(atlas: Atlas, request: AxisRequest | None) -> Quantity:
    """What an axis shows.

    ``request`` is an unknown by its name or symbol, its name between bars for its size,
    None for the Euclidean norm of all unknowns but the parameter, as "|u|" where no
    unknown is called u, or a function of the unknowns (n,); unknowns with a period
    count from half of it below 0 to half above. Raises `ProblemError` for anything else.
    """
    if request is None:
        return _norm_of(atlas)
    request = cast(AxisRequest, name_of(request))
    if callable(request):
        label = getattr(request, "__name__", "function")
        quantity = Quantity(label, _each(request, label))
        _check_is_seen(atlas, quantity)
        return quantity
    names = list(atlas.names)
    check_axis(request, names)
    if request in _sizes(names):
        index = _sizes(names).index(str(request))
        return Quantity(str(request), lambda points: np.abs(points[:, index]))
    if request == NORM:
        return _norm_of(atlas)
    index = names.index(str(request))
    factor, unit = shown_unit(atlas, index)
    period = float(atlas.periods[index])
    middle = _middle(atlas, index) if np.isfinite(period) else 0.0
    return Quantity(
        f"{names[index]} ({unit})" if unit else names[index],
        lambda points: factor * points[:, index],
        factor * period,
        factor * middle,
    )


def check_axis(request: object, names: Sequence[str]) -> None:
    """Raise `ProblemError` unless an axis shows one of the unknowns of these names, the
    size of one or their norm."""
    if request not in (*_sizes(names), NORM):
        index_of_unknown("axis", request, names, others=f"{NORM}, a function, or ")


def _norm_of(atlas: Atlas) -> Quantity:
    """The norm of all unknowns but the parameter; its label names them, so that it is
    not that of the size of one."""
    parameter = atlas.diagram.parameter if atlas.diagram else ""
    rest = [i for i, name in enumerate(atlas.names) if name != parameter]
    periods = atlas.periods[rest]
    named = ", ".join(atlas.names[i] for i in rest)
    label = f"|{named}|" if len(rest) == 1 else f"|({named})|"
    if len(rest) > MOST_NAMED:
        label = f"norm of {len(rest)} unknowns"
    return Quantity(label, lambda points: _norms(points[:, rest], periods))


def _sizes(names: Sequence[str]) -> list[str]:
    """What asks for the sizes of the unknowns."""
    return [f"|{name}|" for name in names]


def _norms(points: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """Euclidean norms (k,) of points (k, q), unknowns with a period within half of it
    of 0."""
    return np.asarray(np.linalg.norm(wrap(points, periods), axis=1))


def _each(
    function: Callable[[np.ndarray], float], label: str
) -> Callable[[np.ndarray], np.ndarray]:
    """The function of many points (k, n) that one of a point (n,) makes; it raises
    `ProblemError` for a value that is no number."""

    def number(point: np.ndarray) -> float:
        value = function(point)
        try:
            return float(value)
        except (TypeError, ValueError):
            name = f"value of the axis function {label}"
            raise ProblemError(name, repr(value), "a number") from None

    return lambda points: np.array([number(point) for point in points])


def _check_is_seen(atlas: Atlas, quantity: Quantity) -> None:
    """Raises `ProblemError` for an axis that shows nothing of any form."""
    samples = [form.branch.sample(SAMPLES) for form in atlas.forms]
    if not samples:
        return
    values = quantity.values(np.concatenate(samples))
    if not np.isfinite(values).any():
        allowed = "a finite number somewhere on the forms"
        name = f"value of the axis function {quantity.label}"
        raise ProblemError(name, values[0], allowed)


def _middle(atlas: Atlas, index: int) -> float:
    """The middle of what is shown of an unknown with a period: that of the forms, where
    they lie within one period, or 0."""
    period = float(atlas.periods[index])
    ends = [form.branch.sample(SAMPLES)[:, index] for form in atlas.forms]
    if not ends:
        return 0.0
    values = np.concatenate(ends)
    low, high = float(values.min()), float(values.max())
    fits_about_zero = max(-low, high) <= 0.5 * period
    has_room = high - low < (1.0 - ROOM) * period
    return 0.5 * (low + high) if has_room and not fits_about_zero else 0.0
