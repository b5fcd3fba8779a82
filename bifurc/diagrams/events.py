"""Events: where functions of the unknowns take given values along a form.

An unknown with a period is a place on a circle. So a function of it that gains a
constant in each turn, as the unknown itself does, takes its value modulo that constant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, TypeAlias, cast

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.branch import Branch
from bifurc.checks import (
    check_callable,
    check_finite,
    check_type,
    floats_of,
    index_of_unknown,
    name_of,
)
from bifurc.decisions import is_event_all_along, is_same_turn
from bifurc.diagrams.diagram import DiagramPoint
from bifurc.diagrams.turnings import unknown_sizes
from bifurc.diagrams.zeros import Zero, ZeroKind, Zeros, zeros_along
from bifurc.errors import ProblemError
from bifurc.problem import Problem
from bifurc.singular.point import Kind
from bifurc.torus import wrap, wrapped_periods

if TYPE_CHECKING:
    import sympy

    from bifurc.checks import UnknownName

SAMPLES, BESIDE = 32, 0.1  # places on a branch, so far, over their sizes, off it
LOST = 1e-14  # of the values of a function: what rounding makes of them
FINEST = 1e-3  # of the largest gain: turns that have a common part have a larger one
UnknownsToNumber: TypeAlias = Callable[[np.ndarray], float]
# By their names: a function whose zeros are looked for, or a function and what it shall
# be equal to, one value or several. In place of a function the name of an unknown, or an
# expression of sympy.
EventRequests: TypeAlias = """Mapping[
    UnknownName,
    UnknownsToNumber
    | UnknownName
    | sympy.Expr
    | tuple[UnknownsToNumber | UnknownName | sympy.Expr, float | Sequence[float]],
]"""
ROUND_CIRCLES = 16  # places on each form at which a function is seen round the circles
SHOWN = 3  # jumps that a remark names


class CircleCut(NamedTuple):
    """Unknowns with ``periods`` (n,), each taken within half of it of its ``middle``
    (n,)."""

    periods: np.ndarray
    middle: np.ndarray

    def wrapped(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) with the unknowns in these ranges."""
        wrapped: np.ndarray = self.middle + wrap(points - self.middle, self.periods)
        return wrapped


@dataclass(frozen=True, eq=False)
class EventFunction:
    """A ``function`` of the unknowns (n,) that shall take a ``value``, and the
    ``label`` under which the user asked for it.

    ``turn`` is what it gains round the circles of the unknowns, modulo which it takes
    the value; inf where it gains nothing. ``cut`` is how circles are cut open for a
    function that gains something else at every place, None where it does not.
    """

    label: str
    function: UnknownsToNumber
    value: float
    turn: float = np.inf
    cut: CircleCut | None = None

    def values(self, points: np.ndarray) -> np.ndarray:
        """The function (k,) at points (k, n); raises `ProblemError` where it gives no
        number."""
        if self.cut is not None:
            points = self.cut.wrapped(points)
        values = np.empty(len(points))
        for k, point in enumerate(points):
            with np.errstate(all="ignore"):
                result = np.asarray(self.function(point))
            if result.size != 1 or result.dtype.kind not in "fiub":
                name = f"value of the event {self.label!r}"
                raise ProblemError(name, repr(result), "one number")
            values[k] = float(result.reshape(()))
        return values

    def differences(self, points: np.ndarray) -> np.ndarray:
        """What the function is more than the value (k,) at points (k, n); where it has a
        turn the sine of that, which is 0 at every whole turn and as steep there."""
        differences: np.ndarray = self.values(points) - self.value
        if np.isfinite(self.turn):
            return self.turn / np.pi * np.sin(np.pi / self.turn * differences)
        return differences

    def value_at(self, point: np.ndarray) -> float:
        """The value, by whole turns next to what the function is at a point (n,)."""
        if not np.isfinite(self.turn):
            return self.value
        here = float(self.values(point[None])[0])
        turns = np.rint((here - self.value) / self.turn)
        return self.value + self.turn * float(turns)


def events_of(requests: EventRequests, names: Sequence[str]) -> list[EventFunction]:
    """What the user asked for, one function for each value; raises `ProblemError`."""
    check_type("events", requests, dict)
    events = []
    for key, request in requests.items():
        label = cast(str, name_of(key))
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
    """A function; that of an expression of sympy, or of an unknown by its name."""
    what = f"events[{label!r}]"
    function = name_of(function)
    if hasattr(function, "free_symbols"):
        from bifurc.equations.symbolic import function_of  # it imports sympy

        return function_of(function, what, names)
    if isinstance(function, str):
        index = index_of_unknown(what, function, names, others="a function or ")
        return lambda point: float(point[index])
    check_callable(what, function)
    return cast(UnknownsToNumber, function)


def on_circles(
    events: Sequence[EventFunction], points: np.ndarray, cut: CircleCut
) -> list[EventFunction]:
    """The events as functions on circles, which are ``cut`` where they have to be, as
    seen at ``points`` (k, n); values a whole turn apart are one."""
    settled: list[EventFunction] = []
    for event in events:
        one = _on_circles(event, points, cut)
        is_known = any(_is_same(one, other) for other in settled)
        if not is_known:
            settled.append(one)
    return settled


def _is_same(event: EventFunction, other: EventFunction) -> bool:
    """Whether two values that were asked for under one name are a whole turn apart."""
    if event.label != other.label or not np.isfinite(event.turn):
        return False
    turns = (event.value - other.value) / event.turn
    return is_same_turn(abs(turns - float(np.rint(turns))))


def _on_circles(
    event: EventFunction, points: np.ndarray, cut: CircleCut
) -> EventFunction:
    """An event with its turn, or with the ``cut`` where it has none."""
    periods = cut.periods
    here = event.values(points)
    turn = 0.0
    for index in np.flatnonzero(np.isfinite(periods)):
        ahead = points.copy()
        ahead[:, index] += periods[index]
        gains = event.values(ahead) - here
        is_known = np.isfinite(gains)
        if not np.any(is_known):
            continue
        gain = float(np.median(gains[is_known]))
        size = float(np.abs(here[is_known]).max()) + abs(gain)
        spread = float(np.abs(gains[is_known] - gain).max())
        if not is_same_turn(spread, size):
            return replace(event, cut=cut)
        if not is_same_turn(abs(gain), size):
            turn = _common_part(turn, abs(gain))
        if turn < 0.0:
            return replace(event, cut=cut)
    return replace(event, turn=turn) if turn > 0.0 else event


def _common_part(a: float, b: float) -> float:
    """The largest number of which ``a`` and ``b`` are whole multiples, -1 where there is
    none (Euclid's algorithm)."""
    least = FINEST * max(a, b)
    while b > least:
        a, b = b, abs(a - b * float(np.rint(a / b)))
    return a if is_same_turn(b, least) else -1.0


def event_zeros(branch: Branch, event: EventFunction, sizes: np.ndarray) -> Zeros:
    """Where a function takes its value along a branch; ``sizes`` (n,) are those of the
    unknowns. Nothing is a zero on a branch along which it has the value everywhere."""
    values = event.differences(branch.sample(SAMPLES))
    largest = float(np.abs(values).max())
    if is_event_all_along(largest, _size_beside(branch, event, sizes)):
        return Zeros((), (), (), True)
    known = np.abs(values[np.isfinite(values)])
    size = float(np.median(known)) if len(known) else 0.0
    rounding = LOST * (size + abs(event.value))
    return zeros_along(branch, lambda s: event.differences(branch(s)), rounding)


def _size_beside(branch: Branch, event: EventFunction, sizes: np.ndarray) -> float:
    """How large the difference of a function to its value is a little way off a
    branch."""
    rng = np.random.default_rng(0)
    points = branch.sample(SAMPLES)
    points = points + BESIDE * sizes * rng.uniform(-1.0, 1.0, points.shape)
    values = np.abs(event.differences(points))
    return float(values[np.isfinite(values)].max(initial=0.0))


# --- along the forms of an atlas ------------------------------------------------------


def events_along(
    problem: Problem, atlas: Atlas, events: Sequence[EventFunction]
) -> tuple[list[DiagramPoint], list[str]]:
    """The places on all forms where functions take their values, and remarks."""
    points: list[DiagramPoint] = []
    remarks: list[str] = []
    if not events or not atlas.forms:
        return points, remarks
    sizes = unknown_sizes(problem)
    periods = wrapped_periods(problem.domain.periods, problem.domain.bounds)
    cut = _cut_of(problem)
    samples = np.concatenate(
        [form.branch.sample(ROUND_CIRCLES) for form in atlas.forms]
    )
    for event in on_circles(events, cut.wrapped(samples), cut):
        if event.cut is not None:
            remarks.append(
                f"event {event.label!r} is no function on circles: unknowns with a period "
                "are taken within one turn"
            )
        for number, form in enumerate(atlas.forms):
            zeros = event_zeros(form.branch, event, sizes)
            points += [
                _event_point(form, number, event, zero, periods) for zero in zeros.zeros
            ]
            remarks += _remarks(form, event, zeros)
    return points, remarks


def _cut_of(problem: Problem) -> CircleCut:
    """Circles cut open opposite to the middle of their bounds, or to 0."""
    is_wrapped = np.isfinite(
        wrapped_periods(problem.domain.periods, problem.domain.bounds)
    )
    is_bounded = np.isfinite(problem.domain.bounds).all(axis=1)
    middle = np.zeros(problem.n)
    has_middle = is_bounded & ~is_wrapped
    middle[has_middle] = problem.domain.bounds[has_middle].mean(axis=1)
    return CircleCut(problem.domain.periods, middle)


def _event_point(
    form: Form, number: int, event: EventFunction, zero: Zero, periods: np.ndarray
) -> DiagramPoint:
    is_touch = zero.kind is ZeroKind.TOUCH
    u = form.branch(zero.s)
    return DiagramPoint(
        name="",
        kind=Kind.TOUCH if is_touch else Kind.EVENT,
        form=number,
        s=zero.s,
        u=u,
        value=event.value_at(wrap(u, periods)),
        label=event.label,
        error=0.5 * (zero.high - zero.low),
    )


def _remarks(form: Form, event: EventFunction, zeros: Zeros) -> list[str]:
    """What is to be said of an event on a form besides its places."""
    head = f"event {event.label!r} on {form.name}"
    remarks = []
    if zeros.jumps:
        places = ", ".join(f"{jump.s:.6g}" for jump in zeros.jumps[:SHOWN])
        more = ", ..." if len(zeros.jumps) > SHOWN else ""
        remarks.append(f"{head}: it jumps across its value at s = {places}{more}")
    for low, high in zeros.held:
        remarks.append(f"{head}: it keeps its value from s = {low:.6g} to {high:.6g}")
    if not zeros.is_resolved:
        remarks.append(f"{head}: it changes too fast to be seen; places may be missing")
    return remarks
