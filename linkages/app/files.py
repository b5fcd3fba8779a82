"""Writing the results of `bifurc map --out DIR`, each file whole or not at all."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_files
from linkages.app.figure_axes import FigureAxes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bifurc.files.table import Variable


def prepare_folder(folder: Path) -> list[Path]:
    """Make sure that files can be written to ``folder``: the folders that were made for
    that, the innermost first; raises `OSError` if it cannot be."""
    chain = [folder, *folder.parents]
    missing = [path for path in chain if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        remove_empty(missing)
        raise
    return missing


def remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders, the innermost first, as far as nothing is in them."""
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()


def write_data(
    atlas: Atlas,
    folder: Path,
    summary: str,
    more: Mapping[str, Variable] = MappingProxyType({}),
    others: Mapping[str, Callable[[Path], object]] = MappingProxyType({}),
) -> list[Path]:
    """The paths of atlas.nc, with ``more`` variables, graph.graphml, summary.txt and
    ``others``, by what writes them, just written to ``folder``, all or none; raises
    `OSError`."""
    from bifurc.files.dataset import save_atlas
    from bifurc.files.graphml import write_graphml

    def write(stage: Path) -> None:
        save_atlas(atlas, stage / "atlas.nc", more)
        write_graphml(atlas, stage / "graph.graphml")
        for name, write_other in others.items():
            write_other(stage / name)
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")

    return replace_files(folder, write)


USUAL_AXES = FigureAxes()


def write_figures(
    atlas: Atlas, folder: Path, over: FigureAxes = USUAL_AXES
) -> list[Path]:
    """The paths of the figures, just written to ``folder``, all or none; raises
    `OSError`."""
    from bifurc.figures import plotting

    others = _figures_over(over)
    return replace_files(
        folder, lambda stage: plotting.save_figures(atlas, stage, others)
    )


def _figures_over(over: FigureAxes) -> dict[str, Callable[[Atlas], Figure]]:
    """The figures that are drawn over other unknowns than usual."""
    others: dict[str, Callable[[Atlas], Figure]] = {}
    if len(over.transition_map) == 2:
        from bifurc.figures.plotting import plot_transition_map

        others["transition_map"] = partial(
            plot_transition_map, joints=over.transition_map
        )
    if len(over.transition_map) == 3:
        from bifurc.figures.space import plot_map_in_space

        others["transition_map"] = partial(
            plot_map_in_space, unknowns=over.transition_map
        )
    if over.singular_values is not None:
        from bifurc.figures.singular_values import plot_singular_values_against

        others["singular_values"] = partial(
            plot_singular_values_against, unknown=over.singular_values
        )
    return others
