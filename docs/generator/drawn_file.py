"""Pictures of a file that a page shows: its text goes in, figures come out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.diagram_plot import plot_diagram
from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.plotting import plot_joint_angles, plot_transition_map, save_figure
from bifurc.systems.equation_file import EquationFile
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.pictures.plot_linkage import plot_linkage

Plot: TypeAlias = Callable[[Atlas], Figure]
# what a picture shows, by the name of the file that `bifurc map --out` writes
PICTURES: dict[str, tuple[Plot, str]] = {
    "linkage": (plot_linkage, "one configuration"),
    "transition_map": (plot_transition_map, "transition map"),
    "joint_angles": (plot_joint_angles, "joints over the first one"),
    "form_graph": (plot_form_graph, "which forms meet"),
    "diagram": (plot_diagram, "bifurcation diagram"),
}


def draw_file(name: str, text: str, kinds: Sequence[str], folder: Path) -> list[Path]:
    """The paths of pictures of these ``kinds`` of what the file called ``name`` holds,
    just written to ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    atlas = _atlas_of(name, text)
    paths = []
    for kind in kinds:
        plot, _ = PICTURES[kind]
        paths += save_figure(plot(atlas), folder / f"{name}-{kind}", ("svg",))
    return paths


def _atlas_of(name: str, text: str) -> Atlas:
    with TemporaryDirectory() as place:
        path = Path(place) / name
        path.write_text(text, encoding="utf-8")
        if path.suffix == ".toml" and EquationFile.read(path).is_of_equations:
            return EquationFile.read(path).system({}).explore()
        return map_linkage(load(path))


def pictures_html(name: str, kinds: Sequence[str], folder: str) -> str:
    """The pictures of a file side by side; ``folder`` leads to them from the page."""
    figures = [
        f'<figure><img class="dark-light" src="{folder}/{name}-{kind}.svg" '
        f'alt="{escape(name)}: {PICTURES[kind][1]}">'
        f"<figcaption>{PICTURES[kind][1]}</figcaption></figure>"
        for kind in kinds
    ]
    return f'<div class="linkage-pictures drawn-pictures">\n{"".join(figures)}\n</div>'
