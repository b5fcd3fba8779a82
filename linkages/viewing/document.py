"""An atlas of a linkage as the viewer reads it: plain values that JSON can hold.

Curves come as the Taylor pieces of their branches, all digits kept: the viewer
evaluates them, and never solves. Angles are in radians, indices of forms and unknowns
count from 0.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from math import degrees
from typing import NamedTuple, NotRequired, TypedDict

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint, Surface
from bifurc.checks import check_type
from bifurc.decisions import closes_to_rounding
from bifurc.figures.form_graph import lay_out_graph
from bifurc.figures.planes import choose_plane
from bifurc.figures.style import color_on_dark, form_style
from bifurc.torus import difference
from linkages.labels import FormLabels, loop_of
from linkages.links.mechanism_drawing import (
    best_view_of_mechanism,
    breadths_of_mechanism,
)
from linkages.loop import Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import mechanism_of
from linkages.readout.loop_atlas import to_loop_angles
from linkages.readout.readout import Readout
from linkages.scene import View, best_view, make_scene
from linkages.structure.structure import Structure
from linkages.viewing.mechanism_document import MechanismDocument, describe_motion

SAMPLES = 72  # places on each form by which the principal plane is found
BESIDE_A_POINT = 2  # of the spacing of these: a form is first shown farther from points
ALIKE = 1e-3  # of a breadth: configurations that differ by less show as much
MOST_SAMPLES = 600  # configurations shown of a surface
MOST_LOCKS = 6  # that a title lists
DIGITS = 6  # after the point, of places in the graph (inches)


class PackedArray(TypedDict):
    """Floats of 64 bits, the lowest byte first, in base64."""

    shape: list[int]
    float64: str


class JointDocument(TypedDict):
    """A joint of a loop that was given as a mechanism: its ``name``, and the joint angle,
    ``offset`` (rad) plus ``sign`` times the unknown of this ``column``."""

    name: str
    column: int
    sign: int
    offset: float


class LoopDocument(TypedDict):
    """The Denavit-Hartenberg table, and the characteristic length as ``size``; the
    ``joints`` where the unknowns are not the joint angles."""

    lengths: list[float]
    twists: list[float]
    offsets: list[float]
    size: float
    joints: NotRequired[list[JointDocument]]


class FormDetails(TypedDict, total=False):
    """Where the viewer has no equations there is ``smallest``, the smallest regular
    singular value at places of the form, as [s, value]. A mechanism is first shown at
    ``start``, where joints are seen apart."""

    smallest: list[list[float]]
    start: float


class FormDocument(FormDetails):
    """A form: its branch as in `bifurc.branch.Branch`, and how it is drawn."""

    name: str
    length: float
    closed: bool
    pieces: PackedArray
    centers: list[float]
    radii: list[float]
    breaks: list[float]
    travel: list[float]
    rank: int
    inactive_joints: list[int]
    color: str
    dark_color: str
    dashes: list[float]


class PointDocument(TypedDict):
    """A singular point; ``passes`` are [index of the form, arclength]."""

    name: str
    kind: str
    rank: int
    angles: list[float]
    passes: list[tuple[int, float]]
    surfaces: list[int]


class MissDocument(TypedDict):
    """A near miss on a form."""

    form: int
    s: float
    value: float


class SurfaceDocument(TypedDict):
    """Configurations of a surface, each near the one before."""

    name: str
    dimension: int
    samples: PackedArray


class NearMotionDocument(TypedDict):
    """One configuration of a near motion, and by how much it is none."""

    sample: list[float]
    misclosure: float


class EdgeDocument(TypedDict):
    """A line of the graph of forms, in inches."""

    name: str
    line: list[list[float]]
    label: list[float]


class GraphDocument(TypedDict):
    """The graph of forms, laid out in inches."""

    names: list[str]
    places: list[list[float]]
    edges: list[EdgeDocument]


class PrincipalDocument(TypedDict):
    """The plane in which (cos theta, sin theta), 2 n numbers, spread most: their
    ``mean``, and two unit ``axes``. An unknown without a period stands for its own
    cosine, and 0 for its sine."""

    mean: list[float]
    axes: list[list[float]]


class ViewDirection(TypedDict):
    """Where to look from at first, in degrees."""

    elevation: float
    azimuth: float


class SubjectDocument(TypedDict):
    """What moves: a ``loop`` or a ``mechanism``."""

    loop: NotRequired[LoopDocument]
    mechanism: NotRequired[MechanismDocument]


class ViewDocument(SubjectDocument):
    """All that the viewer shows; ``note`` stands on the map where there is no form."""

    title: str
    verdict: str
    completeness: str
    note: str
    forms: list[FormDocument]
    points: list[PointDocument]
    near_misses: list[MissDocument]
    assemblies: list[list[float]]
    surfaces: list[SurfaceDocument]
    near_motions: list[NearMotionDocument]
    graph: GraphDocument
    plane: tuple[int, int]
    principal: PrincipalDocument
    view: ViewDirection


def make_view_document(atlas: Atlas, verdict: str = "") -> ViewDocument:
    """The document of an atlas; ``verdict`` is a sentence on what the linkage is.

    Raises `linkages.NoLinkageError` where the atlas is not of a linkage.
    """
    check_type("atlas", atlas, Atlas)
    moving = _moving(atlas)
    view = moving.view
    completeness = atlas.completeness
    forms: list[FormDocument] = []
    for index, (form, details) in enumerate(
        zip(atlas.forms, moving.forms, strict=True)
    ):
        forms.append({**_form(form, index), **details})
    return {
        "title": title_of(atlas),
        "verdict": verdict,
        "completeness": f"Completeness ({completeness.level}): "
        f"{completeness.statement}.",
        "note": _note(atlas),
        **moving.subject,
        "forms": forms,
        "points": [_point(point) for point in atlas.points],
        "near_misses": [
            {"form": miss.form, "s": miss.s, "value": miss.value}
            for miss in atlas.near_misses
        ],
        "assemblies": atlas.rigid.tolist(),
        "surfaces": [_surface(surface, atlas.periods) for surface in atlas.surfaces],
        "near_motions": [
            {"sample": motion.sample.tolist(), "misclosure": motion.misclosure}
            for motion in atlas.near_motions
        ],
        "graph": _graph(atlas),
        "plane": choose_plane(atlas),
        "principal": _principal(atlas),
        "view": {"elevation": view.elevation, "azimuth": view.azimuth},
    }


class _Moving(NamedTuple):
    """What moves, where it is seen best from, and what the viewer has to know besides of
    its ``forms``, one after the other."""

    subject: SubjectDocument
    view: View
    forms: Sequence[FormDetails]


def _moving(atlas: Atlas) -> _Moving:
    """What the unknowns of an atlas move: a loop, one that was given as a mechanism, or
    another mechanism."""
    mechanism = mechanism_of(atlas)
    point = _first(atlas)
    if mechanism is None:
        loop = loop_of(atlas)
        document = _loop(loop)
    else:
        readout = Readout(mechanism)
        if readout.single_loop is None:
            return _moving_bodies(atlas, readout.structure)
        loop = readout.single_loop.loop
        point = to_loop_angles(readout).points(point)
        document = {**_loop(loop), "joints": _joints(readout)}
    view = best_view(make_scene(loop, point))
    return _Moving({"loop": document}, view, [{} for _ in atlas.forms])


def _moving_bodies(atlas: Atlas, structure: Structure) -> _Moving:
    """The bodies of a mechanism, which is first shown where joints are seen apart."""
    motion = describe_motion(structure, np.concatenate(_configurations(atlas)))
    point = _first(atlas)
    forms: list[FormDetails] = []
    for number, form in enumerate(atlas.forms):
        start = _start(atlas, structure, number)
        details: FormDetails = {"start": start}
        if motion["tape"] is None:
            details["smallest"] = _smallest(form)
        if not forms:
            point = form.branch(start)
        forms.append(details)
    view = best_view_of_mechanism(structure, point)
    return _Moving({"mechanism": motion}, view, forms)


def _note(atlas: Atlas) -> str:
    """What the map says where there is no curve on it."""
    if atlas.forms or atlas.surfaces:
        return ""
    if closes_to_rounding(atlas.closure_gap) and atlas.closure_gap > 0:
        return "no form within the limits"
    if 0 < atlas.closure_gap < np.inf:
        return f"no form; closure gap {atlas.closure_gap:.1e}"
    return "no form"


def _loop(loop: Loop) -> LoopDocument:
    table = loop.arrays
    return {
        "lengths": table.lengths.tolist(),
        "twists": table.twists.tolist(),
        "offsets": table.offsets.tolist(),
        "size": loop.characteristic_length,
    }


def _joints(readout: Readout) -> list[JointDocument]:
    """The joints of the loop that a mechanism is, in loop order."""
    back = to_loop_angles(readout).inverse
    joints: list[JointDocument] = []
    for joint in range(len(back.columns)):
        column = back.index(joint)
        joints.append(
            {
                "name": readout.label_of_unknown(column),
                "column": column,
                "sign": int(back.signs[column]),
                "offset": float(back.origin[column]),
            }
        )
    return joints


def _form(form: Form, index: int) -> FormDocument:
    branch = form.branch
    style = form_style(index)
    dashes = [] if style.dashes == "-" else list(style.dashes[1])
    return {
        "name": form.name,
        "length": branch.length,
        "closed": branch.closed,
        "pieces": _packed(branch.pieces),
        "centers": branch.centers.tolist(),
        "radii": branch.radii.tolist(),
        "breaks": branch.breaks.tolist(),
        "travel": branch.travel.tolist(),
        "rank": form.rank,
        "inactive_joints": list(FormLabels.of(form).inactive_joints),
        "color": style.color,
        "dark_color": color_on_dark(style.color),
        "dashes": dashes,
    }


def _point(point: MeetingPoint) -> PointDocument:
    return {
        "name": point.name,
        "kind": point.kind.value,
        "rank": point.point.rank,
        "angles": point.point.u.tolist(),
        "passes": [(form, float(s)) for form, s in point.passes],
        "surfaces": list(point.surfaces),
    }


def _packed(array: np.ndarray) -> PackedArray:
    content = np.ascontiguousarray(array, dtype="<f8").tobytes()
    text = base64.b64encode(content).decode("ascii")
    return {"shape": list(array.shape), "float64": text}


# --- surfaces -------------------------------------------------------------------------


def _surface(surface: Surface, periods: np.ndarray) -> SurfaceDocument:
    every = max(1, -(-len(surface.samples) // MOST_SAMPLES))
    samples = _walk(surface.samples[::every], periods)
    return {
        "name": surface.name,
        "dimension": surface.dimension,
        "samples": _packed(samples),
    }


def _walk(points: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """The points (k, n) in an order in which each is the nearest to the one before that
    is left."""
    left = np.ones(len(points), dtype=bool)
    order = [0]
    left[0] = False
    for _ in range(len(points) - 1):
        gaps = difference(points, points[order[-1]], periods)
        distances = np.where(left, np.linalg.norm(gaps, axis=1), np.inf)
        nearest = int(np.argmin(distances))
        left[nearest] = False
        order.append(nearest)
    return points[order]


# --- the graph and the planes ---------------------------------------------------------


def _graph(atlas: Atlas) -> GraphDocument:
    layout = lay_out_graph(atlas)
    edges: list[EdgeDocument] = []
    for edge in layout.edges:
        label = np.round(edge.label, DIGITS).tolist()
        line = np.round(edge.line, DIGITS).tolist()
        edges.append({"name": edge.name, "line": line, "label": label})
    places = np.round(layout.places, DIGITS).tolist()
    return {"names": list(layout.names), "places": places, "edges": edges}


def _principal(atlas: Atlas) -> PrincipalDocument:
    """The first principal plane of all that is on the map."""
    theta = np.concatenate(_configurations(atlas))
    is_periodic = np.isfinite(atlas.periods)
    angles = theta * (2 * np.pi / atlas.periods)  # 0 where there is no period
    cosines = np.where(is_periodic, np.cos(angles), theta)
    sines = np.where(is_periodic, np.sin(angles), 0.0)
    features = np.concatenate([cosines, sines], axis=1)
    mean = features.mean(axis=0)
    _, _, directions = np.linalg.svd(features - mean, full_matrices=True)
    axes = directions[:2]
    largest = np.abs(axes).argmax(axis=1)
    signs = np.sign(axes[[0, 1], largest])
    return {"mean": mean.tolist(), "axes": (signs[:, None] * axes).tolist()}


def _configurations(atlas: Atlas) -> Sequence[np.ndarray]:
    """Configurations (k, n) of everything that is on the map, zeros where that is
    nothing."""
    parts = [form.branch.sample(SAMPLES) for form in atlas.forms]
    parts += [surface.samples for surface in atlas.surfaces]
    parts += [motion.sample[None] for motion in atlas.near_motions]
    if len(atlas.rigid):
        parts.append(atlas.rigid)
    return parts or [np.zeros((1, len(atlas.names)))]


def _first(atlas: Atlas) -> np.ndarray:
    """A configuration (n,) of what stands first on the map."""
    first = _configurations(atlas)[0]
    configuration: np.ndarray = first[len(first) // 2]
    return configuration


def _start(atlas: Atlas, structure: Structure, number: int) -> float:
    """The place on a form, by its number, at which the joints of a mechanism are
    farthest from one line, and which is not next to a singular point or an end."""
    branch = atlas.forms[number].branch
    spacing = branch.length / SAMPLES
    places = spacing * np.arange(SAMPLES)
    is_free = np.ones(SAMPLES, dtype=bool)
    if not branch.closed:
        is_free[[0, 1, -1]] = False
    for point in atlas.points:
        for form, s in point.passes:
            if form != number:
                continue
            gaps = np.abs(places - s)
            if branch.closed:
                gaps = np.minimum(gaps, branch.length - gaps)
            is_free &= gaps > BESIDE_A_POINT * spacing
    if not is_free.any():
        is_free[:] = True
    breadths = np.where(
        is_free, breadths_of_mechanism(structure, branch(places)), -np.inf
    )
    # the first of those that are alike, whatever rounding makes of them
    return float(places[np.argmax(breadths > (1 - ALIKE) * breadths.max())])


def _smallest(form: Form) -> list[list[float]]:
    """The smallest regular singular value along a form, in order."""
    profile = form.profile
    rows = np.stack([profile.arclength.ravel(), profile.smallest.ravel()], axis=1)
    ordered = rows[np.argsort(rows[:, 0], kind="stable")]
    values: list[list[float]] = ordered.tolist()
    return values


# --- the title ------------------------------------------------------------------------


def title_of(atlas: Atlas) -> str:
    """The name of the linkage of an atlas, and its locks: those of a network are the
    D-H angles of its outer joints. Raises `NoLinkageError` where it is of none."""
    mechanism = mechanism_of(atlas)
    if mechanism is None:
        return loop_of(atlas).name or "linkage"
    name = mechanism.name or "mechanism"
    locks = _locks_of_network(atlas) or _locks(mechanism)
    if not locks:
        return name
    if len(locks) > MOST_LOCKS:
        return f"{name}, {len(locks)} variables locked"
    return f"{name}, locked: {', '.join(locks)}"


def _locks_of_network(atlas: Atlas) -> list[str]:
    """The locks of a network; none for anything else."""
    if "network" not in atlas.subject:
        return []
    # takes as long to import as all that a page of another mechanism needs
    from linkages.networks.mechanism import network_of

    network = network_of(atlas)
    assert network is not None
    return [_angle(joint, kink) for joint, kink in network.kinks.items()]


def _locks(mechanism: Mechanism) -> list[str]:
    """The variables that are locked by themselves, with their values."""
    motions = {one.label: one.motion for one in mechanism.variables}
    locks = []
    for joint in mechanism.joints:
        for label, value in zip(joint.labels, joint.locked, strict=True):
            if value is None:
                continue
            is_turn = motions[label].is_turn
            locks.append(_angle(label, value) if is_turn else f"{label}={value:.6g}")
    return locks


def _angle(label: str, value: float) -> str:
    # rounded first: 40 degrees in radians and back has other last digits
    return f"{label}={round(degrees(value), 6) + 0.0:.6g}°"
