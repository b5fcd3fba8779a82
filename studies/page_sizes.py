"""How large are the pages of `bifurc view`, over the whole catalogue?

    python -m studies.page_sizes [--out out/pages] [--page]

Every linkage of the catalogue is mapped and its page made. The study prints, largest
first, the size of the page and what its document takes of it. With --out the pages are
written there, with --page the table is written as a page of the docs.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import click

from bifurc.tables import table
from linkages import load, map_linkage
from linkages.app.answer.verdict import judge
from linkages.app.options import FOLDER
from linkages.catalogue import catalogue
from linkages.viewing.document import make_view_document
from linkages.viewing.page import LARGEST, make_page, viewer_script
from studies.study import Study

PAGE = Path("docs/page_sizes.md")


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


def describe(sizes: Sequence[PageSize]) -> str:
    """A line for each page, the largest first, and what they have in common."""
    rows = []
    for size in sorted(sizes, key=lambda size: (-size.page, size.name)):
        page, document = f"{size.page / 1000:.0f}", f"{size.document / 1000:.0f}"
        rows.append((size.name, page, document, str(size.pieces)))
    heads = ("linkage", "page (kB)", "document (kB)", "pieces")
    script = len(viewer_script().encode("utf-8")) / 1000
    too_large = sum(1 for size in sizes if size.page > LARGEST)
    return (
        f"{table(heads, rows)}\n\n"
        f"The script takes {script:.0f} kB of each page. Of {len(sizes)} pages "
        f"{too_large} are above {LARGEST / 1000:.0f} kB."
    )


HEAD = """# Sizes of the pages of `bifurc view`

`python -m studies.page_sizes --page` writes this page: every linkage of the catalogue, with the size of its
[page](view.md), what its document takes of it, and the number of Taylor pieces in that.
"""


@click.command(cls=Study)
@click.option("--out", type=FOLDER)
@click.option("--page", is_flag=True, help="Write docs/page_sizes.md.")
def main(out: Path | None, page: bool) -> None:
    """Print the sizes of all pages."""
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    sizes = list(measure(catalogue(), out))
    text = describe(sizes)
    click.echo(text)
    slowest = max(sizes, key=lambda size: size.seconds)
    click.echo(f"The slowest took {slowest.seconds:.2f} s to make ({slowest.name}).")
    if page:
        PAGE.write_text(f"{HEAD}\n```text\n{text}\n```\n", encoding="utf-8")


if __name__ == "__main__":
    main()
