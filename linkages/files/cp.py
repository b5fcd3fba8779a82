"""Crease patterns in CP files, as ORIPA, Oriedita and Box Pleating Studio write them: a
line of text for each line, ``type x1 y1 x2 y2``, with y downwards."""

from __future__ import annotations

from linkages.files.crease_lines import CreaseLine, fold_content
from linkages.files.fold import mechanism_of_fold
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError, check_number, quoted, require

LETTERS = {"1": "B", "2": "M", "3": "V"}
AUXILIARY = ("0", "4")  # lines to draw by, which are no creases
WORDS = (
    "type x1 y1 x2 y2, with type 1 (boundary), 2 (mountain), 3 (valley), or 0 or 4 "
    "(auxiliary)"
)


def read_cp(text: str, name: str, triangulated: bool = False) -> Mechanism:
    """The mechanism of a crease pattern, called by ``name``, its panels ``triangulated``
    or not. Auxiliary lines are left out. Raises `GeometryError` with the line."""
    lines = []
    for number, row in enumerate(text.splitlines(), start=1):
        words = row.split()
        if not words:
            continue
        place = f"line {number}"
        known = words[0] in LETTERS or words[0] in AUXILIARY
        require(known and len(words) == 5, place, quoted(row.strip()), WORDS)
        x1, y1, x2, y2 = (_number(place, word) for word in words[1:])
        if words[0] in LETTERS:
            letter = LETTERS[words[0]]
            lines.append(CreaseLine((x1, -y1), (x2, -y2), letter, place))
    return mechanism_of_fold(fold_content(lines), name, triangulated)


def _number(place: str, word: str) -> float:
    try:
        number = float(word)
    except ValueError:
        raise GeometryError(place, quoted(word), "a number") from None
    check_number(place, number)
    return number
