"""The pictures of a linkage show it as it can be seen."""

import re

import numpy as np

from docs.generator.pictures import clearest_configuration, draw_linkage
from tests.maps import map_of


def test_a_parallelogram_is_not_drawn_folded():
    theta = clearest_configuration(map_of("parallelogram"))
    assert np.abs(np.sin(theta)).max() > 0.5


def test_drawing_and_map_are_written_without_empty_margins(tmp_path):
    draw_linkage(map_of("bennett"), "bennett", tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "bennett-drawing.svg",
        "bennett-map.svg",
    }
    drawing = (tmp_path / "bennett-drawing.svg").read_text(encoding="utf-8")
    width, height = map(
        float, re.search(r'viewBox="0 0 (\S+) (\S+)"', drawing).groups()
    )
    assert max(width, height) < 330  # the figure has 360 points a side
