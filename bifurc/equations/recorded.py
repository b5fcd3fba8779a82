"""Numbers and arrays that write down what is done with them.

A callable that is called with a `RecordedArray` in the place of its unknowns leaves its
operations on a `TapeWriter`. What cannot be written down raises `NotRecordable` with a
sentence.
"""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import Any, NoReturn

import numpy as np

from bifurc.equations.tape import IN_DOUBLES, TapeWriter

BRANCHES = "it branches on the value of an unknown"
PLAIN = (
    "it turns an unknown into a plain number, by float(), a function of math or an "
    "array of floats; numpy's functions and arrays of u.dtype can be recorded"
)
ABSOLUTE = "it takes an absolute value or a sign, which has no derivative at 0"
WHOLE = "it rounds an unknown or takes a remainder"
COMPLEX = "it uses complex numbers"
INDEX = "it takes an unknown for an index"
NEGATIVE_BASE = "it raises a number that is not positive to an unknown"


class NotRecordable(Exception):
    """A callable that cannot be recorded; ``reason`` says why."""

    def __init__(self, reason: str):
        self.reason = reason
        super().__init__(reason)


class Recorder(TapeWriter):
    """A tape while a callable writes on it. ``refusal`` is why it cannot, empty while
    it can: a callable may catch the exception and go on."""

    refusal: str = ""

    def number(self, slot: int) -> RecordedNumber:
        """What a slot holds, as a number to compute with."""
        return RecordedNumber(self, slot)

    def refuse(self, reason: str) -> NoReturn:
        """Raise `NotRecordable`, and remember it."""
        self.refusal = self.refusal or reason
        raise NotRecordable(reason)


def _operators(name: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """An operator of recorded numbers and the reflected one, by the method that writes
    it on a tape."""

    def method(self: RecordedNumber, other: object) -> Any:
        return self.binary(other, name, is_reflected=False)

    def reflected(self: RecordedNumber, other: object) -> Any:
        return self.binary(other, name, is_reflected=True)

    return method, reflected


def _refusal(reason: str) -> Callable[..., Any]:
    """A method of recorded numbers that leaves no trace on a tape."""

    def method(self: RecordedNumber, *_: object) -> NoReturn:
        self.writer.refuse(reason)

    return method


class RecordedNumber:
    """A number on a tape that is being written."""

    __slots__ = ("slot", "writer")
    __array_priority__ = 1000.0

    def __init__(self, writer: Recorder, slot: int):
        self.writer = writer
        self.slot = slot

    def __repr__(self) -> str:
        return f"<RecordedNumber in slot {self.slot}>"

    # --- arithmetic -------------------------------------------------------------------

    def _of(self, slot: int) -> RecordedNumber:
        return self.writer.number(slot)

    def _slot_of(self, other: object) -> int | None:
        """The slot of the other operand; None where it is no number."""
        if isinstance(other, RecordedNumber):
            return other.slot
        if isinstance(other, Real | np.bool_):
            return self.writer.constant(float(other))
        if isinstance(other, complex | np.complexfloating):
            self.writer.refuse(COMPLEX)
        return None

    def binary(self, other: object, name: str, *, is_reflected: bool) -> Any:
        """What an operation on this number and another one is; ``name`` is that of the
        method which writes it."""
        if isinstance(other, np.ndarray):
            return NotImplemented
        slot = self._slot_of(other)
        if slot is None:
            return NotImplemented
        operands = (slot, self.slot) if is_reflected else (self.slot, slot)
        if name == "power":
            return self._of(self._power(*operands))
        return self._of(getattr(self.writer, name)(*operands))

    __add__, __radd__ = _operators("add")
    __sub__, __rsub__ = _operators("subtract")
    __mul__, __rmul__ = _operators("multiply")
    __truediv__, __rtruediv__ = _operators("divide")
    __pow__, __rpow__ = _operators("power")
    arctan2, _ = _operators("angle")  # of the vector (other, self)

    def _power(self, base: int, exponent: int) -> int:
        value = self.writer.value(base)
        if value is not None and not value > 0.0:
            self.writer.refuse(NEGATIVE_BASE)
        if self.writer.value(exponent) == 0.0:
            return self.writer.constant(1.0)  # in NumPy of what is no number as well
        return self.writer.power(base, exponent)

    def __neg__(self) -> RecordedNumber:
        return self._of(self.writer.negative(self.slot))

    def __pos__(self) -> RecordedNumber:
        return self

    # --- what NumPy looks for on the elements of an array -----------------------------

    def conjugate(self) -> RecordedNumber:
        """The number, which is real."""
        return self

    def square(self) -> RecordedNumber:
        """Its square."""
        return self._of(self.writer.multiply(self.slot, self.slot))

    def hypot(self, other: object) -> Any:
        """The length of the vector (self, other)."""
        return (self * self + other * other).sqrt()  # type: ignore[operator]

    def __getattr__(self, name: str) -> Callable[[], RecordedNumber]:
        """A function of one number, by its name in NumPy."""
        operation = _BY_NUMPY_NAME.get(name)
        if operation is not None:
            return lambda: self._of(self.writer.apply(operation, self.slot))
        factor = _FACTORS.get(name)
        if factor is not None:
            return lambda: self * factor
        logarithm = _LOGARITHMS.get(name)
        if logarithm is not None:
            return lambda: self.log() / logarithm
        if name == "exp2":
            return lambda: 2.0**self
        raise AttributeError(name)

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any
    ) -> Any:
        arrays = [_array_of(value) for value in inputs]
        result = getattr(ufunc, method)(*arrays, **options)
        is_number = isinstance(result, np.ndarray) and result.ndim == 0
        return result.item() if is_number else result

    # --- what leaves no trace on a tape -----------------------------------------------

    __lt__ = __le__ = __gt__ = __ge__ = __bool__ = _refusal(BRANCHES)
    __eq__ = __ne__ = _refusal(BRANCHES)
    __hash__ = object.__hash__
    __float__ = _refusal(PLAIN)
    __complex__ = _refusal(COMPLEX)
    __abs__ = _refusal(ABSOLUTE)
    __int__ = __floor__ = __ceil__ = __trunc__ = __round__ = _refusal(WHOLE)
    __mod__ = __rmod__ = __floordiv__ = __rfloordiv__ = __divmod__ = _refusal(WHOLE)
    __index__ = _refusal(INDEX)


_BY_NUMPY_NAME = {
    function.__name__: operation for operation, function in IN_DOUBLES.items()
}
_FACTORS = {
    "deg2rad": np.pi / 180.0,
    "radians": np.pi / 180.0,
    "rad2deg": 180.0 / np.pi,
    "degrees": 180.0 / np.pi,
}
_LOGARITHMS = {"log2": float(np.log(2.0)), "log10": float(np.log(10.0))}

# --- arrays ---------------------------------------------------------------------------

# Functions that NumPy looks for as methods of the elements, which plain numbers have
# not.
_BY_ELEMENT = {*_BY_NUMPY_NAME, *_FACTORS, *_LOGARITHMS, "exp2", "hypot", "arctan2"}
_COMPARING = ("maximum", "minimum", "fmax", "fmin", "heaviside", "copysign")
_TESTING = ("isfinite", "isnan", "isinf", "signbit")
_ROUNDING = ("floor", "ceil", "rint", "trunc", "fmod", "remainder", "modf")
_REFUSED = {
    **dict.fromkeys(("absolute", "fabs", "sign"), ABSOLUTE),
    **dict.fromkeys((*_COMPARING, *_TESTING), BRANCHES),
    **dict.fromkeys(_ROUNDING, WHOLE),
}


class RecordedArray(np.ndarray):
    """An array of objects: recorded numbers, and plain numbers among them."""

    __array_priority__ = 1.0  # np.concatenate makes one of these, too

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any
    ) -> Any:
        name = ufunc.__name__
        if name == "reciprocal":
            return 1.0 / self
        arrays = [_plain_view(value) for value in inputs]
        if name in _BY_ELEMENT or name in _REFUSED:
            writer = _writer_of(arrays)
            if writer is not None:
                if name in _REFUSED:
                    writer.refuse(_REFUSED[name])
                arrays = [_all_recorded(array, writer) for array in arrays]
        if "out" in options:
            options["out"] = tuple(_plain_view(value) for value in options["out"])
        result = getattr(ufunc, method)(*arrays, **options)
        if "out" in options:
            return options["out"][0].view(RecordedArray)
        is_array = isinstance(result, np.ndarray) and result.dtype == object
        return result.view(RecordedArray) if is_array else result


def unknowns_of(writer: Recorder) -> RecordedArray:
    """The unknowns (n,) of a tape that is being written."""
    unknowns = np.empty(writer.n, dtype=object)
    for i in range(writer.n):
        unknowns[i] = writer.number(writer.unknown(i))
    return unknowns.view(RecordedArray)


def _array_of(value: Any) -> Any:
    """A recorded number as an array without axes; anything else as it is."""
    if not isinstance(value, RecordedNumber):
        return value
    array = np.empty((), dtype=object)
    array[()] = value
    return array.view(RecordedArray)


def _plain_view(value: Any) -> Any:
    """A recorded array as NumPy's own; anything else as it is."""
    return value.view(np.ndarray) if isinstance(value, RecordedArray) else value


def _writer_of(arrays: list[Any]) -> Recorder | None:
    """The tape that one of the elements is written on."""
    for array in arrays:
        for element in np.ravel(np.asarray(array, dtype=object)):
            if isinstance(element, RecordedNumber):
                return element.writer
    return None


def _all_recorded(array: Any, writer: Recorder) -> np.ndarray:
    """An array (any shape) whose plain numbers are constants on the tape as well."""
    recorded = np.array(array, dtype=object)
    for place in np.ndindex(recorded.shape):
        element = recorded[place]
        if not isinstance(element, RecordedNumber):
            slot = writer.constant(float(element))
            recorded[place] = writer.number(slot)
    return recorded
