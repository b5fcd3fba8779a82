"""How the linkages of the catalogue are related, as a graph.

"special case of" and "same linkage as" hold up to `linkages.identification.equivalence`
and are checked by `linkages.identification.identify` on random members; where no source
states them, that is where they come from. Of the special cases only the nearest are
listed: the others follow along the graph.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import networkx as nx

from linkages.catalogue import catalogue

__all__ = ["RELATIONS", "Relation", "RelationKind", "relation_graph", "relations_of"]


class RelationKind(Enum):
    """What the first linkage of a relation is to the second."""

    SPECIAL_CASE = "special case of"
    SAME = "same linkage as"
    ISOMER = "isomer of"
    DEGENERATE = "degenerates to"
    CONSTRUCTED = "constructed from"


@dataclass(frozen=True)
class Relation:
    """``first`` is ``kind`` ``second``, both names of the catalogue; ``detail`` says
    how, ``source`` who says so.

    ``joint`` (from 1) of the second is where its links are exchanged for an isomer;
    ``vanishing`` is the parameter of the first that goes to 0 for a degenerate case.
    """

    first: str
    kind: RelationKind
    second: str
    source: str
    detail: str = ""
    joint: int = 0
    vanishing: str = ""


FOUND = "found by identification"
TORI_5R = tuple(name for name in catalogue() if name.startswith("torus-5r"))


def _special(source: str, general: str, *names: str) -> list[Relation]:
    return [
        Relation(name, RelationKind.SPECIAL_CASE, general, source) for name in names
    ]


def _same(source: str, first: str, *names: str) -> list[Relation]:
    return [Relation(name, RelationKind.SAME, first, source) for name in names]


def _built(source: str, detail: str, base: str, *names: str) -> list[Relation]:
    return [
        Relation(name, RelationKind.CONSTRUCTED, base, source, detail) for name in names
    ]


_SPECIAL = [
    *_special("Hunt (1990)", "four-bar", "parallelogram", "kite"),
    *_special("Hunt (1990)", "parallelogram", "rhombus"),
    *_special("Hunt (1990)", "kite", "rhombus"),
    *_special(
        "Song (2013), eq. 2.3.3",
        "generalized-goldberg-5r",
        "goldberg-5r",
        "subtractive-goldberg-5r",
    ),
    *_special(
        "Bil and Budniak (2015), geometry; " + FOUND,
        "generalized-goldberg-5r",
        *TORI_5R,
    ),
    *_special("Baker (1979)", "goldberg-5r", "myard-asymmetric-5r"),
    *_special("Chen and You (2008a)", "extended-myard-5r", "myard-plane-symmetric-5r"),
    *_special(FOUND, "generalized-goldberg-5r", "extended-myard-5r"),
    *_special(
        "Goldberg (1943)", "generalized-serial-goldberg-6r", "serial-goldberg-6r"
    ),
    *_special(
        "Goldberg (1943)", "generalized-l-shape-goldberg-6r", "l-shape-goldberg-6r"
    ),
    *_special(
        FOUND,
        "generalized-l-shape-goldberg-6r",
        "syncopated-l-shape-goldberg-6r",
        "double-subtractive-goldberg-type-vi",
    ),
    *_special(
        "Song and Chen (2012)",
        "wohlhart-double-goldberg",
        "special-wohlhart-double-goldberg",
    ),
    *_special(
        "Song (2013), section 5.2",
        "double-subtractive-goldberg",
        "special-double-subtractive-goldberg",
    ),
    *_special(
        "Wohlhart (1991a)",
        "generalized-double-goldberg",
        "wohlhart-double-goldberg",
        "double-subtractive-goldberg",
        "mixed-double-goldberg-type-i",
    ),
    *_special(
        "Song (2013), section 2.4.6",
        "mavroidis-roth-opposite",
        "wohlhart-double-goldberg",
        "double-subtractive-goldberg",
    ),
    *_special(
        FOUND,
        "mavroidis-roth-reflected",
        "wohlhart-double-goldberg",
        "double-subtractive-goldberg",
    ),
    *_special(
        FOUND, "back-to-back-double-goldberg-sum", "special-wohlhart-double-goldberg"
    ),
    *_special(
        FOUND,
        "back-to-back-double-goldberg-difference",
        "special-double-subtractive-goldberg",
    ),
    *_special(
        "Mavroidis and Roth (1995)",
        "mavroidis-roth-opposite",
        "back-to-back-double-goldberg-sum",
        "back-to-back-double-goldberg-difference",
    ),
    *_special(
        "Mavroidis and Roth (1995)",
        "exchanged-mavroidis-roth-reflected",
        "isomerized-back-to-back-double-goldberg-sum",
        "isomerized-back-to-back-double-goldberg-difference",
    ),
    *_special(
        "Dietmaier (1995b)",
        "dietmaier",
        "mavroidis-roth-reflected",
        "exchanged-mavroidis-roth-reflected",
    ),
    *_special(FOUND, "bricard-line-symmetric", "exchanged-mavroidis-roth-opposite"),
    *_special("Yu and Baker (1981)", "waldron-hybrid", "waldron-collinear"),
    *_special(
        "Song (2013), section 3.4", "waldron-collinear", "mixed-double-goldberg-type-v"
    ),
    *_special(
        FOUND,
        "waldron-hybrid",
        "double-goldberg-type-v",
        "double-subtractive-goldberg-type-v",
    ),
    *_special("Yu and Baker (1981)", "yu-baker-two-ratios", "yu-baker"),
    *_special(
        "Song (2013), section 4.4",
        "bricard-line-symmetric",
        "bricard-line-symmetric-zero-offset",
        "bricard-octahedral-line-symmetric",
    ),
    *_special(
        "Song (2013), section 5.3",
        "bricard-line-symmetric",
        "reconfigurable-bricard-1",
        "reconfigurable-bricard-2",
    ),
    *_special("Baker (1993b)", "bricard-line-symmetric-zero-offset", "altmann"),
    *_special(FOUND, "bricard-trihedral", "altmann"),
    *_special(FOUND, "bricard-trihedral-equal-twists", "altmann"),
    *_special(FOUND, "bricard-plane-symmetric", "wohlhart-symmetric"),
    *_special(FOUND, "wohlhart-hybrid", "wohlhart-symmetric"),
]

_SAME = [
    *_same(
        "Song (2013), section 2.2",
        "bennett",
        "bennett-ab-2",
        "bennett-line-symmetric",
        "bennett-lb-2",
    ),
    *_same("Bil (2012); closed form of the companion torus", "bennett", "torus-4r"),
    *_same("Baker (1979)", "goldberg-5r", "syncopated-goldberg-5r"),
    *_same(
        "Song (2013), table 3.5.3", "wohlhart-double-goldberg", "double-goldberg-type-i"
    ),
    *_same(
        "Song (2013), table 3.5.3",
        "double-subtractive-goldberg",
        "double-subtractive-goldberg-type-i",
    ),
    *_same(
        "Song (2013), table 3.5.2",
        "l-shape-goldberg-variant-6r",
        "double-goldberg-type-ii",
    ),
    *_same(
        "Song (2013), table 3.5.2",
        "serial-goldberg-variant-6r",
        "double-goldberg-type-iv",
    ),
    *_same(FOUND, "l-shape-goldberg-6r", "double-goldberg-type-vi"),
    *_same(FOUND, "syncopated-l-shape-goldberg-6r", "mixed-double-goldberg-type-vi"),
    *_same(FOUND, "mavroidis-roth-opposite", "mavroidis-roth-negative"),
    *_same(
        FOUND, "exchanged-mavroidis-roth-opposite", "exchanged-mavroidis-roth-negative"
    ),
    *_same(FOUND, "bricard-line-symmetric", "bricard-line-symmetric-revised"),
    *_same(
        "Mavroidis and Roth (1995)",
        "bricard-plane-symmetric",
        "bricard-plane-symmetric-revised",
    ),
]

_CONSTRUCTED = [
    *_built("Goldberg (1943)", "summation of two loops", "bennett", "goldberg-5r"),
    *_built(
        "Song and Chen (2011)",
        "subtraction of two loops",
        "bennett",
        "subtractive-goldberg-5r",
    ),
    *_built(
        "Wohlhart (1991a)",
        "two loops, links locked at a kink angle",
        "bennett",
        "generalized-goldberg-5r",
    ),
    *_built(
        "Goldberg (1943)", "a third loop in line", "goldberg-5r", "serial-goldberg-6r"
    ),
    *_built(
        "Goldberg (1943)", "a third loop across", "goldberg-5r", "l-shape-goldberg-6r"
    ),
    *_built(
        "Wohlhart (1991a)",
        "common link pair of two",
        "goldberg-5r",
        "wohlhart-double-goldberg",
    ),
    *_built(
        "Song (2013), table 3.3.1",
        "common link pair of two",
        "subtractive-goldberg-5r",
        "double-subtractive-goldberg",
    ),
    *_built(
        "Song (2013), table 3.3.1",
        "common link pair or common Bennett loop, with a subtractive one",
        "goldberg-5r",
        *(
            f"mixed-double-goldberg-type-{k}"
            for k in ("i", "ii", "iii", "iv", "v", "vi")
        ),
    ),
    *_built(
        "Song (2013), table 3.5.3",
        "common link pair or common Bennett loop of two",
        "goldberg-5r",
        *(f"double-goldberg-type-{k}" for k in ("iii", "v")),
    ),
    *_built(
        "Song (2013), table 3.5.3",
        "common link pair or common Bennett loop of two",
        "subtractive-goldberg-5r",
        *(
            f"double-subtractive-goldberg-type-{k}"
            for k in ("ii", "iii", "iv", "v", "vi")
        ),
    ),
    *_built(
        "Wohlhart (1991a)",
        "common link pair of two",
        "generalized-goldberg-5r",
        "generalized-double-goldberg",
    ),
    *_built(
        "Chen and You (2007)",
        "two on the link pair b, d",
        "goldberg-5r",
        "back-to-back-double-goldberg-sum",
    ),
    *_built(
        "Waldron (1968)", "two loops on a common axis", "bennett", "waldron-hybrid"
    ),
    *_built(
        "Yu and Baker (1981)",
        "taken from a primary Bennett loop",
        "waldron-collinear",
        "yu-baker-two-ratios",
    ),
    *_built(
        "Song (2013), section 5.3",
        "a spatial triangle on opposite links",
        "bennett",
        "reconfigurable-bricard-1",
        "reconfigurable-bricard-2",
    ),
    *_built("Bil and Budniak (2015)", "two pairs of tori", "torus-4r", *TORI_5R),
]

_DEGENERATE = [
    Relation(
        first,
        RelationKind.DEGENERATE,
        second,
        "Goldberg (1943)",
        f"{twist} to 0: its link vanishes",
        0,
        twist,
    )
    for first, second, twist in (
        ("goldberg-5r", "bennett", "gamma"),
        ("serial-goldberg-6r", "goldberg-5r", "delta"),
        ("l-shape-goldberg-6r", "goldberg-5r", "delta"),
    )
]

_ISOMERS = [
    Relation(
        first,
        RelationKind.ISOMER,
        second,
        source,
        f"links at joint {joint} exchanged",
        joint,
    )
    for first, second, joint, source in (
        (
            "exchanged-mavroidis-roth-opposite",
            "mavroidis-roth-opposite",
            4,
            "Wohlhart (1991b)",
        ),
        (
            "exchanged-mavroidis-roth-reflected",
            "mavroidis-roth-reflected",
            4,
            "Wohlhart (1991b)",
        ),
        (
            "isomerized-back-to-back-double-goldberg-sum",
            "special-wohlhart-double-goldberg",
            3,
            FOUND,
        ),
        (
            "isomerized-back-to-back-double-goldberg-difference",
            "special-double-subtractive-goldberg",
            3,
            FOUND,
        ),
        ("bricard-line-symmetric-zero-offset", "wohlhart-double-goldberg", 3, FOUND),
        ("bricard-line-symmetric-zero-offset", "double-subtractive-goldberg", 3, FOUND),
    )
]

RELATIONS: tuple[Relation, ...] = (
    *_SPECIAL,
    *_SAME,
    *_ISOMERS,
    *_DEGENERATE,
    *_CONSTRUCTED,
)


def relation_graph() -> nx.MultiDiGraph:
    """Every linkage as a node with its ``title``, every relation as an edge from the
    first to the second.

    Edges are keyed by the words of their kind and hold ``kind`` (`RelationKind`),
    ``source`` and ``detail``.
    """
    graph = nx.MultiDiGraph()
    for name, found in catalogue().items():
        graph.add_node(name, title=found.title)
    for r in RELATIONS:
        graph.add_edge(
            r.first,
            r.second,
            r.kind.value,
            kind=r.kind,
            source=r.source,
            detail=r.detail,
        )
    return graph


def relations_of(name: str) -> tuple[Relation, ...]:
    """The relations whose first linkage is ``name``, and those that make it the same as
    another."""
    return tuple(
        r
        for r in RELATIONS
        if r.first == name or (r.kind is RelationKind.SAME and r.second == name)
    )
