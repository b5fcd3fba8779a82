"""Words of a result lead to what they mean: in what a command prints, and on the page of a
linkage, the first of each is a link to its definition in docs/words.md."""

from __future__ import annotations

import re
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

from docs.generator.markdown import slug
from docs.generator.places import DOCS

WORDS = "words"  # the page with the definitions
TERM = re.compile(r"(?<=\*\*)[A-Z][a-z-]*(?: [a-z]+)*(?=[.,:]?\*\*)")
LINKAGES = "linkages/"  # the pages of linkages
PRINTED = "console"  # the language of a block with commands and what they print


def terms_of(page: str) -> list[str]:
    """The words, in lower case, that begin a definition on a page of Markdown: bold."""
    return [term.lower() for term in TERM.findall(page)]


def anchor_of(term: str) -> str:
    """Where on its page a word is defined."""
    return f"word-{slug(term)}"


def pattern_of(terms: list[str]) -> re.Pattern[str]:
    """What finds one of the words, also in the plural or at the beginning of a line."""
    longest_first = sorted(terms, key=len, reverse=True)
    words = "|".join(re.escape(term) for term in longest_first)
    plural_of_y = "|".join(re.escape(one[:-1]) for one in terms if one.endswith("y"))
    text = rf"\b(?:({words})(?:s|es)?|({plural_of_y})ies)\b"
    return re.compile(text, re.IGNORECASE)


def linked(
    text: str, pattern: re.Pattern[str], page: str, seen: set[str]
) -> list[nodes.Node]:
    """A text, in which the first of each word that was not ``seen`` is a link to
    ``page``; it is seen then."""
    parts: list[nodes.Node] = []
    end = 0
    for match in pattern.finditer(text):
        term = (match[1] or f"{match[2]}y").lower()
        if term in seen:
            continue
        seen.add(term)
        parts.append(nodes.Text(text[end : match.start()]))
        target = f"{page}#{anchor_of(term)}"
        parts.append(nodes.reference("", match[0], refuri=target, internal=True))
        end = match.end()
    return [*parts, nodes.Text(text[end:])]


class Definitions(SphinxPostTransform):
    """The words of a page of words can be reached."""

    default_priority = 900

    def run(self, **options: object) -> None:
        """Give each paragraph the anchors of the words that it begins with."""
        if self.env.docname != WORDS:
            return
        known = terms_of(_words())
        for bold in self.document.findall(nodes.strong):
            term = bold.astext().rstrip(".,:").lower()
            if term in known:
                bold["ids"].append(anchor_of(term))


class Results(SphinxPostTransform):
    """What commands print and what a page says of a linkage, with words that are
    links."""

    default_priority = 900

    def run(self, **options: object) -> None:
        """Replace the texts."""
        pattern = pattern_of(terms_of(_words()))
        page = self.app.builder.get_relative_uri(self.env.docname, WORDS)
        for block in list(self.document.findall(nodes.literal_block)):
            if block.get("language") != PRINTED:
                continue
            parts = linked(block.astext(), pattern, page, set())
            block.clear()
            block.extend(parts)
            block.rawsource = ""  # else it is highlighted, which leaves text alone
        if not self.env.docname.startswith(LINKAGES):
            return
        seen: set[str] = set()
        for text in list(self.document.findall(nodes.Text)):
            if isinstance(text.parent, nodes.paragraph):
                parts = linked(text.astext(), pattern, page, seen)
                text.parent.replace(text, parts)


def _words() -> str:
    return Path(DOCS / f"{WORDS}.md").read_text(encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Make the links."""
    app.add_post_transform(Definitions)
    app.add_post_transform(Results)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
