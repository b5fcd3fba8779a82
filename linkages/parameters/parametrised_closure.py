"""The closure equations of the members of a family, with parameters among the
unknowns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.recorded import RecordedNumber, Recorder
from bifurc.equations.tape import Tape
from bifurc.equations.valued import ValuedRecorder
from bifurc.parametrised import ParametrisedProblem
from linkages.closure.loop_parts import parts_of_loop
from linkages.closure.motors import IDENTITY, Number, product, turn
from linkages.entry import Entry, Parameter, ParameterKind

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
AT_ORIGIN = np.zeros(3)


def parametrised_closure(
    family: Entry,
    values: Mapping[str, float],
    ranges: Mapping[str, tuple[float, float]],
) -> ParametrisedProblem:
    """The closure of the members of a ``family`` in the n joint angles (rad) and the
    parameters that have ``ranges``; the others, and these at first, have their ``values``.

    Translations are measured in the characteristic length of the first member. All
    conditions of the family hold while parameters move: the constructor itself is recorded.
    Raises `GeometryError` as that does.
    """
    complete = family.complete(values)
    first = family.build(**complete)
    writer = ValuedRecorder([0.0] * first.n + [complete[name] for name in ranges])
    numbers = [writer.number(writer.unknown(k)) for k in range(writer.n)]
    free = dict(zip(ranges, numbers[first.n :], strict=True))
    loop = family.build(**{**complete, **free})
    rows = zip(loop.twists, loop.lengths, loop.offsets, strict=True)
    slots = _residuals(writer, numbers[: first.n], rows, first.characteristic_length)
    tape = writer.tape(slots)
    return ParametrisedProblem(
        tape=tape,
        domain=parts_of_loop(first).domain,
        parameters=domain_of_parameters(family.parameters, ranges),
    )


def domain_of_parameters(
    parameters: Sequence[Parameter], ranges: Mapping[str, tuple[float, float]]
) -> Domain:
    """Those of the ``parameters`` that have ``ranges``."""
    units = {ParameterKind.ANGLE: "rad", ParameterKind.LENGTH: "length"}
    kinds = {parameter.name: parameter.kind for parameter in parameters}
    return Domain(
        names=tuple(ranges),
        units=tuple(units.get(kinds[name], "") for name in ranges),
        periods=np.full(len(ranges), np.inf),
        bounds=np.array(list(ranges.values()), dtype=float).reshape(-1, 2),
    )


def closure_of_tables(n: int, unit: float) -> Tape:
    """The same equations in the n joint angles (rad), twists (rad), lengths and offsets of
    any loop, translations in a ``unit``."""
    recorder = Recorder(4 * n)
    numbers = [recorder.number(recorder.unknown(k)) for k in range(4 * n)]
    rows = zip(
        numbers[n : 2 * n], numbers[2 * n : 3 * n], numbers[3 * n :], strict=True
    )
    return recorder.tape(_residuals(recorder, numbers[:n], rows, unit))


def _residuals(
    recorder: Recorder,
    angles: Sequence[RecordedNumber],
    rows: Iterable[tuple[Number, Number, Number]],
    unit: float,
) -> list[int]:
    """The slots of twice the vector part of the motor of a loop, as a mechanism's; its
    ``rows`` are twist, length and offset."""
    motor = IDENTITY
    for angle, (twist, length, offset) in zip(angles, rows, strict=True):
        for axis, by, advance in ((Z, angle, offset), (X, twist, length)):
            half = 0.5 * by
            step = turn(axis, AT_ORIGIN, np.cos(half), np.sin(half), advance / unit)
            motor = product(motor, step)
    parts = [2.0 * number for number in (*motor.real[1:], *motor.dual[1:])]
    return [
        part.slot
        if isinstance(part, RecordedNumber)
        else recorder.constant(float(part))
        for part in parts
    ]
