"""What is said of a mechanism besides its map: redundant constraints, joints that stand
still, bodies that move as one, ranges of the joint variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas
from bifurc.decisions import unit_over_rounding
from bifurc.numerics.blur import blur_along, change_by_blur
from bifurc.numerics.bordered import as_dense
from bifurc.system import jacobian_at
from linkages.decisions import is_dependent_constraint, keeps_angle
from linkages.readout.ranges import VariableRange, variable_ranges
from linkages.readout.readout import Readout
from linkages.structure.structure import CONSTRAINTS, Closure, Structure

SAMPLES = 400  # of a form
ALIKE = 1e-5  # of the largest one: numbers of bodies that may move as one differ less
IN_PLANE = 3  # constraints of a cycle in a plane


# --- loops ----------------------------------------------------------------------------


@dataclass(frozen=True)
class LoopFacts:
    """A loop of the cycle basis: the names of its ``joints``, how many ``constraints``
    it puts on them, the ``rank`` of these, and the joints that are ``dependent``: their
    motions can be had by the others of the loop."""

    joints: tuple[str, ...]
    constraints: int
    rank: int
    dependent: tuple[str, ...]

    @property
    def redundant(self) -> int:
        """How many of the constraints follow from the others."""
        return self.constraints - self.rank


def loop_facts(readout: Readout, point: np.ndarray) -> list[LoopFacts]:
    """What is redundant in every loop at a configuration (n,) of the atlas, but for those
    of creases that are held flat."""
    problem = readout.closure
    jacobian = jacobian_at(problem, point)
    if not isinstance(jacobian, np.ndarray):
        jacobian = jacobian.tocsr()
    facts = []
    for closure, rows in zip(
        problem.structure.closures, problem.parts.rows, strict=True
    ):
        if _is_held(problem.structure, closure):
            continue
        block = as_dense(jacobian[rows])
        present = np.flatnonzero(block.any(axis=0))
        block = block[:, present]
        rank = _rank(block)
        dependent = []
        for joint in dict.fromkeys(closure.joints):
            columns = _columns_of_joint(problem.structure, joint)
            others = block[:, ~np.isin(present, columns)]
            if columns and _rank(others) == rank:
                dependent.append(joint)
        constraints = CONSTRAINTS[closure.kind]
        if readout.mechanism.is_planar:
            constraints = min(constraints, IN_PLANE)
        facts.append(
            LoopFacts(
                tuple(dict.fromkeys(closure.joints)),
                constraints,
                rank,
                tuple(dependent),
            )
        )
    return facts


def _is_held(structure: Structure, closure: Closure) -> bool:
    """Whether all variables of a closed chain are held."""
    variables = structure.mechanism.variables
    numbers = [n for step in closure.chain for n in structure.variables_of(step.pair)]
    labels = {variables[number].label for number in numbers}
    return bool(labels) and labels <= structure.held


def _columns_of_joint(structure: Structure, name: str) -> list[int]:
    """The numbers of the unknowns that move a joint."""
    columns: list[int] = []
    for number, pair in enumerate(structure.mechanism.pairs):
        if pair.joint != name:
            continue
        free = [k for k in pair.variables if k in structure.column_of]
        columns += [structure.column_of[k] for k in free]
        columns += structure.embedded.get(number, ())
    return sorted(set(columns))


def _rank(matrix: np.ndarray) -> int:
    if not matrix.size:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.count_nonzero(~is_dependent_constraint(values)))


# --- forms ----------------------------------------------------------------------------


@dataclass(frozen=True)
class FormFacts:
    """What a form of a mechanism does: the ``ranges`` of all variables, the joints that
    are ``still``, and the bodies that move as one, in ``groups`` of two and more."""

    ranges: tuple[VariableRange, ...]
    still: tuple[str, ...]
    groups: tuple[tuple[str, ...], ...]


def form_facts(atlas: Atlas, index: int, readout: Readout) -> FormFacts:
    """What the form of this ``index`` in an atlas does."""
    branch = atlas.forms[index].branch
    turning = [event.s for event in atlas.dead_points if event.form == index]
    places = np.array([0.0, branch.length, *turning])
    samples = branch.sample(SAMPLES)
    points = np.concatenate([branch(places), samples])
    rounding = change_by_blur(blur_along(readout.closure, branch))
    groups = _groups(readout, samples, unit_over_rounding(keeps_angle, rounding))
    ranges = variable_ranges(readout, branch, points)
    return FormFacts(ranges, _still(readout, groups), groups)


def _groups(
    readout: Readout, samples: np.ndarray, unit: float
) -> tuple[tuple[str, ...], ...]:
    """Bodies whose displacement with respect to each other is the same at all samples,
    in groups of two and more; those that hang on others by free joints left out."""
    poses = readout.poses(samples)
    length = readout.structure.unit
    bodies = readout.mechanism.bodies
    structure = readout.structure
    joints = structure.hanging.joints if structure.holds_flaps else ()
    hanging = {joint.bodies[0] for joint in joints}
    left = [number for number, body in enumerate(bodies) if body not in hanging]
    groups = []
    for alike in _moved_alike(poses, left):
        groups += _rigid_groups(poses, alike, length, unit)
    groups.sort()
    return tuple(tuple(bodies[number] for number in group) for group in groups)


def _moved_alike(poses: np.ndarray, numbers: Sequence[int]) -> list[list[int]]:
    """The bodies of these ``numbers`` in sets outside of which none moves with them, by
    their ``poses`` (k, b, 4, 4): those that move as one have the same displacement from
    the first sample on, and so the same number made of it."""
    moved = poses @ np.linalg.inv(poses[0])
    weights = np.random.default_rng(0).normal(size=(len(poses), 4, 4))
    marks = np.einsum("kbij,kij->b", moved, weights)[list(numbers)]
    size = float(np.abs(marks).max(initial=1.0))
    order = np.argsort(marks)
    cuts = np.flatnonzero(np.diff(marks[order]) > ALIKE * size) + 1
    return [
        sorted(numbers[k] for k in part) for part in np.split(order, cuts) if len(part)
    ]


def _rigid_groups(
    poses: np.ndarray, numbers: Sequence[int], length: float, unit: float
) -> list[list[int]]:
    """Those of the bodies of these ``numbers`` that move as one, two and more."""
    left = list(numbers)
    groups = []
    while left:
        first = left.pop(0)
        inverse = np.linalg.inv(poses[:, first])
        group = [first]
        for other in list(left):
            relative = inverse @ poses[:, other]
            change = np.abs(relative - relative[0])
            change[:, :3, 3] /= length
            if keeps_angle(float(change.max()), unit):
                group.append(other)
                left.remove(other)
        if len(group) > 1:
            groups.append(group)
    return groups


def _still(readout: Readout, groups: tuple[tuple[str, ...], ...]) -> tuple[str, ...]:
    """The joints all of whose bodies move as one, but for idle turns and what is held
    without having been locked."""
    structure = readout.structure
    left_out = structure.held.union(structure.idle_turns)
    still = []
    for joint in readout.mechanism.joints:
        bodies = set(joint.bodies)
        if left_out.intersection(joint.labels):
            continue
        if joint.freedoms and any(bodies <= set(group) for group in groups):
            still.append(joint.name)
    return tuple(still)
