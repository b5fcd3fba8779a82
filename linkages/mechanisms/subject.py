"""A mechanism as values that JSON can hold, and back."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import asdict, fields, is_dataclass
from enum import StrEnum
from typing import Any

from bifurc.atlas import Atlas
from linkages.labels import NoLinkageError
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Crease, Mechanism, Panel
from linkages.mechanisms.origin import origin_of
from linkages.values import GeometryError, checked_table, require


def mechanism_subject(mechanism: Mechanism) -> dict[str, Any]:
    """The ``subject`` of an atlas of a mechanism."""
    joints = [joint_values(joint) for joint in mechanism.joints]
    values: dict[str, Any] = {"joints": joints, "is_planar": mechanism.is_planar}
    if any(mechanism.origin):
        values["origin"] = list(mechanism.origin)
    if mechanism.rounding:
        values["rounding"] = mechanism.rounding
    if mechanism.moved:
        values["moved"] = mechanism.moved
    if mechanism.panels:
        values["panels"] = [
            {"body": panel.body, "corners": [list(corner) for corner in panel.corners]}
            for panel in mechanism.panels
        ]
    if mechanism.creases:
        values["creases"] = [one._asdict() for one in mechanism.creases]
        values["with_flat_creases"] = mechanism.with_flat_creases
    if mechanism.at_rest:
        values["at_rest"] = list(mechanism.at_rest)
    if mechanism.layers:
        values["layers"] = dict(mechanism.layers)
    if mechanism.motors:
        values["motors"] = list(mechanism.motors)
    if mechanism.with_flaps:
        values["with_flaps"] = True
    return {
        "name": mechanism.name,
        "mechanism": values,
        **mechanism.subject_values(),
    }


def mechanism_of(atlas: Atlas) -> Mechanism | None:
    """The mechanism that an atlas is of; None where it is of a loop that was given as
    such, or of something else. Raises `NoLinkageError` where it is damaged, or in the
    angles of a Denavit-Hartenberg table, as single loops were once.

    >>> import linkages
    >>> def pin(name, body, other, x, y):
    ...     return linkages.Joint(name, "revolute", (body, other), (x, y, 0), (0, 0, 1))
    >>> mechanism = linkages.Mechanism(
    ...     (pin("A", "frame", "crank", 0, 0), pin("B", "crank", "rod", 1, 0),
    ...      pin("C", "rod", "rocker", 4, 2), pin("D", "frame", "rocker", 4, 0)),
    ...     name="crank and rocker",
    ... )
    >>> linkages.mechanism_of(linkages.map_linkage(mechanism)).name
    'crank and rocker'
    """
    values = atlas.subject.get("mechanism")
    if values is None:
        return None
    if "lengths" in atlas.subject:
        raise NoLinkageError(
            "its unknowns are the angles of a Denavit-Hartenberg table, not the "
            "variables of the joints of its mechanism; map the mechanism again"
        )
    try:
        return mechanism_from(values, str(atlas.subject.get("name", "")))
    except GeometryError as error:
        raise NoLinkageError(str(error)) from None


def joint_values(joint: Joint) -> dict[str, Any]:
    """A joint in values that JSON can hold: angles in rad, lengths in the user's unit;
    without the keys that say nothing."""
    values: dict[str, Any] = {}
    for key in (one.name for one in fields(joint)):
        value = getattr(joint, key)
        is_list = isinstance(value, tuple)
        if value is None or (is_list and all(one is None for one in value)):
            continue
        values[key] = [_plain(one) for one in value] if is_list else _plain(value)
    return values


def _plain(value: Any) -> Any:
    """A value as JSON reads it back: no enum, no record and no tuple."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, StrEnum):
        return value.value
    return list(value) if isinstance(value, tuple) else value


def mechanism_from(given: object, name: str) -> Mechanism:
    """The mechanism of the values that `mechanism_subject` gave; raises `GeometryError`
    for others."""
    values = given.get("joints") if isinstance(given, dict) else None
    if not isinstance(values, list) or not all(isinstance(v, dict) for v in values):
        raise GeometryError("joints", repr(values), "a list of joints")
    joints = []
    for value in values:
        try:
            limits = [None if p is None else tuple(p) for p in value.get("limits", [])]
            coupled = [
                None if coupling is None else Coupling(**coupling)
                for coupling in value.get("coupled", [])
            ]
            lists = {"limits": tuple(limits), "coupled": tuple(coupled)}
            joints.append(Joint(**{**value, **lists}))
        except TypeError as error:
            raise GeometryError("joint", repr(value), f"a joint: {error}") from None
    assert isinstance(given, dict)
    is_planar = bool(given.get("is_planar", False))
    origin = origin_of(given, None)
    rounding = float(given.get("rounding", 0.0))
    outlines = given.get("panels", [])
    is_list = isinstance(outlines, list)
    require(is_list, "panels", repr(outlines), "a list of panels")
    bodies = {body for joint in joints for body in joint.bodies}
    panels = tuple(_panel(value, bodies) for value in outlines)
    with_flaps = bool(given.get("with_flaps", False))
    creases = tuple(Crease(**value) for value in given.get("creases", []))
    # none were held once
    with_flat_creases = bool(given.get("with_flat_creases", creases))
    layers = tuple(checked_table("layers", given.get("layers", {}), "a table").items())
    return Mechanism(
        tuple(joints),
        name,
        is_planar,
        origin,
        rounding,
        panels,
        with_flaps,
        creases,
        with_flat_creases=with_flat_creases,
        at_rest=tuple(given.get("at_rest", ())),
        motors=tuple(given.get("motors", ())),
        layers=layers,
        moved=float(given.get("moved", 0.0)),
    )


def _panel(value: Any, bodies: Collection[str]) -> Panel:
    """A panel of its values; raises `GeometryError` for what is none."""
    try:
        corners = tuple((float(x), float(y), float(z)) for x, y, z in value["corners"])
        body = value["body"]
    except (KeyError, TypeError, ValueError):
        raise GeometryError("panel", repr(value), "a body and its corners") from None
    is_body = body in bodies
    require(is_body, "body of a panel", repr(body), "a body of the mechanism")
    return Panel(body, corners)
