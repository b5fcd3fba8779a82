"""Rigid origami from FOLD files (Demaine, Ku and Lang 2016): panels and creases.

A face is a body, a crease between two faces a revolute joint. A folded state that the
file gives, by coordinates in space or by fold angles, is the reference configuration.
Thick panels have their hinges above and below the paper: on the faces that come
together there, or at heights that the file gives (Chen, Peng and You 2015).
"""

from __future__ import annotations

import json
import logging
import math
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from networkx.utils import UnionFind

from linkages.closure.system import ClosureSystem
from linkages.coordinates import spread_of
from linkages.decisions import is_parallel_axis, keeps_angle
from linkages.files.faces import check_joined, faces_of_edges, triangles_of
from linkages.files.misfits import closed_near
from linkages.files.rounded_creases import Ray, exact_points
from linkages.formats.assembly import listed
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Crease, Mechanism, Panel
from linkages.mechanisms.origin import Coordinates, WrittenNumber, counted_from_near
from linkages.readout.poses import Poses
from linkages.values import (
    SOME,
    GeometryError,
    check_number,
    checked_list,
    checked_number,
    checked_table,
    checked_text,
    quoted,
    require,
)

Frame: TypeAlias = Mapping[str, Any]
Side: TypeAlias = tuple[int, int]

log = logging.getLogger(__name__)

FOLDED = "foldedForm"
ANGLES = "edges_foldAngle"
# what the letters of edges_assignment make of a side between two faces
HINGES = ("M", "V", "U")
RIGID = ("F", "J")
CUTS = ("B", "C")
LETTERS = (*HINGES, *RIGID, *CUTS)
# where hinges of thick panels are, over the thickness: on the faces that come together
SIDES = {"V": 0.5, "M": -0.5}
STRAIGHT = 180.0  # degrees, the largest fold angle
UNSAID = 1e-12  # over the size: as far vertices may be moved without a word


# keys of this program, which FOLD tells by the colon
THICKNESS, HEIGHTS = "bifurc:thickness", "bifurc:edges_height"
TRIANGULATED = "bifurc:triangulated"


class _Edge(NamedTuple):
    """What a file says of an edge: its name, its letter, its fold angle in degrees, and
    how high its hinge is above the flat paper."""

    name: str
    letter: str = "U"
    angle: float = 0.0
    height: float = 0.0


class _Crease(NamedTuple):
    """A side from vertex ``start`` to ``end`` of face ``left``, of which face ``right``
    is the other one; and its ``edge``."""

    start: int
    end: int
    left: int
    right: int
    edge: _Edge


def read_fold(text: str, name: str, triangulated: bool = False) -> Mechanism:
    """What `mechanism_of_fold` makes of a file; raises `GeometryError` for what is no JSON
    as well."""
    try:
        content = json.loads(text, parse_float=WrittenNumber)
    except (json.JSONDecodeError, RecursionError) as error:
        raise GeometryError("content", f"no JSON, {error},", "a FOLD file") from None
    content = checked_table("content", content, "a table, as of a FOLD file")
    return mechanism_of_fold(content, name, triangulated)


def mechanism_of_fold(
    content: Frame, name: str, triangulated: bool = False
) -> Mechanism:
    """The mechanism that the content of a FOLD file describes; without a title it gets
    this name. Panels bend along diagonals where it says so, or ``triangulated`` does.

    Every crease is called after its vertices, ``3-7``, every face ``f2``; a variable is
    the change of the fold angle, positive where a valley is folded further. Flat edges
    (F) and joins (J) are rigid, cuts (C) and boundaries (B) hold nothing. Fold angles
    are moved to the nearest ones that close. Of thick panels the flat state is given.
    Raises `GeometryError` for anything wrong.
    """
    frame = _frame(content)
    title = content.get("file_title", content.get("frame_title", name))
    checked_text("file_title", title)
    points, near = _points(frame)
    edges = _edges(frame, len(points))
    if "faces_vertices" in frame:
        faces = _faces(frame, len(points))
    else:
        faces = faces_of_edges(points, _ends(frame, len(points)))
        edges = _on_faces(edges, faces)
        folded = [side for side, edge in edges.items() if edge.letter in HINGES]
        check_joined(points, edges.keys(), folded, faces)
    if _is_triangulated(frame) or triangulated:
        faces = [part for face in faces for part in triangles_of(points, face)]
    creases = _creases(faces, edges)
    is_folded = FOLDED in frame.get("frame_classes", [])
    is_flat = not is_folded and not np.ptp(points[:, 2]) > 0.0
    thick = next((key for key in (THICKNESS, HEIGHTS) if key in frame), "")
    if thick:
        allowed = "left out, or given with the flat crease pattern and its fold angles"
        require(is_flat, thick, "given with folded coordinates,", allowed)
    bodies = _bodies(len(faces), creases)
    moved = 0.0
    if is_flat and not thick:
        points, moved = _exact(points, faces, bodies, creases)
    hinges = _hinges(creases, faces, points, bodies, is_folded)
    joints = [hinge.joint for hinge in hinges]
    if not joints:
        counts = Counter(edge.letter for edge in edges.values())
        drawn = ", ".join(f"{count} {letter}" for letter, count in counts.items())
        allowed = "lines that fold between two faces: M, V or U"
        raise GeometryError("creases", f"none, of {drawn or 'no lines'},", allowed)
    mechanism = Mechanism(
        tuple(joints),
        title or name,
        origin=near.origin or (0.0, 0.0, 0.0),
        rounding=near.rounding,
        panels=_panels(faces, bodies, points, joints),
        moved=moved,
    )
    letters = {hinge.joint.name: hinge.letter for hinge in hinges}
    angles = {hinge.joint.name: hinge.angle for hinge in hinges}
    if not is_folded and any(angles.values()):
        heights = np.ptp(points[:, 2])
        allowed = (
            "the same for all vertices where edges_foldAngle is given; a state that is "
            f'folded has "{FOLDED}" in its frame_classes'
        )
        require(is_flat, "vertices_coords", f"heights {heights:.6g} apart", allowed)
        mechanism, angles = _folded(mechanism, angles)
    return _assigned(mechanism, letters, angles)


def _exact(
    points: np.ndarray,
    faces: Sequence[list[int]],
    bodies: Sequence[str],
    creases: Sequence[_Crease],
) -> tuple[np.ndarray, float]:
    """The vertices (v, 3) of a flat pattern of which the given ones are a rounding, if
    there are such, and how far the farthest one is moved; with a warning."""
    is_mirrored = any(_normal(points[face])[2] < 0.0 for face in faces)
    rays = []
    for crease in creases:
        ends = (crease.start, crease.end)
        sides = (bodies[crease.left], bodies[crease.right])
        for at, to, body in zip(ends, ends[::-1], sides, strict=True):
            rays.append(Ray(at, to, crease.edge.letter, body))
    around = Counter(ray.at for ray in rays)
    around.subtract(vertex for face in faces for vertex in face)
    inner = [vertex for vertex, count in around.items() if count == 0]
    folding = [ray for ray in rays if ray.letter in HINGES]
    mirror = np.array([1.0, -1.0 if is_mirrored else 1.0, 1.0])
    exact = mirror * exact_points(mirror * points, folding, inner)
    moved = float(np.linalg.norm(exact - points, axis=1).max())
    if moved > UNSAID * spread_of(points):
        log.warning(
            "vertices_coords: moved by up to %.3g, as they are a rounding of a pattern "
            "that folds flat",
            moved,
        )
    return exact, moved


def _folded(
    mechanism: Mechanism, angles: Mapping[str, float]
) -> tuple[Mechanism, dict[str, float]]:
    """The mechanism in the closed state nearest to fold ``angles`` (rad), by joint, from
    the flat one, each of its parts by itself, and the angles of this state."""
    joints: list[Joint] = []
    panels: list[Panel] = []
    reached: dict[str, float] = {}
    for part in mechanism.parts:
        folded, of_part = _folded_part(part, angles)
        joints += folded.joints
        panels += folded.panels
        reached |= of_part
    whole = replace(mechanism, joints=tuple(joints), panels=tuple(panels))
    return whole, reached


def _assigned(
    mechanism: Mechanism, letters: Mapping[str, str], angles: Mapping[str, float]
) -> Mechanism:
    """The mechanism whose creases fold as their ``letters`` say, those at ``angles``
    (rad), by joint. One that is folded the other way is free, with a warning."""
    creases = []
    for name, letter in letters.items():
        if letter not in SIDES:
            continue
        crease = Crease(name, letter, angles[name])
        if math.isclose(abs(crease.angle), math.pi):
            crease = crease._replace(angle=crease.sign * math.pi)
        low, high = crease.limits
        if keeps_angle(max(low, -high, 0.0)):
            is_right = crease.sign * crease.angle > 0.0
            creases.append(crease if is_right else crease._replace(angle=0.0))
        else:
            log.warning(
                "crease %s is %s and folded by %.4g degrees: it may fold either way",
                name,
                letter,
                math.degrees(crease.angle),
            )
    whole = replace(mechanism, creases=tuple(creases))
    return whole.with_creases_as_assigned()


# --- the state that is given ----------------------------------------------------------


def _folded_part(
    mechanism: Mechanism, angles: Mapping[str, float]
) -> tuple[Mechanism, dict[str, float]]:
    """The same of a mechanism that is one part."""
    problem = ClosureSystem(replace(mechanism, with_flaps=True, with_flat_creases=True))
    start = np.array([angles[name] for name in problem.domain.names])
    far = "folded such that a gap of {:.3g} is left; near a closed state"
    point = closed_near(problem, ANGLES, start, problem.domain.names, far)
    poses = Poses(problem.structure).at(point[None])[0]
    folded = _posed(mechanism, dict(zip(mechanism.bodies, poses, strict=True)))
    return folded, dict(zip(problem.domain.names, point.tolist(), strict=True))


def _posed(mechanism: Mechanism, poses: Mapping[str, np.ndarray]) -> Mechanism:
    """The mechanism with its bodies moved by ``poses`` (4, 4)."""
    joints = []
    for joint in mechanism.joints:
        pose = poses[joint.bodies[0]]
        point = pose[:3, :3] @ joint.place + pose[:3, 3]
        direction = pose[:3, :3] @ np.array(joint.direction)
        joints.append(replace(joint, point=tuple(point), direction=tuple(direction)))
    panels = []
    for panel in mechanism.panels:
        pose = poses[panel.body]
        corners = np.array(panel.corners) @ pose[:3, :3].T + pose[:3, 3]
        panels.append(Panel(panel.body, tuple(map(tuple, corners.tolist()))))
    return replace(mechanism, joints=tuple(joints), panels=tuple(panels))


def _frame(content: Mapping[str, Any]) -> Frame:
    """The first frame that is folded in space, else the first one with vertices."""
    given = content.get("file_frames", [])
    frames = checked_list("file_frames", given, "a list of frames")
    merged: list[Frame] = [content]
    for number, frame in enumerate(frames, start=1):
        checked_table(f"file_frames[{number}]", frame, "a table")
        parent = frame.get("frame_parent", 0)
        if not frame.get("frame_inherit", False):
            merged.append(frame)
        elif isinstance(parent, int) and 0 <= parent < len(merged):
            merged.append({**merged[parent], **frame})
        else:
            allowed = f"from 0 to {number - 1}, a frame before it"
            raise GeometryError(
                f"frame_parent of file_frames[{number}]", quoted(parent), allowed
            )
    for frame in merged:
        given = frame.get("frame_classes", [])
        classes = checked_list("frame_classes", given, "a list of texts")
        rows = frame.get("vertices_coords")
        in_space = isinstance(rows, list) and all(
            isinstance(row, list) and len(row) == 3 for row in rows
        )
        if FOLDED in classes and in_space:
            return frame
    return next((frame for frame in merged if "vertices_coords" in frame), content)


# --- lists of the file ----------------------------------------------------------------


def _list(frame: Frame, key: str) -> list[Any]:
    given = frame.get(key)
    if not isinstance(given, list) or not given:
        value = "a missing key" if given is None else quoted(given)
        raise GeometryError(key, value, "a list")
    return given


def _points(frame: Frame) -> tuple[np.ndarray, Coordinates]:
    """The vertices (v, 3), and how they are counted."""
    near = counted_from_near(_list(frame, "vertices_coords"))
    rows = near.rows
    points = np.zeros((len(rows), 3))
    for number, row in enumerate(rows):
        what = f"vertices_coords[{number}]"
        row = checked_list(what, row, "[x, y] or [x, y, z]", (2, 3))
        for k, coordinate in enumerate(row):
            points[number, k] = checked_number(what, coordinate)
    return points, near


def _is_triangulated(frame: Frame) -> bool:
    """Whether panels bend along diagonals."""
    given = frame.get(TRIANGULATED, False)
    require(isinstance(given, bool), TRIANGULATED, quoted(given), "true or false")
    return bool(given)


def _faces(frame: Frame, vertices: int) -> list[list[int]]:
    faces = _list(frame, "faces_vertices")
    for number, face in enumerate(faces):
        what = f"faces_vertices[{number}]"
        checked_list(what, face, "a list of three vertices or more", SOME[2:])
        for vertex in face:
            _check_vertex(what, vertex, vertices)
            is_once = face.count(vertex) == 1
            require(is_once, what, face, f"different; {vertex} stands twice")
    return faces


def _check_vertex(what: str, vertex: object, vertices: int) -> None:
    is_number = isinstance(vertex, int) and not isinstance(vertex, bool)
    is_vertex = is_number and vertex in range(vertices)
    allowed = f"vertices, numbers from 0 to {vertices - 1}"
    require(is_vertex, what, quoted(vertex), allowed)


def _edges(frame: Frame, vertices: int) -> dict[Side, _Edge]:
    """What is said of edges, by their vertices in ascending order."""
    if "edges_vertices" not in frame:
        for key in ("edges_assignment", ANGLES, THICKNESS, HEIGHTS):
            allowed = f"given together with {key}"
            require(key not in frame, "edges_vertices", "a missing key", allowed)
        return {}
    ends = _ends(frame, vertices)
    letters = _of_edges(frame, "edges_assignment", len(ends))
    angles = _of_edges(frame, ANGLES, len(ends))
    heights = _of_edges(frame, HEIGHTS, len(ends))
    given = frame.get(THICKNESS, 0.0)
    thickness = checked_number(THICKNESS, given)
    require(thickness >= 0, THICKNESS, given, "0 or more")
    edges = {}
    for number, pair in enumerate(ends):
        letter = letters[number] or "U"
        allowed = f"one of {', '.join(LETTERS)}"
        what = f"edges_assignment[{number}]"
        require(letter in LETTERS, what, quoted(letter), allowed)
        angle = angles[number] or 0.0
        what = f"{ANGLES}[{number}]"
        check_number(what, angle)
        allowed = "from -180 to 180, in degrees"
        require(abs(angle) <= STRAIGHT, what, angle, allowed)
        name = f"{pair[0]}-{pair[1]}"
        height = heights[number]
        if height is None:
            height = SIDES.get(letter, 0.0) * thickness
        height = checked_number(f"{HEIGHTS}[{number}]", height)
        edges[min(pair), max(pair)] = _Edge(name, letter, float(angle), height)
    return edges


def _ends(frame: Frame, vertices: int) -> list[Any]:
    """The pairs of vertices that edges are between."""
    ends = _list(frame, "edges_vertices")
    for number, pair in enumerate(ends):
        what = f"edges_vertices[{number}]"
        checked_list(what, pair, "two vertices", (2,))
        for vertex in pair:
            _check_vertex(what, vertex, vertices)
    return ends


def _of_edges(frame: Frame, key: str, count: int) -> list[Any]:
    if key not in frame:
        return [None] * count
    values = _list(frame, key)
    allowed = f"{count}, one an edge"
    require(len(values) == count, f"number of {key}", len(values), allowed)
    return values


# --- panels and hinges ----------------------------------------------------------------


def _creases(faces: Sequence[list[int]], edges: Mapping[Side, _Edge]) -> list[_Crease]:
    """The sides that two faces share, cuts left out."""
    owners: dict[Side, int] = {}
    for number, face in enumerate(faces):
        for start, end in zip(face, [*face[1:], face[0]], strict=True):
            if (start, end) in owners:
                value = f"{start}-{end} in f{owners[start, end]} and f{number}"
                allowed = "oriented alike, so that two faces run along a side opposite"
                raise GeometryError("faces_vertices", value, f"{allowed} ways")
            owners[start, end] = number
    for side, edge in edges.items():
        is_on_face = side in owners or side[::-1] in owners
        value = f"{edge.name}, {quoted(edge.letter)},"
        allowed = "a side of a face, as every crease (M, V, U) is"
        require(is_on_face or edge.letter not in HINGES, "edge", value, allowed)
    creases = []
    for (start, end), left in owners.items():
        right = owners.get((end, start))
        if right is None or right < left:
            continue
        side = (min(start, end), max(start, end))
        edge = edges.get(side, _Edge(f"{side[0]}-{side[1]}"))
        if edge.letter not in CUTS:
            creases.append(_Crease(start, end, left, right, edge))
    return creases


def _on_faces(
    edges: Mapping[Side, _Edge], faces: Sequence[list[int]]
) -> dict[Side, _Edge]:
    """The edges that are sides of faces; with a warning for creases that are none, as
    they end inside of a face."""
    sides = {
        (min(side), max(side))
        for face in faces
        for side in zip(face, [*face[1:], face[0]], strict=True)
    }
    inside = [
        edge.name
        for side, edge in edges.items()
        if side not in sides and edge.letter in HINGES
    ]
    if inside:
        log.warning(
            "creases that end inside of a face fold nothing: %s", listed(inside)
        )
    return {side: edge for side, edge in edges.items() if side in sides}


class _Hinge(NamedTuple):
    """The ``joint`` of a crease, its ``letter``, and the fold ``angle`` (rad) that the
    file gives."""

    joint: Joint
    letter: str
    angle: float


def _hinges(
    creases: Sequence[_Crease],
    faces: Sequence[list[int]],
    points: np.ndarray,
    bodies: Sequence[str],
    is_folded: bool,
) -> list[_Hinge]:
    """The hinges between bodies, those in one line once, with a warning for creases inside
    of one; of what ``is_folded`` in space the angles are seen there."""
    hinges: list[_Hinge] = []
    between: defaultdict[frozenset[str], list[Joint]] = defaultdict(list)
    inside: list[str] = []
    for crease in creases:
        if crease.edge.letter not in HINGES:
            continue
        if bodies[crease.left] == bodies[crease.right]:
            inside.append(crease.edge.name)
            continue
        left = _normal(points[faces[crease.left]])
        right = _normal(points[faces[crease.right]])
        joint = _joint(crease, points, bodies, left)
        known = between[frozenset(joint.bodies)]
        if any(_is_same_hinge(joint, other) for other in known):
            continue
        known.append(joint)
        angle = math.radians(crease.edge.angle)
        if is_folded:
            angle = _dihedral(left, right, np.array(joint.direction))
        hinges.append(_Hinge(joint, crease.edge.letter, angle))
    if inside:
        log.warning(
            "creases of which flat edges make both faces one body do not fold: %s",
            listed(inside),
        )
    return hinges


def _bodies(faces: int, creases: Sequence[_Crease]) -> list[str]:
    """What the body of every face is called: after the first of the faces that flat
    edges and joins make one."""
    panels = UnionFind(range(faces))
    for crease in creases:
        if crease.edge.letter in RIGID:
            panels.union(crease.left, crease.right)
    firsts: dict[int, int] = {}
    for face in range(faces):
        firsts.setdefault(panels[face], face)
    return [f"f{firsts[panels[face]]}" for face in range(faces)]


def _panels(
    faces: Sequence[list[int]],
    bodies: Sequence[str],
    points: np.ndarray,
    joints: Sequence[Joint],
) -> tuple[Panel, ...]:
    """The outline of every face on its body; a face without a hinge is none."""
    hinged = {body for joint in joints for body in joint.bodies}
    panels = []
    for face, body in zip(faces, bodies, strict=True):
        if body not in hinged:
            continue
        corners = tuple(map(tuple, points[face].tolist()))
        panels.append(Panel(body, corners))
    return tuple(panels)


def _normal(corners: np.ndarray) -> np.ndarray:
    """The unit normal (3,) of a face with these corners (k, 3), on the side from which
    they run counterclockwise; 0 where it has no area."""
    size = float(np.abs(corners).max())
    if size == 0.0:
        return np.zeros(3)
    corners = corners / size  # squares of lengths stay within doubles
    spokes = corners - corners[0]
    double_area = np.cross(spokes[:-1], spokes[1:]).sum(axis=0)
    length = float(np.linalg.norm(double_area))
    return double_area / length if length > 0.0 else np.zeros(3)


def _dihedral(left: np.ndarray, right: np.ndarray, along: np.ndarray) -> float:
    """The fold angle (rad, valleys positive) between faces with unit normals (3,), by
    which the right one turns about the direction ``along`` (3,) of the hinge."""
    return math.atan2(float(np.cross(left, right) @ along), float(left @ right))


def _joint(
    crease: _Crease, points: np.ndarray, bodies: Sequence[str], upwards: np.ndarray
) -> Joint:
    """The hinge of a crease, at its height ``upwards`` (3,). Its first face lies on the
    left of its side, so that a valley turns the other one about the opposite
    direction."""
    start, end = points[crease.start], points[crease.end]
    length = float(np.linalg.norm(end - start))
    what = f"crease {crease.edge.name}"
    require(length != 0.0, what, "its ends coincide,", "of a length other than zero")
    pair = (bodies[crease.left], bodies[crease.right])
    along = tuple(((start - end) / length).tolist())
    middle = tuple((0.5 * (start + end) + crease.edge.height * upwards).tolist())
    return Joint(crease.edge.name, JointKind.REVOLUTE, pair, middle, along)


def _is_same_hinge(joint: Joint, other: Joint) -> bool:
    """Whether two creases between the same two bodies are parts of one line."""
    along, beside = np.array(joint.direction), np.array(other.direction)
    gap = joint.place - other.place
    distance = float(np.linalg.norm(gap)) or 1.0
    sines = [np.cross(along, beside), np.cross(along, gap / distance)]
    return all(is_parallel_axis(float(np.linalg.norm(sine))) for sine in sines)
