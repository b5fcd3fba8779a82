"""Relations between the parameters of a family at whose members the map changes.

One is proposed by whole numbers that bring sums, products or polynomials of the parameters
of one member to zero in many digits, and checked at other members, for which the change is
solved for anew. Source of the search for whole numbers: Ferguson and Bailey's PSLQ.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bifurc.limits import CutOff, Deadline, cut_off_after, until
from linkages.decisions import holds_as_relation
from linkages.entry import ParameterKind, WithParameters
from linkages.parameters.members import Members
from linkages.parameters.moved_changes import DIGITS, GUARD, MovedChange
from linkages.parameters.special import MapChange

if TYPE_CHECKING:
    import mpmath

CHECKED = 50  # members at which a relation is to hold
TRIED = 100  # of which some may be none, or lie beyond a place where the change ends
AWAY = 0.1  # of its value: how far each parameter is moved, so that what is 0 stays
LARGEST = 12  # whole number in it
MOST_ANGLES, MOST_LENGTHS = 4, 4  # in a polynomial
MOST_TERMS = 32  # of a relation
BY_CHANCE = 30  # digits that whole numbers of a relation have together, of DIGITS


class _Term(NamedTuple):
    """A part of a relation as it is written, and its value at a member."""

    text: str
    value: Callable[[Mapping[str, Any]], Any]


class _Shape(NamedTuple):
    """What a relation is made of: a product of powers of terms, or else a sum of their
    multiples."""

    terms: tuple[_Term, ...]
    is_product: bool = False


@dataclass(frozen=True)
class Relation:
    """The ``text`` of an equation between parameters, those left out that are 0, that holds at ``held`` out of so
    many ``members``, at which the change was solved for anew, to ``digits`` at least, 0 where
    it holds for none."""

    text: str
    held: int
    members: int
    digits: int


@dataclass(frozen=True)
class PreciseChange:
    """The ``value`` of a parameter in decimals, to so many digits; and the ``relation``
    that it follows, None where none was found."""

    value: str
    relation: Relation | None


def precise_changes(
    members: Members, changes: Sequence[MapChange], deadline: Deadline
) -> list[PreciseChange | None]:
    """What is known of each of the ``changes`` over the only free parameter of
    ``members``, None where it is not the solution of equations or is lost; of the first
    ones only where Ctrl-C or the deadline ends it."""
    known: list[PreciseChange | None] = []
    try:
        with until(deadline), cut_off_after(deadline):
            for change in changes:
                if deadline.passed:
                    break
                known.append(_precise_change(members, change))
    except (KeyboardInterrupt, CutOff):
        pass
    return known


def _precise_change(members: Members, change: MapChange) -> PreciseChange | None:
    """What is known of one change."""
    if change.problem is None or change.solution is None:
        return None
    import mpmath

    (free,) = members.free
    values = members.with_values(np.array([change.value]))
    first = replace(members, values=values).with_all_free
    moved = MovedChange(first, free.name, change.problem, change.solution)
    precise = moved.at(values)
    if precise is None:
        return None
    with mpmath.workdps(DIGITS):
        value = mpmath.nstr(precise[free.name], DIGITS)
    others = list(itertools.islice(_other_members(moved, values), CHECKED + 1))
    with mpmath.workdps(DIGITS + GUARD):
        return PreciseChange(value, _relation(members.family, free.name, others))


def _relation(
    family: WithParameters, free: str, members: Sequence[Mapping[str, Any]]
) -> Relation | None:
    """The simplest relation that holds at the first one of the members and any other,
    checked at all others; None where there is none among those that are looked for."""
    if not members:
        return None
    for any_terms in _shapes(family, free):
        shape = _without_zeros(any_terms, members[0])
        whole = _whole_numbers(shape, members[0])
        if whole is None:
            continue
        relation = _checked(shape, whole, members[1:])
        if relation.held:
            return relation
    return None


def _other_members(
    change: MovedChange, values: Mapping[str, float]
) -> Iterator[dict[str, mpmath.mpf]]:
    """Random members with the parameter at which their map changes."""
    rng = np.random.default_rng(0)
    for _ in range(TRIED):
        others = {
            name: value * (1.0 + AWAY * rng.uniform(-1.0, 1.0))
            for name, value in values.items()
        }
        member = change.at(others)
        if member is not None:
            yield member


def _checked(
    shape: _Shape, whole: Sequence[int], members: Sequence[Mapping[str, Any]]
) -> Relation:
    """A relation with the members at which it holds."""
    misses = [_miss(shape, whole, member) for member in members]
    held = [miss for miss in misses if holds_as_relation(miss)]
    digits = int(-math.log10(max(10.0**-DIGITS, *held))) if held else 0
    return Relation(_text(shape, whole), len(held), len(members), digits)


def _miss(shape: _Shape, whole: Sequence[int], member: Mapping[str, Any]) -> float:
    """What is left of a relation at a member, over its largest part."""
    import mpmath

    parts = [n * value for n, value in zip(whole, _numbers(shape, member), strict=True)]
    return float(abs(mpmath.fsum(parts)) / max(map(abs, parts)))


def _numbers(shape: _Shape, member: Mapping[str, Any]) -> list[Any]:
    """What is added up in a relation: of a product the logarithms."""
    import mpmath

    values = [term.value(member) for term in shape.terms]
    return [mpmath.log(abs(v)) for v in values] if shape.is_product else values


def _without_zeros(shape: _Shape, member: Mapping[str, Any]) -> _Shape:
    """The terms that are not 0, nor factors of 1, at a member."""
    values = [term.value(member) for term in shape.terms]
    idle = (0, 1) if shape.is_product else (0,)
    terms = [
        term
        for term, value in zip(shape.terms, values, strict=True)
        if abs(value) not in idle
    ]
    return shape._replace(terms=tuple(terms))


def _whole_numbers(shape: _Shape, member: Mapping[str, Any]) -> list[int] | None:
    """The whole numbers of a relation that holds at a member, None where there is
    none."""
    import mpmath

    if len(shape.terms) < 2:
        return None
    tolerance = mpmath.mpf(holds_as_relation.threshold)
    numbers = _numbers(shape, member)
    # as many as no number of so many digits fits by chance
    largest = min(LARGEST, int(0.5 * (10.0 ** (BY_CHANCE / len(numbers)) - 1.0)))
    found = mpmath.pslq(numbers, tol=tolerance, maxcoeff=largest, maxsteps=100_000)
    return None if found is None else [int(n) for n in found]


# --- of what relations are made -------------------------------------------------------


def _shapes(family: WithParameters, free: str) -> Iterator[_Shape]:
    """What relations with the parameter called ``free`` are looked for, simple ones
    first."""
    kinds = {one.name: one.kind for one in family.parameters}
    angles = [name for name, kind in kinds.items() if kind is ParameterKind.ANGLE]
    others = [name for name in kinds if name not in angles]
    plain = [_Term(name, _value_of(name)) for name in others]
    half_tangents = [_of_angle(name, "tan", 2) for name in angles]
    if free in angles:
        own = [_Term(name, _value_of(name)) for name in angles]
        yield _Shape((*own, PI))
        yield _Shape(tuple(half_tangents), is_product=True)
    else:
        yield _Shape(tuple(plain))
    for function in ("sin", "cos"):
        of_angles = [_of_angle(name, function) for name in angles]
        yield _Shape((*plain, *of_angles, TWO), is_product=True)
    yield from _products_with_sums(others, angles)
    if free in angles and len(angles) <= MOST_ANGLES:
        yield _Shape(_monomials(half_tangents))
    if free not in angles and len(others) <= MOST_LENGTHS:
        pairs = itertools.combinations_with_replacement(plain, 2)
        yield _Shape(tuple(_product(pair) for pair in pairs))


def _pi(_: Mapping[str, Any]) -> Any:
    import mpmath

    return +mpmath.pi


def _two(_: Mapping[str, Any]) -> Any:
    import mpmath

    return mpmath.mpf(2)


PI, TWO = _Term("pi", _pi), _Term("2", _two)


def _products_with_sums(
    others: Sequence[str], angles: Sequence[str]
) -> Iterator[_Shape]:
    """Products in which sums and differences of two lengths or angles stand as well: those
    of lengths and sines, as in the ratios of a Bennett linkage whose links are joined of
    two, and those of sines of half the angles; then sums of sines of sums of three."""
    lengths = [_sum(parts) for parts in _signed_sums(others, 2)]
    sines = [_sine(parts, 1) for parts in _signed_sums(angles, 2)]
    half_sines = [_sine(parts, 2) for parts in _signed_sums(angles, 2)]
    half_cosines = [_of_angle(name, "cos", 2) for name in angles]
    for terms in ([*lengths, *sines, TWO], [*half_sines, *half_cosines]):
        if len(terms) <= MOST_TERMS:
            yield _Shape(tuple(terms), is_product=True)
    sums = [_sine(parts, 1) for parts in _signed_sums(angles, 3)]
    if len(sums) <= MOST_TERMS:
        yield _Shape(tuple(sums))


def _signed_sums(
    names: Sequence[str], most: int
) -> Iterator[tuple[tuple[int, str], ...]]:
    """The sums of up to so many, with signs of which the first is +."""
    for size in range(1, most + 1):
        for chosen in itertools.combinations(names, size):
            for signs in itertools.product((1, -1), repeat=size - 1):
                yield tuple(zip((1, *signs), chosen, strict=True))


def _sum(parts: Sequence[tuple[int, str]]) -> _Term:
    """A sum of parameters with signs."""
    text = " ".join(f"{'-' if sign < 0 else '+'} {name}" for sign, name in parts)[2:]
    whole = text if len(parts) == 1 else f"({text})"
    return _Term(whole, lambda member: sum(sign * member[name] for sign, name in parts))


def _sine(parts: Sequence[tuple[int, str]], divisor: int) -> _Term:
    """The sine of a sum of angles over a whole number."""
    import mpmath

    total = _sum(parts)
    text = total.text.strip("()") if divisor == 1 else f"{total.text}/{divisor}"
    return _Term(
        f"sin({text})", lambda member: mpmath.sin(total.value(member) / divisor)
    )


def _value_of(name: str) -> Callable[[Mapping[str, Any]], Any]:
    return lambda member: member[name]


def _of_angle(name: str, function: str, divisor: int = 1) -> _Term:
    """A function of an angle over a whole number."""
    import mpmath

    text = name if divisor == 1 else f"{name}/{divisor}"
    return _Term(
        f"{function}({text})",
        lambda member: getattr(mpmath, function)(member[name] / divisor),
    )


def _monomials(terms: Sequence[_Term]) -> tuple[_Term, ...]:
    """All products of different terms, the empty one among them."""
    return tuple(
        _product(chosen)
        for size in range(len(terms) + 1)
        for chosen in itertools.combinations(terms, size)
    )


def _product(terms: Sequence[_Term]) -> _Term:
    import mpmath

    text = " ".join(term.text for term in terms) or "1"
    return _Term(
        text, lambda member: mpmath.fprod(term.value(member) for term in terms)
    )


# --- how one is written ---------------------------------------------------------------


def _text(shape: _Shape, whole: Sequence[int]) -> str:
    """A relation with nothing negative on either side."""
    write = _as_product if shape.is_product else _as_sum
    parts = [
        (number, term.text) for number, term in zip(whole, shape.terms, strict=True)
    ]
    # parameters stand before constants: these are on the right
    sign = next(1 if number > 0 else -1 for number, _ in parts if number)
    left = write([(abs(n), text) for n, text in parts if sign * n > 0])
    right = write([(abs(n), text) for n, text in parts if sign * n < 0])
    return f"{left} = {right}"


def _as_sum(parts: Sequence[tuple[int, str]]) -> str:
    return " + ".join(text if n == 1 else f"{n} {text}" for n, text in parts) or "0"


def _as_product(parts: Sequence[tuple[int, str]]) -> str:
    return " ".join(text if n == 1 else f"{text}^{n}" for n, text in parts) or "1"
