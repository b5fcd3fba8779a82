"""One member of a sweep: its transition map, told in a fixed set of numbers."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.graphs import arc_graph, transition_graph
from bifurc.search.settings import SearchSettings
from linkages.catalogue import entry
from linkages.linkage import Linkage
from linkages.loop import GeometryError
from linkages.mapping import map_linkage

__all__ = ["FIELDS", "Field", "Status", "atlas_name", "map_member", "summarise"]

log = logging.getLogger(__name__)


class Status(IntEnum):
    """What became of a member."""

    PENDING = -1  # not mapped yet
    MAPPED = 0
    REFUSED = 1  # the constructor refuses the parameters
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
        return float("nan") if self.dtype.startswith("f") else -1


FIELDS: Mapping[str, Field] = {
    "status": Field(
        "i1", "", "0 mapped, 1 refused by the constructor, 2 failed, -1 not done"
    ),
    "forms": Field("i2", "", "number of motion forms"),
    "closed_forms": Field("i2", "", "number of closed forms"),
    "bifurcations": Field("i2", "", "number of bifurcations"),
    "components": Field("i2", "", "number of connected components made of forms"),
    "one_cycle": Field(
        "i1", "", "1 where the graph of forms is one cycle through all of them"
    ),
    "rank_drops": Field("i2", "", "number of rank drops with a single branch"),
    "surfaces": Field("i2", "", "number of components of mobility 2 or more"),
    "rigid": Field("i2", "", "number of isolated rigid assemblies"),
    "inactive_joints": Field(
        "i2", "", "number of forms in which the joint does not turn", per_joint=True
    ),
    "smallest_gap": Field(
        "f8", "1", "smallest singular value at a near miss, relative"
    ),
    "total_length": Field("f8", "rad", "joint-space length of all forms"),
    "longest_form": Field("f8", "rad", "joint-space length of the longest form"),
    "longest_route": Field(
        "f8", "rad", "largest of the shortest distances between two singular points"
    ),
    "mean_route": Field(
        "f8", "rad", "mean of the shortest distances between two singular points"
    ),
    "closure": Field(
        "f8",
        "1",
        "largest closure error along any form, relative to the characteristic length",
    ),
    "closure_gap": Field(
        "f8", "1", "where there is no form: residual left along the valley"
    ),
    "missed_probability": Field(
        "f8", "1", "estimated probability that one more start finds something new"
    ),
    "complete": Field("i1", "", "1 where every slice was complete"),
    "seconds": Field("f8", "s", "processor time taken"),
}


def map_member(
    family: str,
    parameters: Mapping[str, float],
    starts: int,
    seed: int,
    atlas_path: str | None = None,
) -> dict[str, Any]:
    """The summary of one member: values of `FIELDS`, and a ``message`` where it was
    refused or failed.

    With ``atlas_path`` the whole atlas is written there first.
    """
    began = time.process_time()
    found = entry(family)
    try:
        loop = found.build(**parameters)
        values = found.complete(parameters)
        patterns = found.patterns(**values) if found.patterns is not None else ()
    except (GeometryError, ArithmeticError) as error:
        return {"status": int(Status.REFUSED), "message": str(error)}
    try:
        atlas = map_linkage(
            Linkage(loop, patterns),
            settings=SearchSettings(prove=False, starts=starts),
            seed=seed,
        )
    # one bad member must not end a sweep of thousands; the journal keeps the reason
    except Exception as error:
        log.exception("%s with %s", family, dict(parameters))
        return {
            "status": int(Status.FAILED),
            "message": f"{type(error).__name__}: {error}",
        }
    if atlas.provenance.interrupted:
        raise KeyboardInterrupt  # what was found so far is not the member's map
    if atlas_path is not None:
        _save(atlas, Path(atlas_path))
    return {
        "status": int(Status.MAPPED),
        **summarise(atlas),
        "seconds": time.process_time() - began,
    }


def summarise(atlas: Atlas) -> dict[str, Any]:
    """The values of `FIELDS` but for status and seconds; not-a-number is left out."""
    lengths = [form.branch.length for form in atlas.forms]
    gaps = [event.value for event in atlas.near_misses]
    longest, mean = _routes(atlas)
    idle = np.zeros(len(atlas.names), dtype=int)
    for form in atlas.forms:
        idle[np.array(form.labels.get("inactive_joints", []), dtype=int) - 1] += 1
    graph = nx.Graph(transition_graph(atlas))
    cycle = (
        len(graph) > 2
        and nx.is_connected(graph)
        and all(degree == 2 for _, degree in graph.degree())
    )
    out = {
        "forms": len(atlas.forms),
        "closed_forms": sum(form.branch.closed for form in atlas.forms),
        "bifurcations": len(atlas.bifurcations),
        "components": atlas.components,
        "one_cycle": int(cycle),
        "rank_drops": len(atlas.rank_drops),
        "surfaces": len(atlas.surfaces),
        "rigid": len(atlas.rigid),
        "inactive_joints": idle.tolist(),
        "smallest_gap": min(gaps, default=np.nan),
        "total_length": sum(lengths),
        "longest_form": max(lengths, default=np.nan),
        "longest_route": longest,
        "mean_route": mean,
        "closure": max(
            (form.labels.get("max_residual", np.nan) for form in atlas.forms),
            default=np.nan,
        ),
        "closure_gap": atlas.closure_gap,
        "missed_probability": atlas.completeness.missed_probability,
        "complete": int(atlas.completeness.level in ("proved", "certified")),
    }
    return {
        key: value
        for key, value in out.items()
        if not (isinstance(value, float) and not np.isfinite(value))
    }


def _routes(atlas: Atlas) -> tuple[float, float]:
    """Largest and mean of the shortest distances between two singular points of one
    component."""
    names = [point.name for point in atlas.points]
    lengths = dict(nx.all_pairs_dijkstra_path_length(arc_graph(atlas), weight="length"))
    found = [
        lengths[a][b]
        for i, a in enumerate(names)
        for b in names[i + 1 :]
        if b in lengths[a]
    ]
    return (max(found), float(np.mean(found))) if found else (np.nan, np.nan)


def atlas_name(index: int) -> str:
    """File name of the atlas of a member."""
    return f"member_{index:07d}.nc"


def _save(atlas: Atlas, path: Path) -> None:
    """Write an atlas as a whole or not at all."""
    from bifurc.files.dataset import save_atlas

    partial = path.with_name(f".{os.getpid()}_{path.name}")
    save_atlas(atlas, partial)
    os.replace(partial, path)
