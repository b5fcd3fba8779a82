"""The command `bifurc tolerance`; what it shows is made in `linkages.app.tolerance`."""

from __future__ import annotations

from pathlib import Path

import click

__all__ = ["tolerance_command"]


@click.command("tolerance")
@click.argument("linkage", metavar="NAME|FILE.toml")
@click.option(
    "--error", default=1e-4, show_default=True, help="Standard deviation of the errors."
)
@click.option(
    "--samples",
    default=4,
    type=click.IntRange(min=1),
    show_default=True,
    help="Copies that are made.",
)
@click.option(
    "--seed",
    default=0,
    type=click.IntRange(min=0),
    show_default=True,
    help="Number of the first copy.",
)
@click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="KEY=VALUE",
    help="As for `bifurc map`.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for tolerance.txt and .png.",
)
def tolerance_command(
    linkage: str,
    error: float,
    samples: int,
    seed: int,
    parameters: tuple[str, ...],
    out: Path | None,
) -> None:
    """Show what manufacturing errors make of the forms and bifurcations of a linkage.

    \b
    Example:
      bifurc tolerance special-double-subtractive-goldberg --error 1e-4 --out out
    """
    from linkages.app.choice import choose_linkage
    from linkages.app.status import compilation_announced
    from linkages.app.tolerance import climb, describe, measure
    from linkages.mapping import map_linkage

    chosen = choose_linkage(linkage, parameters)
    with compilation_announced():
        atlas = map_linkage(chosen)
    seeds = range(seed, seed + samples)
    copies = [measure(atlas, chosen.loop, error, number) for number in seeds]
    ladder = climb(atlas, chosen.loop, seeds)
    text = describe(atlas, copies, ladder)
    click.echo(text)
    if out is not None:
        from bifurc.files.atomic import replace_files
        from linkages.app.tolerance_figure import draw_tolerance

        figure = draw_tolerance(atlas, copies[0], ladder)

        def write(stage: Path) -> None:
            (stage / "tolerance.txt").write_text(text + "\n", encoding="utf-8")
            figure.savefig(stage / "tolerance.png", dpi=150)

        out.mkdir(parents=True, exist_ok=True)
        replace_files(out, write)
        click.echo(f"wrote tolerance.txt and tolerance.png to {out}", err=True)
