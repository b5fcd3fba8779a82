"""The pictures that a study writes to files, for the gallery of studies."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from sphinx_gallery.scrapers import figure_rst

from docs.generator.places import SCRIPTS


class WrittenPictures:
    """A scraper of sphinx-gallery: it takes the pictures that a block of a study has
    written to its folder."""

    def __repr__(self) -> str:
        return "WrittenPictures"

    def __call__(
        self, block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]
    ) -> str:
        """These pictures in reStructuredText."""
        script = Path(block_vars["src_file"])
        copies = []
        for picture in sorted((SCRIPTS / "out" / script.stem).glob("*.png")):
            copy = next(block_vars["image_path_iterator"])
            shutil.move(picture, copy)
            copies.append(copy)
        return figure_rst(copies, gallery_conf["src_dir"]) if copies else ""
