"""The cards of all linkages, which a small script filters by what is typed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from bifurc.tables import count_of
from docs.generator.linkage_record import LinkageRecord
from docs.generator.pictures import drawing_of
from linkages.entry import Entry


@dataclass(frozen=True)
class Card:
    """What the gallery knows of a linkage; ``words`` is what a search looks through."""

    name: str
    title: str
    source: str
    joints: int
    forms: int
    bifurcations: int

    @property
    def words(self) -> str:
        """Name, title and source in lower case."""
        return f"{self.name} {self.title} {self.source}".lower()


def cards_of(
    entries: Mapping[str, Entry], records: Mapping[str, LinkageRecord]
) -> list[Card]:
    """A card for each entry, in their order."""
    cards = []
    for name, entry in entries.items():
        record = records[name]
        cards.append(
            Card(
                name=name,
                title=entry.title,
                source=entry.source,
                joints=record.joints,
                forms=record.form_count,
                bifurcations=record.bifurcation_count,
            )
        )
    return cards


def search_html(cards: Sequence[Card]) -> str:
    """The fields by which the cards below are searched."""
    joints = _choice("joints", "joints", {card.joints for card in cards})
    forms = _choice("forms", "forms", {card.forms for card in cards})
    return f"""<form class="gallery-search" role="search">
<label class="gallery-words">search
<input type="search" name="words" placeholder="name, title or author"></label>
{joints}
{forms}
<output class="gallery-count" aria-live="polite">{len(cards)} linkages</output>
</form>
"""


def gallery_html(cards: Iterable[Card], root: str) -> str:
    """The cards; ``root`` leads from the page to the top of the site."""
    shown = "\n".join(_card(card, root) for card in cards)
    return f'<div class="gallery">\n{shown}\n</div>'


def _choice(name: str, label: str, values: set[int]) -> str:
    options = "".join(f"<option>{value}</option>" for value in sorted(values))
    any_value = '<option value="">any</option>'
    return f'<label>{label} <select name="{name}">{any_value}{options}</select></label>'


def _card(card: Card, root: str) -> str:
    picture = f"{root}pictures/{drawing_of(card.name)}"
    counts = ", ".join(
        [
            count_of(card.joints, "joint"),
            count_of(card.forms, "form"),
            count_of(card.bifurcations, "bifurcation"),
        ]
    )
    return (
        f'<a class="gallery-card" href="{root}linkages/{card.name}.html"'
        f' data-joints="{card.joints}" data-forms="{card.forms}"'
        f' data-words="{escape(card.words)}">'
        f'<img src="{picture}" alt="" loading="lazy" width="360" height="360">'
        f"<strong>{escape(card.title)}</strong>"
        f"<code>{card.name}</code><span>{counts}</span></a>"
    )
