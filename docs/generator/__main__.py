"""The steps of `make docs` that are not Sphinx's.

python -m docs.generator sources    # gather all pages in build/docs
python -m docs.generator links      # look for dead links in out/site
"""

from __future__ import annotations

import click

from docs.generator.links import dead_links, fetched_from_afar
from docs.generator.places import SITE
from docs.generator.sources import gather_sources


@click.group()
def main() -> None:
    """Make the pages of the site."""


@main.command("sources")
def sources() -> None:
    """Gather all pages, and map every linkage that has changed."""
    gather_sources()


@main.command("links")
def links() -> None:
    """Look for links of the built site that lead nowhere, and for what its pages would
    fetch from other hosts; exit code 1 with any."""
    dead = dead_links(SITE) + fetched_from_afar(SITE)
    for link in dead:
        click.echo(link, err=True)
    if dead:
        raise SystemExit(1)
    click.echo("no dead links, nothing fetched from other hosts")


if __name__ == "__main__":
    main()
