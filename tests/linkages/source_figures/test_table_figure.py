"""Printed tables: what stands in their cells is the geometry of the catalogue."""

import numpy as np
import pytest

from linkages import load
from linkages.catalogue import entry
from linkages.construction.constructions import lock
from linkages.construction.link import basic_links
from linkages.construction.spatial_triangle import Kink
from linkages.families.mixed_double_goldberg import Kind, Order
from linkages.source_figures.draw import draw_source_figure
from linkages.source_figures.table import figure_named
from linkages.source_figures.table_figure import link_texts

TWISTS = np.radians([66, 50, 28, 83])
LINKS = basic_links(1.553, *TWISTS)


def value(text, symbols):
    """The sum that a cell writes, such as a−c."""
    total = symbols[text[0]]
    for sign, name in zip(text[1::2], text[2::2], strict=True):
        total += symbols[name] if sign == "+" else -symbols[name]
    return total


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("order", Order)
def test_the_cells_of_a_type_are_the_links_of_the_catalogue(order, kind):
    name = f"{kind.value.prefix}-type-{order.name.lower()}"
    alpha, beta, gamma, delta = TWISTS
    loop = load(name, a=1.553, alpha=alpha, beta=beta, gamma=gamma, delta=delta).loop
    lengths = {letter: link.length for letter, link in LINKS.items()}
    twists = dict(zip("αβγδ", TWISTS, strict=True))
    cells = [text.split("\n") for text in link_texts(order, kind)]
    shown = [(value(first, lengths), value(second, twists)) for first, second in cells]
    links = np.column_stack([loop.arrays.lengths, loop.arrays.twists])
    np.testing.assert_allclose(shown, links, atol=1e-12)
    assert not np.any(loop.arrays.offsets)


@pytest.mark.parametrize(
    ("kind", "kink", "sign"),
    [
        (Kind.GOLDBERG, Kink.FOLDED, -1),
        (Kind.MIXED, Kink.STRAIGHT, 1),
        (Kind.SUBTRACTIVE, Kink.FOLDED, -1),
    ],
)
def test_type_iii_is_the_5r_that_the_tables_name(kind, kink, sign):
    member = entry(f"{kind.value.prefix}-type-iii")
    loop = member.build(beta=TWISTS[1], delta=TWISTS[3])
    merged = lock(loop, 3, kink).arrays
    assert np.cos(member.facts["locked"][3]) == pytest.approx(1 - 2 * kink.value)
    assert merged.twists[1] == pytest.approx(TWISTS[1] + sign * TWISTS[3])


def test_a_table_of_one_family_has_a_column_for_each_link():
    figure = draw_source_figure(figure_named("thesis-table-3.5.1"))
    cells = figure.axes[0].tables[0].get_celld()
    texts = {place: cell.get_text().get_text() for place, cell in cells.items()}
    heads = [texts[0, column] for column in range(2, 8)]
    assert heads == ["12", "23", "34", "45", "56", "61"]
    assert texts[1, 2] == "a−c\nα−γ"
    assert texts[2, 1] == "Baker's second variant"
