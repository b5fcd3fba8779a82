"""From the findings of a search to an atlas."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, Provenance, Surface
from bifurc.curves.minima import stand_out
from bifurc.curves.monitor import dead_points, singular_values
from bifurc.problem import Problem
from bifurc.search.canonical_course import wrapped_periods
from bifurc.search.canonical_order import (
    order_branches,
    order_points,
    order_surfaces,
)
from bifurc.search.closure_gap import closure_gap
from bifurc.search.completeness import judge_completeness
from bifurc.search.findings import Findings, TracedBranch
from bifurc.search.meeting_points import meeting_points
from bifurc.torus import wrap

__all__ = ["assemble_atlas"]


def assemble_atlas(
    problem: Problem, findings: Findings, provenance: Provenance
) -> Atlas:
    """The atlas of the findings, in an order that does not depend on the seeds.

    Every point in it is wrapped: see `Atlas`.
    """
    periods = wrapped_periods(problem)
    order = order_branches(problem, findings.branches)
    traced = [findings.traced[k] for k in order]
    branches = [branch.branch for branch in traced]
    surfaces = _surfaces(problem, findings, periods)
    located = [replace(point, u=wrap(point.u, periods)) for point in findings.points]
    points = meeting_points(problem, located, branches, surfaces, periods)
    rigid = wrap(np.array(findings.rigid).reshape(-1, problem.n), periods)
    is_mobile = bool(traced or surfaces)
    gap = 0.0 if is_mobile else closure_gap(problem, findings.seeds, findings.gaps)
    return Atlas(
        names=problem.names,
        units=problem.units,
        periods=problem.periods,
        forms=_forms(problem, traced, points),
        points=points,
        near_misses=_near_misses(problem, traced, periods),
        dead_points=_dead_points(problem, traced, periods),
        rigid=rigid[order_points(rigid, periods, problem.scale)],
        surfaces=surfaces,
        completeness=judge_completeness(findings, provenance),
        closure_gap=gap,
        provenance=provenance,
    )


# --- forms and surfaces ---------------------------------------------------------------


def _forms(
    problem: Problem, traced: Sequence[TracedBranch], points: Sequence[MeetingPoint]
) -> tuple[Form, ...]:
    """The branches as forms, numbered from 1."""
    components = _component_numbers(len(traced), points)
    singular = {form for point in points for form, _ in point.passes}
    forms = []
    for index, (branch, component) in enumerate(zip(traced, components, strict=True)):
        smallest = 0.0 if index in singular else _smallest_value(problem, branch)
        name = f"Form {index + 1}"
        forms.append(Form(name, branch.branch, branch.profile, smallest, component))
    return tuple(forms)


def _smallest_value(problem: Problem, traced: TracedBranch) -> float:
    """The smallest regular singular value along a branch: at its minima or its ends."""
    branch, profile = traced.branch, traced.profile
    _, minima = traced.minima
    smallest = min(minima.min(initial=np.inf), profile.smallest.min())
    if not branch.closed:
        ends = branch(np.array([0.0, branch.length]))
        at_ends = singular_values(problem, ends)[:, profile.rank - 1]
        smallest = min(smallest, at_ends.min())
    return float(smallest)


def _component_numbers(count: int, points: Sequence[MeetingPoint]) -> list[int]:
    """Number of the connected component of every form, counted from 0 in the order of
    the forms."""
    graph: nx.Graph[Hashable] = nx.Graph()
    graph.add_nodes_from(range(count))
    for point in points:
        forms = [form for form, _ in point.passes]
        surfaces = [("surface", k) for k in point.surfaces]
        nx.add_path(graph, [*forms, *surfaces])
    parts = []
    for members in nx.connected_components(graph):
        forms = sorted(member for member in members if isinstance(member, int))
        if forms:
            parts.append(forms)
    numbers = [0] * count
    for number, forms in enumerate(sorted(parts)):
        for form in forms:
            numbers[form] = number
    return numbers


def _surfaces(
    problem: Problem, findings: Findings, periods: np.ndarray
) -> tuple[Surface, ...]:
    """The surfaces, numbered from 1."""
    surfaces = findings.components.surfaces(findings.seeds.points)
    in_order = [surfaces[k] for k in order_surfaces(problem, surfaces)]
    named = []
    for number, surface in enumerate(in_order, start=1):
        samples = wrap(surface.samples, periods)
        named.append(replace(surface, name=f"surface {number}", samples=samples))
    return tuple(named)


# --- events ---------------------------------------------------------------------------


def _near_misses(
    problem: Problem, traced: Sequence[TracedBranch], periods: np.ndarray
) -> tuple[Event, ...]:
    """The minima of the singular value that are no singular points, form by form."""
    events = []
    for form, branch in enumerate(traced):
        arclengths, values = branch.minima
        is_low = stand_out(problem, branch.branch, branch.profile, values)
        is_near_miss = is_low & ~np.isin(arclengths, branch.located)
        if not np.any(is_near_miss):
            continue
        arclengths, values = arclengths[is_near_miss], values[is_near_miss]
        places = wrap(branch.branch(arclengths), periods)
        for k in order_points(places, periods, problem.scale):
            s, value = float(arclengths[k]), float(values[k])
            events.append(Event(form, s, places[k], value))
    return tuple(events)


def _dead_points(
    problem: Problem, traced: Sequence[TracedBranch], periods: np.ndarray
) -> tuple[Event, ...]:
    """The dead points, form by form and unknown by unknown."""
    events = []
    for form, branch in enumerate(traced):
        roots = dead_points(branch.branch)
        unknowns = np.repeat(np.arange(problem.n), [len(each) for each in roots])
        arclengths = np.concatenate(roots)
        places = wrap(branch.branch(arclengths), periods)
        for k in order_points(places, periods, problem.scale, groups=unknowns):
            s, index = float(arclengths[k]), int(unknowns[k])
            events.append(Event(form, s, places[k], index=index))
    return tuple(events)
