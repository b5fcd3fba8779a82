"""Writing the results of `bifurc map --out DIR`, each file whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bifurc.atlas import Atlas

__all__ = ["prepare_folder", "staging", "write_data", "write_figures"]


def prepare_folder(folder: Path) -> None:
    """Make sure that files can be written to ``folder``, which is made if need be;
    raises `OSError` if not."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def write_data(atlas: Atlas, folder: Path, summary: str) -> list[Path]:
    """Write atlas.nc, graph.graphml and summary.txt; returns the paths.

    Files are made in a hidden folder inside ``folder`` and renamed when they are
    complete.
    """
    from bifurc.files.dataset import save_atlas
    from bifurc.files.graphml import write_graphml

    written: list[Path] = []
    with staging(folder, written) as stage:
        save_atlas(atlas, stage / "atlas.nc")
        write_graphml(atlas, stage / "graph.graphml")
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")
    return written


def write_figures(atlas: Atlas, folder: Path) -> list[Path]:
    """Write the figures, all or none, as `write_data` does; returns the paths."""
    from bifurc.figures.plotting import save_figures

    written: list[Path] = []
    with staging(folder, written) as stage:
        save_figures(atlas, stage)
    return written


@contextmanager
def staging(folder: Path, written: list[Path]) -> Iterator[Path]:
    """A folder whose files move to ``folder`` at the end, unless something went
    wrong."""
    with tempfile.TemporaryDirectory(prefix=".writing-", dir=folder) as name:
        yield Path(name)
        for path in sorted(Path(name).iterdir()):
            os.replace(path, folder / path.name)
            written.append(folder / path.name)
