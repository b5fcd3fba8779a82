"""Writing the results of `bifurc map --out DIR`, each file whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bifurc.atlas import Atlas

__all__ = ["prepare_folder", "staging", "write_results"]


def prepare_folder(folder: Path) -> None:
    """Make sure that files can be written to ``folder``, which is made if need be; raises `OSError` if not."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def write_results(atlas: Atlas, folder: Path, summary: str) -> list[Path]:
    """Write atlas.nc, graph.graphml, summary.txt and the figures; returns the paths in that order.

    Every step works in a hidden folder inside ``folder`` and its files are renamed when they are complete.
    """
    from bifurc.dataset import save_atlas
    from bifurc.graphml import write_graphml

    written: list[Path] = []
    with staging(folder, written) as stage:
        save_atlas(atlas, stage / "atlas.nc")
    with staging(folder, written) as stage:
        write_graphml(atlas, stage / "graph.graphml")
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")
    if atlas.forms:
        from bifurc.plotting import save_figures

        with staging(folder, written) as stage:
            save_figures(atlas, stage)
    return written


@contextmanager
def staging(folder: Path, written: list[Path]) -> Iterator[Path]:
    """A folder whose files move to ``folder`` at the end, unless something went wrong."""
    with tempfile.TemporaryDirectory(prefix=".writing-", dir=folder) as name:
        yield Path(name)
        for path in sorted(Path(name).iterdir()):
            os.replace(path, folder / path.name)
            written.append(folder / path.name)
