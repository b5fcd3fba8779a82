"""The viewer as a widget of a notebook; needs anywidget, the extra ``jupyter``."""

# anywidget and traitlets have no types for what they make of a class
# mypy: disable-error-code="misc"
from __future__ import annotations

import math
from typing import Any

import anywidget
import traitlets

from linkages.viewing.document import ViewDocument
from linkages.viewing.page import viewer_script

__all__ = ["LinkageWidget"]

START = 0.3  # of a form: seldom at a singular point, as its ends and its middle are


class LinkageWidget(anywidget.AnyWidget):
    """The moving linkage beside its map.

    ``form`` is the name of the form that is shown, and ``position`` the arclength (rad)
    there: both follow the notebook's reader, and lead the linkage where they are set.
    Rigid assemblies, near motions and surfaces are shown as lists, whose names stand
    for that of a form; ``position`` then counts their configurations from 0. Raises
    `traitlets.TraitError` for another name, and for a position that is not finite.
    """

    _esm = viewer_script()
    document = traitlets.Dict().tag(sync=True)
    form = traitlets.Unicode().tag(sync=True)
    position = traitlets.Float().tag(sync=True)

    def __init__(self, document: ViewDocument, **options: Any):
        self._names = _names_of(document)
        form, position = _start_of(document, self._names)
        super().__init__(
            document=dict(document), form=form, position=position, **options
        )

    @traitlets.validate("form")
    def _full_name(self, proposal: traitlets.Bunch) -> str:
        """The name of the form that is called, or begins, as proposed."""
        name = proposal["value"]
        if name in self._names:
            return str(name)
        beginning = [one for one in self._names if _begins_with(one, name)]
        if len(beginning) == 1:
            return beginning[0]
        allowed = ", ".join(map(repr, self._names))
        raise traitlets.TraitError(f"form {name!r}: it must be one of {allowed}")

    @traitlets.validate("position")
    def _finite(self, proposal: traitlets.Bunch) -> float:
        """The position, where it is a number."""
        position = float(proposal["value"])
        if not math.isfinite(position):
            raise traitlets.TraitError(f"position {position}: it must be finite")
        return position


def _begins_with(full_name: str, name: str) -> bool:
    """Whether a name begins with the words of another."""
    next_letter = full_name[len(name) : len(name) + 1]
    return full_name.lower().startswith(name.lower()) and not next_letter.isalnum()


def _start_of(document: ViewDocument, names: list[str]) -> tuple[str, float]:
    """What is shown at first, and where on it."""
    if not document["forms"]:
        return names[0], 0.0
    first = min(document["forms"], key=lambda form: form["name"])
    return first["name"], START * first["length"]


def _names_of(document: ViewDocument) -> list[str]:
    """What the viewer can show, as viewer/tracks.js names it."""
    names = [form["name"] for form in document["forms"]]
    names += [surface["name"] for surface in document["surfaces"]]
    if document["assemblies"]:
        names.append("rigid assemblies")
    if document["near_motions"]:
        names.append("near motions")
    if any(not point["passes"] for point in document["points"]):
        names.append("singular points")
    return names or ["open chain"]
