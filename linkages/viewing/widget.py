"""The viewer as a widget of a notebook; needs anywidget, the extra ``jupyter``."""

# anywidget and traitlets have no types for what they make of a class
# mypy: disable-error-code="misc"
from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import anywidget
import traitlets

from linkages.viewing.document import Document
from linkages.viewing.page import viewer_script

START = 0.3  # of a form: seldom at a singular point, as its ends and its middle are


class Track(NamedTuple):
    """What can be shown: a form, closed or not, by its length (rad), or a list of
    configurations by the number of the last one."""

    length: float
    is_closed: bool = False
    is_list: bool = False

    def place(self, position: float) -> float:
        """The position brought onto it, as viewer/tracks.js does."""
        if self.is_closed:
            rest = position % self.length
            return 0.0 if rest >= self.length else rest
        clipped = min(max(position, 0.0), self.length)
        return float(math.floor(clipped + 0.5)) if self.is_list else clipped


class LinkageWidget(anywidget.AnyWidget):
    """The moving linkage beside its map.

    ``form`` is the name of the form that is shown, and ``position`` the arclength (rad)
    there: both follow the notebook's reader, and lead the linkage where they are set.
    Rigid assemblies, near motions and surfaces are shown as lists, whose names stand
    for that of a form; ``position`` then counts their configurations from 0. A position
    beyond a closed form goes on from its beginning, beyond anything else it is that of
    the end. Raises `traitlets.TraitError` for another name, and for a position that is
    not finite.
    """

    _esm = viewer_script()
    document = traitlets.Dict().tag(sync=True)
    form = traitlets.Unicode().tag(sync=True)
    position = traitlets.Float().tag(sync=True)

    def __init__(self, document: Document, **options: Any):
        self._tracks = _tracks_of(document)
        form, position = _start_of(document, self._tracks)
        super().__init__(
            document=dict(document), form=form, position=position, **options
        )

    @traitlets.validate("form")
    def _full_name(self, proposal: traitlets.Bunch) -> str:
        """The name of the form that is called, or begins, as proposed."""
        name = proposal["value"]
        if name in self._tracks:
            return str(name)
        beginning = [one for one in self._tracks if _begins_with(one, name)]
        if len(beginning) == 1:
            return beginning[0]
        allowed = ", ".join(map(repr, self._tracks))
        raise traitlets.TraitError(f"form {name!r}: it must be one of {allowed}")

    @traitlets.validate("position")
    def _on_the_form(self, proposal: traitlets.Bunch) -> float:
        """The position on the form that is shown, where it is a number."""
        position = float(proposal["value"])
        if not math.isfinite(position):
            raise traitlets.TraitError(f"position {position}: it must be finite")
        # held notifications are validated in any order: a form that was named by its
        # beginning brings the position onto it once it has its name
        track = self._tracks.get(self.form)
        return position if track is None else track.place(position)

    @traitlets.observe("form")
    def _stay_on_the_form(self, _: traitlets.Bunch) -> None:
        """Bring the position onto a form that is shorter."""
        self.position = self._tracks[self.form].place(self.position)


def _begins_with(full_name: str, name: str) -> bool:
    """Whether a name begins with the words of another."""
    next_letter = full_name[len(name) : len(name) + 1]
    return full_name.lower().startswith(name.lower()) and not next_letter.isalnum()


def _start_of(document: Document, names: Iterable[str]) -> tuple[str, float]:
    """What is shown at first, and where on it."""
    drawn = document["drawn"]
    if drawn and drawn["place"]:
        form, s = drawn["place"]
        return document["forms"][form]["name"], s
    if not document["forms"]:
        return next(iter(names)), 0.0
    first = min(document["forms"], key=lambda form: form["name"])
    return first["name"], START * first["length"]


def _tracks_of(document: Document) -> dict[str, Track]:
    """What the viewer can show, by the names that viewer/tracks.js gives it."""
    near_motions = document["near_motions"]
    curves = [near["curve"] for near in near_motions if near["curve"]]
    tracks = {
        curve["name"]: Track(curve["length"], curve["closed"])
        for curve in [*document["forms"], *curves]
    }
    lists = {
        surface["name"]: surface["samples"]["shape"][0]
        for surface in document["surfaces"]
    }
    lists["rigid assemblies"] = len(document["assemblies"])
    lists |= {near["name"]: 1 for near in near_motions if not near["curve"]}
    alone = [point for point in document["points"] if not point["passes"]]
    lists["singular points"] = len(alone)
    for name, count in lists.items():
        if count:
            tracks[name] = Track(count - 1, is_list=True)
    return tracks or {"open chain": Track(0, is_list=True)}
