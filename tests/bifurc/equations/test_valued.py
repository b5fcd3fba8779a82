"""Recorded numbers that have a value take the way that their value takes."""

import numpy as np
import pytest

from bifurc.equations.recorded import RecordedArray
from bifurc.equations.valued import ValuedRecorder


def recorded(function, point):
    writer = ValuedRecorder(point)
    numbers = [writer.number(writer.unknown(k)) for k in range(writer.n)]
    return writer.tape([function(*numbers).slot])


def value(tape, *point):
    return tape.compiled.residuals(np.array([point], dtype=float))[0, 0]


def test_a_branch_is_that_of_the_point():
    def function(x, y):
        return x * y if x < y else x - y

    assert value(recorded(function, [1.0, 2.0]), 5.0, 3.0) == 15.0
    assert value(recorded(function, [2.0, 1.0]), 5.0, 3.0) == 2.0


@pytest.mark.parametrize("at", [-0.7, 0.7])
def test_an_absolute_value_has_the_sign_of_the_point(at):
    tape = recorded(lambda x: abs(np.sin(x)), [at])
    assert value(tape, at) == abs(np.sin(at))
    assert value(tape, -at) == -abs(np.sin(at))


def test_numbers_are_compared_by_their_values():
    writer = ValuedRecorder([2.0])
    x = writer.number(writer.unknown(0))
    assert float(x * x + 1.0) == 5.0
    assert x == 2.0
    assert x != 3.0
    assert x <= 2.0 <= x
    assert x > 1.0
    assert not x - 2.0
    assert max(x, 1.0) is x


def test_plain_numbers_beside_it_in_an_array_are_of_the_same_kind():
    writer = ValuedRecorder([0.5])
    x = writer.number(writer.unknown(0))
    array = np.empty(2, dtype=object)
    array[:] = x, 1.0
    cosines = np.cos(array.view(RecordedArray))
    assert float(cosines[1] + cosines[0]) == pytest.approx(np.cos(0.5) + np.cos(1.0))
    assert cosines[1] < 1.0
