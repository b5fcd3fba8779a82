"""A configuration of a linkage, drawn."""

import numpy as np

from docs.generator.scene_figure import draw_configuration
from linkages.catalogue import entry


def test_a_configuration_is_drawn_with_its_joint_numbers():
    figure = draw_configuration(
        entry("bennett").build(), np.array([1.0, 2.0, -1.0, -2.0]), "Bennett"
    )
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[0].texts] == ["1", "2", "3", "4"]
