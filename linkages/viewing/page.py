"""The viewer as one page of HTML that holds all it needs."""

from __future__ import annotations

import json
import logging
import os
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

from bifurc.files.atomic import replace_file
from linkages.viewing.document import Document

log = logging.getLogger(__name__)

LARGEST = 1_500_000  # bytes; a page beyond it is slow to open


def make_page(document: Document) -> str:
    """The page that shows a document, with the viewer's script inside.

    It opens from disk, and fetches nothing.
    """
    # a text in it must not end the script element that holds it
    content = json.dumps(document, allow_nan=False).replace("<", "\\u003c")
    # the policy of the page lets it run what it holds, and fetch nothing
    return Template(_text("page.html")).substitute(
        title=escape(document["title"]), document=content, script=viewer_script()
    )


def viewer_script() -> str:
    """The viewer: an ES module, built from the folder viewer/ of the sources."""
    return _text("static/viewer.js")


def _text(name: str) -> str:
    file = resources.files("linkages.viewing") / name
    return file.read_text(encoding="utf-8")


def write_page(document: Document, path: str | os.PathLike[str]) -> Path:
    """The path of the page just written, whole or not at all.

    Raises `OSError` that names ``path``.
    """
    page = make_page(document)
    size = len(page.encode("utf-8"))
    if size > LARGEST:
        log.warning("%s: the page has %.1f MB", path, size / 1e6)
    return replace_file(path, lambda part: part.write_text(page, encoding="utf-8"))
