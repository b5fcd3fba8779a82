"""Write the pages of the docs that come out of the code anew.

    python -m studies.pages [NAME ...]

Tests compare what stands on them with what the code says. The pages of
``studies.margins --page`` and ``studies.page_sizes --page`` take minutes, and hang on
more than the catalogue: they have commands of their own.
"""

from collections.abc import Callable
from pathlib import Path

import click

from studies.errata_page import errata_page
from studies.figures_page import figures_page
from studies.negative_controls import controls_page
from studies.results_page import results_page
from studies.study import Study

DOCS = Path(__file__).parents[1] / "docs"
PAGES: dict[str, Callable[[], str]] = {
    "errata": errata_page,
    "figures": figures_page,
    "negative_controls": controls_page,
    "results": results_page,
}


@click.command(
    cls=Study, help="Write pages of the docs that come out of the code anew."
)
@click.argument("names", nargs=-1, type=click.Choice(list(PAGES)))
def main(names: tuple[str, ...]) -> None:
    """Write the pages named; all without names."""
    for name in names or PAGES:
        target = DOCS / f"{name}.md"
        target.write_text(PAGES[name](), encoding="utf-8")
        click.echo(f"wrote {target}")


if __name__ == "__main__":
    main()
