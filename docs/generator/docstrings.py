"""Docstrings are plain English with code in backticks, and examples at a prompt: other
marks of reStructuredText mean nothing in them."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

CODE = re.compile(r"(`+[^`]*`+)")
MARKS = re.compile(r"([*|])|_(?![A-Za-z0-9])")


def escape_marks(line: str) -> str:
    """A line in which bars, stars and underlines at the end of words stand for
    themselves, but for what is code."""
    parts = CODE.split(line)
    for i in range(0, len(parts), 2):
        parts[i] = MARKS.sub(lambda mark: "\\" + mark[0], parts[i])
    return "".join(parts)


def _escape(
    app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]
) -> None:
    is_example = False
    for i, line in enumerate(lines):
        is_example = bool(line.strip()) and (is_example or line.startswith(">>>"))
        if not is_example:
            lines[i] = escape_marks(line)


def setup(app: Sphinx) -> dict[str, bool]:
    """Read docstrings so."""
    app.connect("autodoc-process-docstring", _escape)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
