"""Entries of the catalogue, read from tables.

Beside each module of `linkages.families` stands a TOML file of its name, which says what
its linkages are; the module says how they are worked out (`Model`).

    source = "..."                # what stands here holds where a linkage says nothing else
    [parameters]                  # by name: the default as length, number, degrees or radians
    a = {length = "1.7 sin(66 deg)", range = [0.3, 3.0], meaning = "length of link a"}
    [conditions]                  # those that several linkages name
    ratio = "sin(twist)/length is the same for the links a, b"

    [[linkage]]                   # a field of `Entry` each
    name = "..."
    parameters = ["a", "alpha"]   # in this order; all of the file if none are listed
    changes.a = {meaning = "..."} # in which a parameter differs
    conditions = ["ratio", "in words", {equations = "R1 = R2"}, {text = "", equations = ""}]
    relations = [{kind = "special case of", other = "...", source = "..."}]

A number may be a formula of `linkages.construction.equations`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import resources
from math import radians
from typing import Any

from linkages.construction.equations import evaluate
from linkages.entry import (
    Condition,
    Entry,
    FormPattern,
    Guesses,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
from linkages.loop import Loop

UNITS = {
    "length": (ParameterKind.LENGTH, 1.0),
    "number": (ParameterKind.NUMBER, 1.0),
    "degrees": (ParameterKind.ANGLE, radians(1)),
    "radians": (ParameterKind.ANGLE, 1.0),
}


@dataclass(frozen=True)
class Model:
    """How a linkage is worked out, see `Entry`."""

    construct: Callable[..., Loop]
    patterns: Callable[..., tuple[FormPattern, ...]] | None = None
    guesses: Guesses | None = None
    scan: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


def read_entries(family: str, models: Mapping[str, Model]) -> tuple[Entry, ...]:
    """The linkages of the table of a family, each with its model.

    Raises `ValueError` where both do not name the same linkages, and `TypeError` or
    `KeyError` for a table that holds something else.
    """
    linkages = read_records("linkages.families", family, "linkage")
    names = {linkage["name"] for linkage in linkages}
    if names != models.keys():
        raise ValueError(f"{family}: {names ^ models.keys()} without table or model")
    return tuple(
        Entry(family=family, **one, **vars(models[one["name"]])) for one in linkages
    )


def read_records(package: str, name: str, kind: str) -> list[dict[str, Any]]:
    """The fields of every record of a ``kind``, such as "linkage", in the table of this
    name in a package."""
    file = resources.files(package) / f"{name}.toml"
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    parameters = table.pop("parameters")
    conditions = table.pop("conditions", {})
    records = table.pop(kind)
    return [_record({**table, **one}, parameters, conditions) for one in records]


def _record(
    fields: dict[str, Any],
    parameters: Mapping[str, Mapping[str, Any]],
    conditions: Mapping[str, str | Mapping[str, str]],
) -> dict[str, Any]:
    names = fields.pop("parameters", parameters)
    changes = fields.pop("changes", {})
    own = [_parameter(name, parameters[name] | changes.get(name, {})) for name in names]
    out: dict[str, Any] = {"parameters": tuple(own)}
    for key, value in fields.items():
        if key == "conditions":
            value = [_condition(one, conditions) for one in value]
        elif key == "relations":
            value = [_relation(**one) for one in value]
        elif key == "facts":
            value = {name: _fact(fact) for name, fact in value.items()}
        out[key] = tuple(value) if isinstance(value, list) else value
    return out


def _parameter(name: str, fields: dict[str, Any]) -> Parameter:
    (unit,) = fields.keys() - {"range", "meaning"}
    kind, size = UNITS[unit]
    default, low, high = (size * _number(x) for x in (fields[unit], *fields["range"]))
    return Parameter(name, default, kind, fields["meaning"], low, high)


def _number(value: float | str) -> float:
    return float(evaluate(value) if isinstance(value, str) else value)


def _condition(
    one: str | Mapping[str, str], named: Mapping[str, str | Mapping[str, str]]
) -> Condition:
    """A condition in words, one of those ``named``, or one with equations, which are
    its text where it has no other."""
    if isinstance(one, str):
        one = named.get(one, one)
    if isinstance(one, str):
        return Condition(one)
    return Condition(**{"text": one["equations"], **one})


def _relation(kind: str, **fields: Any) -> Relation:
    return Relation(RelationKind(kind), **fields)


def _fact(value: Any) -> Any:
    """A fact, or facts by the numbers of joints."""
    if isinstance(value, dict):
        return {int(joint): of_joint for joint, of_joint in value.items()}
    return value
