"""The front door of the viewer for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.errors import BifurcError
from linkages.viewing.document import make_view_document

if TYPE_CHECKING:
    from linkages.viewing.widget import LinkageWidget


class NoWidgetError(BifurcError, ImportError):
    """The widget cannot be made, since anywidget is not installed."""


def view(atlas: Atlas, *, trace: Sequence[str] = ()) -> LinkageWidget:
    """A widget that shows the linkage of an atlas in motion, beside its map.

    Its traits ``form`` and ``position`` (arclength, rad) follow what is seen, and lead
    it. The paths of points are drawn that ``trace`` names as "BODY:X,Y" or "BODY:X,Y,Z".
    Raises `NoLinkageError` where the atlas is not of a linkage, `GeometryError` for a
    point of no body, and `ImportError` without anywidget, which the extra ``jupyter``
    installs.

    >>> import linkages
    >>> widget = linkages.view(linkages.map_linkage(linkages.load("bennett")))
    >>> widget.form
    'Bennett form'
    """
    check_type("atlas", atlas, Atlas)
    document = make_view_document(atlas, trace=trace)
    try:
        from linkages.viewing.widget import LinkageWidget
    except ImportError as error:
        raise NoWidgetError(
            f"the widget needs {error.name}; pip install 'bifurc[jupyter]' brings it"
        ) from None
    return LinkageWidget(document)
