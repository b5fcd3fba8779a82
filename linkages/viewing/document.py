"""An atlas of a linkage as the viewer reads it: plain values that JSON can hold.

Curves come as the Taylor pieces of their branches, all digits kept: the viewer
evaluates them, and never solves. Angles are in radians, indices of forms and unknowns
count from 0. Arrays are packed: their shape, and float64, floats of 64 bits, the lowest
byte first, in base64.

title, verdict   sentences on what the linkage is, and on its completeness
completeness
note             what stands on the map where there is no form
loop             what moves, where it is one: lengths, twists, offsets, the characteristic
                 length as size; the joints, where unknowns are not the joint angles:
                 name, and the angle as offset plus sign times the unknown of this column
mechanism        what moves else (`linkages.links.motion_document`)
forms            name, length, closed, rank, inactive_joints, travel; pieces (packed),
                 centers, radii and breaks as in `bifurc.branch.Branch`; color, dark_color
                 and dashes; start, where it is first shown, of a mechanism, and smallest,
                 the smallest regular singular value as [s, value], without equations
points           name, kind, rank, angles; passes, as [index of the form, arclength];
                 surfaces, by their numbers
near_misses      form, s, value
dead_points      form, s, and the name of the joint that drives, or has limits
assemblies       configurations
surfaces         name, dimension; samples (packed), each near the one before
near_motions     name, sample, and by how much it misses closure, misclosure; curve, the
                 same as of a form, null of a surface
graph            of the forms, laid out in inches: names, places; edges, each a name, the
                 place of its label and a line
plane            the unknowns over which the map is drawn
principal        the plane in which (cos theta, sin theta), 2 n numbers, spread most: their
                 mean, and two unit axes; an unknown without a period stands for its own
                 cosine, and 0 for its sine
view             where to look from at first, elevation and azimuth in degrees, and what
                 is up then
joint_radius     how large joints are drawn, in the user's unit
trace            points whose paths are drawn: name, the number of the body, as in a
                 mechanism, or of the link from 0; place, on it, in the user's unit
drawn            the configuration in which a file gives the linkage: angles, its name on
                 the map, and its place [index of the form, s], null where no form passes
"""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from math import degrees
from typing import Any, TypeAlias

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint, Surface
from bifurc.branch import Branch
from bifurc.checks import check_type
from bifurc.figures.drawing import emptiness
from bifurc.figures.form_graph import REACH, lay_out_graph
from bifurc.figures.planes import choose_plane, shown_branches
from bifurc.figures.style import (
    Style,
    color_on_dark,
    form_style,
    near_motion_style,
)
from bifurc.tables import count_of
from bifurc.torus import difference
from linkages.labels import FormLabels
from linkages.links.parts import Parts
from linkages.links.traced_points import TracedPoint, traced_point
from linkages.mechanisms.mechanism import Lock
from linkages.readout.dead_points import driven_dead_points
from linkages.readout.drawn import drawn_place
from linkages.subject import subject_at
from linkages.viewing.start import configurations, first_place, start_of

Document: TypeAlias = dict[str, Any]  # values that JSON can hold

MOST_SAMPLES = 600  # configurations shown of a surface
MOST_LOCKS = 6  # that a title lists
SIDE_BY_SIDE = 3.0  # forms, at least, in a row of the graph
BREADTH = 2 * REACH  # of the graph for each form in a row, inches
DIGITS = 6  # after the point, of places in the graph (inches)


def make_view_document(
    atlas: Atlas, verdict: str = "", trace: Sequence[str] = ()
) -> Document:
    """The document of an atlas; ``verdict`` is a sentence on what the linkage is, and
    ``trace`` names points whose paths are drawn, as `linkages.plot_linkage` has it.

    Raises `linkages.NoLinkageError` where the atlas is not of a linkage, and
    `linkages.GeometryError` for a point of no body.
    """
    check_type("atlas", atlas, Atlas)
    parts = subject_at(atlas).parts_for(trace)
    completeness = atlas.completeness
    forms = [
        {**_form(form, number), **parts.form_on_page(form, start_of(atlas, number))}
        for number, form in enumerate(atlas.forms)
    ]
    first = first_place(atlas).point
    view = parts.best_view(first)
    points = np.concatenate(configurations(atlas))
    return {
        "title": title_of(atlas),
        "verdict": verdict,
        "completeness": f"Completeness ({completeness.level}): "
        f"{completeness.statement}.",
        "note": _note(atlas),
        **parts.page(points),
        "forms": forms,
        "points": [_point(point) for point in atlas.points],
        **_places_on_forms(atlas),
        "assemblies": atlas.rigid.tolist(),
        "surfaces": [_surface(surface, atlas.periods) for surface in atlas.surfaces],
        "near_motions": _near_motions(atlas),
        "graph": _graph(atlas),
        "plane": choose_plane(atlas),
        "principal": _principal(atlas),
        "view": view._asdict(),
        "joint_radius": _joint_radius(parts, first, points),
        "trace": [_traced(traced_point(parts, text)) for text in trace],
        "drawn": _drawn(atlas),
    }


def _joint_radius(parts: Parts, first: np.ndarray, points: np.ndarray) -> float:
    extent = parts.extent(first, parts.lines(points))
    return parts.joint_radius(first, extent)


def _places_on_forms(atlas: Atlas) -> Document:
    """The near misses and the dead points of what drives."""
    return {
        "near_misses": [
            {"form": miss.form, "s": miss.s, "value": miss.value}
            for miss in atlas.near_misses
        ],
        "dead_points": [
            {"form": event.form, "s": event.s, "name": atlas.names[event.index]}
            for event in driven_dead_points(atlas)
        ],
    }


def _note(atlas: Atlas) -> str:
    """What the map says where there is nothing on it."""
    if shown_branches(atlas) or atlas.surfaces or len(atlas.rigid):
        return ""
    return "; ".join(emptiness(atlas))


def _form(form: Form, index: int) -> Document:
    return {
        "name": form.name,
        **_curve(form.branch, form_style(index)),
        "rank": form.rank,
        "inactive_joints": list(FormLabels.of(form).inactive_joints),
    }


def _curve(branch: Branch, style: Style) -> Document:
    dashes = [] if style.dashes == "-" else list(style.dashes[1])
    return {
        "length": branch.length,
        "closed": branch.closed,
        "pieces": _packed(branch.pieces),
        "centers": branch.centers.tolist(),
        "radii": branch.radii.tolist(),
        "breaks": branch.breaks.tolist(),
        "travel": branch.travel.tolist(),
        "color": style.color,
        "dark_color": color_on_dark(style.color),
        "dashes": dashes,
    }


def _near_motions(atlas: Atlas) -> list[Document]:
    motions = []
    index = len(atlas.forms)
    for motion in atlas.near_motions:
        curve: Document | None = None
        if motion.branch is not None:
            style = near_motion_style(index)
            index += 1
            curve = {
                "name": motion.name,
                **_curve(motion.branch, style),
                "rank": len(atlas.names) - 1,
                "inactive_joints": [],
                "start": 0.5 * motion.branch.length,
                "smallest": [],
            }
        motions.append(
            {
                "name": motion.name,
                "sample": motion.sample.tolist(),
                "misclosure": motion.misclosure,
                "curve": curve,
            }
        )
    return motions


def _point(point: MeetingPoint) -> Document:
    return {
        "name": point.name,
        "kind": point.kind.value,
        "rank": point.point.rank,
        "angles": point.point.u.tolist(),
        "passes": [(form, float(s)) for form, s in point.passes],
        "surfaces": list(point.surfaces),
    }


def _traced(point: TracedPoint) -> Document:
    return {"name": point.name, "body": point.body, "place": point.place.tolist()}


def _drawn(atlas: Atlas) -> Document | None:
    drawn = drawn_place(atlas)
    if drawn is None:
        return None
    place = None if drawn.form is None else [drawn.form, drawn.s]
    return {"angles": drawn.point.tolist(), "name": drawn.name, "place": place}


def _packed(array: np.ndarray) -> Document:
    content = np.ascontiguousarray(array, dtype="<f8").tobytes()
    text = base64.b64encode(content).decode("ascii")
    return {"shape": list(array.shape), "float64": text}


# --- surfaces -------------------------------------------------------------------------


def _surface(surface: Surface, periods: np.ndarray) -> Document:
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


def _graph(atlas: Atlas) -> Document:
    count = len(atlas.forms) + len(atlas.surfaces)
    layout = lay_out_graph(atlas, width=BREADTH * max(SIDE_BY_SIDE, math.sqrt(count)))
    edges: list[Document] = []
    for edge in layout.edges:
        label = np.round(edge.label, DIGITS).tolist()
        line = np.round(edge.line, DIGITS).tolist()
        edges.append({"name": edge.name, "line": line, "label": label})
    places = np.round(layout.places, DIGITS).tolist()
    return {"names": list(layout.names), "places": places, "edges": edges}


def _principal(atlas: Atlas) -> Document:
    """The first principal plane of all that is on the map."""
    theta = np.concatenate(configurations(atlas))
    is_periodic = np.isfinite(atlas.periods)
    angles = theta * (2 * np.pi / atlas.periods)  # 0 where there is no period
    cosines = np.where(is_periodic, np.cos(angles), theta)
    sines = np.where(is_periodic, np.sin(angles), 0.0)
    features = np.concatenate([cosines, sines], axis=1)
    mean = features.mean(axis=0)
    # two rows more, so that there are two directions also of one configuration
    rows = np.concatenate([features - mean, np.zeros((2, features.shape[1]))])
    _, _, directions = np.linalg.svd(rows, full_matrices=False)
    axes = directions[:2]
    largest = np.abs(axes).argmax(axis=1)
    signs = np.sign(axes[[0, 1], largest])
    return {"mean": mean.tolist(), "axes": (signs[:, None] * axes).tolist()}


# --- the title ------------------------------------------------------------------------


def title_of(atlas: Atlas) -> str:
    """The name of the linkage of an atlas, and its locks: those of a network are the
    D-H angles of its outer joints. Raises `NoLinkageError` where it is of none."""
    subject = subject_at(atlas)
    locks = subject.locks
    name = subject.name or subject.kind
    if not locks:
        return name
    if len(locks) > MOST_LOCKS:
        return f"{name}, {count_of(len(locks), 'variable')} locked"
    return f"{name}, locked: {', '.join(map(_lock, locks))}"


def _lock(lock: Lock) -> str:
    """A lock with its value."""
    if not lock.is_angle:
        return f"{lock.name}={lock.value:.6g}"
    # rounded first: 40 degrees in radians and back has other last digits
    return f"{lock.name}={round(degrees(lock.value), 6) + 0.0:.6g}°"
