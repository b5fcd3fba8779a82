"""The picture of an atlas in a notebook, above its tables.

After `%load_ext bifurc.figures.notebook` every atlas is shown so; without it a notebook
shows the tables alone. (An atlas does not know of figures, so that it needs no
matplotlib.)
"""

from __future__ import annotations

import io
from typing import Any

from bifurc.atlas import Atlas
from bifurc.figures.plotting import plot_transition_map
from bifurc.figures.rc import drawing_style


def load_ipython_extension(shell: Any) -> None:
    """Show every atlas in this shell of IPython with its picture from now on."""
    formatter = shell.display_formatter.formatters["text/html"]
    formatter.for_type(Atlas, atlas_page)


def atlas_page(atlas: Atlas) -> str:
    """The transition map of an atlas as inline SVG, and its tables, in HTML."""
    picture = io.StringIO()
    with drawing_style():
        figure = plot_transition_map(atlas)
        figure.savefig(picture, format="svg", metadata={"Date": None, "Creator": None})
    text = picture.getvalue()
    svg = text[text.index("<svg") :]
    return svg + atlas._repr_html_()
