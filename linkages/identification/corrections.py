"""Which linkage of the catalogue a table with a misprint is meant to be.

A printed table is rounded, and some number of it is wrong: it has another sign, is the
supplement of the right one, or another number altogether; two rows are exchanged; a
column is shifted by a row, as between the two conventions of Denavit and Hartenberg;
twists are in the other unit; two numbers are wrong that have nothing to do with each
other, and are not both twists. A family makes a table of fewer parameters than it has
numbers, so that the numbers that are right tell the wrong one: it is left out, and the
member is fitted to the others. Where parameters are read off at the number that is left
out, they are tried at values all over their range. Kinds of mistakes are gone through,
simple ones first, until one leaves nothing but rounding.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TypeAlias

import numpy as np

from linkages.catalogue import catalogue, distinct_entries
from linkages.entry import Entry, Guesses, Parameter, ParameterKind
from linkages.geometry_table import link_name
from linkages.identification.equivalence import normal_form, table
from linkages.identification.fitting import (
    NEAR,
    Member,
    View,
    best_member,
    blind_gaps,
    build_table,
    changed_by,
    gaps_of,
    hidden_parameters,
    joints_of,
    rebuild,
    refit,
    views_of,
)
from linkages.identification.identify import Identification
from linkages.identification.match import Match, make_match
from linkages.identification.recovery import Row, plain_guess, plain_parameters
from linkages.loop import Loop

# What rounding to three digits may change: a number, and all numbers of a table together;
# over the characteristic length, rad.
ROUNDED = 0.01
# Values that are tried for a number that is left out: twists over half a turn, lengths
# over the characteristic length.
TWISTS = np.arange(0.0, np.pi, np.pi / 48)
LENGTHS = np.concatenate([[0.0], np.geomspace(0.1, 5.0, 15)])
DECIMALS = 9  # of parameters, at most
MOST_DECIMALS = 12  # of a printed number
# Times half a unit of the last printed decimal: what least squares may leave of a number
# of which rounding leaves half a unit at most.
EXCESS = 3.0
REACH = 1.0  # from a trial to the member, all numbers together
SPARSE = 3  # so much fewer values are tried where other angles are scanned for each
PATIENCE = 5.0  # s of processor time, for two numbers; six joints take some 3
NUDGE = 0.003  # of a number, by which it is seen whether guesses read it


@dataclass(frozen=True)
class Change:
    """A number of a table that is wrong: its ``row`` (lengths, twists, offsets) and
    ``column`` from 0, what is ``printed``, and what is ``meant``; twists in rad."""

    row: Row
    column: int
    printed: float
    meant: float

    def name(self, n: int) -> str:
        """What the number is called in a table of n joints: a12, alpha12 or R1."""
        if self.row is Row.OFFSETS:
            return f"R{self.column + 1}"
        letter = "a" if self.row is Row.LENGTHS else "alpha"
        return f"{letter}{link_name(self.column, n)}"


@dataclass(frozen=True)
class Correction:
    """A linkage that a table is meant to be, which it is to rounding but for a
    ``mistake``.

    ``match`` is that of the table without the mistake: of the printed one, or of one
    whose rows stand in other places. ``changes`` are the numbers that are wrong in the
    printed one; none where rounding is all that keeps it from the linkage.
    ``is_rounding``: the decimals that are printed account for all other differences.
    """

    match: Match
    mistake: str = ""
    changes: tuple[Change, ...] = ()
    is_rounding: bool = True

    @property
    def depth(self) -> int:
        """How far a table is from what is meant: 0 by rounding, 1 by one number that is
        wrong, 2 by another single mistake, in several numbers."""
        return min(len(self.changes), 2)


@dataclass(frozen=True)
class Corrections:
    """What a table may be meant to be, the best first, and the names of the families
    that were ``left`` out of a search for two wrong numbers: their guesses are scanned
    for, which takes minutes, or the time was up."""

    found: tuple[Correction, ...]
    left: tuple[str, ...] = ()


Progress: TypeAlias = Callable[[str, int], None]


def corrections_of(
    identification: Identification,
    progress: Progress | None = None,
    patience: float = PATIENCE,
) -> Corrections:
    """What a table is meant to be that is no linkage of the catalogue: those that it is
    to rounding, or else what `find_corrections` finds, or else those nearest."""
    near = _nearest(identification)
    rounded = tuple(one for one in near if one.is_rounding)
    if rounded:
        return Corrections(rounded)
    loop = identification.loop
    mended = find_corrections(loop, progress=progress, patience=patience)
    return replace(mended, found=mended.found or near)


def roundings_of(identification: Identification) -> tuple[Correction, ...]:
    """The linkages of the catalogue that a table is but for the decimals that are not
    printed, the most special first."""
    return tuple(one for one in _nearest(identification) if one.is_rounding)


def _nearest(identification: Identification) -> tuple[Correction, ...]:
    """The linkages of the catalogue that are near to a table as it is."""
    loop = identification.loop
    printed, unit = table(loop), loop.characteristic_length
    views = views_of(printed)
    rounded = []
    for match in identification.nearest:
        found = _corrected(match.entry, views, printed, printed, unit)
        rounded += [found] if found else []
    return tuple(sorted(rounded, key=_order))


def find_corrections(
    loop: Loop,
    entries: Iterable[Entry] | None = None,
    progress: Progress | None = None,
    patience: float = PATIENCE,
) -> Corrections:
    """What the table of ``loop`` may be meant to be: with one number wrong, by another
    mistake, or with two numbers wrong, each of which is looked for unless one before it
    leaves nothing but rounding. Two numbers are looked for during ``patience`` s of
    processor time. ``progress`` is called with what was looked at and how many."""
    known = distinct_entries() if entries is None else entries
    families = [entry for entry in known if joints_of(entry) == loop.n]
    with np.errstate(all="ignore"):
        found = _by_single_number(families, loop, progress)
        if not _has_rounding(found):
            found = [*found, *_by_rearranging(families, loop)]
        left: list[str] = []
        if not _has_rounding(found):
            pairs, left = _by_two_numbers(families, loop, patience)
            found = [*found, *pairs]
    return Corrections(tuple(sorted(found, key=_order)), tuple(left))


def _has_rounding(corrections: Iterable[Correction]) -> bool:
    """Whether any leaves nothing but rounding."""
    return any(one.is_rounding for one in corrections)


def _by_single_number(
    families: Sequence[Entry], loop: Loop, progress: Progress | None
) -> list[Correction]:
    """The members that the table of a loop is but for one number."""
    printed, unit = table(loop), loop.characteristic_length
    corrections: list[Correction] = []
    # a scan takes long, and what is scanned is more general than the others
    for entry in sorted(families, key=lambda entry: bool(entry.scan)):
        if not (entry.scan and corrections):
            corrections += _without(entry, printed, _single_numbers(printed), unit)
        if progress:
            progress("families", families.index(entry))
    return corrections


def _by_rearranging(families: Sequence[Entry], loop: Loop) -> list[Correction]:
    """The members that the table of a loop is but for numbers that are alike, rows or
    columns in another place, or else two numbers of a column."""
    printed, unit = table(loop), loop.characteristic_length
    corrections: list[Correction] = []
    for entry in families:
        corrections += _without(entry, printed, _like_numbers(printed), unit)
    rows = _rows_in_place(printed)
    corrections += _rearranged(families, printed, rows, unit)
    if not _has_rounding(corrections):
        columns = _columns_in_place(printed)
        corrections += _rearranged(families, printed, columns, unit)
    return corrections


def _by_two_numbers(
    families: Sequence[Entry], loop: Loop, patience: float
) -> tuple[list[Correction], list[str]]:
    """The members that the table of a loop is but for two numbers, and the names of the
    families that were not looked at to the end."""
    printed, unit = table(loop), loop.characteristic_length
    corrections: list[Correction] = []
    left = [entry.name for entry in families if entry.scan]
    deadline = time.process_time() + patience

    def is_time_left(_: object) -> bool:
        return time.process_time() < deadline

    for entry in families:
        if entry.scan:
            continue
        pairs = itertools.takewhile(is_time_left, _pairs_of_numbers(printed))
        corrections += _without(entry, printed, pairs, unit)
        if not is_time_left(None):
            left.append(entry.name)
    return corrections, left


def _rearranged(
    families: Sequence[Entry],
    printed: np.ndarray,
    rearrangements: Iterable[tuple[str, np.ndarray]],
    unit: float,
) -> Iterator[Correction]:
    """The members that a table (3, n) is with its numbers in other places."""
    for words, meant in rearrangements:
        views = views_of(meant)
        for entry in families:
            found = _corrected(entry, views, printed, meant, unit, words)
            if found is not None and found.changes:
                yield found


def _order(correction: Correction) -> tuple[bool, int, int, int, int, int, int]:
    """What rounding accounts for comes first, then the simplest mistakes, the most special
    first, in the order of the catalogue. A length has no sign that is left out: it is a
    twist that has the wrong one, where either may."""
    match = correction.match
    turned = [one for one in correction.changes if one.meant < 0 <= one.printed]
    lengths = sum(one.row is Row.LENGTHS for one in turned)
    decade = math.floor(math.log10(max(match.distance, 1e-12)))
    rounded = -100 if correction.is_rounding else decade
    position = list(catalogue()).index(match.entry.name)
    special = match.freedom, len(match.parameters)
    is_doubtful = not correction.is_rounding
    return is_doubtful, correction.depth, lengths, rounded, *special, position


def _corrected(
    entry: Entry,
    views: Sequence[View],
    printed: np.ndarray,
    meant: np.ndarray,
    unit: float,
    words: str = "",
    reach: float = NEAR,
) -> Correction | None:
    """The member of an entry that is a table as it is ``meant`` to be (3, n), in one of
    its ``views``; None where none is, to rounding."""
    half_units = _half_units(printed)
    bounds = EXCESS * half_units / np.array([[unit], [1.0], [unit]])
    farthest = max(ROUNDED, float(np.sqrt(printed.shape[1]) * np.linalg.norm(bounds)))
    member = best_member(entry, views, unit, reach)
    if member is None or member.distance > min(farthest, NEAR):
        return None
    # lengths and twists count by their last decimals
    weighted = refit(entry, member, float(half_units[0, 0] / half_units[1, 0]))
    member = rebuild(entry, member, weighted.parameters, unit) or member
    member = _plainest(entry, member, bounds, unit)
    is_rounding = _is_within(member, bounds, unit)
    least = bounds if is_rounding else np.full((3, 1), ROUNDED)
    changes = tuple(_changes(printed, member.as_given, least, unit))
    match = make_match(member, entry, meant, unit)
    return Correction(match, words, changes, is_rounding)


def _half_units(printed: np.ndarray) -> np.ndarray:
    """Half a unit of the last decimal of lengths and offsets, and of twists, (3, 1), the
    latter in rad.

    All numbers are taken to be printed to as many digits, those that end earlier being
    exact: twists in rad with as many decimals as lengths, in degrees with one less.
    """
    lengths = _decimals(printed[[0, 2]])
    in_rad, in_degrees = _decimals(printed[1]), _decimals(np.degrees(printed[1]))
    if in_degrees < in_rad:
        decimals = max(lengths, in_degrees + 1)
        twist = math.radians(0.5 * 10.0 ** (1 - decimals))
    else:
        decimals = max(lengths, in_rad)
        twist = 0.5 * 10.0**-decimals
    length = 0.5 * 10.0**-decimals
    return np.array([[length], [twist], [length]])


def _decimals(values: np.ndarray) -> int:
    """How many decimals numbers have."""
    for decimals in range(MOST_DECIMALS):
        if np.allclose(values, np.round(values, decimals), rtol=1e-13, atol=1e-13):
            return decimals
    return MOST_DECIMALS


def _is_within(member: Member, bounds: np.ndarray, unit: float) -> bool:
    """Whether no number that counts differs by more than the ``bounds`` (3, 1)."""
    gaps = gaps_of(member, unit).reshape(member.values.shape)
    return bool(np.all(np.abs(gaps) <= bounds))


def _plainest(entry: Entry, member: Member, bounds: np.ndarray, unit: float) -> Member:
    """The member whose parameters have the fewest decimals, angles in degrees, of those
    that differ from a table by no more than the ``bounds`` (3, 1)."""
    for decimals in range(DECIMALS):
        parameters = {}
        for parameter in entry.parameters:
            is_angle = parameter.kind is ParameterKind.ANGLE
            factor = 180 / math.pi if is_angle else 1.0
            value = factor * member.parameters[parameter.name]
            parameters[parameter.name] = round(value, decimals) / factor
        other = rebuild(entry, member, parameters, unit)
        if other is not None and _is_within(other, bounds, unit):
            return other
    return member


def _changes(
    printed: np.ndarray, exact: np.ndarray, least: np.ndarray, unit: float
) -> Iterator[Change]:
    """The numbers of a printed table (3, n) that are off by more than the ``least``
    (3, 1)."""
    gaps = (printed - exact) / unit
    gaps[1] = 2 * np.sin((printed[1] - exact[1]) / 2)
    for row, column in np.argwhere(np.abs(gaps) > least).tolist():
        value, right = printed[row, column], exact[row, column]
        if row == Row.TWISTS.value:
            right = math.remainder(right, 2 * math.pi)
        yield Change(Row(row), column, float(value), float(right))


# --- one number -----------------------------------------------------------------------


def _without(
    entry: Entry, printed: np.ndarray, wrong: Iterable[np.ndarray], unit: float
) -> Iterator[Correction]:
    """The members that a table (3, n) is but for some numbers, for each choice of them
    in ``wrong``, masks (3, n)."""
    views = views_of(printed)
    is_off = _numbers_off(entry, views, unit)
    for mask in wrong:
        trials: list[View] = []
        for view, off in zip(views, is_off, strict=True):
            # where they stand as the table is read, mirrored or not
            place = view.reading.of(mask.astype(float)) != 0
            if not np.any(off & ~place & ~_depends(entry, place)):
                trials += _views_without(entry, view, place, unit)
        if trials:
            found = _corrected(entry, trials, printed, printed, unit, reach=REACH)
            if found is not None and found.changes:
                yield found


def _single_numbers(printed: np.ndarray) -> Iterator[np.ndarray]:
    """Masks (3, n) of each number of a table."""
    for place in np.ndindex(printed.shape):
        mask = np.zeros(printed.shape, dtype=bool)
        mask[place] = True
        yield mask


def _pairs_of_numbers(printed: np.ndarray) -> Iterator[np.ndarray]:
    """Masks (3, n) of each two numbers of a table that are not both twists: what is left
    of those may only be a sine, which does not tell a twist from its supplement."""
    for pair in itertools.combinations(_single_numbers(printed), 2):
        mask = pair[0] | pair[1]
        if np.count_nonzero(mask[Row.TWISTS.value]) < 2:
            yield mask


def _like_numbers(printed: np.ndarray) -> Iterator[np.ndarray]:
    """Masks (3, n) of the numbers of a row that are alike, signs apart: a length that
    occurs twice is one misprint."""
    for row in range(len(printed)):
        sizes = np.abs(printed[row])
        for size in np.unique(sizes):
            mask = np.zeros(printed.shape, dtype=bool)
            mask[row] = sizes == size
            if 1 < np.count_nonzero(mask) < printed.shape[1] and size > 0:
                yield mask


def _numbers_off(entry: Entry, views: Sequence[View], unit: float) -> np.ndarray:
    """Which numbers of a table are off (k, 3, n), as it reads in each of its views, from
    the member with what it says of plain parameters; no other parameter changes them."""
    off = np.zeros((len(views), *views[0].form.shape), dtype=bool)
    is_fixed = ~changed_by(entry, hidden_parameters(entry))
    for number, view in enumerate(views):
        plain = {**entry.defaults, **plain_guess(entry, view.form)}
        values = build_table(entry, plain)
        if values is not None:
            gaps = blind_gaps(view.form[None], values[None], unit)[0]
            off[number] = (gaps > NEAR) & is_fixed
    return off


def _depends(entry: Entry, place: np.ndarray) -> np.ndarray:
    """Mask (3, n) of the numbers that depend on the plain parameters that are read at a
    place (3, n)."""
    names = []
    for name, spot in plain_parameters(entry).items():
        if place[spot.row.value, spot.column]:
            names.append(name)
    return changed_by(entry, names)


def _views_without(
    entry: Entry, view: View, place: np.ndarray, unit: float
) -> Iterator[View]:
    """A view without the numbers at a place (3, n); with guesses for them, if they are
    read."""
    values = np.where(place, np.nan, view.values)
    yield replace(view, values=values)
    if not np.any(place & _read_places(entry)):
        return
    if len(set(view.form[place].round(DECIMALS))) > 1 and not _are_alike(view, place):
        yield from _views_with_guesses(entry, view, values, place, unit)
        return
    is_twist = bool(place[Row.TWISTS.value].any())
    trials = TWISTS if is_twist else unit * LENGTHS
    # twists in normal form are alike, or supplements
    is_opposite = place & (np.abs(view.form - view.form[place][0]) > ROUNDED)
    for guess in trials[::SPARSE] if entry.scan else trials:
        form = np.where(place, guess, view.form)
        yield View(view.reading, values, np.where(is_opposite, np.pi - form, form))


def _are_alike(view: View, place: np.ndarray) -> bool:
    """Whether the numbers at a place (3, n) stand in one row, and are alike there, signs
    and supplements apart."""
    rows = np.flatnonzero(place.any(axis=1))
    numbers = view.form[place]
    gaps = np.minimum(
        np.abs(numbers - numbers[0]), np.abs(numbers + numbers[0] - np.pi)
    )
    return len(rows) == 1 and bool(gaps.max() <= ROUNDED)


def _views_with_guesses(
    entry: Entry, view: View, values: np.ndarray, place: np.ndarray, unit: float
) -> Iterator[View]:
    """A view without the numbers at a place (3, n), with guesses for each of those that
    are read, independent of each other."""
    spots = np.argwhere(place & _read_places(entry)).tolist()
    step = SPARSE ** len(spots)
    trials = []
    for row, _ in spots:
        is_twist = row == Row.TWISTS.value
        trials.append(TWISTS[::step] if is_twist else unit * LENGTHS[::SPARSE])
    for guesses in itertools.product(*trials):
        form = view.form.copy()
        for spot, guess in zip(spots, guesses, strict=True):
            form[tuple(spot)] = guess
        yield View(view.reading, values, form)


def _read_places(entry: Entry) -> np.ndarray:
    """Mask (3, n) of the numbers of a table from which parameters are guessed."""
    mask = changed_by(entry, ()).copy()
    for spot in plain_parameters(entry).values():
        mask[spot.row.value, spot.column] = True
    if entry.guesses is not None:
        mask |= _guessed_from(entry.construct, entry.parameters, entry.guesses)
    return mask


@cache
def _guessed_from(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...], guesses: Guesses
) -> np.ndarray:
    """Mask (3, n) of the numbers of a table that ``guesses`` read."""
    form = normal_form(table(construct(**{p.name: p.default for p in parameters})))
    usual = _values(guesses(form))
    mask = np.zeros(form.shape, dtype=bool)
    for place in np.ndindex(form.shape):
        moved = form.copy()
        moved[place] += NUDGE
        mask[place] = _values(guesses(moved)) != usual
    return mask


def _values(guesses: Iterable[Mapping[str, float]]) -> list[tuple[float, ...]]:
    return [tuple(guess.values()) for guess in guesses]


# --- rows and columns -----------------------------------------------------------------

COLUMNS = ("lengths", "twists", "offsets")


def _rows_in_place(printed: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """What a table (3, n) may be meant to be of which two rows are exchanged, a column
    is shifted, or in another unit; with that in words."""
    for one, other in itertools.combinations(range(printed.shape[1]), 2):
        words = f"rows {one + 1} and {other + 1} are exchanged"
        yield words, _exchanged(printed, one, other)
    for row, name in enumerate(COLUMNS):
        for step, direction in ((1, "up"), (-1, "down")):
            meant = printed.copy()
            meant[row] = np.roll(printed[row], step)
            yield f"the {name} are shifted by one row {direction}", meant
    largest = float(np.abs(printed[1]).max())
    if 0 < largest < math.radians(2 * math.pi):
        yield "the twists are in radians", printed * [[1.0], [180 / math.pi], [1.0]]
    if largest > 2 * math.pi:
        yield "the twists are in degrees", printed * [[1.0], [math.pi / 180], [1.0]]


def _columns_in_place(printed: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """What a table (3, n) may be meant to be of which two numbers of a column are
    exchanged."""
    for row, name in enumerate(COLUMNS):
        for one, other in itertools.combinations(range(printed.shape[1]), 2):
            meant = printed.copy()
            meant[row] = _exchanged(printed, one, other)[row]
            if printed[row, one] != printed[row, other]:
                words = f"the {name} of rows {one + 1} and {other + 1} are exchanged"
                yield words, meant


def _exchanged(values: np.ndarray, one: int, other: int) -> np.ndarray:
    order = list(range(values.shape[1]))
    order[one], order[other] = other, one
    exchanged: np.ndarray = values[:, order]
    return exchanged
