"""One member of a sweep: its transition map in a fixed set of numbers, the variables of
the dataset."""

from __future__ import annotations

import csv
import logging
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from importlib.resources import files
from pathlib import Path
from typing import TypeAlias

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.graphs import arc_graph, transition_graph
from bifurc.settings import SearchSettings
from bifurc.systems.equation_file import EquationFileError
from linkages.app.answer.verdict import is_without_gaps
from linkages.app.sweep.subjects import JointName, Member, MemberSource
from linkages.values import GeometryError

# values of `FIELDS` by name, and the message of a member that was refused or failed
Record: TypeAlias = dict[str, int | float | str | list[int]]


class Status(IntEnum):
    """What became of a member."""

    PENDING = -1  # not mapped yet
    MAPPED = 0
    REFUSED = 1  # its parameters or locks make no member
    FAILED = 2  # mapping raised an error, which the journal keeps


@dataclass(frozen=True)
class Field:
    """A variable of the dataset: its type, unit and meaning; ``per_joint`` has one
    value for each joint."""

    dtype: str
    unit: str
    meaning: str
    per_joint: bool = False

    @property
    def missing(self) -> float:
        """What stands where there is no value."""
        return math.nan if self.dtype.startswith("f") else -1


def _read_fields() -> dict[str, Field]:
    """All variables by their names, as ``fields.csv`` lists them."""
    text = files("linkages.app.sweep").joinpath("fields.csv").read_text("utf-8")
    fields = {}
    for line in csv.DictReader(text.splitlines()):
        name, is_per_joint = line.pop("name"), bool(line.pop("per_joint"))
        fields[name] = Field(**line, per_joint=is_per_joint)
    return fields


FIELDS = _read_fields()

log = logging.getLogger(__name__)


def map_member(
    subject: MemberSource,
    values: Mapping[str, float],
    starts: int,
    seed: int,
    atlas_path: str | None = None,
) -> Record:
    """The summary of the member of a subject at ``values`` of its quantities (rad for
    angles): values of `FIELDS`, and a ``message`` where it was refused or failed.

    With ``atlas_path`` the whole atlas is written there first.
    """
    began = time.process_time()
    try:
        member = subject.member(values)
    except (GeometryError, EquationFileError, ArithmeticError) as error:
        return {"status": int(Status.REFUSED), "message": str(error)}
    settings = SearchSettings(count=False, starts=starts)
    try:
        atlas = member.atlas(settings, seed)
    except GeometryError as error:  # such as for locks that leave nothing to move
        return {"status": int(Status.REFUSED), "message": str(error)}
    # one bad member must not end a sweep of thousands; the journal keeps the reason
    except Exception as error:
        log.exception("%s with %s", subject.identity, dict(values))
        message = f"{type(error).__name__}: {error}"
        return {"status": int(Status.FAILED), "message": message}
    if atlas.provenance.interrupted:
        raise KeyboardInterrupt  # what was found so far is not the member's map
    if atlas_path is not None:
        from bifurc.files.dataset import save_atlas

        save_atlas(atlas, Path(atlas_path))
    record: Record = {"status": int(Status.MAPPED)}
    record |= summarise(atlas, member)
    record["inactive_joints"] = _forms_without(atlas, member, subject.joints)
    record["seconds"] = time.process_time() - began
    return record


def summarise(atlas: Atlas, member: Member) -> Record:
    """The values of `FIELDS` that the atlas of a member tells; not-a-number is left
    out."""
    lengths = [form.branch.length for form in atlas.forms]
    gaps = [event.value for event in atlas.near_misses]
    residuals = [member.closure(form) for form in atlas.forms]
    routes = _route_lengths(atlas)
    record: Record = {
        "mobility": atlas.mobility,
        "forms": len(atlas.forms),
        "closed_forms": sum(form.branch.closed for form in atlas.forms),
        "bifurcations": len(atlas.bifurcations),
        "components": atlas.components,
        "one_cycle": int(_is_one_cycle(atlas)),
        "rank_drops": len(atlas.rank_drops),
        "surfaces": len(atlas.surfaces),
        "rigid": len(atlas.rigid),
        "smallest_gap": min(gaps, default=math.nan),
        "total_length": sum(lengths),
        "longest_form": max(lengths, default=math.nan),
        "longest_route": max(routes, default=math.nan),
        "mean_route": float(np.mean(routes)) if routes else math.nan,
        "closure": max(residuals, default=math.nan),
        "closure_gap": atlas.closure_gap,
        "missed_probability": atlas.completeness.missed_probability,
        "complete": int(is_without_gaps(atlas.completeness)),
    }
    if atlas.diagram is not None:
        record["folds"] = len(atlas.diagram.folds)
        record["hopf_points"] = len(atlas.diagram.hopf_points)
        record["events"] = len(atlas.diagram.events())
    return {key: value for key, value in record.items() if not _is_missing(value)}


def _is_missing(value: int | float | str | list[int]) -> bool:
    return isinstance(value, float) and not math.isfinite(value)


def _forms_without(
    atlas: Atlas, member: Member, joints: Sequence[JointName]
) -> list[int]:
    """For every one of the ``joints`` the number of forms in which it stands still."""
    of_forms = [
        member.still_joints(atlas, number) for number in range(len(atlas.forms))
    ]
    return [sum(joint in still for still in of_forms) for joint in joints]


def _is_one_cycle(atlas: Atlas) -> bool:
    """Whether the graph of forms is one cycle through all of them."""
    graph = nx.Graph(transition_graph(atlas))
    if len(graph) < 3 or not nx.is_connected(graph):
        return False
    return all(degree == 2 for _, degree in graph.degree())


def _route_lengths(atlas: Atlas) -> list[float]:
    """The shortest distances (rad) between two singular points of one component."""
    lengths = dict(nx.all_pairs_dijkstra_path_length(arc_graph(atlas), weight="length"))
    names = [point.name for point in atlas.points]
    routes = []
    for i, start in enumerate(names):
        for goal in names[i + 1 :]:
            if goal in lengths[start]:
                routes.append(lengths[start][goal])
    return routes


def atlas_name(index: int) -> str:
    """File name of the atlas of a member."""
    return f"member_{index:07d}.nc"
