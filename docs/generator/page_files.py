"""The files that a page shows: what its examples read."""

from __future__ import annotations

import re

BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```", re.MULTILINE | re.DOTALL)
FORMATS = ("toml", "csv", "xml", "json")
NAMED = re.compile(r"# (\S+\.toml)\n")


def files_of(page: str) -> dict[str, str]:
    """The texts of the files in a page of Markdown, by their names.

    A name stands behind the language of a block, or in a comment in the first line of
    one of TOML. Raises `ValueError` for a block of such a language without a name.
    """
    files = {}
    for language, name, text in BLOCK.findall(page):
        if language not in FORMATS:
            continue
        comment = NAMED.match(text)
        if comment is not None:
            name = comment[1]
        if not name:
            raise ValueError(f"a block of {language} has no name: {text[:60]!r}")
        files[name] = text
    return files
