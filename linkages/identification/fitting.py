"""The member of a catalogue entry that is nearest to a table, over every way to read
the table."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from linkages.entry import Entry, Parameter, ParameterKind
from linkages.identification.equivalence import (
    Reading,
    Signs,
    compare,
    find_signs,
    normal_form,
    readings,
    table,
)
from linkages.identification.recovery import (
    Row,
    plain_guess,
    plain_parameters,
)
from linkages.loop import Loop
from linkages.values import GeometryError

# members that miss by less are fitted, and are near; relative to the characteristic
# length, rad
NEAR = 0.05
DONE = 1e-12  # nothing is gained below
STEPS = 8  # of Gauss-Newton
FITTED = 3  # candidates that are fitted
STEP = 1e-7  # of a difference quotient
PARTS = (1.0, 0.3, 0.05)  # of a step, tried in turn until it is an improvement
SCANNED = 1.0  # points of a scan that miss by more are not followed
LONGEST_TURN = 0.2  # rad, of a hidden angle in one step


@dataclass(frozen=True)
class View:
    """A table (3, n) as it reads one way, NaN for a number that is left out, and that in
    normal form with a guess in its place."""

    reading: Reading
    values: np.ndarray
    form: np.ndarray


@dataclass(frozen=True)
class Candidate:
    """Parameters that a view suggests, and the table (3, n) that they make."""

    view: View
    parameters: dict[str, float]
    values: np.ndarray


@dataclass(frozen=True)
class Member:
    """A member of an entry: its parameters, its table (3, n), the view of the given
    table that it is near to, how the member's axes and links are reversed then, the
    distance, and how many of its parameters matter (0: not known)."""

    parameters: dict[str, float]
    values: np.ndarray
    view: View
    signs: Signs
    distance: float
    freedom: int = 0

    @property
    def as_given(self) -> np.ndarray:
        """The member's table (3, n), read and signed as the given one."""
        return self.view.reading.undone(self.signs.of(self.values))


def views_of(given: np.ndarray) -> tuple[View, ...]:
    """The table ``given`` (3, n) in all its readings, one for all those that give the
    same numbers."""
    views: dict[bytes, View] = {}
    for reading in readings(given.shape[1]):
        values = reading.of(given)
        key = np.round(values, 12).tobytes()
        views.setdefault(key, View(reading, values, normal_form(values)))
    return tuple(views.values())


def joints_of(entry: Entry) -> int:
    """The number of joints of the entry's members."""
    return int(changed_by(entry, ()).shape[1])


def best_member(
    entry: Entry, views: Sequence[View], unit: float, reach: float = NEAR
) -> Member | None:
    """The member of ``entry`` nearest to a table in one of its ``views``, or None when
    no view suggests one.

    Lengths are measured in ``unit``. Guesses that miss by less than ``reach`` are
    fitted; where all views are farther off, the member is the best guess.
    """
    with np.errstate(all="ignore"):
        candidates = _candidates(entry, views, unit)
    if not candidates:
        return None
    targets = np.array([candidate.view.values for candidate in candidates])
    tables = np.array([candidate.values for candidate in candidates])
    gaps = compare(targets, tables, unit)
    # of equals the first, read as given
    order = np.argsort(np.round(gaps.exact, 10), kind="stable")
    near = [k for k in order[:FITTED] if gaps.exact[k] < reach]
    chosen = near or order[:1]
    members = [_member(candidates[k], unit) for k in chosen]
    least = gaps.exact.min()
    if least > NEAR / 10:
        # twists modulo pi and signs of offsets may have been read off wrongly
        limit = min(reach, least / 3)
        blind = np.argsort(gaps.blind)[: 8 * FITTED]
        others = [candidates[k] for k in blind if gaps.blind[k] < limit]
        members += _with_other_signs(entry, others, unit)
    members.sort(key=lambda member: round(member.distance, 10))
    starts = [member for member in members[:FITTED] if member.distance < reach]
    fits = [_fit(entry, member, unit) for member in starts]
    return min(fits or members, key=lambda member: round(member.distance, 12))


def build_table(entry: Entry, parameters: Mapping[str, float]) -> np.ndarray | None:
    """The table (3, n) of the member; None where the constructor refuses it."""
    try:
        return table(entry.construct(**parameters))
    except (GeometryError, ArithmeticError, ValueError):
        return None


# --- candidates


def _candidates(entry: Entry, views: Sequence[View], unit: float) -> list[Candidate]:
    """Parameters that the table suggests in its views, with the members they make."""
    plains = [{**entry.defaults, **plain_guess(entry, view.form)} for view in views]
    has_hidden = entry.guesses is not None or bool(entry.scan)
    is_near = [True] * len(views)
    if has_hidden:
        is_near = _plain_parts_fit(entry, plains, views, unit).tolist()
    candidates: list[Candidate] = []
    for view, plain in itertools.compress(zip(views, plains, strict=True), is_near):
        if not has_hidden:
            candidates += _built(entry, view, [plain])
        elif entry.guesses is not None:
            guesses = [{**plain, **guess} for guess in entry.guesses(view.form)]
            candidates += _built(entry, view, guesses)
        else:
            candidates += _scanned_candidates(entry, view, plain, unit)
    return candidates


def _scanned_candidates(
    entry: Entry, view: View, plain: Mapping[str, float], unit: float
) -> list[Candidate]:
    """The nearest points of the scan, each moved to the nearest member that differs in
    the hidden angles alone."""
    names = tuple(entry.scan)
    guesses = []
    for angles in itertools.product(*entry.scan.values()):
        guesses.append({**plain, **dict(zip(names, angles, strict=True))})
    points = list(_built(entry, view, guesses))
    if not points:
        return []
    tables = np.array([point.values for point in points])
    gaps = compare(view.values, tables, unit).blind
    nearest = np.argsort(gaps)[: 2 * FITTED]
    is_far = gaps > SCANNED
    return [_descend(entry, points[k], unit, names) for k in nearest if not is_far[k]]


def _built(
    entry: Entry, view: View, guesses: Iterable[Mapping[str, float]]
) -> Iterator[Candidate]:
    """Those of the ``guesses``, each once, that the constructor accepts."""
    seen = set()
    for guess in guesses:
        parameters = {name: float(value) for name, value in guess.items()}
        numbers = tuple(round(value, 12) for value in parameters.values())
        if numbers in seen:
            continue
        seen.add(numbers)
        values = build_table(entry, parameters)
        if values is not None and np.all(np.isfinite(values)):
            yield Candidate(view, parameters, values)


def _plain_parts_fit(
    entry: Entry,
    plains: Sequence[Mapping[str, float]],
    views: Sequence[View],
    unit: float,
) -> np.ndarray:
    """For each view (v,), whether the numbers that no hidden parameter changes are near
    those of the table, signs apart; true where only the hidden parameters can tell."""
    tables = [build_table(entry, plain) for plain in plains]
    is_built = np.array([values is not None for values in tables])
    fits = np.ones(len(views), dtype=bool)
    if not is_built.any():
        return fits
    fixed = ~changed_by(entry, hidden_parameters(entry))
    forms = np.array([view.form for view in views])[is_built]  # (k, 3, n)
    others = np.array([values for values in tables if values is not None])
    gaps = blind_gaps(forms, others, unit)
    fits[is_built] = ~np.any(gaps[:, fixed] > NEAR, axis=1)
    return fits


def blind_gaps(forms: np.ndarray, tables: np.ndarray, unit: float) -> np.ndarray:
    """By how much the numbers of ``tables`` (k, 3, n) differ from tables in normal form
    ``forms`` (k, 3, n), whatever axes and links are reversed, and twists modulo pi."""
    others = normal_form(tables)
    gaps: np.ndarray = np.abs(np.abs(forms) - np.abs(others)) / unit
    turn = np.abs(np.sin(forms[:, 1] - others[:, 1]))
    opposite = np.abs(np.sin(forms[:, 1] + others[:, 1]))
    # a link of no length may be reversed unseen
    is_short = np.minimum(forms[:, 0], others[:, 0]) < NEAR * unit
    gaps[:, 1] = np.where(is_short, np.minimum(turn, opposite), turn)
    return gaps


def hidden_parameters(entry: Entry) -> tuple[str, ...]:
    """Names of the parameters that do not stand in the table as they are."""
    plain = plain_parameters(entry)
    return tuple(p.name for p in entry.parameters if p.name not in plain)


def changed_by(entry: Entry, names: Iterable[str]) -> np.ndarray:
    """Mask (3, n) of the numbers of the table that these parameters change."""
    return _changed_by(entry.construct, entry.parameters, tuple(names))


@cache
def _changed_by(
    construct: Callable[..., Loop],
    parameters: tuple[Parameter, ...],
    names: tuple[str, ...],
) -> np.ndarray:
    defaults = {p.name: p.default for p in parameters}
    base = table(construct(**defaults))
    mask = np.zeros(base.shape, dtype=bool)
    for name in names:
        moved = table(construct(**{**defaults, name: defaults[name] * 1.013}))
        mask |= np.abs(moved - base) >= 1e-12
    return mask


def _member(candidate: Candidate, unit: float) -> Member:
    view = candidate.view
    signs = find_signs(view.values, candidate.values, unit)
    gaps = _gaps(view.values, signs.of(candidate.values), unit)
    distance = float(np.linalg.norm(gaps))
    return Member(candidate.parameters, candidate.values, view, signs, distance)


def _gaps(read: np.ndarray, values: np.ndarray, unit: float) -> np.ndarray:
    """Differences (3 n,) of two tables: lengths and offsets in ``unit``, chords of
    twists."""
    out: np.ndarray = (read - values) / unit
    out[1] = 2 * np.sin((read[1] - values[1]) / 2)
    gaps: np.ndarray = np.nan_to_num(out, nan=0.0).ravel()
    return gaps


def _with_other_signs(
    entry: Entry, candidates: Iterable[Candidate], unit: float
) -> list[Member]:
    """For each candidate the nearest member, if any, when plain twists may be half a
    turn more and plain offsets opposite."""
    members = []
    for candidate in candidates:
        guesses = _resigned(entry, candidate)
        others = list(_built(entry, candidate.view, guesses))
        if others:
            tables = np.array([other.values for other in others])
            gaps = compare(candidate.view.values, tables, unit).exact
            members.append(_member(others[gaps.argmin()], unit))
    return members


def _resigned(entry: Entry, candidate: Candidate) -> Iterator[dict[str, float]]:
    """The parameters with every choice of half turns and signs."""
    choices: dict[str, list[float]] = {}
    for name, place in plain_parameters(entry).items():
        value = candidate.parameters[name]
        values = [value]
        if place.row is Row.TWISTS:
            values.append(value + np.pi)
            if not candidate.view.values[0, place.column]:  # reversed unseen
                values += [-value, np.pi - value]
        elif place.row is Row.OFFSETS:
            values.append(-value)
        choices[name] = values
    for choice in itertools.product(*choices.values()):
        yield {**candidate.parameters, **dict(zip(choices, choice, strict=True))}


# --- fitting


def _fit(entry: Entry, member: Member, unit: float) -> Member:
    """The member at the least distance, by Gauss-Newton from ``member`` with its
    reversals held."""
    names = tuple(member.parameters)
    scales = _scales(entry, names, unit)
    counts = np.isfinite(member.view.values).ravel()
    for _ in range(STEPS):
        if member.distance < DONE:
            break
        jacobian = _jacobian(entry, member, names, unit)[counts]
        gaps = _gaps(member.view.values, member.signs.of(member.values), unit)[counts]
        step = np.linalg.lstsq(jacobian, gaps, rcond=1e-9)[0] * scales
        changes = dict(zip(names, step.tolist(), strict=True))
        after = _improved(entry, member, changes, unit)
        if after is None:
            break
        gain = member.distance - after.distance
        member = after
        if gain < 1e-3 * member.distance:
            break
    jacobian = _jacobian(entry, member, names, unit)
    sizes = np.linalg.svd(jacobian, compute_uv=False)
    return replace(member, freedom=int(np.sum(sizes > 1e-6 * sizes[0])))


def _improved(
    entry: Entry, member: Member, step: Mapping[str, float], unit: float
) -> Member | None:
    """The member after the step, shortened until that is an improvement; None if it
    never is."""
    for part in PARTS:
        parameters = {
            name: value + part * step[name] for name, value in member.parameters.items()
        }
        after = rebuild(entry, member, parameters, unit)
        if after is not None and after.distance < member.distance:
            return after
    return None


def refit(entry: Entry, member: Member, unit: float) -> Member:
    """The member at the least distance in another ``unit`` of lengths, from a near
    one."""
    candidate = Candidate(member.view, member.parameters, member.values)
    return _fit(entry, _member(candidate, unit), unit)


def gaps_of(member: Member, unit: float) -> np.ndarray:
    """By how much a table differs from the member beside it (3 n,), lengths and offsets
    in ``unit``, twists in rad; 0 for a number that is left out."""
    return _gaps(member.view.values, member.signs.of(member.values), unit)


def rebuild(
    entry: Entry, member: Member, parameters: dict[str, float], unit: float
) -> Member | None:
    """The member with other parameters, beside the same view of the given table; None
    where the constructor refuses them."""
    values = build_table(entry, parameters)
    if values is None:
        return None
    after = _member(Candidate(member.view, parameters, values), unit)
    return replace(after, freedom=member.freedom)


def _scales(entry: Entry, names: tuple[str, ...], unit: float) -> np.ndarray:
    """``unit`` for lengths, 1 for other parameters (k,)."""
    lengths = {p.name for p in entry.parameters if p.kind is ParameterKind.LENGTH}
    return np.array([unit if name in lengths else 1.0 for name in names])


def _jacobian(
    entry: Entry, member: Member, names: tuple[str, ...], unit: float
) -> np.ndarray:
    """Derivatives (3 n, k) of the signed table by the parameters, these in their
    scales."""
    base = member.signs.of(member.values)
    columns = []
    for name, scale in zip(names, _scales(entry, names, unit), strict=True):
        column = np.zeros(base.size)
        # from the side that the constructor accepts
        for step in (STEP, -STEP):
            moved = member.parameters[name] + step * scale
            values = build_table(entry, {**member.parameters, name: moved})
            if values is not None:
                column = _gaps(member.signs.of(values), base, unit) / step
                break
        columns.append(column)
    return np.array(columns).T


def _descend(
    entry: Entry, start: Candidate, unit: float, names: tuple[str, ...]
) -> Candidate:
    """Gauss-Newton on the hidden angles ``names`` alone, from a point of a scan, with
    the signs that fit best at each step."""
    candidate = start
    for _ in range(STEPS):
        member = _member(candidate, unit)
        gaps = _gaps(member.view.values, member.signs.of(member.values), unit)
        jacobian = _jacobian(entry, member, names, unit)
        step = np.linalg.lstsq(jacobian, gaps, rcond=1e-9)[0]
        after = dict(candidate.parameters)
        for name, turn in zip(names, step, strict=True):
            after[name] += float(np.clip(turn, -LONGEST_TURN, LONGEST_TURN))
        built = build_table(entry, after)
        if built is None or np.abs(step).max() < 1e-10:
            break
        candidate = Candidate(start.view, after, built)
    return candidate
