"""Folders of texts that are written again only where they differ, so that Sphinx reads
again only what changed."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path


def write_texts(folder: Path, texts: Mapping[str, str]) -> None:
    """Write each text to its path below ``folder``; a file that holds it already is
    left alone."""
    for name, text in texts.items():
        path = folder / name
        if path.exists() and path.read_text(encoding="utf-8") == text:
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def keep_only(folder: Path, names: set[str], besides: frozenset[str]) -> None:
    """Remove the files below ``folder`` that are not among ``names``, paths as written
    by `write_texts`; the folders ``besides`` are left to others."""
    if not folder.exists():
        return
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        is_others = any(name == own or name.startswith(f"{own}/") for own in besides)
        if path.is_file() and name not in names and not is_others:
            path.unlink()


def remove_folder(folder: Path) -> None:
    """Remove a folder with all that it holds, if it is there."""
    shutil.rmtree(folder, ignore_errors=True)
