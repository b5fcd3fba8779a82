"""The motions along forms and routes that a command line names."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from linkages.app.atlas_source import route_between
from linkages.app.exit_codes import CommandError
from linkages.app.texts.form_names import choose_forms
from linkages.export.model import Motion, motion_of_form, motion_of_route
from linkages.subject import subject_at


def choose_motions(
    atlas: Atlas,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
) -> list[Motion]:
    """The motions along forms and routes, all forms where neither is named."""
    chosen = choose_forms(atlas, forms) if forms or not routes else []
    motions = [motion_of_form(form, count) for form in chosen]
    for start, goal in routes:
        motion = make_route_motion(atlas, start, goal, count)
        if motion.name in [other.name for other in motions]:
            raise CommandError(
                f"--route {start!r} {goal!r}: the route from {motion.name} is named "
                "already, and may be only once"
            )
        motions.append(motion)
    return motions


def make_route_motion(atlas: Atlas, start: str, goal: str, count: int) -> Motion:
    """The motion along the shortest route between two forms.

    Raises `CommandError` for an unknown form, where there is no route, and for one
    without length.
    """
    option = f"--route {start!r} {goal!r}"
    try:
        first, last = atlas.full_name(start), atlas.full_name(goal)
    except RouteError as error:
        raise CommandError(f"{option}: {error}") from None
    route = route_between(atlas, first, last)
    if not route.legs:
        raise CommandError(
            f"{option}: it begins and ends in one configuration of {first!r}; name two "
            "different forms, or --form for all of one"
        )
    problem = subject_at(atlas).closure
    return motion_of_route(atlas, route, f"{first} to {last}", count, problem)
