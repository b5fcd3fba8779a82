"""Writing the results of `bifurc map --out DIR`, each file whole or not at all."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_files
from linkages.app.answer.configurations import readout_of
from linkages.app.figure_axes import FigureAxes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


def write_data(atlas: Atlas, folder: Path, summary: str) -> list[Path]:
    """The paths of atlas.nc, graph.graphml, of a mechanism mechanism.graphml, and
    summary.txt, just written to ``folder``, all or none; raises `OSError`."""
    from bifurc.files.graphml import write_graphml

    def write(stage: Path) -> None:
        _write_dataset(atlas, stage / "atlas.nc")
        write_graphml(atlas, stage / "graph.graphml")
        readout = readout_of(atlas)
        if readout is not None:
            from linkages.mechanisms.graphml import write_mechanism_graph

            write_mechanism_graph(readout.mechanism, stage / "mechanism.graphml")
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")

    return replace_files(folder, write)


def _write_dataset(atlas: Atlas, path: Path) -> None:
    """Write the dataset of an atlas, of a mechanism with the variables of all joints;
    raises `OSError`."""
    from bifurc.files.dataset import save_atlas

    readout = readout_of(atlas)
    if readout is None:
        save_atlas(atlas, path)
        return
    from linkages.readout.dataset_variables import dataset_variables

    save_atlas(atlas, path, dataset_variables(atlas, readout))


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
        from bifurc.figures.singular_values_against import plot_singular_values_against

        others["singular_values"] = partial(
            plot_singular_values_against, unknown=over.singular_values
        )
    return others
