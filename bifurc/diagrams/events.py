"""Events: where functions of the unknowns take given values along a form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np

from bifurc.branch import Branch
from bifurc.checks import check_callable, check_finite, check_type, floats_of
from bifurc.curves.monitor import NODES
from bifurc.decisions import is_event, is_event_all_along
from bifurc.errors import ProblemError
from bifurc.numerics.roots import bracketed_roots

__all__ = ["EventFunction", "EventRequests", "event_places", "events_of"]

SAMPLES, BESIDE = 16, 0.1  # places on a branch, so far, over their sizes, off it
UnknownsToNumber: TypeAlias = Callable[[np.ndarray], float]
# By their names: a function whose zeros are looked for, or a function and what it shall
# be equal to, one value or several. In place of a function the name of an unknown.
EventRequests: TypeAlias = Mapping[
    str, UnknownsToNumber | tuple[UnknownsToNumber | str, float | Sequence[float]]
]


@dataclass(frozen=True)
class EventFunction:
    """A ``function`` of the unknowns (n,) that shall take a ``value``, and the
    ``label`` under which the user asked for it."""

    label: str
    function: UnknownsToNumber
    value: float

    def differences(self, points: np.ndarray) -> np.ndarray:
        """What the function is more than the value (k,) at points (k, n); raises
        `ProblemError` where it gives no number."""
        values = np.empty(len(points))
        for k, point in enumerate(points):
            with np.errstate(all="ignore"):
                result = np.asarray(self.function(point))
            if result.size != 1 or result.dtype.kind not in "fiub":
                name = f"value of the event {self.label!r}"
                raise ProblemError(name, repr(result), "one number")
            values[k] = float(result.reshape(()))
        differences: np.ndarray = values - self.value
        return differences


def events_of(requests: EventRequests, names: Sequence[str]) -> list[EventFunction]:
    """What the user asked for, one function for each value; raises `ProblemError`."""
    check_type("events", requests, dict)
    events = []
    for label, request in requests.items():
        check_type("name of an event", label, str)
        has_value = isinstance(request, tuple)
        if has_value and len(cast(tuple[object, ...], request)) != 2:
            allowed = "a function, or a function and the values that it shall take"
            raise ProblemError(f"events[{label!r}]", repr(request), allowed)
        function, values = cast(
            tuple[object, object], request if has_value else (request, 0.0)
        )
        checked = _function_of(function, label, names)
        for value in np.atleast_1d(floats_of(f"events[{label!r}]", values)):  # type: ignore[arg-type]
            check_finite(f"events[{label!r}]", value)
            events.append(EventFunction(label, checked, float(value)))
    return events


def _function_of(
    function: object, label: str, names: Sequence[str]
) -> UnknownsToNumber:
    """A function, or the unknown that stands for one by its name."""
    if isinstance(function, str):
        if function not in names:
            allowed = f"a function or one of the unknowns {', '.join(names)}"
            raise ProblemError(f"events[{label!r}]", repr(function), allowed)
        index = names.index(function)
        return lambda point: float(point[index])
    check_callable(f"events[{label!r}]", function)
    return cast(UnknownsToNumber, function)


def event_places(branch: Branch, event: EventFunction, sizes: np.ndarray) -> np.ndarray:
    """Arclengths, in order, at which a function passes its value, or takes it at a
    place that is looked at; ``sizes`` (n,) are those of the unknowns.

    There are none where it jumps, as at a pole, and on a branch along which it has the
    value everywhere.
    """
    nodes = branch.places(NODES).ravel()
    s = np.concatenate([[0.0], nodes, [branch.length]])
    values = event.differences(branch(s))
    beside = _size_beside(branch, event, sizes)
    if is_event_all_along(float(np.abs(values).max()), beside):
        return np.empty(0)
    at_once: np.ndarray = s[values == 0.0]
    if branch.closed:
        at_once = at_once[at_once < branch.length]
    (changing,) = np.nonzero(values[:-1] * values[1:] < 0)
    if not len(changing):
        return at_once
    low, high = s[changing], s[changing + 1]
    roots = bracketed_roots(lambda x: event.differences(branch(x)), low, high)
    ends = np.maximum(np.abs(values[changing]), np.abs(values[changing + 1]))
    left = np.abs(event.differences(branch(roots)))
    places: np.ndarray = np.sort(np.concatenate([at_once, roots[is_event(left, ends)]]))
    return places


def _size_beside(branch: Branch, event: EventFunction, sizes: np.ndarray) -> float:
    """How large the difference of a function to its value is a little way off a
    branch."""
    rng = np.random.default_rng(0)
    points = branch.sample(SAMPLES)
    points = points + BESIDE * sizes * rng.uniform(-1.0, 1.0, points.shape)
    values = np.abs(event.differences(points))
    return float(values[np.isfinite(values)].max(initial=0.0))
