"""From a linkage to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bifurc.atlas import Atlas
from bifurc.limits import HeldInterrupt, deadline_within, until
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.entry import Linkage
from linkages.loop import Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.subject import as_subject

DEFAULT_SEARCH = SearchSettings()


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
    before, forms have numbers only, and the statement says so. `linkages.labels.FormLabels` reads what a form is,
    `linkages.labels.loop_of` the loop that an atlas is of, and
    `linkages.readout.readout.Readout` the joint variables of a mechanism, also of
    one that is a single loop. Every form
    has its ``certificate``, unless the settings say otherwise. Raises `GeometryError`
    for anything but a linkage or a mechanism, and for a loop with lengths whose squares
    leave the range of doubles.

    >>> import linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> for form in atlas.forms:
    ...     print(form.name, round(form.branch.length, 6), form.branch.winding)
    rhombus form 12.566371 [ 1 -1  1 -1]
    folded form (joints 2,4 inactive) 8.885766 [ 1  0 -1  0]
    folded form (joints 1,3 inactive) 8.885766 [ 0  1  0 -1]
    >>> [point.name for point in atlas.bifurcations], str(atlas.completeness.level)
    (['B1', 'B2', 'B3'], 'proved')
    """
    deadline = deadline_within(settings.budget)
    subject = as_subject(linkage)
    with HeldInterrupt() as interrupt, until(replace(deadline, interrupt=interrupt)):
        found = explore(subject.traced, settings=settings, seed=seed, progress=progress)
        atlas = subject.labelled(found)
        interrupt.settle()
    return atlas
