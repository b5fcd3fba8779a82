"""Writing the results of `bifurc map --out DIR`, each file whole or not at all."""

from __future__ import annotations

import tempfile
from pathlib import Path

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_files

__all__ = ["prepare_folder", "write_data", "write_figures"]


def prepare_folder(folder: Path) -> None:
    """Make sure that files can be written to ``folder``, which is made if need be;
    raises `OSError` if not."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def write_data(atlas: Atlas, folder: Path, summary: str) -> list[Path]:
    """The paths of atlas.nc, graph.graphml and summary.txt, just written to ``folder``,
    all or none; raises `OSError`."""
    from bifurc.files.dataset import save_atlas
    from bifurc.files.graphml import write_graphml

    def write(stage: Path) -> None:
        save_atlas(atlas, stage / "atlas.nc")
        write_graphml(atlas, stage / "graph.graphml")
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")

    return replace_files(folder, write)


def write_figures(atlas: Atlas, folder: Path) -> list[Path]:
    """The paths of the figures, just written to ``folder``, all or none; raises
    `OSError`."""
    from bifurc.figures.plotting import save_figures

    return replace_files(folder, lambda stage: save_figures(atlas, stage))
