"""What pages can show besides text: a linkage, a file drawn, the gallery, a flow chart."""

from __future__ import annotations

from html import escape
from pathlib import Path

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs.generator.drawn_file import draw_file, pictures_html
from docs.generator.exploration import read_record, record_file
from docs.generator.flow_chart import chart_svg, read_chart
from docs.generator.gallery import cards_of, gallery_html, search_html
from docs.generator.page_files import files_of
from docs.generator.pictures import drawing_of, map_of
from docs.generator.places import EXTRA
from linkages.catalogue import catalogue

GENERATOR = sorted(Path(__file__).parent.glob("*.py"))


def view_html(name: str, counts: str, root: str) -> str:
    """Drawing and map of a linkage, and a button that loads the moving linkage in
    their place; ``root`` leads from the page to the top of the site."""
    page = f"{root}viewer/{name}.html"
    drawing = f"{root}pictures/{drawing_of(name)}"
    transition_map = f"{root}pictures/{map_of(name)}"
    shown = escape(name)
    return f"""<div class="linkage-view">
<p class="linkage-buttons">
<button type="button" data-page="{page}" data-title="{shown} in motion">\
Show it in motion</button>
<a href="{page}">on a page of its own</a></p>
<div class="linkage-pictures">
<figure><img class="dark-light" src="{drawing}" alt="{shown} in one configuration">
<figcaption>one configuration: joints, their axes, links</figcaption></figure>
<figure><img class="dark-light" src="{transition_map}" alt="transition map of {shown}">
<figcaption>transition map: {escape(counts)}</figcaption></figure>
</div>
</div>"""


class Raw(SphinxDirective):
    """A directive that writes HTML."""

    def html(self, text: str) -> list[nodes.Node]:
        """The nodes of some HTML; a page is read again when the generator changes."""
        for module in GENERATOR:
            self.env.note_dependency(str(module))
        return [nodes.raw("", text, format="html")]

    @property
    def root(self) -> str:
        """The way from the page to the top of the site."""
        depth: int = self.env.docname.count("/")
        return "../" * depth


class LinkageView(Raw):
    """A linkage of the catalogue: ``{linkage} NAME``."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The pictures and the button."""
        name = self.arguments[0]
        if name not in catalogue():
            raise self.error(f"no linkage is called {name!r}")
        self.env.note_dependency(str(record_file(name)))
        return self.html(view_html(name, read_record(name).counts, self.root))


class DrawnFile(Raw):
    """Pictures of a file that the page shows: ``{drawn} FILE KIND ...``."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The pictures, side by side."""
        name, *kinds = self.arguments[0].split()
        page = self.env.docname
        text = Path(self.env.doc2path(page)).read_text(encoding="utf-8")
        folder = f"drawn/{page}"
        try:
            draw_file(name, files_of(text)[name], kinds, EXTRA / folder)
        except KeyError as error:
            raise self.error(f"there is no {error} to draw on this page") from None
        return self.html(pictures_html(name, kinds, f"{self.root}{folder}"))


class LinkageGallery(Raw):
    """Cards of linkages: ``{linkage-gallery} NAME ...``; without names those of the
    whole catalogue, with fields to search them."""

    optional_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The search fields, if any, and the cards."""
        names = self.arguments[0].split() if self.arguments else list(catalogue())
        for name in names:
            self.env.note_dependency(str(record_file(name)))
        records = {name: read_record(name) for name in names}
        entries = {name: catalogue()[name] for name in names}
        cards = cards_of(entries, records)
        gallery = gallery_html(cards, self.root)
        search = "" if self.arguments else search_html(cards)
        return self.html(search + gallery)


class FlowChart(Raw):
    """A flow chart in Mermaid."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The chart, which can be scrolled where it is wider than the page."""
        try:
            chart = read_chart("\n".join(self.content))
        except ValueError as error:
            raise self.error(str(error)) from None
        return self.html(f'<div class="flow-chart-room">{chart_svg(chart)}</div>')


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directives."""
    app.add_directive("linkage", LinkageView)
    app.add_directive("drawn", DrawnFile)
    app.add_directive("linkage-gallery", LinkageGallery)
    app.add_directive("mermaid", FlowChart)
    app.add_lexer("csv", TextLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
