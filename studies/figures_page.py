"""What stands in docs/figures.md: every figure of the sources, how it is drawn, and
how it compares with the source.  ``python -m studies.pages figures`` writes it.
"""

from __future__ import annotations

from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np

from linkages.networks.network import Network, build_network
from linkages.networks.plan import FOUR_BENNETT
from linkages.source_figures.table import Agreement, Kind, SourceFigure, source_figures

PAGE = Path(__file__).parents[1] / "docs" / "figures.md"

SOURCES = {
    "thesis": "Song 2013, Kinematic study of overconstrained linkages and design of "
    "reconfigurable mechanisms",
    "000": "Song and Chen 2012, A family of mixed double-Goldberg 6R linkages",
    "001": "Song and Chen 2012, A special Wohlhart's double-Goldberg 6R linkage",
    "003": "Bil and Budniak 2014, Model of 5R spatial linkage in the geometry of tori",
    "004": "Racila and Dahan 2010, Spatial properties of Wohlhart symmetric mechanism",
}

KINDS = {
    Kind.ASSEMBLY: "axes and links: a graph with the names of the links, and the same "
    "in space; removed links are dashed, shared ones grey, locked joints filled",
    Kind.VIEWS: "a configuration from the front and from above, with its line of "
    "symmetry",
    Kind.MOTION: "one linkage at equal distances along a form",
    Kind.PATHS: "joint angles against that of joint 1",
    Kind.SINGULAR_VALUES: "all six singular values against the angle of joint 1, "
    "linear, in the source's unit of length; dashed lines are the bifurcations of the "
    "map, triangles its near misses",
    Kind.TRANSITIONS: "the transition map, with lettered configurations along the "
    "forms",
    Kind.NOTATION: "names of lengths and angles",
    Kind.TRANSLATOR: "Wohlhart's symmetric mechanism as a translator",
    Kind.TORI: "circles that make tori, and linkages on them",
    Kind.TABLE: "a printed table of types: lengths and twists of their links in symbols",
}

AGREEMENTS = {
    Agreement.AGREES: "all that text and caption of the source say of the figure holds "
    "in ours",
    Agreement.OWN_GEOMETRY: "the same, but the source prints no numbers: the geometry "
    "is that of the catalogue",
    Agreement.DIFFERS: "text or caption is wrong; ours is right, and its caption says "
    "what differs",
}

HEAD = """# Figures of the sources

Every figure of the thesis and of four papers, and their tables of linkages, drawn anew from the geometry:

```sh
bifurc figure --list
bifurc figure thesis-5.2.7 --out figures
make gallery                              # all of them, into out/gallery
```

Each is written as PNG and SVG, with its caption. What a figure shows stands in a table
(`linkages/source_figures/data/`), how it is drawn in one function a kind. A linkage is
taken from the catalogue, mapped, and set in a configuration; links that a construction
removes are the common normals of the axes that they join, and a fourth joint of a
Bennett linkage is the image of another one under the half turn about its line of
symmetry. Tests compare every such link with the length and the twist that its name
states. Photographs are replaced by the same linkage, drawn.

The copies of the sources hold no pictures: figures are compared with their captions,
with the text and with the numbers, not with the pictures.

"""

TRANSLATOR = """## The translator

`python -m studies.wohlhart_translator` prints the strokes of Wohlhart's symmetric
mechanism and draws figures 3 to 12 of Racila and Dahan (2010). Two facts found here
make that short (`linkages/closed_forms/translator.py`, with tests against measured
values):

- The input-output equation (15) is a square: it says that cos(theta/2) cos(phi/2) -
  cos(alpha) sin(theta/2) sin(phi/2) is 1/2 or -1/2. With half the sum s and half the
  difference d of the angles this is (1 + cos(alpha)) cos(s) + (1 - cos(alpha)) cos(d)
  = 1 or -1, from which every stroke follows without solving anything.
- The root in (29), once corrected, is constant: H = 2 a |sin(theta/2) sin(phi/2)
  sin(alpha)| / sqrt(3).

Draws both strokes, since the paper does not say which.
"""


NETWORK = """
## Table 5.4.1 of the thesis

All 28 ways to lock two joints of the network of four Bennett linkages, from its closed
form (`linkages/networks/network.py`), with twists of 35, 62, 81 and 48
degrees. The thesis prints 4/5 for 3/5 among the odd pairs, and leaves out 1/6, 2/7 and
3/8 of the pairs n/n+3.

"""

TWISTS = (35.0, 62.0, 81.0, 48.0)  # of a, b, c, d, degrees
MOVES = 1e-6  # rate of a joint that turns, against rounding


def figures_page() -> str:
    """The page as Markdown."""
    figures = list(source_figures().values())
    parts = [HEAD, _kinds(figures), _agreements(figures)]
    for source, title in SOURCES.items():
        own = [figure for figure in figures if figure.name.startswith(f"{source}-")]
        parts.append(_table(source, title, own))
    parts.append(TRANSLATOR)
    parts.append(NETWORK)
    parts.append(_lock_table())
    return "".join(parts)


# --- table 5.4.1 ----------------------------------------------------------------------


def moving_joints(locks: tuple[int, int]) -> tuple[int, ...]:
    """The joints of the ring of the network, 1 to 8, that turn when two are locked."""
    alpha, *others = np.radians(TWISTS)
    rates = _rates(build_network(FOUR_BENNETT, np.sin(alpha), alpha, *others))  # (8, 3)
    held = rates[[joint - 1 for joint in locks]]
    motion = rates @ np.linalg.svd(held)[2][-1]
    return tuple(int(joint) + 1 for joint in np.flatnonzero(np.abs(motion) > MOVES))


def _rates(network: Network) -> np.ndarray:
    """Derivatives (8, 3) of the angles of the ring by those of the joints 1, 3 and 5,
    in a configuration of no symmetry."""
    states = np.array([1.0, -2.0, 0.7, 0.3])
    # the angle at joint 7 is less the sum of the others
    of_odd = np.vstack([np.eye(3), -np.ones(3)])
    of_states = [network.rates(total, states) for total in network.turns.values()]
    rates: np.ndarray = np.array(of_states) @ of_odd
    return rates


def lock_kind(locks: tuple[int, int]) -> str:
    """What the network becomes with two joints locked, by the rules of table 5.4.1."""
    first, second = locks
    distance = min(second - first, 8 - (second - first))
    is_odd = first % 2 == 1
    if distance == 1 or (distance == 2 and is_odd):
        return "generalized Goldberg 5R"
    if distance == 2:
        return "isomer of the generalized L-shape Goldberg 6R"
    if distance == 3:
        return "generalized variant of the L-shape Goldberg 6R"
    if is_odd:
        return "Waldron's hybrid 6R, no offset at joint 0"
    return "generalized Wohlhart double-Goldberg 6R"


def _lock_table() -> str:
    rows = ["| locked | the loop | joints that turn |", "|---|---|---|"]
    for locks in combinations(range(1, 9), 2):
        moving = " ".join(map(str, moving_joints(locks)))
        rows.append(f"| {locks[0]}/{locks[1]} | {lock_kind(locks)} | {moving} |")
    return "\n".join(rows) + "\n"


def _kinds(figures: list[SourceFigure]) -> str:
    counts = Counter(figure.kind for figure in figures)
    rows = ["| kind | figures | what is drawn |", "|---|---|---|"]
    for kind, text in KINDS.items():
        rows.append(f"| {kind} | {counts[kind]} | {text} |")
    return "\n".join(rows) + "\n\n"


def _agreements(figures: list[SourceFigure]) -> str:
    counts = Counter(figure.agreement for figure in figures)
    rows = ["| source | figures | meaning |", "|---|---|---|"]
    for agreement, text in AGREEMENTS.items():
        rows.append(f"| {agreement} | {counts[agreement]} | {text} |")
    return "\n".join(rows) + "\n\n"


def _table(source: str, title: str, figures: list[SourceFigure]) -> str:
    rows = [
        f"## {title}\n",
        f"`bifurc figure {source}-NUMBER --out DIR`; {len(figures)} figures.\n",
        "| figure | shows | kind | source | what differs, and why |",
        "|---|---|---|---|---|",
    ]
    for figure in figures:
        cells = (
            figure.name,
            figure.title,
            figure.kind,
            figure.agreement,
            figure.remark,
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows) + "\n\n"
