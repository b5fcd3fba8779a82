"""The command `bifurc map`: explore, report, write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bifurc.limits import Deadline, HeldInterrupt
from linkages.app import options
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from linkages.app.files import FigureAxes
    from linkages.entry import Linkage
    from linkages.mechanisms.mechanism import Mechanism


@click.command("map", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.out_option("dataset, graph, summary, figures and the page map.html")
@options.json_option("; angles in radians")
@options.no_certify_option
@click.option(
    "--nearest",
    is_flag=True,
    help=(
        "Map the exact linkage of the catalogue that a rounded or misprinted table is "
        "meant to be."
    ),
)
@click.option(
    "--digits",
    type=click.IntRange(20, 1000),
    help=(
        "Find every singular point again in arithmetic of so many digits, "
        "and show how many of the map's agree."
    ),
)
@click.option(
    "--axes",
    type=options.JointWords(2, 3),
    metavar="I,J[,K]",
    help=(
        "Draw the transition map over these two or three joints, by their names or "
        "numbers; needs --out."
    ),
)
@click.option(
    "--against",
    type=options.JointWords(1, 1),
    metavar="I",
    help="Draw the singular values against this joint; needs --out.",
)
@click.option(
    "--range",
    "window",
    type=options.Pair(":", "0:360"),
    metavar="LOW:HIGH",
    help="The first and the last angle in the figures, degrees.  [default: -180:180]",
)
@click.option(
    "--overlay",
    type=options.FILE,
    metavar="FILE.csv",
    help=(
        "Lay points over the figures: a column of degrees (lengths in the file's unit) "
        "for each of some joints, with their names in the first line; needs --out."
    ),
)
@options.proof_options
@options.trace_option
@options.figure_options
@options.atlas_options
def map_command(
    linkage: str,
    out: Path | None,
    as_json: bool,
    no_certify: bool,
    nearest: bool,
    digits: int | None,
    proof: options.ProofOptions,
    axes: tuple[str, ...] | None,
    against: tuple[str, ...] | None,
    window: tuple[float, float] | None,
    overlay: Path | None,
    trace: tuple[str, ...],
    figures: options.FigureOptions,
    choice: options.AtlasOptions,
) -> None:
    """Map every motion form of a linkage, every bifurcation, and the graph between
    them.

    \b
    Examples:
      bifurc map bennett --param alpha=70 --param beta=30
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map bricard-line-symmetric --out out --axes 1,5 --against 1
      bifurc map bennett --out out --format pdf --size 3.4x2.6 --range 0:360
      bifurc map four-bar --out out --trace 23:1,0.5
      bifurc map my_linkage.toml --json > map.json
      bifurc map printed_table.csv --nearest --out out
      bifurc map five_bar.toml --lock J1=40
      bifurc map slider_crank.toml --out out --axes J1,J4
      bifurc map four-bennett-network --lock 2=40 --lock 6=-75
      bifurc map special-double-subtractive-goldberg --digits 50
      bifurc map special-double-subtractive-goldberg --certificate map.json.gz
    """
    from linkages.app.atlas_source import explore_parts
    from linkages.app.files import figure_axes
    from linkages.app.output import require_out

    require_out(out)
    for option in [*proof.names, *["--digits"] * bool(digits)]:
        require_exact(option, as_json, nearest, choice.hold)
    deadline = Deadline(choice.search.budget)
    mechanism, exact = choose_mapped(linkage, choice, nearest, deadline)
    require_proof(proof, linkage, mechanism)
    parts = mechanism.parts
    over = [figure_axes(part, axes, against, window, overlay, trace) for part in parts]
    folders = folders_of(out, len(parts))
    # Ctrl-C ends the search, but not before what was found is shown and written
    with HeldInterrupt():
        search = replace(choice.search, certify=not no_certify)
        atlases = explore_parts(parts, search, deadline)
        paths = report_and_write(atlases, folders, as_json, choice.verbose, exact)
    if digits:
        confirm(atlases, linkage, choice.parameters, digits)
    least = prove(atlases[0], linkage, choice, proof)
    write_all_pictures(atlases, folders, paths, over, figures)
    steps = [] if as_json else steps_after(atlases, linkage, choice, nearest, out)
    end(atlases, as_json, steps, least)


def report_and_write(
    atlases: Sequence[Atlas],
    folders: Sequence[Path | None],
    as_json: bool,
    is_whole: bool,
    exact: str,
) -> list[list[Path]]:
    """Print the maps, and write the numbers of each into its folder: the paths of the
    files."""
    paths = []
    try:
        report(atlases, as_json, is_whole)
    finally:  # where nothing can be shown, there are still the files
        for atlas, folder in zip(atlases, folders, strict=True):
            paths.append(write_numbers(atlas, folder, exact))
    return paths


def require_proof(
    proof: options.ProofOptions, name: str, mechanism: Linkage | Mechanism
) -> None:
    """Raise `CommandError` where a proof is asked for that there is not, or a file that
    cannot be written."""
    if not proof.names:
        return
    from linkages.app.output import require_ending, require_writable
    from linkages.app.reports.proof import require_provable
    from linkages.subject import as_subject

    require_provable(name, as_subject(mechanism))
    if proof.certificate is not None:
        require_ending("--certificate", proof.certificate, ".json", ".json.gz")
        require_writable(proof.certificate, "--certificate")


def prove(
    atlas: Atlas,
    linkage: str,
    choice: options.AtlasOptions,
    proof: options.ProofOptions,
) -> ExitCode:
    """With what the command ends at least: whether all of a map is proved, in what is
    left of the budget, if that is asked for."""
    if not proof.names:
        return ExitCode.DONE
    from linkages.app.reports.proof import prove_map

    seconds = choice.search.budget - atlas.provenance.seconds
    holds = prove_map(atlas, linkage, choice.parameters, proof.certificate, seconds)
    return ExitCode.DONE if holds else ExitCode.DOES_NOT_HOLD


def write_all_pictures(
    atlases: Sequence[Atlas],
    folders: Sequence[Path | None],
    written: Sequence[Sequence[Path]],
    over: Sequence[FigureAxes],
    look: options.FigureOptions,
) -> None:
    """Write the figures and the page of every map into its folder, if there is one, and
    say what is in it besides the files ``written`` before."""
    from linkages.app.output import say_written

    for k, folder in enumerate(folders):
        if folder is not None:
            pictures = write_pictures(atlases[k], folder, over[k], look)
            say_written([*written[k], *pictures], folder)


def confirm(
    atlases: Sequence[Atlas], linkage: str, parameters: Sequence[str], digits: int
) -> None:
    """Print how many of the maps' digits agree with those of so many; of several maps
    with their names."""
    from linkages.app.output import say
    from linkages.app.reports.confirmation import describe_confirmation
    from linkages.subject import subject_at

    for atlas in atlases:
        if len(atlases) > 1:
            say("\n" + subject_at(atlas).name)
        say("\n" + describe_confirmation(atlas, linkage, parameters, digits))


def folders_of(out: Path | None, count: int) -> list[Path | None]:
    """The folder for each of the mechanisms of a file: ``out``, or one in it each where
    they are several; files can be written to each."""
    from linkages.app.output import require_folder

    folders = [out] * count
    if out is not None and count > 1:
        folders = [out / f"part-{number}" for number in range(1, count + 1)]
    for folder in folders:
        require_folder(folder)
    return folders


def require_exact(
    option: str, as_json: bool, nearest: bool, hold: options.HoldOptions
) -> None:
    """Raise `CommandError` for what does not go with an option that takes the numbers of
    a linkage in many digits."""
    if as_json:
        raise CommandError(
            f"{option}: it has no place in the JSON document; leave out --json"
        )
    if hold.is_without_centre:
        raise CommandError(f"{option}: it does not go with --without-centre")
    if hold.is_modified:
        raise CommandError(f"{option}: it does not go with --modified-dh")
    if nearest:
        raise CommandError(f"{option}: it does not go with --nearest")


def choose_mapped(
    linkage: str, choice: options.AtlasOptions, nearest: bool, deadline: Deadline
) -> tuple[Linkage | Mechanism, str]:
    """What is mapped, and the text of a file with its exact table where it is the
    ``nearest`` linkage to the one that was named."""
    from linkages.app.choice import choose_in_time

    mechanism = choose_in_time(linkage, choice, deadline)
    if not nearest:
        return mechanism, ""
    from linkages.app.nearest import nearest_linkage
    from linkages.subject import as_subject

    meant = nearest_linkage(as_subject(mechanism).as_loop())
    click.echo(meant.words, err=True)
    return meant.linkage, meant.toml


def steps_after(
    atlases: Sequence[Atlas],
    linkage: str,
    choice: options.AtlasOptions,
    nearest: bool,
    out: Path | None,
) -> list[str]:
    """What can be done next with a linkage; nothing is said of several."""
    if len(atlases) > 1:
        return []
    from linkages.app.texts.next_steps import next_steps, next_steps_of_nearest

    if nearest:
        return next_steps_of_nearest(atlases[0], linkage, choice, out)
    return next_steps(atlases[0], linkage, choice, out is not None)


def end(
    atlases: Sequence[Atlas], as_json: bool, steps: Sequence[str], least: ExitCode
) -> None:
    """End the command with the largest exit code of all verdicts, and the ``least`` one,
    after what can be done next, ``steps``, or the verdicts where a document does not say
    them."""
    from linkages.app.answer.verdict import judge
    from linkages.app.output import say_next

    verdicts = [judge(atlas) for atlas in atlases]
    say_next(*steps)
    for verdict in verdicts:
        if as_json and verdict.code is not ExitCode.DONE:
            click.echo(verdict.sentence, err=True)
    click.get_current_context().exit(
        max(least, *(verdict.code for verdict in verdicts))
    )


def report(atlases: Sequence[Atlas], as_json: bool, is_whole: bool) -> None:
    """Print the maps of all mechanisms of a file, as tables or as one JSON document, of
    several one with "parts"."""
    from linkages.app.answer.document import make_document
    from linkages.app.output import say, say_json

    if not as_json:
        from linkages.app.texts.summary import make_screen, make_summary

        make = make_summary if is_whole else make_screen
        say("\n\n\n".join(make(atlas) for atlas in atlases))
        return
    documents = [make_document(atlas) for atlas in atlases]
    say_json(documents[0] if len(documents) == 1 else {"parts": documents})


def write_numbers(atlas: Atlas, out: Path | None, exact: str = "") -> list[Path]:
    """The paths of dataset, graph and summary, and of the ``exact`` table if it is no
    empty text, just written to ``out`` if there is one."""
    if out is None:
        return []
    from linkages.app.files import write_data
    from linkages.app.output import writing_to
    from linkages.app.texts.summary import make_summary
    from linkages.subject import subject_at

    with writing_to(out):
        subject = subject_at(atlas)
        more, others = subject.dataset_variables(atlas), dict(subject.files())
        if exact:
            from linkages.app.texts.next_steps import EXACT

            others[EXACT] = lambda path: path.write_text(exact, encoding="utf-8")
        return write_data(atlas, out, make_summary(atlas), more, others)


def write_pictures(
    atlas: Atlas, out: Path, over: FigureAxes, look: options.FigureOptions
) -> list[Path]:
    """The paths of the figures, and of the page that `bifurc view` makes, just written
    to ``out``."""
    from linkages.app.answer.verdict import judge
    from linkages.app.files import write_figures
    from linkages.app.output import writing_to
    from linkages.viewing.document import make_view_document
    from linkages.viewing.page import write_page

    with writing_to(out):
        figures = write_figures(atlas, out, over, look)
        document = make_view_document(atlas, judge(atlas).sentence, over.trace)
        return [*figures, write_page(document, out / "map.html")]
