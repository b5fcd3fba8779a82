"""Where branches are traced from, and whether more random starts are worth while.

What was met by a few starts only has neighbours as small as it is that were met by none:
of an island with a share p of N starts none comes with a probability of exp(-p N). So
starts are drawn until each island was met some times. Where too many were met just once
there is no end in sight, and no more are drawn.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np

from bifurc.search.findings import Fate, Findings
from bifurc.singular.point import SingularPoint


class Start(NamedTuple):
    """A solution (n,) to trace a branch from, first to the side of ``direction`` (n,)
    where there is one."""

    point: np.ndarray
    direction: np.ndarray | None = None


def half_branch_starts(point: SingularPoint) -> list[Start]:
    """Starts on all half-branches of a singular point, a little off it."""
    directions = point.half_branches
    return [Start(point.u + point.radius * along, along) for along in directions]


# Starts that meet an island: of one as large none comes in 5e-5 of searches.
FEWEST = 10
# Share of the starts that met what no other one met: of those to come about as many meet
# something new (Good 1953).
ENDLESS = 0.25


def asks_for_more_starts(findings: Findings) -> bool:
    """Whether some island was met by few random starts, and most by more. Islands are
    forms, joined by singular points, isolated assemblies and near motions; what lies on
    components of higher dimension says nothing of them."""
    hits = _hits_of_islands(findings)
    if not len(hits) or hits.min() >= FEWEST:
        return False
    singles = np.count_nonzero(hits == 1)
    return bool(singles < ENDLESS * hits.sum())


def _hits_of_islands(findings: Findings) -> np.ndarray:
    """How many random starts (i,) met each island."""
    is_random = findings.seeds.random
    hits = Counter(fate for number, fate in findings.fates.items() if is_random[number])
    islands = _islands_of_forms(findings)
    of_forms = np.zeros(islands.max(initial=-1) + 1, dtype=int)
    of_others = {Fate.RIGID: [0] * len(findings.rigid)}
    of_others[Fate.ON_NEAR_MOTION] = [0] * len(findings.near_motions)
    for fate, count in hits.items():
        if fate.fate is Fate.ON_FORM:
            of_forms[islands[fate.number]] += count
        elif fate.fate in of_others:
            of_others[fate.fate][fate.number] += count
    return np.concatenate([of_forms, *of_others.values()]).astype(int)


def _islands_of_forms(findings: Findings) -> np.ndarray:
    """The number (k,) of the island that each of the traced branches lies on."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(findings.traced)
    meet = np.zeros((len(findings.points), count), dtype=bool)
    for row, point in enumerate(findings.points):
        for column, branch in enumerate(findings.branches):
            distance, _ = branch.nearest(point.u, within=point.radius)
            meet[row, column] = distance[0] <= point.radius
    rows, columns = np.nonzero(meet)
    size = len(findings.points) + count
    links = coo_array((np.ones(len(rows)), (rows + count, columns)), shape=(size, size))
    islands = connected_components(links, directed=False)[1][:count]
    _, numbers = np.unique(islands, return_inverse=True)
    return np.asarray(numbers)
