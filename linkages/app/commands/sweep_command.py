"""The command `bifurc sweep`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from linkages.app import options
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table

MOST_MEMBERS = 1_000_000_000
MOST_WORKERS = 10_000


@click.command("sweep", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml")
@click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="NAME=FIRST:LAST:COUNT",
    help=(
        "Grid of a parameter, or of a constant of equations, or NAME=VALUE for one "
        "value, or NAME=LOW:HIGH with --random; angles of linkages in degrees."
    ),
)
@click.option(
    "--lock",
    "locks",
    multiple=True,
    metavar="JOINT=FIRST:LAST:COUNT",
    help=(
        "Grid of values at which a joint of a mechanism or a network is held, or "
        "JOINT=VALUE, or JOINT=LOW:HIGH with --random; in the units of `bifurc map`."
    ),
)
@options.HOLD_OPTIONS["is_without_centre"]
@click.option(
    "--random",
    type=click.IntRange(1, MOST_MEMBERS),
    help="Number of members drawn at random, in place of a grid.",
)
@click.option(
    "--out",
    default="sweep.zarr",
    show_default=True,
    type=options.NamedPath(),
    help="Zarr dataset to write.",
)
@click.option(
    "--atlases",
    type=options.FOLDER,
    help="Folder for every member's atlas.",
)
@click.option(
    "--workers",
    type=click.IntRange(1, MOST_WORKERS),
    help="Number of processes (all cores by default).",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Dask scheduler, for several machines: tcp://host:8786.",
)
@options.starts_option("Number of random starts of every member.")
@options.seed_option("Seed of the random starts and members.")
def sweep_command(
    source: str,
    parameters: tuple[str, ...],
    locks: tuple[str, ...],
    is_without_centre: bool,
    random: int | None,
    out: Path,
    atlases: Path | None,
    workers: int | None,
    scheduler: str | None,
    starts: int,
    seed: int,
) -> None:
    """Map many members of a family or a network, a mechanism with joints held at many
    values, or equations with many values of their constants, and write a summary of each
    over the grid.

    A journal beside the dataset (OUT.journal) keeps every finished member: the same
    command run again after an interruption, even a kill, goes on where it stopped.

    \b
    Examples:
      bifurc sweep double-subtractive-goldberg --param beta=10:170:36 --param gamma=10:60:11
      bifurc sweep bricard-line-symmetric-zero-offset --random 1000 --out bricard.zarr
      bifurc sweep bennett --random 5000 --scheduler tcp://127.0.0.1:8786
      bifurc sweep four-bennett-network --lock 2=40 --lock 6=-170:170:35
      bifurc sweep five_bar.toml --lock A=-180:175:72
      bifurc sweep reaction.toml --param B=5:20:61
    """
    from bifurc.tables import count_of
    from linkages.app.sweep.plan import read_plan

    plan = read_plan(
        source,
        parameters,
        random or 0,
        starts,
        seed,
        locks=locks,
        is_without_centre=is_without_centre,
    )
    try:
        from linkages.app.sweep.run import prepare_sweep
        from linkages.app.sweep.store import count_status

        with prepare_sweep(
            plan, out, workers=workers, scheduler=scheduler, atlases=atlases
        ) as sweep:
            label = count_of(plan.size, "member")
            with click.progressbar(
                length=plan.size, label=label, file=sys.stderr
            ) as bar:
                sweep.run(bar.update)
    except ModuleNotFoundError as error:
        raise CommandError(f"{error}; install bifurc[sweep]") from None
    except KeyboardInterrupt:
        text = f"interrupted; run the same command again to go on ({out})"
        click.echo(text, err=True)
        click.get_current_context().exit(ExitCode.INTERRUPTED)
    _report(out, count_status(out))


def _report(out: Path, counts: dict[str, int]) -> None:
    """Say how many members have which status; a failure has its own exit code."""
    from linkages.app.output import say
    from linkages.app.sweep.member import Status

    shown = ", ".join(f"{count} {name.lower()}" for name, count in counts.items())
    say(f"{out}: {shown}")
    if Status.FAILED.name in counts:
        click.get_current_context().exit(ExitCode.DOES_NOT_HOLD)
