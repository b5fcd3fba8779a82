"""Mechanisms as SDFormat 1.11, the files of Gazebo (sdformat.org).

The frames of all links coincide in the reference configuration, so that every number of
the mechanism stands in the file as it is. The body at rest is the world. Cylindrical
and planar joints, which SDF does not know, are chains with links between them. What is
coupled has a ``<mimic>``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.sax.saxutils import escape, quoteattr

from linkages.formats.composites import link_behind
from linkages.formats.names import (
    WORLD,
    NameRules,
    body_name,
    pair_name,
    pair_names,
    row_text,
    with_names_for,
)
from linkages.formats.sdf_reading import AXES
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism, Pair, Variable
from linkages.mechanisms.size import Size
from linkages.values import require


def mechanism_sdf(mechanism: Mechanism) -> str:
    """The text of an SDF file with one model in the reference configuration; masses are
    made up. Raises `GeometryError` where a joint is locked elsewhere than at 0, for
    which SDF has no word. Names that SDF forbids, or that stand there for two things,
    are changed, and the log says so."""
    mechanism = with_names_for(mechanism, NAMES)
    name = mechanism.name.replace("::", ".") or "mechanism"
    if not _is_allowed(name):
        name += ".model"
    moment = repr(Size(mechanism).characteristic_length ** 2)
    links = [body for body in mechanism.bodies if body != mechanism.frame]
    joints = []
    for pair in mechanism.pairs:
        lines, between = _pair(mechanism, pair)
        joints += lines
        links += between
    lines = [
        '<?xml version="1.0"?>',
        '<sdf version="1.11">',
        f"  <model name={quoteattr(name)}>",
    ]
    for link in links:
        lines += _link(body_name(mechanism, link), moment)
    return "\n".join([*lines, *joints, "  </model>", "</sdf>"]) + "\n"


def _is_allowed(name: str) -> bool:
    """Whether a name is not reserved (SDFormat 1.7 and later)."""
    is_reserved = name.startswith("__") and name.endswith("__")
    return not (is_reserved or "::" in name or name == WORLD)


def _names_of_joint(joint: Joint) -> list[str]:
    """The names that may stand in a file for a joint: of its pairs, of its variables,
    and of the links between these."""
    return [
        *pair_names(joint),
        *joint.labels,
        *(link_behind(label) for label in joint.labels),
    ]


# links are among the names of joints: all are siblings
NAMES = NameRules(
    is_allowed=_is_allowed,
    of_joint=_names_of_joint,
    links_of_joint=lambda joint: (),
    siblings=True,
)


def _link(name: str, moment: str) -> list[str]:
    diagonal = "".join(f"<{key}>{moment}</{key}>" for key in ("ixx", "iyy", "izz"))
    return [
        f"    <link name={quoteattr(name)}>",
        f"      <inertial><mass>1</mass><inertia>{diagonal}</inertia></inertial>",
        "    </link>",
    ]


def _pair(mechanism: Mechanism, pair: Pair) -> tuple[list[str], list[str]]:
    """The lines of the joints of a pair, and the links between them."""
    joint = mechanism.joint(pair.joint)
    variables = [mechanism.variables[number] for number in pair.variables]
    for variable in variables:
        locked = variable.locked or 0.0
        value = f"{locked:.10g}"
        if variable.motion.is_turn:
            value = f"{math.degrees(locked):.10g} degrees"
        what = f"locked of joint {variable.label}"
        require(locked == 0.0, what, value, "0, or left out, in an SDF file")
    base, moved = (body_name(mechanism, body) for body in (pair.base, pair.moved))
    name = pair_name(joint, pair)
    place = joint.place
    if not variables or _has_two_axes(mechanism, pair):
        axes = []
        for tag, variable in zip(AXES, variables, strict=False):
            axes += _axis(tag, variable, mechanism, 1.0)
        return _joint(name, joint.kind.facets.sdf[0], base, moved, place, axes), []
    between = [link_behind(variable.label) for variable in variables[:-1]]
    bodies = [base, *between, moved]
    lines = []
    for variable, first, second in zip(variables, bodies, bodies[1:], strict=False):
        sign = -1.0 if second == WORLD else 1.0
        axis = _axis(AXES[0], variable, mechanism, sign)
        kind = _kind(variable)
        if kind == "screw":
            pitch = 2 * math.pi * variable.motion.advance
            text = f"<screw_thread_pitch>{pitch!r}</screw_thread_pitch>"
            axis.append(text)
        lines += _joint(variable.label, kind, first, second, place, axis)
    return lines, between


def _kind(variable: Variable) -> str:
    if variable.locked is not None:
        kind = JointKind.RIGID
    elif not variable.motion.is_turn:
        kind = JointKind.PRISMATIC
    else:
        kind = JointKind.HELICAL if variable.motion.advance else JointKind.REVOLUTE
    return kind.facets.sdf[0]


def _axis(tag: str, variable: Variable, mechanism: Mechanism, sign: float) -> list[str]:
    """The axis of a variable, with the ``sign`` of its direction; none where it is
    locked."""
    if variable.locked is not None:
        return []
    direction = row_text(sign * variable.motion.direction)
    more = _mimic(variable, mechanism)
    if variable.limits is not None:
        low, high = (repr(float(value)) for value in variable.limits)
        more = f"<limit><lower>{low}</lower><upper>{high}</upper></limit>{more}"
    return [f"<{tag}><xyz>{direction}</xyz>{more}</{tag}>"]


def _mimic(variable: Variable, mechanism: Mechanism) -> str:
    """What a variable follows; empty where that is itself."""
    number, ratio, offset = variable.leader
    if mechanism.variables[number].label == variable.label:
        return ""
    joint, tag = mechanism.variables[number].label, AXES[0]
    for pair in mechanism.pairs:
        if number in pair.variables and _has_two_axes(mechanism, pair):
            tag = AXES[pair.variables.index(number)]
            joint = pair_name(mechanism.joint(pair.joint), pair)
    numbers = (
        f"<multiplier>{ratio!r}</multiplier><offset>{offset!r}</offset>"
        "<reference>0</reference>"
    )
    return f'<mimic joint={quoteattr(joint)} axis="{tag}">{numbers}</mimic>'


def _has_two_axes(mechanism: Mechanism, pair: Pair) -> bool:
    """Whether a pair is written as a universal joint, not as a chain."""
    if mechanism.joint(pair.joint).kind is not JointKind.UNIVERSAL:
        return False
    if pair.moved == mechanism.frame:
        return False
    return all(mechanism.variables[number].locked is None for number in pair.variables)


def _joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    place: Iterable[float],
    axes: list[str],
) -> list[str]:
    """The lines of a joint. The world is no child in SDF: it is the parent then, and
    the direction of an axis is given as seen from there."""
    if child == WORLD:
        parent, child = child, parent
    return [
        f'    <joint name={quoteattr(name)} type="{kind}">',
        f"      <pose>{row_text(place)} 0 0 0</pose>",
        f"      <parent>{escape(parent)}</parent>",
        f"      <child>{escape(child)}</child>",
        *(f"      {line}" for line in axes),
        "    </joint>",
    ]
