"""What of an atlas is drawn: which forms, which angles, and points of the user's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from bifurc.atlas import NEAR_DRAWN, Atlas, Event, MeetingPoint, Surface
from bifurc.checks import UnknownName, name_of
from bifurc.errors import ProblemError, RouteError
from bifurc.form_order import listed_numbers

SAMPLES = 32  # of a form, by which it is seen whether an unknown stands still
STILL = 1e-9  # what an unknown changes by that stands still


@dataclass(frozen=True)
class Selection:
    """What of an atlas is drawn.

    ``forms`` are names of forms, in full or by the part that tells them apart, or their
    numbers in tables, from 1; all where there are none.
    ``window`` are the first and the last angle that are shown, in degrees, at most a
    turn. ``overlay`` are points of the user's that are laid over: their values, as axes
    show them, by the names or symbols of the unknowns; it is drawn where both unknowns of a plane
    have some.
    """

    forms: Sequence[str | int] = ()
    window: tuple[float, float] | None = None
    overlay: Mapping[str, Sequence[float]] | Mapping[UnknownName, Sequence[float]] = (
        field(default_factory=dict)
    )

    def __post_init__(self) -> None:
        """Raises `ProblemError` for a window that is none, and for columns of unequal
        lengths."""
        if self.window is not None:
            low, high = self.window
            if not 0 < high - low <= 360:
                allowed = "a first and a larger last angle in degrees, at most a turn"
                raise ProblemError("window", self.window, allowed)
        lengths = {name: len(values) for name, values in self.overlay.items()}
        if len(set(lengths.values())) > 1:
            raise ProblemError("overlay", lengths, "as many values of each unknown")

    def indices(self, atlas: Atlas) -> list[int]:
        """The indices of the forms of an atlas that are drawn, in the order in which they
        are listed; raises `ProblemError`."""
        chosen = [_index_of(atlas, form) for form in self.forms]
        return [i for i in listed_numbers(atlas) if i in chosen or not chosen]

    def points(self, atlas: Atlas) -> list[MeetingPoint]:
        """The singular points of an atlas that are drawn: all, or those on the forms
        that are chosen."""
        if not self.forms:
            return list(atlas.points)
        chosen = set(self.indices(atlas))
        return [
            point
            for point in atlas.points
            if any(form in chosen for form, _ in point.passes)
        ]

    def rigid(self, atlas: Atlas) -> np.ndarray:
        """The isolated solutions (k, n) that are drawn: none where forms are chosen."""
        return atlas.rigid[:0] if self.forms else atlas.rigid

    def surfaces(self, atlas: Atlas) -> tuple[Surface, ...]:
        """The surfaces that are drawn: none where forms are chosen."""
        return () if self.forms else atlas.surfaces

    def dead_points(self, atlas: Atlas) -> list[Event]:
        """The dead points that are drawn: of the unknowns that drive, and do not stand
        still, on the forms that are drawn."""
        drivers = atlas.subject.get("drivers", ())
        chosen = self.indices(atlas)
        events = []
        for event in atlas.dead_points:
            if event.form in chosen and event.index in drivers:
                values = atlas.forms[event.form].branch.sample(SAMPLES)[:, event.index]
                if np.ptp(values) > STILL:
                    events.append(event)
        return events

    def drawn(self, atlas: Atlas) -> np.ndarray | None:
        """The configuration (n,) as drawn, if there is one, and, where forms are chosen,
        if it is on one of them."""
        if atlas.drawn is None or not self.forms:
            return atlas.drawn
        for index in self.indices(atlas):
            distance, _ = atlas.forms[index].branch.nearest(atlas.drawn)
            if distance[0] < NEAR_DRAWN:
                return atlas.drawn
        return None

    def points_over(self, *names: str) -> np.ndarray | None:
        """The user's points (k, m) over the unknowns of m names; None where there are
        none."""
        overlay = {name_of(name): values for name, values in self.overlay.items()}
        if not set(names) <= set(overlay):
            return None
        columns = [overlay[name] for name in names]
        return np.array(columns, dtype=float).T


EVERYTHING = Selection()


def _index_of(atlas: Atlas, form: str | int) -> int:
    names = [one.name for one in atlas.forms]
    if isinstance(form, str):
        with suppress(RouteError):
            return atlas.form(form)
    if isinstance(form, int) and 1 <= form <= len(names):
        return listed_numbers(atlas)[form - 1]
    allowed = f"one of {', '.join(names)}, or a number from 1 to {len(names)}"
    raise ProblemError("form", repr(form), allowed)
