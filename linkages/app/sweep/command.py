"""The command line of a sweep."""

from __future__ import annotations

import sys
from pathlib import Path

import click

__all__ = ["sweep_command"]


@click.command("sweep")
@click.argument("family")
@click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="NAME=FIRST:LAST:COUNT",
    help="Grid of a parameter, or NAME=VALUE for one value, or NAME=LOW:HIGH with --random; angles in degrees.",
)
@click.option(
    "--random",
    type=click.IntRange(1),
    help="Number of members drawn at random, in place of a grid.",
)
@click.option(
    "--out",
    default="sweep.zarr",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Zarr dataset to write.",
)
@click.option(
    "--atlases",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for every member's atlas.",
)
@click.option(
    "--workers",
    type=click.IntRange(1),
    help="Number of processes (all cores by default).",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Dask scheduler, for several machines: tcp://host:8786.",
)
@click.option(
    "--starts",
    default=200,
    show_default=True,
    help="Number of random starts of every member.",
)
@click.option(
    "--seed",
    default=0,
    show_default=True,
    help="Seed of the random starts and members.",
)
def sweep_command(
    family: str,
    parameters: tuple[str, ...],
    random: int | None,
    out: Path,
    atlases: Path | None,
    workers: int | None,
    scheduler: str | None,
    starts: int,
    seed: int,
) -> None:
    """Map many members of a family and write a summary of each over the grid of
    parameters.

    A journal beside the dataset (OUT.journal) keeps every finished member: the same
    command run again after an interruption, even a kill, goes on where it stopped.

    \b
    Examples:
      bifurc sweep double-subtractive-goldberg --param beta=10:170:36 --param gamma=10:60:11
      bifurc sweep bricard-line-symmetric-zero-offset --random 1000 --out bricard.zarr
      bifurc sweep bennett --random 5000 --scheduler tcp://127.0.0.1:8786
    """
    from linkages.app.sweep.journal import JournalError
    from linkages.app.sweep.plan import read_plan
    from linkages.app.sweep.run import run_sweep
    from linkages.app.sweep.store import count_status

    plan = read_plan(family, parameters, random or 0, starts, seed)
    try:
        with click.progressbar(
            length=plan.size, label=f"{plan.size} members", file=sys.stderr
        ) as bar:
            run_sweep(
                plan,
                out,
                workers=workers,
                scheduler=scheduler,
                atlases=atlases,
                progress=bar.update,
            )
    except JournalError as error:
        raise click.ClickException(str(error)) from None
    except ModuleNotFoundError as error:
        raise click.ClickException(f"{error}; install bifurc[sweep]") from None
    except KeyboardInterrupt:
        click.echo(
            f"interrupted; run the same command again to go on ({out})", err=True
        )
        raise
    counts = ", ".join(
        f"{count} {name.lower()}" for name, count in count_status(out).items()
    )
    click.echo(f"{out}: {counts}")
