"""Joint variables of a mechanism, read from the unknowns of its equations."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from bifurc.torus import wrap
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.poses import Poses, rotation_vectors
from linkages.structure.single_loop import SingleLoop, as_single_loop
from linkages.structure.structure import Structure

if TYPE_CHECKING:
    from linkages.closure.closure import Closure

# A number for a joint of one variable, a list for another one: rad, the user's unit.
JointVariables: TypeAlias = dict[str, float | list[float]]


class Readout:
    """The variables of a ``mechanism`` at configurations of its atlas.

    The unknowns of an atlas are those of its `Structure`.
    """

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        self.structure = Structure(mechanism)

    @cached_property
    def closure(self) -> Closure:
        """The closure equations of the mechanism, in the same unknowns."""
        # what writes equations is not imported where values are only read
        from linkages.closure.closure import Closure

        return Closure(self.mechanism, structure=self.structure)

    @cached_property
    def single_loop(self) -> SingleLoop | None:
        """The mechanism as a loop; None where it is no single one of revolute joints."""
        return as_single_loop(self.structure)

    def labels(self) -> list[str]:
        """What every variable is called, in the order of the joints; those of a
        spherical joint are not among them."""
        return [variable.label for variable in self.mechanism.variables]

    def values(self, points: np.ndarray) -> np.ndarray:
        """The values (k, v) of all variables at configurations (k, n) of an atlas, rad
        and the user's unit, as they stand, without regard to periods."""
        rows = np.atleast_2d(points)
        columns = [
            self.structure.values(rows, number)
            for number in range(len(self.mechanism.variables))
        ]
        return np.array(columns, dtype=float).reshape(len(columns), len(rows)).T

    def wrapped(self, point: np.ndarray) -> np.ndarray:
        """The values (v,) at one configuration (n,), angles between -pi and pi."""
        return wrap(self.values(point[None])[0], self.periods)

    @cached_property
    def periods(self) -> np.ndarray:
        """The periods (v,) of the variables, inf where there is none."""
        periods = np.full(len(self.mechanism.variables), np.inf)
        for number, column in self.structure.column_of.items():
            if np.isfinite(self.structure.unknowns[column].period):
                periods[number] = 2 * np.pi
        return periods

    def limits(self) -> dict[str, tuple[float, float]]:
        """The limits within which variables are followed, by label, in rad and the
        user's unit; angles without limits are left out."""
        limits = {}
        for number, variable in enumerate(self.mechanism.variables):
            pair = self.structure.limits(number)
            if pair is not None:
                limits[variable.label] = pair
        return limits

    def variables(self, point: np.ndarray) -> JointVariables:
        """The variables of every joint at one configuration (n,) of an atlas; those of
        a spherical joint are its rotation vectors. A rigid joint has none."""
        values = self.wrapped(point)
        vectors = self._rotation_vectors(point)
        by_joint: dict[str, list[float]] = {}
        for number, pair in enumerate(self.mechanism.pairs):
            numbers = [float(values[k]) for k in pair.variables]
            numbers += vectors.get(number, [])
            by_joint.setdefault(pair.joint, []).extend(numbers)
        result: JointVariables = {}
        for joint, numbers in by_joint.items():
            if numbers:
                result[joint] = numbers[0] if len(numbers) == 1 else numbers
        return result

    def _rotation_vectors(self, point: np.ndarray) -> dict[int, list[float]]:
        """The rotation vectors of all spherical pairs, by number, at one configuration
        (n,)."""
        if not self._spherical:
            return {}
        rotations = self._poses.rotations(point[None], self._spherical)
        vectors = rotation_vectors(rotations[:, 0]).tolist()
        return dict(zip(self._spherical, vectors, strict=True))

    @cached_property
    def _spherical(self) -> list[int]:
        """The spherical pairs, by number."""
        pairs = enumerate(self.mechanism.pairs)
        return [number for number, pair in pairs if pair.center is not None]

    @cached_property
    def _poses(self) -> Poses:
        return Poses(self.structure)

    def rotations(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """The rotations (k, 3, 3) at configurations (k, n) of an atlas that spherical
        joints make, of each further body with respect to the first one, from the
        reference configuration. They are called after the joint, "S1", or, in a joint
        of several bodies, "S1.rod"."""
        if not self._spherical:
            return {}
        rotations = self._poses.rotations(np.atleast_2d(points), self._spherical)
        return dict(zip(self._labels_of_spherical, rotations, strict=True))

    @property
    def _labels_of_spherical(self) -> list[str]:
        """What the spherical pairs are called."""
        labels = []
        for number in self._spherical:
            pair = self.mechanism.pairs[number]
            is_of_several = len(self.mechanism.joint(pair.joint).bodies) > 2
            label = f"{pair.joint}.{pair.moved}" if is_of_several else pair.joint
            labels.append(label)
        return labels

    def poses(self, points: np.ndarray) -> np.ndarray:
        """The transforms (k, b, 4, 4) of all bodies at configurations (k, n) of an
        atlas, from the reference configuration, the frame at rest."""
        return self._poses.at(np.atleast_2d(points))
