"""Numbers that geometry is given in: what they may be, and how errors show them."""

from __future__ import annotations

import difflib
import math
import numbers
import sys
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any, TypeGuard

from bifurc.errors import ValueNotAllowed

# beyond it doubles tell an angle to less than 1e-12 rad, to which loops close
MOST_TURNS = 1000
SHORTEST, LONGEST = 1e-100, 1e100  # vectors whose squares are in the range of doubles
# of a word with a typo to the word; 'lengths' has 0.6 to 'angles', 'turns' 0.9 to 'turn'
LIKENESS = 0.75
FEWEST_DIGITS, ALL_DIGITS = 6, 17  # of numbers in errors
ANY, SOME = range(sys.maxsize), range(1, sys.maxsize)  # entries of a list


class GeometryError(ValueNotAllowed):
    """A linkage that cannot be built: ``name`` is the offending quantity."""


def require(is_met: bool, name: str, value: object, allowed: str) -> None:
    """Raises `GeometryError` of these parts unless what must be ``is_met``."""
    if not is_met:
        raise GeometryError(name, value, allowed)


def check_keys(what: str, keys: Iterable[object], allowed: Sequence[str]) -> None:
    """Raises `GeometryError` for a key of a table of a file that is not ``allowed``,
    with the one that is nearly it, if there is one."""
    for key in keys:
        if key not in allowed:
            near = difflib.get_close_matches(str(key), allowed, n=1, cutoff=LIKENESS)
            value = f"{key!r} (the nearest is {near[0]!r})" if near else f"{key!r}"
            raise GeometryError(what, value, "one of " + ", ".join(allowed))


def checked_list(
    name: str, value: object, allowed: str, counts: Container[int] = ANY
) -> list[Any]:
    """A list of a file; raises `GeometryError` for what is none, and for another number
    of entries than one of ``counts``."""
    if not isinstance(value, list) or len(value) not in counts:
        raise GeometryError(name, quoted(value), allowed)
    return value


def checked_table(name: str, value: object, allowed: str) -> Mapping[str, Any]:
    """A table of a file; raises `GeometryError` for what is none."""
    if not isinstance(value, Mapping):
        raise GeometryError(name, quoted(value), allowed)
    return value


def checked_text(name: str, value: object) -> str:
    """A text of a file; raises `GeometryError` for what is none."""
    if not isinstance(value, str):
        raise GeometryError(name, quoted(value), "a text in quotes")
    return value


def checked_number(name: str, value: Any) -> float:
    """A float; raises `GeometryError` as `check_number`."""
    check_number(name, value)
    return float(value)


def check_number(name: str, value: object) -> None:
    """Raises `GeometryError` unless ``value`` is a real number and, where it is a float
    or an integer, finite.

    Mpmath numbers, sympy expressions and exact numbers are real numbers, too.
    """
    if type(value) is float and math.isfinite(value):
        return  # as a rule
    if _is_float(value) and not isinstance(value, bool):
        if not _is_finite(value):
            raise GeometryError(name, value, "a finite number")
    elif not _is_number_of_library(value):
        raise GeometryError(name, quoted(value), "a number")


def _is_float(value: object) -> TypeGuard[float]:
    """Whether a value is a float or becomes one: a float or an integer of Python or of
    numpy, which takes long to import."""
    is_scalar = hasattr(value, "dtype") and isinstance(value, numbers.Real)
    return isinstance(value, int | float) or is_scalar


def _is_finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all floats
        return False


def _is_number_of_library(value: object) -> bool:
    """Whether a value that is no float is a real number of mpmath, sympy or
    `linkages.construction.exact`."""
    if isinstance(value, bool) or hasattr(value, "dtype"):
        return False
    if isinstance(value, numbers.Complex):
        return isinstance(value, numbers.Real)
    return hasattr(value, "__float__")


def quoted(value: object) -> str:
    """``value`` as error messages show it, texts in quotes."""
    return f'"{value}"' if isinstance(value, str) else str(value)


def check_angle(name: str, value: object, *, in_degrees: bool = False) -> None:
    """Raises `GeometryError` as `check_number`, and for a float of over a thousand
    turns, in rad or ``in_degrees``."""
    check_number(name, value)
    turn, unit = (360.0, "deg") if in_degrees else (2 * math.pi, "rad")
    largest = MOST_TURNS * turn
    if not _is_float(value):
        return
    angle = float(value)
    if not abs(angle) <= largest:
        shown, bound = told_apart(angle, largest)
        allowed = f"between -{bound} and {bound} {unit}, {MOST_TURNS} turns"
        raise GeometryError(name, f"{shown} {unit}", allowed)


def check_numbers(name: str, values: Sequence[object]) -> None:
    """Raises `GeometryError` as `check_number` for each value; entries are counted from
    1."""
    if _are_finite_floats(values):
        return  # as a rule, and thousands of times when a linkage is identified
    for i, value in enumerate(values, start=1):
        check_number(f"{name}[{i}]", value)


def check_angles(name: str, values: Sequence[object]) -> None:
    """Raises `GeometryError` as `check_angle` for each value, rad; entries are counted
    from 1."""
    if _are_finite_floats(values, MOST_TURNS * 2 * math.pi):
        return
    for i, value in enumerate(values, start=1):
        check_angle(f"{name}[{i}]", value)


def _are_finite_floats(values: Sequence[Any], largest: float = math.inf) -> bool:
    """Whether all values are floats, not `numpy.float64`, finite and no larger."""
    if set(map(type, values)) != {float} or not all(map(math.isfinite, values)):
        return False
    return bool(max(map(abs, values)) <= largest)


def checked_vector(name: str, row: object) -> tuple[float, float, float]:
    """A vector [x, y, z] of finite numbers; raises `GeometryError` for anything else."""
    allowed = "a vector [x, y, z]"
    if isinstance(row, str) or not isinstance(row, Iterable):
        raise GeometryError(name, quoted(row), allowed)
    coordinates = list(row)
    if len(coordinates) != 3:
        raise GeometryError(name, coordinates, allowed)
    for k, coordinate in enumerate(coordinates, start=1):
        check_number(f"{name}[{k}]", coordinate)
    x, y, z = (float(coordinate) for coordinate in coordinates)
    return (x, y, z)


def check_direction(name: str, vector: Sequence[float]) -> None:
    """Raises `GeometryError` for a vector without direction, or one so short or so long
    that its square is none that doubles have."""
    size = max(abs(coordinate) for coordinate in vector)
    if not size > 0:
        raise GeometryError(name, _listed(vector), "a non-zero vector")
    if not SHORTEST <= size <= LONGEST:
        allowed = f"a vector of a length between {SHORTEST:g} and {LONGEST:g}"
        raise GeometryError(name, _listed(vector), allowed)


def _listed(vector: Sequence[float]) -> str:
    return ", ".join(f"{float(coordinate):.16g}" for coordinate in vector)


def told_apart(value: float, *others: float) -> list[str]:
    """All numbers with as few digits, six at least, as tell ``value`` from the
    others; zero has no sign."""
    for digits in range(FEWEST_DIGITS, ALL_DIGITS + 1):
        first, *rest = (f"{x + 0.0:.{digits}g}" for x in (value, *others))
        pairs = zip(rest, others, strict=True)
        if all(text != first or other == value for text, other in pairs):
            break
    return [first, *rest]
