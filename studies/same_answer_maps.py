"""Maps of one process of the study `studies.same_answer`, held against reference maps.

    python -m studies.same_answer_maps REFERENCE [NAME ...] [--seeds N] [--draws N]

The process before it decides which kernels of OpenBLAS are used
(``OPENBLAS_CORETYPE``). One JSON line is printed for every map.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import click

from bifurc import explore
from linkages import load_linkage, map_linkage
from linkages.app.answer.document import Document, make_document
from linkages.app.options import NamedPath
from linkages.catalogue import catalogue
from linkages.labelling import name_atlas
from studies.document_differences import differences
from studies.noisy_loop import noisy_closure
from studies.study import Study


@dataclass(frozen=True)
class Comparison:
    """What differs (``lines``) between a map and the reference map of a ``linkage``.

    ``seed`` is that of the random starts, ``draw`` that of the rounding noise, -1 for
    no noise.
    """

    linkage: str
    seed: int
    draw: int
    seconds: float
    lines: list[str]


def map_document(name: str, seed: int) -> Document:
    """The document of the map of a linkage of the catalogue."""
    return make_document(map_linkage(load_linkage(name), seed=seed))


def noisy_document(name: str, draw: int) -> Document:
    """The document of its map seen through rounding noise; ``draw`` is also the seed of
    the random starts."""
    linkage = load_linkage(name)
    atlas = explore(noisy_closure(linkage.loop, draw), seed=draw)
    return make_document(name_atlas(atlas, linkage))


def compare_maps(
    name: str, reference: Document, seeds: int, draws: int
) -> Iterator[Comparison]:
    """The maps of a linkage with so many seeds and draws of noise, against a reference
    map."""
    for seed in range(seeds):
        began = time.perf_counter()
        lines = differences(reference, map_document(name, seed))
        yield Comparison(name, seed, -1, time.perf_counter() - began, lines)
    for draw in range(draws):
        began = time.perf_counter()
        lines = differences(reference, noisy_document(name, draw))
        yield Comparison(name, draw, draw, time.perf_counter() - began, lines)


@click.command(cls=Study, help=__doc__)
@click.argument("reference", type=NamedPath())
@click.argument("names", nargs=-1)
@click.option("--seeds", type=int, default=10)
@click.option("--draws", type=int, default=0)
@click.option("--write", is_flag=True, help="Write the reference.")
def main(
    reference: Path, names: tuple[str, ...], seeds: int, draws: int, write: bool
) -> None:
    """Write the reference, or print one JSON line for every map."""
    names = names or tuple(catalogue())
    if write:
        documents = {name: map_document(name, 0) for name in names}
        reference.write_text(json.dumps(documents), encoding="utf-8")
        return
    documents = json.loads(reference.read_text(encoding="utf-8"))
    for name in names:
        for comparison in compare_maps(name, documents[name], seeds, draws):
            click.echo(json.dumps(asdict(comparison)))


if __name__ == "__main__":
    main()
