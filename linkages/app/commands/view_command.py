"""The command `bifurc view`: the moving linkage beside its map, as a page."""

from __future__ import annotations

from pathlib import Path

import click

from linkages.app import options
from linkages.app.exit_codes import exit_code_table

PAGE = ".html"


@click.command("view", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.option(
    "--out",
    type=options.FILE,
    metavar="FILE.html",
    help="The page.  [default: NAME.html in this folder]",
)
@click.option("--no-open", is_flag=True, help="Write the page, but do not open it.")
@options.trace_option
@options.atlas_options
def view_command(
    source: str,
    out: Path | None,
    no_open: bool,
    trace: tuple[str, ...],
    choice: options.AtlasOptions,
) -> None:
    """Show a linkage in motion beside its transition map: one page, which a browser
    opens without a network.

    \b
    Examples:
      bifurc view special-double-subtractive-goldberg
      bifurc view my_linkage.toml --out my_linkage.html --no-open
      bifurc view out/atlas.nc
      bifurc view four-bennett-network --lock 2=40 --lock 6=-75
      bifurc view four-bar --trace 23:1,0.5
    """
    from linkages.app.answer.verdict import exit_by, judge
    from linkages.app.atlas_source import atlas_of
    from linkages.app.output import (
        require_ending,
        require_writable,
        writing_to,
    )
    from linkages.viewing.document import make_view_document
    from linkages.viewing.page import write_page

    path = out or Path(Path(source).stem + PAGE)
    require_ending("--out", path, PAGE)
    require_writable(path)
    atlas = atlas_of(source, choice)
    verdict = judge(atlas)
    document = make_view_document(atlas, verdict.sentence, trace)
    with writing_to(path):
        write_page(document, path)
    click.echo(f"wrote {path}", err=True)
    if not no_open:
        open_page(path)
    exit_by(verdict)


def open_page(path: Path) -> None:
    """Show a page in the browser; where there is none, say so."""
    import webbrowser

    if not webbrowser.open(path.resolve().as_uri()):
        click.echo(f"no browser was found; open {path} in one", err=True)
