"""The atlas that a command line names: a saved one, or that of a linkage."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.limits import Deadline, until
from linkages.app.answer.verdict import judge
from linkages.app.choice import choose_held, choose_in_time, require_table
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.options import AtlasOptions, SearchOptions
from linkages.app.output import StatusLine
from linkages.entry import Linkage
from linkages.file import ATLAS_ENDING
from linkages.labels import NoLinkageError
from linkages.mapping import map_linkage
from linkages.subject import Subject, as_subject, subject_at

if TYPE_CHECKING:
    from bifurc.routes.route import Route
    from bifurc.routes.wishes import Wishes
    from linkages.mechanisms.mechanism import Mechanism


def explore_linkage(linkage: Linkage | Mechanism, search: SearchOptions) -> Atlas:
    """The transition map of a linkage or a mechanism; progress is shown on standard error.

    Ctrl-C ends the search early, and the atlas holds what was found by then. Raises
    `bifurc.ProblemError` for settings out of their range.
    """
    settings = search.settings()
    with StatusLine() as status:
        return map_linkage(
            linkage, settings=settings, seed=search.seed, progress=status
        )


def explore_parts(
    parts: Sequence[Linkage | Mechanism], search: SearchOptions, deadline: Deadline
) -> list[Atlas]:
    """The maps of mechanisms, one after the other, until a deadline that they share."""
    if len(parts) == 1:
        with until(deadline):
            return [explore_linkage(parts[0], search)]
    atlases = []
    for number, part in enumerate(parts):
        budget = deadline.left / (len(parts) - number)
        atlases.append(explore_linkage(part, replace(search, budget=budget)))
    return atlases


def require_uninterrupted(atlas: Atlas) -> None:
    """Raise `CommandError` where Ctrl-C ended the search: half a map is of no use to
    the command."""
    if atlas.provenance.interrupted:
        raise CommandError(judge(atlas).sentence, ExitCode.INTERRUPTED)


def open_linkage_atlas(path: str) -> Atlas:
    """The atlas of a linkage in a file. Raises `bifurc.AtlasFileError` for a file that
    holds no atlas, and `CommandError` for one that holds another, or is not there."""
    from bifurc.files.dataset import load_atlas
    from bifurc.files.text_file import missing_file

    try:
        atlas = load_atlas(path)
    except FileNotFoundError:
        raise CommandError(f"{path}: {missing_file(Path(path))}") from None
    try:
        subject_at(atlas)
    except NoLinkageError as error:
        raise CommandError(f"{path}: {error}") from None
    return atlas


AS_SAVED = AtlasOptions()


def is_atlas_file(source: str) -> bool:
    """Whether ``source`` names a saved atlas."""
    return source.endswith(ATLAS_ENDING)


def atlas_of(source: str, options: AtlasOptions) -> Atlas:
    """The saved atlas, or that of the linkage, called ``source``, with joints held.

    Raises `CommandError` for parameters of a saved atlas, or options of its search, and
    where Ctrl-C ended the search.
    """
    if is_atlas_file(source):
        if options.parameters:
            raise CommandError("--param: it has no effect on a saved atlas")
        if options.hold != AS_SAVED.hold:
            raise CommandError(
                f"{options.hold.names}: it has no effect on a saved atlas; map the mechanism "
                "with it"
            )
        if options.search != AS_SAVED.search:
            raise CommandError(
                "--starts, --seed, --tolerance, --budget: they have no effect on a "
                "saved atlas, which is not searched again"
            )
        return open_linkage_atlas(source)
    deadline = Deadline(options.search.budget)
    linkage = choose_in_time(source, options, deadline)
    with until(deadline):
        return _explored(linkage, options.search)


def route_between(atlas: Atlas, start: str, goal: str) -> Route:
    """The shortest route between two forms or surfaces by their full names; raises
    `CommandError` where there is none."""
    from bifurc.routes.wishes import NONE

    return routes_between(atlas, start, goal, 1, NONE)[0]


def routes_between(
    atlas: Atlas, start: str, goal: str, best: int, wishes: Wishes
) -> list[Route]:
    """Up to ``best`` routes, the best first by what is wished, between two forms or
    surfaces by their full names; raises `CommandError` where there is none."""
    from bifurc.errors import RouteError
    from bifurc.routes.route import find_routes

    problem = subject_at(atlas).closure
    try:
        wishes = wishes.resolved(atlas)
    except RouteError as error:
        raise CommandError(f"--avoid, --through: {error}") from None
    try:
        return find_routes(atlas, start, goal, best, problem=problem, wishes=wishes)
    except RouteError as error:
        raise CommandError(str(error), ExitCode.NO_ROUTE) from None


def _no_subject(subject: Subject) -> bool:
    return False


def loop_atlas_of(
    source: str,
    options: AtlasOptions,
    is_taken: Callable[[Subject], bool] = _no_subject,
) -> Atlas:
    """The saved atlas, or that of the linkage, called ``source``, where it is a single
    loop of revolute joints, in the joint angles of this loop; raises `CommandError` for
    a mechanism as well, but for subjects that are taken as they are."""
    if is_atlas_file(source):
        atlas = atlas_of(source, options)
        if is_taken(subject_at(atlas)):
            return atlas
        require_table(source, subject_at(atlas).table)
        return subject_at(atlas).in_loop_angles(atlas)
    linkage = choose_held(source, options.parameters, options.hold)
    subject = as_subject(linkage)
    if is_taken(subject):
        return _explored(linkage, options.search)
    require_table(source, subject.table)
    atlas = _explored(linkage, options.search)
    return subject_at(atlas).in_loop_angles(atlas)


def _explored(linkage: Linkage | Mechanism, search: SearchOptions) -> Atlas:
    atlas = explore_linkage(linkage, search)
    require_uninterrupted(atlas)
    return atlas
