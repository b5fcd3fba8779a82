"""Files that others wrote are read and mapped."""

import mujoco
import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages import load, map_linkage
from linkages.closure.closure import Closure
from tests.linkages.formats.robot_models import (
    MJCF,
    SDF,
    mjcf_text,
    sdf_text,
)

# mobility, forms, bifurcations
FACTS = {
    "robotiq_2f85": (3, 0, 0),  # a five-bar a finger, driven alike
    "robotiq_2f85_v4": (1, 1, 0),
    "ten_armature_1_equiv": (1, 2, 0),
    "jdotv_connect_2d": (1, 1, 0),  # but for a body that turns about its joint
    "four_bar_loop": (1, 2, 2),  # a parallelogram
    "anchored_loop": (1, 1, 0),  # 0.5, 0.5, 0.5 and 1.1: no bar turns fully
    "closed_loop_four_bar_linkage": (1, 2, 2),  # a parallelogram
}


def read(name, folder):
    is_mjcf = name in MJCF
    path = folder / f"{name}.{'xml' if is_mjcf else 'sdf'}"
    path.write_text(mjcf_text(MJCF[name]) if is_mjcf else sdf_text(SDF[name]))
    return load(path)


@pytest.mark.parametrize("name", FACTS)
def test_a_model_of_others_is_read_and_mapped(name, tmp_path):
    settings = SearchSettings(starts=60)
    atlas = map_linkage(read(name, tmp_path), settings=settings)
    facts = atlas.mobility, len(atlas.forms), len(atlas.bifurcations)
    assert facts == FACTS[name]


@pytest.mark.parametrize("name", MJCF)
def test_the_mobility_is_that_of_mujoco(name, tmp_path):
    mechanism = read(name, tmp_path)
    problem = Closure(mechanism)
    points, gaps = problem.project(problem.reference[None])
    assert gaps[0] < 1e-12
    ours = np.linalg.svd(problem.jacobians(points)[0], compute_uv=False)
    model = mujoco.MjModel.from_xml_string(mjcf_text(MJCF[name]))
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    is_equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    jacobian = data.efc_J.reshape(data.nefc, -1)[is_equality]
    # numbers in the files are rounded to 1e-6
    theirs = np.linalg.svd(jacobian, compute_uv=False)
    ranks = np.sum(ours > 1e-4), np.sum(theirs > 1e-4 * theirs[0])
    idle = len(problem.structure.idle_turns)
    assert problem.n - ranks[0] + idle == model.nv - ranks[1]
