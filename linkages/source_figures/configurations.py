"""The linkages that figures show, their forms, and configurations on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.branch import Branch
from bifurc.numerics.roots import bracketed_roots
from bifurc.settings import SearchSettings
from bifurc.torus import wrap
from linkages.catalogue import entry
from linkages.entry import Linkage, ParameterKind
from linkages.linkage import load_linkage
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.source_figures.table import Content

SAMPLES = 720  # of a form, between which a given angle is looked for
CHOICES = 48  # configurations among which the clearest is chosen
CLEAR_ENOUGH = 0.99  # of the clearest: the first such one is taken
TURN = 2 * np.pi


def linkage_of(content: Content) -> Linkage:
    """The linkage that a figure names, angles of its ``parameters`` in degrees."""
    name = content["linkage"]
    family = entry(name)
    kinds = {parameter.name: parameter.kind for parameter in family.parameters}
    values = {}
    for key, value in content.get("parameters", {}).items():
        is_angle = kinds.get(key) is ParameterKind.ANGLE
        values[key] = float(np.radians(value)) if is_angle else float(value)
    return load_linkage(name, **values)


def loop_of_content(content: Content) -> Loop:
    """The loop of the linkage that a figure names."""
    return linkage_of(content).loop


def atlas_of(content: Content) -> Atlas:
    """The transition map of the linkage that a figure names, without certificates; its
    bifurcations are called as in the source, where the figure says which forms meet at
    ``points`` of these numbers."""
    parameters = tuple(sorted(content.get("parameters", {}).items()))
    atlas = _atlas(content["linkage"], parameters)
    points = content.get("points")
    return atlas if points is None else _with_names(atlas, points)


def _with_names(atlas: Atlas, meetings: Mapping[str, Sequence[str]]) -> Atlas:
    """The atlas with a number for each bifurcation, by the forms that meet there."""
    names = {}
    for number, forms in meetings.items():
        meeting = {atlas.forms.index(form_named(atlas, form)) for form in forms}
        names[frozenset(meeting)] = f"B$_{{{number}}}$"
    points = []
    for point in atlas.points:
        members = frozenset(form for form, _ in point.passes)
        points.append(replace(point, name=names[members]))
    return replace(atlas, points=tuple(points))


@cache
def _atlas(name: str, parameters: tuple[tuple[str, float], ...]) -> Atlas:
    linkage = linkage_of({"linkage": name, "parameters": dict(parameters)})
    return map_linkage(linkage, settings=SearchSettings(certify=False))


def form_named(atlas: Atlas, name: str) -> Form:
    """The form whose name is, or begins with, ``name``, before a space or a bracket;
    the longest form where the name is empty."""
    if not name:
        return max(atlas.forms, key=lambda form: form.branch.length)
    for form in atlas.forms:
        if form.name == name or form.name.startswith(f"{name} "):
            return form
    names = ", ".join(form.name for form in atlas.forms)
    raise LookupError(f"no form is called {name!r}; there are {names}")


def places_at(branch: Branch, joint: int, angle: float) -> np.ndarray:
    """Arclengths (k,) at which joint number ``joint`` stands at ``angle`` (rad), in
    their order along the branch."""
    s = np.linspace(0.0, branch.length, SAMPLES + 1)
    turns = np.floor((branch(s)[:, joint - 1] - angle) / TURN)
    passed = np.flatnonzero(np.diff(turns))
    levels = angle + TURN * np.maximum(turns[passed], turns[passed + 1])
    if not len(passed):
        return np.empty(0)

    def gaps(places: np.ndarray) -> np.ndarray:
        return np.asarray(branch(places)[:, joint - 1] - levels)

    return bracketed_roots(gaps, s[passed], s[passed + 1])


def configuration(content: Content) -> np.ndarray:
    """The joint angles (n,), rad, of the configuration that a figure names.

    ``form`` names the form; ``at`` = [joint, degrees, number] the place where a joint
    has an angle, counted along the form; left out, the place where the joints lie
    furthest apart.
    """
    form = form_named(atlas_of(content), content.get("form", ""))
    loop = loop_of_content(content)
    if "at" in content:
        joint, degrees, number = content["at"]
        s = places_at(form.branch, joint, np.radians(degrees))[number]
    elif "part" in content:
        s = content["part"] * form.branch.length
    else:
        s = widest_place(loop, form.branch)
    return np.asarray(wrap(form.branch(s), form.branch.periods))


def widest_place(loop: Loop, branch: Branch) -> float:
    """The arclength, among equally spaced ones, at which the two joints that are
    closest lie furthest apart."""
    places = np.linspace(0.0, branch.length, CHOICES, endpoint=False)
    points = loop.frames(branch(places))[:, :-1, :3, 3]
    gaps = np.linalg.norm(points[:, :, None] - points[:, None], axis=-1)
    first, second = np.triu_indices(loop.n, 1)
    least = gaps[:, first, second].min(axis=1)
    clear = np.flatnonzero(least >= CLEAR_ENOUGH * least.max())
    return float(places[clear[0]])
