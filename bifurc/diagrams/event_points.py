"""The events along all forms of an atlas, and what is to be said of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.diagrams.diagram import DiagramPoint
from bifurc.diagrams.events import CircleCut, EventFunction, event_zeros, on_circles
from bifurc.diagrams.turnings import unknown_sizes
from bifurc.diagrams.zeros import Zero, ZeroKind, Zeros
from bifurc.problem import Problem
from bifurc.singular.point import Kind
from bifurc.torus import wrap, wrapped_periods

SAMPLES = 16  # places on each form at which a function is seen round the circles
SHOWN = 3  # jumps that a remark names


def events_along(
    problem: Problem, atlas: Atlas, events: Sequence[EventFunction]
) -> tuple[list[DiagramPoint], list[str]]:
    """The places on all forms where functions take their values, and remarks."""
    points: list[DiagramPoint] = []
    remarks: list[str] = []
    if not events or not atlas.forms:
        return points, remarks
    sizes = unknown_sizes(problem)
    periods = wrapped_periods(problem.periods, problem.bounds)
    cut = _cut_of(problem)
    samples = np.concatenate([form.branch.sample(SAMPLES) for form in atlas.forms])
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
    is_wrapped = np.isfinite(wrapped_periods(problem.periods, problem.bounds))
    is_bounded = np.isfinite(problem.bounds).all(axis=1)
    middle = np.zeros(problem.n)
    has_middle = is_bounded & ~is_wrapped
    middle[has_middle] = problem.bounds[has_middle].mean(axis=1)
    return CircleCut(problem.periods, middle)


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
