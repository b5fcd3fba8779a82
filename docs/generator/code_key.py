"""A key of all code that a result comes from: where it is the same, so is the
result."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from pathlib import Path

from docs.generator.places import DOCS, ROOT

FOLDERS = (ROOT / "bifurc", ROOT / "linkages", ROOT / "studies")
# of the generator, what records and pictures are made by; pages are written each time
MODULES = ("exploration.py", "linkage_record.py", "pictures.py", "study_scripts.py")
ENDINGS = frozenset({".py", ".hpp", ".cpp", ".js", ".json", ".toml"})
LIBRARIES = ("matplotlib", "numpy", "scipy", "sympy")


@cache
def code_key() -> str:
    """The key of the packages, the studies, and the libraries that they rest on."""
    versions = [f"{name} {version(name)}" for name in LIBRARIES]
    return key_of([sys.version, *versions, *_sources()])


def _sources() -> Iterable[str]:
    paths = [DOCS / "generator" / name for name in MODULES]
    for folder in FOLDERS:
        paths += [path for path in folder.rglob("*") if path.suffix in ENDINGS]
    for path in sorted(paths):
        yield path.relative_to(ROOT).as_posix()
        yield _digest(path)


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def key_of(texts: Iterable[str]) -> str:
    """The key of some texts in their order."""
    total = hashlib.sha256()
    for text in texts:
        total.update(text.encode("utf-8") + b"\0")
    return total.hexdigest()
