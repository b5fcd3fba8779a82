"""The member of a catalogue entry that is nearest to a table, over every way to read
the table."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from linkages.entry import Entry, Parameter
from linkages.identification.equivalence import (
    Reading,
    Signs,
    compare,
    find_signs,
    normal_form,
    readings,
    table,
)
from linkages.identification.recovery import HINTS, SCANS, plain_guess, plain_parameters
from linkages.loop import GeometryError, Loop

__all__ = ["Member", "View", "best_member", "joints_of", "views_of"]

# candidates that miss by less are fitted; relative to the characteristic length, rad
NEAR = 0.05
DONE = 1e-12  # nothing is gained below
STEPS, FITTED, STEP = 8, 3, 1e-7


@dataclass(frozen=True)
class View:
    """A table (3, n) as it reads one way, and that in normal form."""

    reading: Reading
    values: np.ndarray
    form: np.ndarray


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
    found: dict[bytes, View] = {}
    for reading in readings(given.shape[1]):
        values = reading.of(given)
        found.setdefault(
            np.round(values, 12).tobytes(), View(reading, values, normal_form(values))
        )
    return tuple(found.values())


def joints_of(entry: Entry) -> int:
    """The number of joints of the entry's members."""
    return int(_unchanged(entry.construct, entry.parameters).shape[1])


def best_member(entry: Entry, views: Sequence[View], unit: float) -> Member | None:
    """The member of ``entry`` nearest to a table in one of its ``views``, or None when
    no view suggests one.

    Lengths are measured in ``unit``. Where all views are far off, the member is the
    best guess, not fitted.
    """
    guesses = [
        (view, *guess) for view in views for guess in _candidates(entry, view, unit)
    ]
    if not guesses:
        return None
    targets, tables = (
        np.array(part)
        for part in zip(*((view.values, t) for view, _, t in guesses), strict=True)
    )
    found = compare(targets, tables, unit)
    order = np.argsort(
        np.round(found.exact, 10), kind="stable"
    )  # of equals the first, read as given
    near = [k for k in order[:FITTED] if found.exact[k] < NEAR] or order[:1]
    members = [_member(entry, guesses[k][0], guesses[k][1], unit) for k in near]
    if (
        found.exact.min() > NEAR / 10
    ):  # twists modulo pi and signs of offsets may have been read off wrongly
        blind = [
            k
            for k in np.argsort(found.blind)[: 8 * FITTED]
            if found.blind[k] < min(NEAR, found.exact.min() / 3)
        ]
        resigned = (
            _other_signs(entry, guesses[k][0], guesses[k][1], unit) for k in blind
        )
        members += [m for m in resigned if m is not None]
    members.sort(key=lambda member: round(member.distance, 10))
    fitted = [_fit(entry, m, unit) for m in members[:FITTED] if m.distance < NEAR]
    return min(fitted or members, key=lambda member: round(member.distance, 12))


def _build(entry: Entry, parameters: Mapping[str, float]) -> np.ndarray | None:
    try:
        return table(entry.construct(**parameters))
    except (GeometryError, ArithmeticError, ValueError):
        return None


def _candidates(
    entry: Entry, view: View, unit: float
) -> Iterator[tuple[dict[str, float], np.ndarray]]:
    """Parameters that the table suggests in this view, with the members they make."""
    form = view.form
    plain = {**entry.defaults, **plain_guess(entry, form)}
    if entry.name not in HINTS and entry.name not in SCANS:
        yield from _built(entry, [plain])
        return
    if not _plain_part_fits(entry, plain, form, unit):
        return
    with np.errstate(all="ignore"):
        if entry.name in HINTS:
            yield from _built(
                entry, [{**plain, **hint} for hint in HINTS[entry.name](form)]
            )
            return
        axes = SCANS[entry.name]
        grid = [
            dict(zip(axes, map(float, at), strict=True))
            for at in itertools.product(*axes.values())
        ]
        members = list(_built(entry, [{**plain, **at} for at in grid]))
        if members:
            gaps = compare(
                view.values, np.array([values for _, values in members]), unit
            ).blind
            for k in np.argsort(gaps)[: 2 * FITTED]:
                yield _descend(entry, members[k], view.values, unit, tuple(axes))


def _built(
    entry: Entry, guesses: list[dict[str, float]]
) -> Iterator[tuple[dict[str, float], np.ndarray]]:
    for guess in guesses:
        parameters = {name: float(value) for name, value in guess.items()}
        values = _build(entry, parameters)
        if values is not None and np.all(np.isfinite(values)):
            yield parameters, values


def _plain_part_fits(
    entry: Entry, plain: Mapping[str, float], form: np.ndarray, unit: float
) -> bool:
    """Whether the numbers that no hidden parameter changes are near those of the table,
    signs apart."""
    values = _build(entry, plain)
    if values is None:
        return True  # only the hidden parameters can tell
    fixed, other = _unchanged(entry.construct, entry.parameters), normal_form(values)
    gaps = np.abs(np.abs(form) - np.abs(other)) / unit
    turn, opposite = (np.abs(np.sin(form[1] - sign * other[1])) for sign in (1, -1))
    short = (
        np.minimum(form[0], other[0]) < NEAR * unit
    )  # a link of no length may be reversed unseen
    gaps[1] = np.where(short, np.minimum(turn, opposite), turn)
    return not np.any(gaps[fixed] > NEAR)


@cache
def _unchanged(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...]
) -> np.ndarray:
    """Mask (3, n) of the numbers of the table that only plain parameters change."""
    plain = plain_parameters(Entry("", "", "", construct, parameters))
    defaults = {p.name: p.default for p in parameters}
    base = table(construct(**defaults))
    mask = np.ones(base.shape, dtype=bool)
    for p in parameters:
        if p.name not in plain:
            mask &= (
                np.abs(
                    table(construct(**{**defaults, p.name: p.default * 1.013})) - base
                )
                < 1e-12
            )
    return mask


def _member(
    entry: Entry, view: View, parameters: dict[str, float], unit: float
) -> Member:
    values = table(entry.construct(**parameters))
    signs = find_signs(view.values, values, unit)
    distance = float(np.linalg.norm(_gaps(view.values, signs.of(values), unit)))
    return Member(parameters, values, view, signs, distance)


def _gaps(read: np.ndarray, values: np.ndarray, unit: float) -> np.ndarray:
    """Differences (3 n,) of two tables: lengths and offsets in ``unit``, chords of
    twists."""
    out = (read - values) / unit
    out[1] = 2 * np.sin((read[1] - values[1]) / 2)
    return out.ravel()


def _other_signs(
    entry: Entry, view: View, parameters: dict[str, float], unit: float
) -> Member | None:
    """The nearest member, if any, when plain twists may be half a turn more and plain
    offsets opposite."""
    choices = []
    for name, (row, column, _) in plain_parameters(entry).items():
        value = parameters[name]
        if row == 1:
            reversed_unseen = () if view.values[0, column] else (-value, np.pi - value)
            choices.append(
                [(name, x) for x in (value, value + np.pi, *reversed_unseen)]
            )
        elif row == 2:
            choices.append([(name, value), (name, -value)])
    tried = list(
        _built(
            entry,
            [{**parameters, **dict(some)} for some in itertools.product(*choices)],
        )
    )
    if not tried:
        return None
    best = compare(
        view.values, np.array([values for _, values in tried]), unit
    ).exact.argmin()
    return _member(entry, view, tried[best][0], unit)


def _fit(entry: Entry, member: Member, unit: float) -> Member:
    """The member at the least distance, by Gauss-Newton from ``member`` with its
    reversals held."""
    names = tuple(member.parameters)
    for _ in range(STEPS):
        jacobian = _jacobian(entry, member, names, unit)
        if member.distance < DONE:
            break
        gaps = _gaps(member.view.values, member.signs.of(member.values), unit)
        step = np.linalg.lstsq(jacobian, gaps, rcond=1e-9)[0] * _scales(
            entry, names, unit
        )
        after = _stepped(
            entry, member, dict(zip(names, step.tolist(), strict=True)), unit
        )
        if after is None:
            break
        gain, member = member.distance - after.distance, after
        if gain < 1e-3 * member.distance:
            break
    sizes = np.linalg.svd(_jacobian(entry, member, names, unit), compute_uv=False)
    return replace(member, freedom=int(np.sum(sizes > 1e-6 * sizes[0])))


def _stepped(
    entry: Entry, member: Member, step: Mapping[str, float], unit: float
) -> Member | None:
    """The member after the step, shortened until that is an improvement; None if it
    never is."""
    for part in (1.0, 0.3, 0.05):
        parameters = {
            name: value + part * step[name] for name, value in member.parameters.items()
        }
        if _build(entry, parameters) is not None:
            after = _member(entry, member.view, parameters, unit)
            if after.distance < member.distance:
                return after
    return None


def _scales(entry: Entry, names: tuple[str, ...], unit: float) -> np.ndarray:
    kinds = {p.name: p.kind for p in entry.parameters}
    return np.array([unit if kinds[name] == "length" else 1.0 for name in names])


def _jacobian(
    entry: Entry, member: Member, names: tuple[str, ...], unit: float
) -> np.ndarray:
    """Derivatives (3 n, k) of the signed table by the parameters, these in their
    scales; 0 where a side is refused."""
    base = member.signs.of(member.values)
    columns = []
    for name, scale in zip(names, _scales(entry, names, unit), strict=True):
        for step in (STEP, -STEP):
            values = _build(
                entry,
                {**member.parameters, name: member.parameters[name] + step * scale},
            )
            if values is not None:
                columns.append(_gaps(member.signs.of(values), base, unit) / step)
                break
        else:
            columns.append(np.zeros(base.size))
    return np.array(columns).T


def _descend(
    entry: Entry,
    start: tuple[dict[str, float], np.ndarray],
    read: np.ndarray,
    unit: float,
    names: tuple[str, ...],
) -> tuple[dict[str, float], np.ndarray]:
    """Gauss-Newton on the hidden angles ``names`` alone, signs as found, from a point
    of a scan."""
    parameters, values = start
    for _ in range(STEPS):
        signs = find_signs(read, values, unit)
        base = signs.of(values)
        columns = []
        for name in names:
            moved = _build(entry, {**parameters, name: parameters[name] + STEP})
            columns.append(
                np.zeros(base.size)
                if moved is None
                else _gaps(signs.of(moved), base, unit) / STEP
            )
        step = np.linalg.lstsq(
            np.array(columns).T, _gaps(read, base, unit), rcond=1e-9
        )[0]
        moved_to = {
            n: parameters[n] + float(np.clip(d, -0.2, 0.2))
            for n, d in zip(names, step, strict=True)
        }
        after = {**parameters, **moved_to}
        built = _build(entry, after)
        if built is None or np.abs(step).max() < 1e-10:
            break
        parameters, values = after, built
    return parameters, values
