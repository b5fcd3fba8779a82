"""Motions of a linkage at given moments, forms and routes by configurations; and what an
animated model shows of it: bodies of rods, with the symbols of their joints, and where
the bodies are along a motion.

Places of a model are in the frame of the body that has them, in the unit of the linkage.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.problem import Problem
from bifurc.routes.route import Route, spread_route
from bifurc.tables import distinct_heads
from linkages.links.parts import Parts, Symbol
from linkages.readout.poses import quaternions_without_jumps

NOTHING = 1e-9  # in characteristic lengths: a rod that is none


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


def poses_of(transforms: np.ndarray) -> Poses:
    """The poses of n bodies by their transforms (n, k, 4, 4) at k moments."""
    rotations = quaternions_without_jumps(transforms[..., :3, :3])
    return Poses(transforms[..., :3, 3], rotations)


# --- a table --------------------------------------------------------------------------


def make_angle_table(
    arclength: np.ndarray, variables: np.ndarray, names: Sequence[str]
) -> str:
    """A line for every configuration of a motion, with all digits: its arclength (k,)
    and the joint variables (k, v), below a line of their ``names``."""
    heads = ("arclength", *distinct_heads(names, ("arclength",)))
    lines = [",".join(map(_cell, heads))]
    for row in np.column_stack([arclength, variables]):
        lines.append(",".join(repr(float(value)) for value in row))
    return "\n".join(lines) + "\n"


def _cell(name: str) -> str:
    """A name as a cell; joints may be called anything (RFC 4180)."""
    if not set(name) & set(',"\r\n'):
        return name
    return '"' + name.replace('"', '""') + '"'


# --- what is animated -----------------------------------------------------------------


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


def model_of(parts: Parts, name: str, motions: list[Motion]) -> LinkageModel:
    """The model of some parts, by ``name`` where there is one."""
    points = np.concatenate([motion.configurations for motion in motions])
    bodies = []
    for number, lines in enumerate(parts.lines(points)):
        symbols = tuple(parts.symbols_on(number))
        bodies.append(
            Body(parts.full_names[number], _long_enough(lines, parts.size), symbols)
        )
    moved = []
    for motion in motions:
        transforms = parts.poses(motion.configurations)
        moved.append((motion, poses_of(np.moveaxis(transforms, 1, 0))))
    return LinkageModel(
        name or parts.whole, parts.size, tuple(bodies), parts.frame, tuple(moved)
    )


def _long_enough(
    lines: np.ndarray, size: float
) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """The lines (m, 2, 3) that are longer than nothing."""
    return tuple(
        (start, end)
        for start, end in lines
        if np.linalg.norm(end - start) > NOTHING * size
    )
