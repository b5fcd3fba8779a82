"""Reading a linkage from a TOML file.

Formats are told apart by their keys. A single loop is a Denavit-Hartenberg table in the convention of
`linkages.loop`:

    name = "my linkage"            # optional
    angles = "deg"                 # or "rad"
    lengths = [1.0, 0.65, 1.0, 0.65]
    twists = [100, 40, 100, 40]
    offsets = [0, 0, 0, 0]

or the joint axes in one configuration, in loop order, in any unit and frame:

    points = [[0, 0, 0], [1, 0, 0], ...]
    directions = [[0, 0, 1], [0, 1, 1], ...]

What has ``[[joints]]``, ``[[loops]]``, or ``bars`` or ``arcs`` between ``[points]`` is a
mechanism (`linkages.files.mechanism_file`), and so are crease patterns and the files of
other programs, told by the endings of their names (`linkages.formats.table`).
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from bifurc.errors import PathError
from bifurc.files.text_file import TextFileError, missing_file, read_toml
from linkages.axes import Vectors, loop_from_axes
from linkages.formats.table import TOML, format_of
from linkages.loop import MAX_JOINTS, MIN_JOINTS, Loop
from linkages.mechanisms.origin import WrittenNumber, counted_from_near
from linkages.values import (
    GeometryError,
    check_angle,
    check_keys,
    checked_list,
    checked_number,
    checked_text,
    quoted,
    require,
)

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

log = logging.getLogger(__name__)

Content: TypeAlias = Mapping[str, object]

TABLE = ("lengths", "twists", "offsets")
AXES = ("points", "directions")
OF_MECHANISMS = ("joints", "bars", "arcs", "loops")
KEYS = ("name", "angles", *TABLE, *AXES)
ATLAS_ENDING = ".nc"  # how the name of a saved atlas ends
FULL_TURN = 2 * math.pi
# what is said of a file whose reader does not take an option
NOT_TAKEN = {
    "closures": "takes no closures; a URDF takes them",
    "triangulated": "has no panels to triangulate; FOLD, CP and SVG files have",
}


class AngleUnit(StrEnum):
    """The unit of the twists in a file."""

    DEGREES = "deg"
    RADIANS = "rad"


class LinkageFileError(PathError):
    """A linkage file that cannot be used."""


@contextmanager
def _errors_about(path: Path) -> Iterator[None]:
    """Errors of reading as `LinkageFileError` that names the file."""
    try:
        yield
    except TextFileError as error:
        raise LinkageFileError(path, error.reason) from None
    except GeometryError as error:
        raise LinkageFileError(path, str(error)) from None
    except FileNotFoundError:
        raise LinkageFileError(path, missing_file(path)) from None
    except OSError as error:
        raise LinkageFileError(path, f"cannot be read: {error.strerror}") from None


def read_file(
    path: Path | str, closures: Path | str | None = None, triangulated: bool = False
) -> Loop | Mechanism:
    """The loop or the mechanism that a file describes; without a name it is called
    after the file. A file of ``closures`` closes the loops of a robot; panels of a crease
    pattern bend along diagonals where they are ``triangulated``. Raises
    `LinkageFileError`."""
    path = Path(path)
    if path.suffix == ATLAS_ENDING:
        reason = "is a map that is made already; bifurc view and bifurc route take it"
        raise LinkageFileError(path, reason)
    known = format_of(path)
    options = _options(closures, triangulated)
    for option in options:
        if known is None or option not in known.options:
            raise LinkageFileError(path, NOT_TAKEN[option])
    with _errors_about(path):
        if known is not None and known.read is not None:
            return known.read(path, **options)
        content = read_content(path)
        if not _is_of_mechanism(content):
            return _read_loop(content, path.stem)[0]
        from linkages.files.mechanism_file import read_mechanism

        return read_mechanism(content, path.stem)


def _options(closures: Path | str | None, triangulated: bool) -> dict[str, Any]:
    """Those options of readers that are given; raises `LinkageFileError`."""
    options: dict[str, Any] = {}
    if closures is not None:
        options["closures"] = file = Path(closures)
        with _errors_about(file):
            require(file.is_file(), "closures", quoted(str(file)), "a file")
    if triangulated:
        options["triangulated"] = True
    return options


def read_content(path: Path) -> Content:
    """What a TOML file holds; raises `LinkageFileError` for equations, and
    `TextFileError`."""
    content: Content = read_toml(path, WrittenNumber)
    if {"unknowns", "equations"} <= content.keys():
        message = f"it holds equations; `bifurc solve {path}` solves them"
        raise LinkageFileError(path, message)
    return content


def _is_of_mechanism(content: Content) -> bool:
    """Whether the content of a file is a mechanism, and no single loop."""
    has_points = isinstance(content.get("points"), Mapping)
    return has_points or any(key in content for key in OF_MECHANISMS)


def read_linkage(path: Path | str) -> tuple[Loop, np.ndarray | None]:
    """The loop that a TOML file describes, and its joint angles (n,), rad, where the
    file gives axes (else None).

    A loop without a name is called after the file. Raises `LinkageFileError` for a file
    that cannot be read and for anything wrong in it. Twists that look like degrees in a
    file that says radians are used as they stand, with a warning in the log.
    """
    path = Path(path)
    known = format_of(path)
    is_toml = known is None or known.read is None
    with _errors_about(path):
        content = read_content(path) if is_toml else {}
        if is_toml and not _is_of_mechanism(content):
            return _read_loop(content, path.stem)
    if not is_toml:
        loop = read_file(path)
        if isinstance(loop, Loop):
            return loop, None
    message = "describes a mechanism, and this takes a single loop of revolute joints"
    raise LinkageFileError(path, message)


def read_precisely(path: Path | str) -> Loop:
    """The loop that a TOML file describes, in mpmath numbers at the precision that is
    set.

    The decimals of a table are taken as they are written, degrees turned into radians
    exactly; joint axes give the same loop as `read_linkage`, its doubles taken as
    exact. Raises `LinkageFileError`.
    """
    import mpmath

    loop, configuration = read_linkage(path)
    if configuration is not None or format_of(Path(path)) not in (None, TOML):
        return loop
    with _errors_about(Path(path)):
        content: Mapping[str, Any] = read_toml(Path(path), mpmath.mpf)
    lengths = tuple(mpmath.mpf(length) for length in content["lengths"])
    twists = tuple(mpmath.mpf(twist) for twist in content["twists"])
    offsets = tuple(mpmath.mpf(offset) for offset in content["offsets"])
    if content["angles"] == AngleUnit.DEGREES:
        twists = tuple(twist * mpmath.pi / 180 for twist in twists)
    return Loop(lengths, twists, offsets, loop.name)


# --- keys -----------------------------------------------------------------------------


def _read_loop(content: Content, name: str) -> tuple[Loop, np.ndarray | None]:
    """A loop, called as the content says or else by ``name``, and its joint angles (n,),
    rad, where axes are given."""
    check_keys("key", content, KEYS)
    of_table = [key for key in TABLE if key in content]
    of_axes = [key for key in AXES if key in content]
    both = " with ".join([*of_table[:1], *of_axes[:1]])
    is_one = not (of_table and of_axes)
    require(is_one, "keys", both, "those of a table or those of axes, not both")
    wanted = AXES if of_axes else TABLE
    for key in wanted:
        others = " and ".join(other for other in wanted if other != key)
        is_given = key in content
        require(is_given, key, "a missing list", f"given together with {others}")
    given = checked_text("name", content.get("name", name))
    if of_axes:
        return _read_axes(content, given)
    return _read_table(content, given), None


# --- the two formats ------------------------------------------------------------------


def _read_table(content: Content, name: str) -> Loop:
    lengths = _numbers(content, "lengths")
    twists = _numbers(content, "twists")
    offsets = _numbers(content, "offsets")
    for key, values in (("twists", twists), ("offsets", offsets)):
        is_whole = len(values) == len(lengths)
        allowed = f"{len(lengths)}, the number of lengths"
        require(is_whole, f"number of {key}", len(values), allowed)
    if _angle_unit(content) is AngleUnit.DEGREES:
        for i, twist in enumerate(twists, start=1):
            check_angle(f"twists[{i}]", twist, in_degrees=True)
        _warn_of_radians(twists)
        twists = [math.radians(twist) for twist in twists]
    else:
        _warn_of_degrees(twists)
    return Loop(tuple(lengths), tuple(twists), tuple(offsets), name)


def _read_axes(content: Content, name: str) -> tuple[Loop, np.ndarray]:
    given, directions = (_list(content, key, "vectors [x, y, z]") for key in AXES)
    near = counted_from_near(given)
    # `loop_from_axes` checks every vector
    loop, configuration = loop_from_axes(
        cast(Vectors, near.rows), cast(Vectors, directions), name
    )
    rounding = max(loop.rounding, near.rounding)
    return replace(loop, rounding=rounding), configuration


def _angle_unit(content: Content) -> AngleUnit:
    allowed = '"deg" or "rad"'
    why = f"{allowed}, the unit of the twists"
    require("angles" in content, "angles", "a missing key", why)
    unit = content["angles"]
    require(unit in tuple(AngleUnit), "angles", quoted(unit), allowed)
    return AngleUnit(str(unit))


def _warn_of_degrees(twists: list[float]) -> None:
    for i, twist in enumerate(twists, start=1):
        if abs(twist) > FULL_TURN:
            log.warning(
                'twists[%d] is %g with angles = "rad", more than a full turn; '
                'if it is in degrees, write angles = "deg"',
                i,
                twist,
            )


def _warn_of_radians(twists: list[float]) -> None:
    """Degrees of a table are seldom all so small, and broken numbers as well."""
    are_small = all(abs(twist) <= FULL_TURN for twist in twists)
    if are_small and not all(twist.is_integer() for twist in twists):
        log.warning(
            'no twist is over %.3g with angles = "deg"; if they are in radians, write '
            'angles = "rad"',
            FULL_TURN,
        )


def _list(content: Content, key: str, items: str) -> list[object]:
    values = checked_list(key, content[key], f"a list of {items}")
    is_loop = MIN_JOINTS <= len(values) <= MAX_JOINTS
    allowed = f"one for each joint, {MIN_JOINTS} to {MAX_JOINTS} joints"
    require(is_loop, f"number of {key}", len(values), allowed)
    return values


def _numbers(content: Content, key: str) -> list[float]:
    values = enumerate(_list(content, key, "numbers"), start=1)
    return [checked_number(f"{key}[{i}]", value) for i, value in values]
