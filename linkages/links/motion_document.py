"""A mechanism as the viewer reads it: how its bodies move, as a product of elementary
motions along a tree of bodies, and what of them is drawn.

Lengths are in characteristic lengths, but for what is said to be in the user's unit.
Places and directions are those of the reference configuration. Bodies and unknowns are
given by their numbers, from 0.

size         the characteristic length in the user's unit
frame, held  the body at rest, and the one that is drawn at rest at first
unknowns     name; times factor it is in rad or the user's unit of length: is_angle and
             is_length say which, a number of an embedded rotation is neither; period or
             None
followers    variables coupled to an unknown: name, is_angle; rate times the unknown of
             this column, plus offset; times factor it is in rad or the user's unit
steps        from the body origin to the body goal: the product of factors, or a rotation;
             the inverse of it where the sign is -1
  factors    elementary motions (`linkages.mechanisms.joint.Motion`): is_turn, direction,
             point, advance; by rate times the unknown of this column, plus offset; by the
             offset alone where the column is None, as the variable is locked
  rotation   about center, by a matrix whose first two columns are the unknowns of these
             columns; the last three of nine are a translation
rods         between points, centers, of the bodies ends
  parts      bodies that move as one at an end; start comes to the spherical joint there,
             inside are their displacements, three rows of four, from the first of them
  leg        its slide: the length is length + rate times the unknown of column; or None
bodies       what `draw_bodies` gives
symbols      what `draw_symbols` gives
tape         the closure equations as operations by their names, one after the other, left
             and right the numbers of earlier ones or of an unknown, with constants; the
             outputs are the equations; None where unknowns are many
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from linkages.closure.equations import write_equations
from linkages.links.mechanism_drawing import draw_bodies, draw_symbols, held_body
from linkages.readout.poses import Poses, TreeStep
from linkages.structure.rods import Rod
from linkages.structure.structure import Structure, Unknown

Document: TypeAlias = dict[str, Any]  # values that JSON can hold

MOST_UNKNOWNS = 30  # up to which a page has time for singular values at each frame


def has_tape(structure: Structure) -> bool:
    """Whether the document holds the closure equations."""
    return len(structure.unknowns) <= MOST_UNKNOWNS


def describe_motion(structure: Structure, points: np.ndarray) -> Document:
    """The document of a mechanism; slides are drawn as long as they are used at
    ``points`` (k, n), the configurations on the map."""
    poses = Poses(structure)
    mechanism = structure.mechanism
    return {
        "size": structure.unit,
        "frame": mechanism.bodies.index(mechanism.frame),
        "held": mechanism.bodies.index(held_body(mechanism)),
        "unknowns": [
            _unknown(unknown, float(factor))
            for unknown, factor in zip(
                structure.unknowns, structure.scales, strict=True
            )
        ],
        "followers": _followers(structure),
        "steps": [_step(structure, step) for step in poses.tree],
        "rods": [_rod(poses, rod) for rod in structure.rods],
        "bodies": draw_bodies(structure, points),
        "symbols": draw_symbols(structure),
        "tape": _tape(structure) if has_tape(structure) else None,
    }


def _tape(structure: Structure) -> Document:
    nodes, outputs = write_equations(structure).tape.nodes()
    return {
        "operations": [node.operation.name.lower() for node in nodes],
        "left": [node.left for node in nodes],
        "right": [node.right for node in nodes],
        "constants": [node.constant for node in nodes],
        "outputs": outputs,
    }


def _unknown(unknown: Unknown, factor: float) -> Document:
    return {
        "name": unknown.label,
        "is_angle": unknown.is_angle,
        "is_length": unknown.is_length,
        "factor": factor,
        "period": unknown.period if np.isfinite(unknown.period) else None,
    }


def _followers(structure: Structure) -> list[Document]:
    followers: list[Document] = []
    for number, variable in enumerate(structure.mechanism.variables):
        share = structure.share(number)
        if share is None or variable.leader.number == number:
            continue
        is_angle = variable.motion.is_turn
        followers.append(
            {
                "name": variable.label,
                "is_angle": is_angle,
                "factor": 1.0 if is_angle else structure.unit,
                "column": share.column,
                "rate": share.rate,
                "offset": share.offset,
            }
        )
    return followers


def _step(structure: Structure, step: TreeStep) -> Document:
    rotation: Document | None = None
    columns = structure.embedded.get(step.pair)
    if columns is not None:
        center = structure.center(step.pair) / structure.unit
        rotation = {"columns": list(columns), "center": center.tolist()}
    numbers = structure.variables_of(step.pair)
    factors = [_factor(structure, number) for number in numbers]
    factors += _shifts(structure, step.pair)
    return {
        "origin": step.origin,
        "goal": step.goal,
        "sign": step.sign,
        "factors": factors,
        "rotation": rotation,
    }


def _factor(structure: Structure, number: int) -> Document:
    variable = structure.mechanism.variables[number]
    motion = variable.motion
    share = structure.share(number)
    locked = (variable.locked or 0.0) / (1.0 if motion.is_turn else structure.unit)
    return {
        "is_turn": motion.is_turn,
        "direction": motion.direction.tolist(),
        "point": (motion.point / structure.unit).tolist(),
        "advance": motion.advance / structure.unit,
        "column": None if share is None else share.column,
        "rate": 0.0 if share is None else share.rate,
        "offset": locked if share is None else share.offset,
    }


def _shifts(structure: Structure, pair: int) -> list[Document]:
    """The slides of a pair that moves a free point; none for another one."""
    if pair not in structure.shifts:
        return []
    directions = structure.point_pairs[pair].directions
    return [
        {
            "is_turn": False,
            "direction": direction.tolist(),
            "point": [0.0, 0.0, 0.0],
            "advance": 1.0,
            "column": column,
            "rate": 1.0,
            "offset": 0.0,
        }
        for direction, column in zip(directions, structure.shifts[pair], strict=True)
    ]


def _rod(poses: Poses, rod: Rod) -> Document:
    structure = poses.structure
    unit = structure.unit
    centers = rod.centers
    inside = poses.inside_rod(rod)
    far = (inside[poses.holder(rod, 1)] @ np.append(centers[1], 1.0))[:3]
    parts: list[Document] = []
    for bodies, start in zip(rod.parts, (centers[0], far), strict=True):
        rows = [_rows(inside[body], unit) for body in bodies]
        parts.append(
            {"start": (start / unit).tolist(), "bodies": list(bodies), "inside": rows}
        )
    leg: Document | None = None
    if rod.leg is not None:
        share = structure.share(rod.leg.variable)
        assert share is not None  # a locked slide makes no leg
        leg = {
            "column": share.column,
            "rate": rod.leg.sign * share.rate,
            "length": rod.length / unit + rod.leg.sign * share.offset,
        }
    return {
        "ends": list(rod.ends),
        "centers": [(center / unit).tolist() for center in centers],
        "parts": parts,
        "leg": leg,
    }


def _rows(transform: np.ndarray, unit: float) -> list[float]:
    """The upper three rows of a transform (4, 4), one after the other."""
    rows = transform[:3].copy()
    rows[:, 3] /= unit
    return rows.ravel().tolist()
