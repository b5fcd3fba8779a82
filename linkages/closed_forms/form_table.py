"""Closed forms, read from the tables in the folder ``tables``: a TOML file for each family.

    [[goldberg-5r]]                       # of this linkage; its forms in their order
    like = {linkage = "...", form = 1}    # what is not said here stands there, also of another family
    form = "..."                          # fields of `ClosedForm`
    angles = ["alpha", "beta"]
    constants = {m_a = "m(alpha, beta)"}
    where = {t_2 = "reciprocal(theta_1, m_a)"}    # names for what occurs again
    joints = ["theta_1", "t_2", ["pi - t_2", "..."]]    # the angle of each, or several that are equal
    relation = "..."

Where a form is like another one, ``constants`` and ``where`` are put beside those of the
other, and ``joints`` may be some by their numbers.

Formulas are those of `linkages.construction.equations`. In them the name of an angle is the
tangent of its half, and sin(alpha), cos(alpha) and m(alpha, beta) = (alpha + beta)/(alpha -
beta) are of such tangents; theta_1 is the angle of joint 1 itself, s_1 and c_1 are the pair
of it. Angles are added; arc(y, x) has the tangent y/x of its half, and reciprocal(t, m) the
tangent m/tan(t/2).
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Any, TypeAlias

from linkages.closed_forms.closed_form import (
    ClosedForm,
    HalfTangent,
    constant,
    cosine_of,
    joint,
    sine_of,
    tangent,
)
from linkages.construction import numbers
from linkages.construction.equations import evaluate
from linkages.construction.numbers import Number

FormTable: TypeAlias = dict[str, Any]  # a table of TOML, as the head says
KEYS = frozenset(
    {"like", "form", "source", "angles", "lengths", "constants", "where", "joints"}
    | {"relation", "second"}
)


@cache
def form_tables(family: str) -> dict[str, list[FormTable]]:
    """The closed forms of a family, those of each linkage by its name; none where there
    is no file."""
    file = resources.files("linkages.closed_forms") / "tables" / f"{family}.toml"
    if not file.is_file():
        return {}
    tables = tomllib.loads(file.read_text(encoding="utf-8"))

    def complete(table: FormTable) -> FormTable:
        model = table.get("like")
        if model is None:
            return table
        name, number = model["linkage"], model.get("form", 0)
        if "family" in model:
            return changed(form_tables(model["family"])[name][number], table)
        return changed(complete(tables[name][number]), table)

    return {name: [complete(one) for one in forms] for name, forms in tables.items()}


def changed(table: FormTable, changes: FormTable) -> FormTable:
    """The table of a form with what the ``changes`` say in its place."""
    out = table | changes
    for key in ("constants", "where"):
        out[key] = {**table.get(key, {}), **changes.get(key, {})}
    if isinstance(out["joints"], dict):
        joints = list(table["joints"])
        for number, angle in out["joints"].items():
            joints[int(number) - 1] = angle
        out["joints"] = joints
    return out


def closed_form(linkage: str, table: FormTable) -> ClosedForm:
    """The closed form of a linkage that a complete table describes; raises `ValueError`
    for entries that a form has not."""
    if not table.keys() <= KEYS:
        raise ValueError(f"{linkage}: a closed form has no {table.keys() - KEYS}")
    names = _names(table)
    for name, formula in table.get("where", {}).items():
        names[name] = evaluate(formula, names)
    constants = {}
    for name, formula in table["constants"].items():
        constants[name] = evaluate(formula, names)
    angles = []
    for formulas in table["joints"]:
        several = [formulas] if isinstance(formulas, str) else formulas
        angles.append(tuple(evaluate(one, names).pair for one in several))
    relation = table.get("relation", "")
    return ClosedForm(
        linkage,
        table["form"],
        table["source"],
        tuple(table["angles"]),
        tuple(angles),
        constants,
        tuple(table.get("lengths", ())),
        relation=evaluate(relation, names) if relation else None,
        second=table["second"] if relation else 0,
    )


def _names(table: FormTable) -> dict[str, Any]:
    """What formulas may use."""
    names: dict[str, Any] = {
        "sin": sine_of,
        "cos": cosine_of,
        "sqrt": numbers.sqrt,
        "m": lambda x, y: (x + y) / (x - y),
        "arc": HalfTangent,
        "reciprocal": _reciprocal,
        "zero": HalfTangent(0, 1),
        "pi": HalfTangent(1, 0),
    }
    for number in range(1, len(table["joints"]) + 1):
        s, c = joint(number)
        names |= {f"s_{number}": s, f"c_{number}": c}
        names[f"theta_{number}"] = HalfTangent(s, c)
    names |= {name: tangent(name) for name in table["angles"]}
    symbols = (*table.get("lengths", ()), *table["constants"])
    return names | {name: constant(name) for name in symbols}


def _reciprocal(angle: HalfTangent, factor: Number) -> HalfTangent:
    """The angle whose half has the tangent ``factor`` over that of another."""
    return HalfTangent(factor * angle.bottom, angle.top)
