"""Motions of a linkage at given moments: forms and routes by configurations, and the
poses of its bodies along them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.problem import Problem
from bifurc.routes.route import Route, spread_route
from linkages.loop import Loop


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion by its ``name``: configurations (k, n), rad, without jumps, evenly
    spaced in ``arclength`` (k,), rad."""

    name: str
    configurations: np.ndarray
    arclength: np.ndarray


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of n bodies along a motion of k moments: ``translations`` (n, k, 3) and
    unit quaternions ``rotations`` (n, k, 4), x, y, z, w, each near the one before.

    Link i of a loop stands before joint i + 1, as in
    `linkages.links.rods.link_corners`; the last one is the frame of all.
    """

    translations: np.ndarray
    rotations: np.ndarray


def motion_of_form(form: Form, count: int) -> Motion:
    """A form at ``count`` places, its begin and its end among them."""
    arclength = np.linspace(0.0, form.branch.length, count)
    configurations = form.branch(arclength)
    return Motion(form.name, configurations, arclength)


def motion_of_route(
    atlas: Atlas, route: Route, name: str, count: int, problem: Problem
) -> Motion:
    """A route of an atlas of a ``problem`` at ``count`` places, its begin and its end
    among them; raises `bifurc.RouteError` for one without length."""
    arclength, configurations = spread_route(atlas, route, count, problem)
    return Motion(name, configurations, arclength)


def link_poses(loop: Loop, motion: Motion) -> Poses:
    """The poses of all links along a motion, in the frame of the link that joins the
    last joint to the first."""
    frames = np.moveaxis(loop.frames(motion.configurations)[:, 1:], 1, 0)
    return poses_of(frames)


def poses_of(transforms: np.ndarray) -> Poses:
    """The poses of n bodies by their transforms (n, k, 4, 4) at k moments."""
    rotations = quaternions_without_jumps(transforms[..., :3, :3])
    return Poses(transforms[..., :3, 3], rotations)


def quaternions_without_jumps(matrices: np.ndarray) -> np.ndarray:
    """Unit quaternions (n, k, 4), x, y, z, w, of rotations (n, k, 3, 3) of n bodies at k
    moments, each near the one before."""
    from scipy.spatial.transform import Rotation

    count, moments = matrices.shape[:2]
    quaternions = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat()
    rotations: np.ndarray = quaternions.reshape(count, moments, 4)
    turns = (rotations[:, 1:] * rotations[:, :-1]).sum(axis=-1)
    signs = np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=1)
    rotations[:, 1:] *= signs[..., None]
    return rotations


# --- a table --------------------------------------------------------------------------


def make_angle_table(
    arclength: np.ndarray, variables: np.ndarray, names: Sequence[str]
) -> str:
    """A line for every configuration of a motion, with all digits: its arclength (k,)
    and the joint variables (k, v), below a line of their ``names``."""
    heads = [_cell(name) for name in ("arclength", *names)]
    lines = [",".join(heads)]
    rows = np.column_stack([arclength, variables])
    for row in rows:
        lines.append(",".join(repr(float(value)) for value in row))
    return "\n".join(lines) + "\n"


def _cell(name: str) -> str:
    """A name as a cell; joints may be called anything (RFC 4180)."""
    if not set(name) & set(',"\r\n'):
        return name
    return '"' + name.replace('"', '""') + '"'
