"""How large are the pages of `bifurc view`, over the whole catalogue?

    python -m studies.page_sizes [--out out/pages]

Every linkage of the catalogue is mapped and its page made. The study prints, largest
first, the size of the page, what its script and its curves take of it, and how long it
took to make. With --out the pages are written there.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import click

from linkages.app.texts import table
from linkages.app.verdict import judge
from linkages.catalogue import catalogue
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.viewing.document import make_view_document
from linkages.viewing.page import LARGEST, make_page, viewer_script

__all__ = ["PageSize", "measure"]


class PageSize(NamedTuple):
    """The page of a linkage: bytes of all of it and of its document, its curves' number
    of pieces, and the seconds that it took to make."""

    name: str
    page: int
    document: int
    pieces: int
    seconds: float


def measure(names: Iterable[str], out: Path | None = None) -> Iterator[PageSize]:
    """The sizes of the pages of some linkages; the pages are written to ``out``."""
    for name in names:
        atlas = map_linkage(load(name))
        start = time.perf_counter()
        document = make_view_document(atlas, judge(atlas).sentence)
        page = make_page(document)
        seconds = time.perf_counter() - start
        if out is not None:
            (out / f"{name}.html").write_text(page, encoding="utf-8")
        pieces = sum(len(form.branch.pieces) for form in atlas.forms)
        content = len(json.dumps(document))
        yield PageSize(name, len(page.encode("utf-8")), content, pieces, seconds)


@click.command()
@click.option("--out", type=click.Path(path_type=Path, file_okay=False))
def main(out: Path | None) -> None:
    """Print the sizes of all pages."""
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    sizes = sorted(measure(catalogue(), out), key=lambda size: -size.page)
    rows = []
    for name, page, document, pieces, seconds in sizes:
        cells = (f"{page:,}", f"{document:,}", str(pieces), f"{1000 * seconds:.0f}")
        rows.append((name, *cells))
    heads = ("linkage", "page (bytes)", "document (bytes)", "pieces", "made in (ms)")
    click.echo(table(heads, rows))
    script = len(viewer_script().encode("utf-8"))
    too_large = sum(1 for size in sizes if size.page > LARGEST)
    click.echo(f"\nThe script takes {script:,} bytes of each page.")
    click.echo(f"{len(sizes)} pages, {too_large} of them above {LARGEST:,} bytes.")


if __name__ == "__main__":
    main()
