"""Reading a system of equations from a TOML file.

name = "A to B reaction"          # optional
parameter = "p"                   # optional: an unknown, for the diagram

[unknowns]                        # bounds, or a table
x = [0, 1]
y = { bounds = [0, 8], unit = "K" }
phi = { period = "2*pi", unit = "rad" }
p = [0, 0.16]

[parameters]                      # optional: constants
B = 14

[definitions]                     # optional: each of what stands above it
rate = "p*(1 - x)*exp(y)"

[equations]                       # or a list of texts
mass = "x' = rate - x"

[events]                          # optional
half = "x = 0.5"
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

from bifurc.atlas import Atlas
from bifurc.equations.expression import (
    FUNCTION_NAMES,
    ExpressionError,
    Part,
    parse_expression,
)
from bifurc.equations.expression_problem import ExpressionProblem, FirstOutput, tape_of
from bifurc.equations.program import CONSTANTS, Program, Step
from bifurc.equations.tape import TapeWriter
from bifurc.errors import PathError, ProblemError
from bifurc.files.text_file import TextFileError, read_toml
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings

DEFAULT_SETTINGS = SearchSettings()
Content: TypeAlias = Mapping[str, object]

REQUIRED = ("unknowns", "equations")
KEYS = ("name", "parameter", *REQUIRED, "parameters", "definitions", "events")
UNKNOWN_KEYS = ("bounds", "period", "unit")
NAME = re.compile(r"[^\W\d]\w*")
EQUALS = re.compile(r"==?")
RATE = re.compile(r"\s*([^\W\d]\w*)\s*'\s*==?")
INFINITE = {"inf": math.inf, "+inf": math.inf, "-inf": -math.inf}


class EquationFileError(PathError):
    """A file of equations that cannot be used."""


@dataclass(frozen=True, eq=False)
class EquationSystem:
    """What a file of equations says.

    ``equations`` are their texts by their names, ``values`` the constants by theirs,
    ``events`` functions of the unknowns (n,) whose zeros are looked for. ``is_flow``:
    whether the equations are rates, so that stability is defined.
    """

    name: str
    problem: ExpressionProblem
    parameter: str | None
    equations: Mapping[str, str]
    values: Mapping[str, float]
    events: Mapping[str, FirstOutput]
    is_flow: bool

    def explore(
        self,
        *,
        settings: SearchSettings = DEFAULT_SETTINGS,
        seed: int = 0,
        progress: Callable[[str, int], None] | None = None,
    ) -> Atlas:
        """The atlas of the system, whose ``subject`` says what was solved; see
        `bifurc.explore`."""
        atlas = explore(
            self.problem,
            settings=settings,
            seed=seed,
            progress=progress,
            parameter=self.parameter,
            events=dict(self.events) or None,
            is_flow=self.is_flow,
        )
        subject = {
            "kind": "system",
            "name": self.name,
            "equations": dict(self.equations),
            "parameters": dict(self.values),
        }
        return replace(atlas, subject=subject)


def read_equations(
    path: Path | str,
    values: Mapping[str, float] | None = None,
    free: Mapping[str, tuple[float, float]] | None = None,
) -> EquationSystem:
    """The system of equations that a TOML file describes; docs/equations.md says how.

    ``values`` replace those of the parameters in the file; those that are ``free``
    within bounds are further unknowns of the problem, after the others. Nothing in the
    file is run.
    Raises `EquationFileError` for a file that cannot be read, and for anything wrong in
    it, with the name of the entry.

    >>> import bifurc, pathlib
    >>> text = '''
    ... equations = ["x^2 + y^2 = r^2"]
    ... [unknowns]
    ... x = [-3, 3]
    ... y = [-3, 3]
    ... [parameters]
    ... r = 1
    ... '''
    >>> _ = pathlib.Path("circle.toml").write_text(text)
    >>> (form,) = bifurc.read_equations("circle.toml", {"r": 2}).explore().forms
    >>> form.branch.closed, round(form.branch.length, 9)
    (True, 12.566370614)
    """
    return EquationFile.read(path).system(values or {}, free or {})


@dataclass(frozen=True)
class EquationFile:
    """What a file of equations holds: its ``content``, decimals as texts."""

    path: Path
    content: Content

    @staticmethod
    def read(path: Path | str) -> EquationFile:
        """The file at a path; raises `EquationFileError` where it cannot be read."""
        path = Path(path)
        try:
            return EquationFile(path, read_toml(path, parse_float=str))
        except TextFileError as error:
            raise EquationFileError(path, error.reason) from None

    @property
    def is_of_equations(self) -> bool:
        """Whether it has what a file of equations must have, and no other file has."""
        return all(key in self.content for key in REQUIRED)

    @property
    def constants(self) -> list[str]:
        """The names of the constants that can have other values."""
        table = self.content.get("parameters", {})
        return list(table) if isinstance(table, dict) else []

    def system(
        self,
        values: Mapping[str, float],
        free: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> EquationSystem:
        """The system with these ``values`` of constants, and with others ``free`` within
        bounds; raises `EquationFileError`."""
        try:
            return _Reading(self.path, self.content, dict(values), dict(free)).system()
        except _Refusal as refusal:
            raise EquationFileError(self.path, str(refusal)) from None
        except ProblemError as error:
            raise EquationFileError(self.path, str(error)) from None


class _Refusal(Exception):
    """Something wrong in the file."""


def holds_equations(path: Path | str) -> bool:
    """Whether a file is one of equations rather than of a linkage; what cannot be read
    is not."""
    try:
        return EquationFile.read(path).is_of_equations
    except EquationFileError:
        return False


class _Unknown(NamedTuple):
    """An unknown as the file describes it."""

    low: float
    high: float
    period: float
    unit: str


class _Equation(NamedTuple):
    """An equation: the ``part`` that is to be zero, or the rate of an unknown, which is
    empty where none is named."""

    label: str
    text: str
    part: Part
    rate_of: str


@dataclass
class _Reading:
    """A file while it is read: ``content``, ``overrides`` of parameters, the bounds of
    those that are ``free``, and the symbols that are known so far."""

    path: Path
    content: Content
    overrides: dict[str, float]
    free: dict[str, tuple[float, float]]
    symbols: dict[str, Part] = field(default_factory=dict)
    program: Program = field(default_factory=Program)

    def system(self) -> EquationSystem:
        """All of it."""
        _check_keys("key", self.content, KEYS)
        for key in REQUIRED:
            if key not in self.content:
                raise _Refusal(f"{key}: it is missing")
        values = self._parameters()
        unknowns = self._unknowns()
        parameter = self._parameter(list(unknowns))
        self._definitions(list(unknowns))
        equations = self._equations(list(unknowns))
        is_flow = self._is_flow(equations, list(unknowns), parameter)
        if is_flow:
            order = list(unknowns)
            equations.sort(key=lambda one: order.index(one.rate_of))
        further = {name: _Unknown(*self.free[name], math.inf, "") for name in self.free}
        all_unknowns = {**unknowns, **further}
        problem = ExpressionProblem(
            self.program,
            [equation.part.place for equation in equations],
            list(all_unknowns),
            [(one.low, one.high) for one in all_unknowns.values()],
            periods=[one.period for one in all_unknowns.values()],
            units=[one.unit for one in all_unknowns.values()],
        )
        return EquationSystem(
            name=self._text("name", self.path.stem),
            problem=problem,
            parameter=parameter,
            equations={one.label: one.text for one in equations},
            values=values,
            events=self._events(list(unknowns)),
            is_flow=is_flow,
        )

    # --- symbols ----------------------------------------------------------------------

    def _parameters(self) -> dict[str, float]:
        """The constants by their names."""
        table = self._table("parameters")
        for name in (*self.overrides, *self.free):
            if name not in table:
                hint = _nearest(name, table)
                raise _Refusal(f"parameters.{name}: there is none in the file{hint}")
        values = {}
        for name, given in table.items():
            label = f"parameters.{name}"
            self._check_name(label, name)
            if not math.isfinite(self.overrides.get(name, 0.0)):
                refused = self.overrides[name]
                raise _Refusal(f"{label}: {refused} is not a finite number")
            value = repr(self.overrides[name]) if name in self.overrides else given
            part = self._constant(label, value)
            values[name] = float(part.value or 0.0)
            if name in self.free:
                part = Part(self.program.place(Step(name)))
            self.symbols[name] = part
        return values

    def _unknowns(self) -> dict[str, _Unknown]:
        table = self._table("unknowns")
        unknowns = {}
        for name, given in table.items():
            label = f"unknowns.{name}"
            self._check_name(label, name)
            unknowns[name] = self._unknown(label, given)
        if len(unknowns) < 2:
            raise _Refusal(
                f"unknowns: {len(unknowns)} of them; there must be 2 or more"
            )
        for name in unknowns:
            self.symbols[name] = Part(self.program.place(Step(name)))
        return unknowns

    def _unknown(self, label: str, given: object) -> _Unknown:
        entries: Mapping[str, object] = {"bounds": given}
        if isinstance(given, dict):
            entries = given
            _check_keys(label, entries, UNKNOWN_KEYS)
        elif not isinstance(given, list):
            raise _Refusal(f"{label}: {given!r} is no [low, high], and no table")
        period = math.inf
        if "period" in entries:
            period = self._number(f"{label}.period", entries["period"])
            if not 0.0 < period < math.inf:
                raise _Refusal(f"{label}.period: {period:g} is not positive")
        low, high = -math.inf, math.inf
        if "bounds" in entries:
            bounds = entries["bounds"]
            if not isinstance(bounds, list) or len(bounds) != 2:
                raise _Refusal(f"{label}.bounds: {bounds!r} is no [low, high]")
            low, high = (self._number(f"{label}.bounds", one) for one in bounds)
            if not low < high:
                raise _Refusal(f"{label}.bounds: {low:g} is not below {high:g}")
        unit = entries.get("unit", "")
        if not isinstance(unit, str):
            raise _Refusal(f"{label}.unit: {unit!r} is no text in quotes")
        return _Unknown(low, high, period, unit)

    def _parameter(self, unknowns: Sequence[str]) -> str | None:
        """The unknown along which there is a diagram."""
        if "parameter" not in self.content:
            return None
        parameter = self._text("parameter", "")
        if parameter not in unknowns:
            hint = _nearest(parameter, unknowns)
            if parameter in self.symbols:
                hint = "; it has a value, and must have bounds among the unknowns"
            raise _Refusal(f"parameter: {parameter!r} is no unknown{hint}")
        return parameter

    def _definitions(self, unknowns: Sequence[str]) -> None:
        for name, text in self._table("definitions").items():
            label = f"definitions.{name}"
            self._check_name(label, name)
            self.symbols[name] = self._part(label, text)

    # --- equations and events ---------------------------------------------------------

    def _equations(self, unknowns: Sequence[str]) -> list[_Equation]:
        given = self.content["equations"]
        if isinstance(given, list):
            given = {f"{k}": text for k, text in enumerate(given, start=1)}
        if not isinstance(given, dict):
            raise _Refusal("equations: neither a table nor a list of texts")
        if not given:
            raise _Refusal("equations: there are none")
        equations = [
            self._equation(name, text, unknowns) for name, text in given.items()
        ]
        self._check_that_unknowns_are_left(equations, unknowns)
        return equations

    def _check_that_unknowns_are_left(
        self, equations: Sequence[_Equation], unknowns: Sequence[str]
    ) -> None:
        """Refuse equations whose two sides are the same."""
        names = [*unknowns, *self.free]
        writer = TapeWriter(len(names))
        places = [equation.part.place for equation in equations]
        slots = self.program.write_on(writer, places, names)
        for equation, slot in zip(equations, slots, strict=True):
            if writer.value(slot) is not None:
                label = f"equations.{equation.label}"
                raise _Refusal(f"{label}: {equation.text!r} holds no unknown")

    def _equation(self, name: str, text: object, unknowns: Sequence[str]) -> _Equation:
        label = f"equations.{name}"
        if not isinstance(text, str):
            raise _Refusal(f"{label}: {text!r} is no text in quotes")
        rate = RATE.match(text)
        if rate is None:
            part = self._part(label, text)
            rate_of = ""
        else:
            if EQUALS.search(text, rate.end()):
                raise _Refusal(f"{label}: {text!r} has more than one sign =")
            part = self._side(label, text, rate.end(), len(text))
            rate_of = rate[1]
            if rate_of not in unknowns:
                hint = _nearest(rate_of, unknowns)
                raise _Refusal(f"{label}: {rate_of!r} is no unknown{hint}")
        return _Equation(name, text, part, rate_of)

    def _is_flow(
        self,
        equations: Sequence[_Equation],
        unknowns: Sequence[str],
        parameter: str | None,
    ) -> bool:
        """Whether the equations are the rates of all unknowns but the parameter."""
        rates = [equation.rate_of for equation in equations]
        if not any(rates):
            return False
        for equation in equations:
            label = f"equations.{equation.label}"
            if not equation.rate_of:
                raise _Refusal(
                    f"{label}: it says no rate (x' = ...), and others do; all or none "
                    "must"
                )
            if parameter is None:
                raise _Refusal(f"{label}: a rate, and no unknown is the parameter")
            if equation.rate_of == parameter:
                raise _Refusal(f"{label}: the parameter {parameter} has no rate")
            if rates.count(equation.rate_of) > 1:
                raise _Refusal(f"{label}: {equation.rate_of} has a rate already")
        missing = [one for one in unknowns if one not in (*rates, parameter)]
        if missing:
            raise _Refusal(f"equations: there is no rate of {', '.join(missing)}")
        return True

    def _events(self, unknowns: Sequence[str]) -> dict[str, FirstOutput]:
        events = {}
        for name, text in self._table("events").items():
            part = self._part(f"events.{name}", text)
            if part.value is not None:
                raise _Refusal(f"events.{name}: {text!r} holds no unknown")
            names = [*unknowns, *self.free]
            events[name] = FirstOutput(tape_of(self.program, [part.place], names))
        return events

    # --- entries ----------------------------------------------------------------------

    def _table(self, key: str) -> Mapping[str, object]:
        table = self.content.get(key, {})
        if not isinstance(table, dict):
            raise _Refusal(f"{key}: {table!r} is no table")
        return table

    def _text(self, key: str, default: str) -> str:
        text = self.content.get(key, default)
        if not isinstance(text, str):
            raise _Refusal(f"{key}: {text!r} is no text in quotes")
        return text

    def _part(self, label: str, text: object) -> Part:
        """An expression, or what the left of an equation is more than the right."""
        if isinstance(text, int) and not isinstance(text, bool):
            text = str(text)
        if not isinstance(text, str):
            raise _Refusal(f"{label}: {text!r} is no text in quotes")
        signs = list(EQUALS.finditer(text))
        if len(signs) > 1:
            raise _Refusal(f"{label}: {text!r} has more than one sign =")
        if not signs:
            return self._side(label, text, 0, len(text))
        left = self._side(label, text, 0, signs[0].start())
        right = self._side(label, text, signs[0].end(), len(text))
        place = self.program.place(Step("-", (left.place, right.place)))
        value = None
        if left.value is not None and right.value is not None:
            value = left.value - right.value
        return Part(place, value, left.size + right.size)

    def _side(self, label: str, text: str, begin: int, end: int) -> Part:
        """The expression from ``begin`` to ``end`` of a text, in the columns of which an
        error counts."""
        try:
            text_of_side = " " * begin + text[begin:end]
            return parse_expression(text_of_side, self.symbols, self.program)
        except ExpressionError as error:
            raise _Refusal(f"{label}: {text!r}: {error}") from None

    def _constant(self, label: str, given: object) -> Part:
        if isinstance(given, bool) or not isinstance(given, int | str):
            raise _Refusal(f"{label}: {given!r} is no number, and no text of one")
        part = self._part(label, str(given))
        if part.value is None:
            raise _Refusal(f"{label}: {given!r} is no constant")
        return part

    def _number(self, label: str, given: object) -> float:
        """A constant, which may be infinite."""
        if isinstance(given, str) and given in INFINITE:
            return INFINITE[given]
        return float(self._constant(label, given).value or 0.0)

    def _check_name(self, label: str, name: str) -> None:
        if NAME.fullmatch(name) is None:
            raise _Refusal(f"{label}: {name!r} is no name of letters and digits")
        if name in FUNCTION_NAMES or name in CONSTANTS:
            raise _Refusal(f"{label}: the name {name!r} has a meaning already")
        if name in self.symbols:
            raise _Refusal(f"{label}: there is another {name!r} above")


def _check_keys(label: str, table: Content, known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            hint = _nearest(key, known)
            raise _Refusal(f"{label}: {key!r} is none of {', '.join(known)}{hint}")


def _nearest(name: str, names: Iterable[str]) -> str:
    near = difflib.get_close_matches(name, list(names), n=1)
    return f"; the nearest is {near[0]!r}" if near else ""
