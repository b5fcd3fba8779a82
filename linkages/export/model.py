"""Motions of a linkage at given moments, forms and routes by configurations; and what an
animated model shows of it: bodies of rods, with the symbols of their joints, and where
the bodies are along a motion.

Places of a model are in the frame of the body that has them, in the unit of the linkage.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.problem import Problem
from bifurc.routes.route import Route, spread_route
from linkages.links.mechanism_drawing import (
    SymbolDrawing,
    draw_bodies,
    draw_symbols,
)
from linkages.links.rods import link_corners, seat_heights
from linkages.loop import Loop
from linkages.mechanisms.joint import JointKind, Shape
from linkages.readout.readout import Readout

NOTHING = 1e-9  # in characteristic lengths: a rod that is none
UPWARD = np.array([0.0, 0.0, 1.0])


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
    lines = [",".join(_cell(name) for name in ("arclength", *names))]
    for row in np.column_stack([arclength, variables]):
        lines.append(",".join(repr(float(value)) for value in row))
    return "\n".join(lines) + "\n"


def _cell(name: str) -> str:
    """A name as a cell; joints may be called anything (RFC 4180)."""
    if not set(name) & set(',"\r\n'):
        return name
    return '"' + name.replace('"', '""') + '"'


# --- what is animated -----------------------------------------------------------------


class Symbol(NamedTuple):
    """A joint on a body: its ``place`` (3,), and its ``direction`` (3,), a unit
    vector."""

    name: str
    shape: Shape
    place: np.ndarray
    direction: np.ndarray


@dataclass(frozen=True, eq=False)
class Body:
    """A body with ``rods`` from one place (3,) to another."""

    name: str
    rods: tuple[tuple[np.ndarray, np.ndarray], ...]
    symbols: tuple[Symbol, ...]


@dataclass(frozen=True, eq=False)
class LinkageModel:
    """A linkage of a characteristic length, its ``size``. ``motions`` have the poses of
    all bodies in their order; the body number ``frame`` stands still."""

    name: str
    size: float
    bodies: tuple[Body, ...]
    frame: int
    motions: tuple[tuple[Motion, Poses], ...]


def model_of_loop(loop: Loop, motions: list[Motion]) -> LinkageModel:
    """A loop: links "link 12" and so on, each with the joint behind it, whose axis is
    the z axis of the link; the link that joins the last joint to the first stands
    still."""
    heights = seat_heights(loop)
    corners = link_corners(loop)
    size = loop.characteristic_length
    dash = "-" if loop.n > 9 else ""  # as in linkages.app.texts.numbers.link_name
    bodies = []
    for i in range(loop.n):
        joint = (i + 1) % loop.n
        seat = np.array([0.0, 0.0, float(heights[joint])])
        symbol = Symbol(f"joint {joint + 1}", Shape.CYLINDER, seat, UPWARD)
        rods = _long_enough(list(pairwise(corners[i])), size)
        bodies.append(Body(f"link {i + 1}{dash}{joint + 1}", rods, (symbol,)))
    moved = tuple((motion, link_poses(loop, motion)) for motion in motions)
    return LinkageModel(loop.name or "linkage", size, tuple(bodies), loop.n - 1, moved)


def model_of_mechanism(readout: Readout, motions: list[Motion]) -> LinkageModel:
    """A mechanism: its bodies by their names, drawn as on the page of the viewer; a body
    has the frame of the reference configuration."""
    structure = readout.structure
    mechanism = readout.mechanism
    points = np.concatenate([motion.configurations for motion in motions])
    symbols = draw_symbols(structure)
    bodies = []
    for number, drawing in enumerate(draw_bodies(structure, points)):
        ends = [
            (structure.unit * np.array(start), structure.unit * np.array(end))
            for start, end in drawing["lines"]
        ]
        own = _symbols_on(symbols, number, structure.unit)
        rods = _long_enough(ends, structure.unit)
        bodies.append(Body(drawing["name"], rods, own))
    moved = []
    for motion in motions:
        transforms = readout.poses(motion.configurations)
        moved.append((motion, poses_of(np.moveaxis(transforms, 1, 0))))
    return LinkageModel(
        mechanism.name or "mechanism",
        structure.unit,
        tuple(bodies),
        mechanism.bodies.index(mechanism.frame),
        tuple(moved),
    )


def _symbols_on(
    drawings: list[SymbolDrawing], body: int, unit: float
) -> tuple[Symbol, ...]:
    """The symbols that a body carries; the second axis of a universal joint is on its
    other body, and a rigid joint has no symbol."""
    symbols = []
    for drawing in drawings:
        kind = JointKind(drawing["kind"])
        if kind is JointKind.RIGID:
            continue
        shape = kind.facets.shape
        name = f"joint {drawing['label']}".strip()
        directions = drawing["directions"] or [UPWARD.tolist()]
        holders = (drawing["holder"], drawing["other"])
        for holder, direction in zip(holders, directions, strict=False):
            if holder == body:
                place = unit * np.array(drawing["place"])
                symbols.append(Symbol(name, shape, place, np.array(direction)))
    return tuple(symbols)


def _long_enough(
    ends: list[tuple[np.ndarray, np.ndarray]], size: float
) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """The rods that are longer than nothing."""
    return tuple(
        (start, end)
        for start, end in ends
        if np.linalg.norm(end - start) > NOTHING * size
    )
