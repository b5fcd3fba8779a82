"""Reading a linkage from a TOML file.

Two formats, told apart by their keys. A Denavit-Hartenberg table in the convention of
`linkages.loop`:

    name = "my linkage"            # optional
    angles = "deg"                 # or "rad"
    lengths = [1.0, 0.65, 1.0, 0.65]
    twists = [100, 40, 100, 40]
    offsets = [0, 0, 0, 0]

or the joint axes in one configuration, in loop order, in any unit and frame:

    points = [[0, 0, 0], [1, 0, 0], ...]
    directions = [[0, 0, 1], [0, 1, 1], ...]
"""

from __future__ import annotations

import difflib
import logging
import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bifurc.errors import BifurcError
from linkages.loop import MAX_JOINTS, MIN_JOINTS, GeometryError, Loop, loop_from_axes

__all__ = ["LinkageFileError", "read_linkage", "read_precisely"]

log = logging.getLogger(__name__)

TABLE, AXES = ("lengths", "twists", "offsets"), ("points", "directions")
KNOWN = ("name", "angles", *TABLE, *AXES)
FULL_TURN = 2 * math.pi


class LinkageFileError(BifurcError, ValueError):
    """A linkage file that cannot be used: which file, and what in it must be what."""

    def __init__(self, path: Path | str, message: str):
        self.path, self.message = str(path), message
        super().__init__(f"{path}: {message}")


def read_linkage(path: Path | str) -> tuple[Loop, np.ndarray | None]:
    """The loop that a TOML file describes, and its joint angles (n,), rad, where the
    file gives axes (else None).

    A loop without a name is called after the file. Raises `LinkageFileError` for a file
    that cannot be read and for anything wrong in it. Twists that look like degrees in a
    file that says radians are used as they stand, with a warning in the log.
    """
    path = Path(path)
    content = _parse(path)
    try:
        _check_keys(content)
        name = content.get("name", path.stem)
        if not isinstance(name, str):
            raise GeometryError("name", _shown(name), "a text in quotes")
        if any(key in content for key in AXES):
            return loop_from_axes(*_axes(content), name)
        return _table(content, name), None
    except GeometryError as error:
        raise LinkageFileError(path, str(error)) from None


def read_precisely(path: Path | str) -> Loop:
    """The loop that a TOML file describes, in mpmath numbers at the precision that is
    set.

    The decimals of a table are taken as they are written, degrees turned into radians
    exactly; joint axes give the same loop as `read_linkage`, its doubles taken as
    exact. Raises `LinkageFileError`.
    """
    import mpmath

    loop, configuration = read_linkage(path)
    if configuration is not None:
        return loop
    content = tomllib.loads(
        Path(path).read_text(encoding="utf-8"), parse_float=mpmath.mpf
    )
    lengths, twists, offsets = (
        tuple(mpmath.mpf(x) for x in content[key]) for key in TABLE
    )
    if content["angles"] == "deg":
        twists = tuple(twist * mpmath.pi / 180 for twist in twists)
    return Loop(lengths, twists, offsets, loop.name)


def _parse(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise LinkageFileError(path, "there is no such file") from None
    except OSError as error:
        raise LinkageFileError(path, f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise LinkageFileError(
            path, f"is not UTF-8 text: byte {error.start} is wrong"
        ) from None
    except (
        tomllib.TOMLDecodeError
    ) as error:  # its message ends with the line and the column
        raise LinkageFileError(path, f"is not valid TOML: {error}") from None


def _check_keys(content: Mapping[str, Any]) -> None:
    """Every key is known, and they make one of the two formats, whole."""
    for key in content:
        if key not in KNOWN:
            near = difflib.get_close_matches(key, KNOWN, n=1, cutoff=0.0)[0]
            allowed = "one of " + ", ".join(KNOWN)
            raise GeometryError("key", f"{key!r} (the nearest is {near!r})", allowed)
    both = [[key for key in group if key in content] for group in (TABLE, AXES)]
    if all(both):
        raise GeometryError(
            "keys",
            f"{both[0][0]} with {both[1][0]}",
            "those of a table or those of axes, not both",
        )
    wanted = AXES if both[1] else TABLE
    for key in wanted:
        if key not in content:
            raise GeometryError(
                key, "a missing list", f"given together with {_others(wanted, key)}"
            )


def _others(group: tuple[str, ...], key: str) -> str:
    return " and ".join(other for other in group if other != key)


def _table(content: Mapping[str, Any], name: str) -> Loop:
    lengths, twists, offsets = (_numbers(content, key) for key in TABLE)
    for key, values in (("twists", twists), ("offsets", offsets)):
        if len(values) != len(lengths):
            raise GeometryError(
                f"number of {key}",
                len(values),
                f"{len(lengths)}, the number of lengths",
            )
    if _in_degrees(content):
        twists = [math.radians(twist) for twist in twists]
    else:
        for i, twist in enumerate(twists, start=1):
            if abs(twist) > FULL_TURN:
                log.warning(
                    'twists[%d] is %g with angles = "rad", more than a full turn; if it is in degrees, write '
                    'angles = "deg"',
                    i,
                    twist,
                )
    return Loop(tuple(lengths), tuple(twists), tuple(offsets), name)


def _in_degrees(content: Mapping[str, Any]) -> bool:
    if "angles" not in content:
        raise GeometryError(
            "angles", "a missing key", '"deg" or "rad", the unit of the twists'
        )
    unit = content["angles"]
    if unit not in ("deg", "rad"):
        raise GeometryError("angles", _shown(unit), '"deg" or "rad"')
    return bool(unit == "deg")


def _list(content: Mapping[str, Any], key: str, of: str) -> list[Any]:
    values = content[key]
    if not isinstance(values, list):
        raise GeometryError(key, _shown(values), f"a list of {of}")
    if not MIN_JOINTS <= len(values) <= MAX_JOINTS:
        allowed = f"one for each joint, {MIN_JOINTS} to {MAX_JOINTS} joints"
        raise GeometryError(f"number of {key}", len(values), allowed)
    return values


def _numbers(content: Mapping[str, Any], key: str) -> list[float]:
    return [
        _number(value, f"{key}[{i}]")
        for i, value in enumerate(_list(content, key, "numbers"), start=1)
    ]


def _number(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise GeometryError(what, _shown(value), "a number")
    if not math.isfinite(value):
        raise GeometryError(what, value, "a finite number")
    return float(value)


def _axes(content: Mapping[str, Any]) -> tuple[list[list[float]], list[list[float]]]:
    points, directions = (_vectors(content, key) for key in AXES)
    if len(points) != len(directions):
        raise GeometryError(
            "number of directions",
            len(directions),
            f"{len(points)}, the number of points",
        )
    return points, directions


def _vectors(content: Mapping[str, Any], key: str) -> list[list[float]]:
    out = []
    for i, row in enumerate(_list(content, key, "vectors [x, y, z]"), start=1):
        if not isinstance(row, list) or len(row) != 3:
            raise GeometryError(f"{key}[{i}]", _shown(row), "a vector [x, y, z]")
        out.append([_number(x, f"{key}[{i}][{j}]") for j, x in enumerate(row, start=1)])
    return out


def _shown(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value)
