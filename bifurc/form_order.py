"""In which order the forms of an atlas are listed, in tables, legends and panels."""

from __future__ import annotations

import re
from itertools import pairwise

from bifurc.atlas import Atlas

NUMBER = re.compile(r"(\b[IVX]+\b|[0-9]+)")
ROMAN = {"I": 1, "V": 5, "X": 10}


def listed_numbers(atlas: Atlas) -> list[int]:
    """The numbers of the forms, from 0, in the order of their names: Form 2 before
    Form 10, Form V before Form IX."""
    names = [_words_and_numbers(form.name) for form in atlas.forms]
    return sorted(range(len(names)), key=lambda number: names[number])


def _words_and_numbers(name: str) -> list[str | int]:
    """A name as words and numbers in turn, a word first."""
    parts: list[str | int] = []
    for k, part in enumerate(NUMBER.split(name)):
        is_number = k % 2 == 1
        parts.append(_number(part) if is_number else part)
    return parts


def _number(text: str) -> int:
    """A number in digits or in Roman numerals."""
    if text.isdecimal():
        return int(text)
    values = [ROMAN[letter] for letter in text]
    total = values[-1]
    for value, following in pairwise(values):
        total += value if value >= following else -value
    return total
