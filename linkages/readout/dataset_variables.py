"""Variables of a dataset for the joints of a mechanism: all joint variables, those that
are locked as well, and the rotations of spherical joints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc.atlas import Atlas
from bifurc.files.layout import samples_of
from bifurc.files.table import Variable, make_variable
from linkages.readout.poses import rotation_vectors
from linkages.readout.readout import Readout

VARIABLES, ROTATIONS = "joint_variable_name", "rotation_name"
# dimensions of the places at which values are given
FORM, POINT, ASSEMBLY = ("form", "sample"), ("point",), ("assembly",)


def dataset_variables(atlas: Atlas, readout: Readout) -> dict[str, Variable]:
    """What the file of an atlas of a mechanism holds besides its unknowns, by name.

    ``joint_variable`` (form, sample, joint_variable_name) are all joint variables along
    the forms, as they stand, in the units of ``joint_variable_unit``, and which of them
    move but what hangs, ``joint_variable_hangs``;
    ``rotation_vector`` (form, sample, rotation_name, coordinate) those of spherical
    joints, rad, from the reference configuration. Those with ``point_`` and
    ``assembly_`` before the name are at singular points and in rigid assemblies, angles
    between -pi and pi there.
    """
    result: dict[str, Variable] = {}
    names = readout.labels()
    if names:
        result |= {
            VARIABLES: make_variable((VARIABLES,), np.array(names), "joint variables"),
            "joint_variable_unit": make_variable(
                (VARIABLES,), np.array(_units(readout)), "units of joint variables"
            ),
            "joint_variable_hangs": make_variable(
                (VARIABLES,), _hang(readout), "whether nothing closes over it"
            ),
        }
        result |= {
            name: make_variable((*places, VARIABLES), values, "joint variables")
            for name, places, values in (
                ("joint_variable", FORM, _along_forms(atlas, readout.values)),
                ("point_joint_variable", POINT, _wrapped(readout, _points(atlas))),
                ("assembly_joint_variable", ASSEMBLY, _wrapped(readout, atlas.rigid)),
            )
        }
    rotations = list(readout.rotations(readout.structure.reference[None]))
    if rotations:
        long_name = "rotation vectors of spherical joints"

        def vectors(points: np.ndarray) -> np.ndarray:
            return _vectors(readout, points)

        result[ROTATIONS] = make_variable(
            (ROTATIONS,), np.array(rotations), "spherical joints"
        )
        result |= {
            name: make_variable(
                (*places, ROTATIONS, "coordinate"), values, long_name, "rad"
            )
            for name, places, values in (
                ("rotation_vector", FORM, _along_forms(atlas, vectors)),
                ("point_rotation_vector", POINT, vectors(_points(atlas))),
                ("assembly_rotation_vector", ASSEMBLY, vectors(atlas.rigid)),
            )
        }
    return result


def _units(readout: Readout) -> list[str]:
    """The unit of every joint variable, as JSON has it."""
    turns = [variable.motion.is_turn for variable in readout.mechanism.variables]
    return ["rad" if is_turn else "length" for is_turn in turns]


def _hang(readout: Readout) -> np.ndarray:
    """1 for every joint variable that moves nothing but what hangs, else 0 (v,)."""
    labels = readout.structure.hanging.labels
    return np.array([label in labels for label in readout.labels()], dtype=np.int8)


def _points(atlas: Atlas) -> np.ndarray:
    """The singular points (k, n)."""
    points = [point.point.u for point in atlas.points]
    return np.array(points, dtype=float).reshape(-1, len(atlas.names))


def _wrapped(readout: Readout, points: np.ndarray) -> np.ndarray:
    """The joint variables (k, v) at configurations (k, n), angles between -pi and
    pi."""
    values = [readout.wrapped(point) for point in points]
    return np.array(values, dtype=float).reshape(len(points), len(readout.labels()))


def _vectors(readout: Readout, points: np.ndarray) -> np.ndarray:
    """The rotation vectors (k, s, 3) of spherical joints at configurations (k, n)."""
    rotations = list(readout.rotations(points).values())
    if not len(points):
        return np.empty((0, len(rotations), 3))
    return np.stack([rotation_vectors(one) for one in rotations], axis=1)


def _along_forms(
    atlas: Atlas, values_at: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """The values (forms, samples, ...) at the samples of all forms, behind the last one
    of a form NaN."""
    cells = [values_at(samples_of(form)) for form in atlas.forms]
    longest = max((len(cell) for cell in cells), default=0)
    shape = values_at(np.empty((0, len(atlas.names)))).shape[1:]
    result = np.full((len(cells), longest, *shape), np.nan)
    for row, cell in zip(result, cells, strict=True):
        row[: len(cell)] = cell
    return result
