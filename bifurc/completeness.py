"""How sure it is that nothing is missing from an answer: claims and doubts as records.

What was shown is a `Claim`, what is open a `Doubt`: a kind, numbers, and the words into
which these are put at last. A program asks the records; the words are for people.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Generic, TypeVar

from bifurc.tables import count_of

Kind = TypeVar("Kind")


class Level(StrEnum):
    """How sure it is that nothing is missing."""

    # None is missing: all were counted and followed, in floating point.
    COUNTED = "counted"
    # None is missing that is larger than the statement says.
    CERTIFIED = "certified"
    # One more random start finds something new with at most the stated probability.
    ESTIMATED = "estimated"
    # The time was over before all starts were looked at.
    OUT_OF_TIME = "out of time"
    # Ctrl-C ended the search.
    INTERRUPTED = "interrupted"

    @classmethod
    def _missing_(cls, value: object) -> Level | None:
        """What older files call proved was counted."""
        return cls.COUNTED if value == "proved" else None


BEST_FIRST = tuple(Level)


class Scope(StrEnum):
    """What a claim is about."""

    # Branches and surfaces.
    MOTIONS = "motions"
    # Isolated solutions.
    ASSEMBLIES = "assemblies"
    # All that random starts reached.
    STARTS = "starts"
    # The search itself: whether it came to its end.
    SEARCH = "search"


@dataclass(frozen=True)
class Statement:
    """A ``kind`` of statement with its ``data``, values that JSON can hold, and the
    ``words`` with fields for these."""

    kind: str
    words: str
    data: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The statement in English."""
        return self.words.format(**_shown(self.data))


@dataclass(frozen=True)
class Claim(Statement):
    """What is known of a ``scope``: nothing is missing from it to this ``level``. None
    where the statement says how something is listed, and claims nothing."""

    scope: Scope = Scope.MOTIONS
    level: Level | None = None


@dataclass(frozen=True)
class Doubt(Statement):
    """What is open of a ``subject``, a form or a point by name, all where it is empty;
    ``amount`` is the number on which that hangs, 0 where there is none, ``forms`` are the
    numbers, from 0, of the forms that are the subject."""

    subject: str = ""
    amount: float = 0.0
    forms: tuple[int, ...] = ()

    @property
    def text(self) -> str:
        """The doubt in English."""
        own = {"subject": self.subject, "amount": self.amount}
        return self.words.format(**own, **_shown(self.data))

    def naming(self, names: Sequence[str]) -> Doubt:
        """The same doubt, with forms of these ``names``."""
        if not self.forms:
            return self
        return replace(self, subject=" and ".join(names[form] for form in self.forms))


@dataclass(frozen=True)
class StatementKind:
    """A kind of statement: what it is called, and its words."""

    name: str
    words: str


class ClaimKind(StatementKind):
    """A kind of claim."""

    def claim(self, scope: Scope, level: Level | None, **data: Any) -> Claim:
        """A claim of this kind."""
        return Claim(self.name, self.words, data, scope, level)

    def is_kind_of(self, claim: Claim) -> bool:
        """Whether a claim is of this kind."""
        return claim.kind == self.name


class DoubtKind(StatementKind):
    """A kind of doubt."""

    def doubt(self, subject: str = "", amount: float = 0.0, **data: Any) -> Doubt:
        """A doubt of this kind."""
        return Doubt(self.name, self.words, data, subject, float(amount))

    def of_forms(self, *forms: int, amount: float = 0.0, **data: Any) -> Doubt:
        """A doubt of this kind about forms that have no names of their own yet."""
        subject = " and ".join(numbered_form(form) for form in forms)
        return Doubt(self.name, self.words, data, subject, float(amount), forms)


def numbered_form(form: int) -> str:
    """What a form is called by its number, from 0."""
    return f"Form {form + 1}"


class Kinds(Generic[Kind]):
    """The kinds that a ``table`` lists, of the TOML file beside a ``module``: each is an
    attribute, called as its key."""

    def __init__(self, kind: Callable[[str, str], Kind], module: str, table: str):
        text = Path(module).with_suffix(".toml").read_text(encoding="utf-8")
        for key, words in tomllib.loads(text)[table].items():
            setattr(self, key, kind(key.lower().replace("_", " "), words))

    def __iter__(self) -> Iterator[Kind]:
        return iter(vars(self).values())

    def __getattr__(self, key: str) -> Kind:
        raise AttributeError(f"there is no kind {key!r} of statements")


def worst_level(claims: Iterable[Claim]) -> Level | None:
    """The level of what the claims say together; None where they claim nothing."""
    levels = [claim.level for claim in claims if claim.level is not None]
    return max(levels, key=BEST_FIRST.index, default=None)


@dataclass(frozen=True)
class Completeness:
    """How sure it is that nothing is missing: what is claimed, and what is in doubt.

    ``missed_probability`` bounds the chance that one more random start would reach
    something new.
    """

    claims: tuple[Claim, ...]
    doubts: tuple[Doubt, ...]
    missed_probability: float

    @property
    def level(self) -> Level:
        """That of the worst claim; of an answer in doubt nothing is known."""
        level = worst_level(self.claims) or Level.ESTIMATED
        if self.doubts:
            return max(level, Level.ESTIMATED, key=BEST_FIRST.index)
        return level

    @property
    def is_in_doubt(self) -> bool:
        """Whether something in the answer is not decided."""
        return bool(self.doubts)

    @property
    def statement(self) -> str:
        """All of it in English."""
        claims = "; ".join(claim.text for claim in self.claims)
        if not self.doubts:
            return claims
        doubts = "; ".join(doubt.text for doubt in self.doubts)
        return f"in doubt: {doubts}; {claims}"


def completeness_document(completeness: Completeness) -> dict[str, Any]:
    """What JSON documents say of completeness: every claim and every doubt with its
    numbers and its text, and all of it in one sentence."""
    return {
        "level": completeness.level.value,
        "claims": [
            {
                "kind": claim.kind,
                "scope": claim.scope.value,
                "level": None if claim.level is None else claim.level.value,
                "data": dict(claim.data),
                "text": claim.text,
            }
            for claim in completeness.claims
        ],
        "doubts": [
            {
                "kind": doubt.kind,
                "subject": doubt.subject,
                "amount": doubt.amount,
                "data": dict(doubt.data),
                "text": doubt.text,
            }
            for doubt in completeness.doubts
        ],
        "statement": completeness.statement,
        "missed_probability": completeness.missed_probability,
    }


# --- how data are shown in words ------------------------------------------------------


class _Count(int):
    """A number that "{forms:form}" shows with its noun: 1 form, 2 forms; any other number
    may be whole, too."""

    def __format__(self, noun: str) -> str:
        is_noun = noun[:1].isalpha()
        return count_of(self, noun) if is_noun else format(int(self), noun)


def _shown(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data as words show them: numbers of things with nouns, lists by commas,
    ``places``, intervals of arclengths, by the first one."""
    shown: dict[str, Any] = {}
    for key, value in data.items():
        if key == "places":
            shown[key] = _places(value)
        elif isinstance(value, list | tuple):
            shown[key] = ", ".join(map(str, value))
        elif isinstance(value, int):
            shown[key] = _Count(value)
        else:
            shown[key] = value
    return shown


def _places(intervals: list[tuple[float, float]]) -> str:
    """The first of some intervals, and how many more there are."""
    low, high = intervals[0]
    places = f"between s = {low:.6g} and {high:.6g}"
    more = len(intervals) - 1
    if more:
        places += f" and at {count_of(more, 'more place')}"
    return places
