"""From a linkage to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.limits import (
    HeldInterrupt,
    current_deadline,
    deadline_within,
    made_before_the_end,
    made_in_time,
    until,
)
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.tables import count_of
from linkages.entry import Linkage
from linkages.loop import Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.subject import as_subject, keep_subject

DEFAULT_SEARCH = SearchSettings()
WHOLE = 0.5  # of the time, for a whole sheet of which a simpler one is known to move


def map_linkage(
    linkage: Linkage | Loop | Mechanism,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    seed: int = 0,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """The transition map of a linkage or a mechanism: every form with its name, every
    bifurcation, every near miss.

    ``seed`` is that of the random starts; ``progress`` is called with what was found
    and how many. The budget of the settings holds for naming as well: where it ends
    before, forms have numbers only, and the statement says so.
    `linkages.labels.FormLabels` reads what a form is, `linkages.labels.loop_of` the
    loop that an atlas is of, and `linkages.readout.readout.Readout` the joint variables
    of a mechanism, also of one that is a single loop. Every form has its
    ``certificate``, unless the settings say otherwise. Raises `ProblemError` for
    settings of another type, `GeometryError` for anything but a linkage or a mechanism,
    and for a loop with lengths whose squares leave the range of doubles, and
    `OutOfTimeError` where the time is over before there are equations.

    >>> import linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> for form in atlas.forms:
    ...     print(form.name, round(form.branch.length, 6), form.branch.winding)
    rhombus form 12.566371 [ 1 -1  1 -1]
    folded form (joints 2,4 inactive) 8.885766 [ 1  0 -1  0]
    folded form (joints 1,3 inactive) 8.885766 [ 0  1  0 -1]
    >>> [point.name for point in atlas.bifurcations], str(atlas.completeness.level)
    (['B1', 'B2', 'B3'], 'counted')
    """
    check_type("settings", settings, SearchSettings)
    deadline = deadline_within(settings.budget)
    search = partial(explore, settings=settings, seed=seed, progress=progress)
    with HeldInterrupt() as interrupt, until(replace(deadline, interrupt=interrupt)):
        parts = ""
        if isinstance(linkage, Mechanism):
            parts = f" of {count_of(len(linkage.bodies), 'body')}"
        stage = f"while the closed loops{parts} were looked for"
        subject = made_before_the_end(stage, lambda: as_subject(linkage))
        stage = f"while the equations{parts} were written"
        traced = made_before_the_end(stage, lambda: subject.traced)
        simpler = made_in_time(subject.simpler)
        with until(current_deadline().share(WHOLE if simpler else 1.0)):
            atlas = subject.labelled(search(traced))
        is_open = not (atlas.forms or atlas.surfaces or interrupt.was_pressed)
        if simpler and is_open and made_in_time(lambda: simpler.traced):
            subject = simpler
            atlas = simpler.labelled(search(simpler.traced))
        interrupt.settle()
    keep_subject(atlas, subject)
    return atlas
