"""The relations between linkages can be drawn."""

from studies.relations_figure import draw_relations


def test_the_relations_are_drawn_with_every_linkage_that_has_one():
    figure = draw_relations()
    shown = "\n".join(text.get_text() for text in figure.axes[0].texts).replace(
        "\n", ""
    )
    for name in ("bennett-lb-2", "wohlhart-symmetric", "torus-5r"):
        assert name in shown
