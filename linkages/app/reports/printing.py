"""Printed parts as `bifurc export` makes them: sizes from the command line, seats of
the hinges, the file and what is said of it."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.tables import table
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.options import PrintOptions
from linkages.app.texts.configurations import show_configuration
from linkages.geometry_table import link_name
from linkages.labels import loop_of
from linkages.loop import Loop
from linkages.printing.assembly import Dimensions, Kind
from linkages.printing.seating import (
    REACHES,
    PartApproach,
    Seating,
    choose_seats,
    find_meetings,
)
from linkages.values import GeometryError, told_apart

SIZE = 100.0  # mm
SMALLEST_SIZE, LARGEST_SIZE = 1.0, 10_000.0  # mm
FARTHEST = 10.0  # characteristic lengths: how far along its axis a hinge may sit
MOST_MEETINGS = 12  # that are listed
SEAT_HEADS = ("joint", "offset (mm)", "its pin goes through")
MEETING_HEADS = ("parts", "left (mm)", "form", "arclength (deg)", "joint angles (deg)")


def require_cad(out: Path) -> None:
    """Raise `CommandError` unless there is what makes solids."""
    if find_spec("build123d") is None:
        raise CommandError(
            f"--to {out}: solids need build123d, which is not there; "
            "pip install 'bifurc[cad]' brings it"
        )


def seat_hinges(
    atlas: Atlas, forms: Sequence[Form], options: PrintOptions, seed: int
) -> Seating:
    """Where the hinges of the linkage, scaled to mm, sit so that no parts meet along
    forms, or the best that was seen.

    Raises `GeometryError` for sizes that do not fit the linkage.
    """
    loop = loop_of(atlas)
    size = loop.characteristic_length
    loop = loop.scaled(scale_of(size, options))
    dimensions = dimensions_of(loop.characteristic_length, options)
    offsets = _read_offsets(options.offsets, loop)
    generator = np.random.default_rng(seed)
    return choose_seats(loop, dimensions, forms, generator, offsets)


def dimensions_of(size: float, options: PrintOptions) -> Dimensions:
    """The sizes of parts of a linkage whose mean length of a link is ``size``, mm;
    raises `GeometryError` for those that do not fit it."""
    dimensions = Dimensions(options.diameter, options.play, options.wall)
    if not dimensions.diameter < size:
        shown, most = told_apart(dimensions.diameter, size)
        allowed = f"less than {most} mm, the mean length of a link"
        raise GeometryError("--diameter", f"{shown} mm", allowed)
    return dimensions


def scale_of(size: float, options: PrintOptions) -> float:
    """How many mm the unit of a linkage is, whose mean length of a link is ``size``: as
    is asked for, or such that this is the size that is."""
    if options.unit_in_mm is not None:
        if options.size is not None:
            raise CommandError("--size: it has no effect beside --unit; give one")
        scale = options.unit_in_mm
    else:
        scale = (SIZE if options.size is None else options.size) / size
    if not SMALLEST_SIZE <= scale * size <= LARGEST_SIZE:
        shown, least, most = told_apart(scale * size, SMALLEST_SIZE, LARGEST_SIZE)
        allowed = f"from {least} to {most} mm"
        raise GeometryError("mean length of a link", f"{shown} mm", allowed)
    return scale


def _read_offsets(text: str | None, loop: Loop) -> np.ndarray | None:
    """The offsets (n,), mm, that a text lists; raises `GeometryError`."""
    if text is None:
        return None
    farthest = FARTHEST * loop.characteristic_length
    allowed = (
        f"{loop.n} numbers with commas between, each from {-farthest:g} to {farthest:g}"
    )
    try:
        offsets = np.array([float(part) for part in text.split(",")])
    except ValueError:
        raise GeometryError("--offsets", repr(text), allowed) from None
    is_within = bool(np.all(np.abs(offsets) <= farthest))  # "not a number" is not
    if len(offsets) != loop.n or not is_within:
        raise GeometryError("--offsets", repr(text), allowed)
    return offsets


def write_parts(atlas: Atlas, form: Form, seating: Seating, out: Path) -> None:
    """Write the file of that ending: the parts as they stand where ``form`` begins, or
    laid out; raises `OSError`."""
    from bifurc.files.atomic import replace_file
    from linkages.printing.solids import make_parts, write_step, write_stl

    assembly = seating.assembly
    try:
        parts = make_parts(assembly)
    except ArithmeticError as error:
        raise CommandError(f"--diameter: with these sizes {error}") from None
    if out.name.lower().endswith(".stl"):
        replace_file(out, lambda part: write_stl(parts, part))
        return
    n = assembly.loop.n
    names = [f"link {link_name(i, n)}" for i in range(n)]
    title = loop_of(atlas).name or "linkage"
    theta = form.branch(0.0)
    replace_file(
        out, lambda part: write_step(assembly, parts, theta, names, title, part)
    )


# --- what is said ---------------------------------------------------------------------


def describe_seating(seating: Seating) -> str:
    """A table of where the hinges sit and what their pins go through, and how near
    parts come where none meet."""
    n = seating.assembly.loop.n
    seats = seating.assembly.seats
    rows = []
    for joint in range(n):
        order = [link_name((joint - 1) % n, n), link_name(joint, n)]
        if seats.sides[joint] < 0:
            order.reverse()
        through = f"link {order[0]}, link {order[1]}, cap"
        rows.append((f"{joint + 1}", f"{seats.heights[joint] + 0.0:g}", through))
    parts = [table(SEAT_HEADS, rows)]
    if seating.is_apart:
        nearest = seating.nearest
        where = f"{np.degrees(nearest.s):.3f} deg along {nearest.form.name}"
        parts.append(
            f"Outside hinges parts keep {nearest.at_least:.3f} mm apart; nearest are "
            f"{_part_names(seating, nearest)}, {nearest.clearance:.3f} mm at {where}."
        )
    return "\n".join(parts)


def describe_meetings(
    atlas: Atlas, seating: Seating, meetings: Sequence[PartApproach]
) -> str:
    """A table of the parts that come nearer than the play, and where."""
    rows = []
    for meeting in meetings[:MOST_MEETINGS]:
        rows.append(
            (
                _part_names(seating, meeting),
                f"{meeting.clearance:.3f}",
                meeting.form.name,
                f"{np.degrees(meeting.s):.3f}",
                show_configuration(atlas, meeting.theta),
            )
        )
    shown = table(MEETING_HEADS, rows)
    more = len(meetings) - MOST_MEETINGS
    return f"{shown}\n  and {more} more" if more > 0 else shown


def meetings_along(seating: Seating, forms: Sequence[Form]) -> list[PartApproach]:
    """All parts that come nearer than the play along forms, the nearest first."""
    gap = seating.assembly.dimensions.play
    meetings = [seating.nearest]
    for form in forms:
        for meeting in find_meetings(seating.assembly, form, gap):
            is_known = meeting.form is seating.nearest.form
            if not (is_known and meeting.parts == seating.nearest.parts):
                meetings.append(meeting)
    return sorted(meetings, key=lambda meeting: meeting.clearance)


def interference_error(seating: Seating, options: PrintOptions) -> CommandError:
    """The error that says, in a line, that parts meet."""
    gap = seating.assembly.dimensions.play
    nearest = seating.nearest
    names = _part_names(seating, nearest)
    if nearest.clearance < 0:
        state = f"{names} overlap by {-nearest.clearance:.3f} mm"
    else:
        state = f"between {names} {nearest.at_least:.3f} mm are left"
    place = f"{np.degrees(nearest.s):.3f} deg along {nearest.form.name}"
    if options.offsets is not None:
        start = f"--offsets: parts do not keep {gap:g} mm apart"
        message = f"{start}: {state} at {place}"
    else:
        reach = max(REACHES) * seating.assembly.loop.characteristic_length
        message = (
            f"no offsets up to {reach:g} mm were seen with all parts {gap:g} mm apart; "
            f"with the best ones {state} at {place}; try a smaller --diameter, a larger "
            "--size, another --seed, or --form with one form"
        )
    return CommandError(message, ExitCode.PARTS_MEET)


def _part_names(seating: Seating, approach: PartApproach) -> str:
    n = seating.assembly.loop.n
    names = []
    for part in approach.parts:
        is_link = part.kind is Kind.LINK
        number = link_name(part.joint, n) if is_link else f"{part.joint + 1}"
        names.append(f"{part.kind.value} {number}")
    return " and ".join(names)
