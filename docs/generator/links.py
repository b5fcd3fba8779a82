"""Links of a built site that lead nowhere.

Sphinx checks the links of its own pages; this looks at the finished files, with what
was written as HTML, and asks for every file and every anchor.
"""

from __future__ import annotations

from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

ATTRIBUTES = frozenset({"href", "src", "data-page"})
PARTS = "_static"  # a folder of the site: parts of pages stand there, not pages


class DeadLink(NamedTuple):
    """A link, and the page (below the site) that holds it."""

    page: str
    target: str

    def __str__(self) -> str:
        return f"{self.page}: {self.target} leads nowhere"


class _Page(HTMLParser):
    """The anchors of a page, where it leads, and what it fetches when it is opened."""

    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.targets: set[str] = set()
        self.fetched: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if not value:
                continue
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            elif name in ATTRIBUTES:
                self.targets.add(value)
                if name == "src" or tag == "link":
                    self.fetched.add(value)


@cache
def _page(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def dead_links(site: Path) -> list[DeadLink]:
    """Every link on the pages of ``site`` to a file or an anchor that is not there.

    Links to other sites are not followed.
    """
    dead = []
    for path in _pages(site):
        for target in sorted(_page(path).targets):
            if not _leads_somewhere(path, target):
                dead.append(DeadLink(path.relative_to(site).as_posix(), target))
    return dead


def _pages(site: Path) -> list[Path]:
    return [
        path
        for path in sorted(site.rglob("*.html"))
        if PARTS not in path.relative_to(site).parts
    ]


def _leads_somewhere(path: Path, target: str) -> bool:
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return True
    goal = _goal(path.parent, unquote(parts.path)) if parts.path else path
    if goal is None:
        return False
    anchor = unquote(parts.fragment)
    if not anchor or goal.suffix != ".html":
        return True
    return anchor in _page(goal).anchors


@cache
def _goal(folder: Path, name: str) -> Path | None:
    """The file that a link on the pages of a folder leads to, if it is there."""
    goal = (folder / name).resolve()
    if goal.is_dir():
        goal = goal / "index.html"
    return goal if goal.exists() else None


def fetched_from_afar(site: Path) -> list[DeadLink]:
    """Scripts, styles and pictures that pages of ``site`` fetch from other hosts: none
    of them is there without a network."""
    return [
        DeadLink(path.relative_to(site).as_posix(), target)
        for path in _pages(site)
        for target in sorted(_page(path).fetched)
        if urlsplit(target).netloc
    ]
