"""Texts as Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

SPECIAL = re.compile(r"([\\*_\[\]<>$|~#])")


def plain(text: str) -> str:
    """A text whose characters mean nothing in Markdown, but for backticks."""
    parts = text.split("`")
    for i in range(0, len(parts), 2):  # what stands between two backticks is code
        parts[i] = SPECIAL.sub(r"\\\1", parts[i])
    return "`".join(parts)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; its cells are Markdown already."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def bullets(lines: Iterable[str]) -> str:
    """A list of Markdown lines."""
    return "\n".join(f"- {line}" for line in lines)


def section(title: str, body: str) -> str:
    """A section of a page; empty where there is nothing to say."""
    return f"## {title}\n\n{body}" if body else ""


def slug(text: str) -> str:
    """A text as the name of a file: lower case, words joined by hyphens."""
    return "-".join(re.findall(r"[a-z0-9]+", text.lower()))
