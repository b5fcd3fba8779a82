"""The picture of a linkage as a drawing for CAD programs: DXF of AutoCAD release 12,
which all of them read, lines and texts on a layer for each kind of part, in the user's
unit of length.

The format is Autodesk's "DXF Reference"; a pair of lines is a group code and a value.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from linkages.pictures.picture import Picture

TEXT = "names"  # the layer of the names of joints
LETTERS = 0.03  # height of letters, in the extent of the picture
ASIDE = 1.5  # how far from a joint its name stands, in the height of letters


def make_dxf(picture: Picture) -> str:
    """The drawing of a picture."""
    letters = LETTERS * float(np.ptp(picture.corners, axis=0).max())
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER")]
    pairs += [(9, "$ACADVER"), (1, "AC1009"), (0, "ENDSEC")]
    pairs += [(0, "SECTION"), (2, "ENTITIES")]
    for stroke in picture.strokes:
        points = stroke.points
        if stroke.closed:
            points = np.concatenate([points, points[:1]])
        for start, end in pairwise(points):
            pairs += [(0, "LINE"), (8, stroke.part.value)]
            pairs += _place(start, 0)
            pairs += _place(end, 1)
    for name in picture.names:
        pairs += [(0, "TEXT"), (8, TEXT)]
        pairs += _place(name.place + ASIDE * letters, 0)
        pairs += [(40, _number(letters)), (1, _in_ascii(name.text))]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def _place(place: np.ndarray, index: int) -> Iterator[tuple[int, str]]:
    """The groups of a point (2,), the first or the second one of an entity."""
    for axis, x in enumerate((*place, 0.0), 1):
        yield 10 * axis + index, _number(x)


def _number(x: float) -> str:
    return repr(float(x) + 0.0)


def _in_ascii(text: str) -> str:
    r"""A text with other letters as \U+XXXX, in one line."""
    letters = [one if " " <= one <= "~" else f"\\U+{ord(one):04X}" for one in text]
    return "".join(letters)
