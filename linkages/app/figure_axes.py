"""What the figures of a map are drawn over: unknowns by the names of their joints, or by
their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from linkages.app.exit_codes import CommandError
from linkages.app.subject import as_subject

if TYPE_CHECKING:
    from linkages.linkage import Linkage
    from linkages.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class FigureAxes:
    """What figures are drawn over: two or three unknowns for the transition map, one
    for the singular values, each numbered from 1; the usual ones where nothing is
    said."""

    transition_map: tuple[int, ...] = ()
    singular_values: int | None = None


def figure_axes(
    linkage: Linkage | Mechanism,
    axes: Sequence[str] | None,
    against: Sequence[str] | None,
) -> FigureAxes:
    """What the figures of a linkage are drawn over, for the names or numbers of its
    joints; raises `CommandError` for one that it does not have, or that is named
    twice."""
    if axes is None and against is None:
        return FigureAxes()
    names = as_subject(linkage).unknowns
    numbers = read_numbers("--against", against or (), names)
    return FigureAxes(
        read_numbers("--axes", axes or (), names), numbers[0] if numbers else None
    )


def read_numbers(
    option: str, words: Sequence[str], names: Sequence[str]
) -> tuple[int, ...]:
    """The numbers, from 1, of the unknowns that ``words`` name, or else number."""
    numbers: list[int] = []
    for word in words:
        number = number_of(word, names)
        if number is None:
            raise CommandError(
                f"{option}: there is no joint {word} to draw over; the names are "
                f"{', '.join(names)}, the numbers 1 to {len(names)}"
            )
        if number in numbers:
            raise CommandError(f"{option} {word}: {names[number - 1]} is named twice")
        numbers.append(number)
    return tuple(numbers)


def number_of(word: str, names: Sequence[str]) -> int | None:
    """The number, from 1, of the unknown that has this name or else this number; None
    where there is none. Joints may be called by numbers of their own."""
    if word in names:
        return names.index(word) + 1
    if word.isdecimal() and 1 <= int(word) <= len(names):
        return int(word)
    return None
