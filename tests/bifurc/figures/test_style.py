"""Colours that can be seen: on a white page, on a dark one."""

import numpy as np
import pytest

from bifurc.figures.style import COLORS, color_on_dark

WHITE, DARK = "#ffffff", "#14171b"
SEEN = 2.0  # contrast of a thick line in print
SEEN_ON_DARK = 3.0  # of Web Content Accessibility Guidelines 2.1, for graphics


def luminance(color):
    """Relative luminance (WCAG 2.1) of a colour "#rrggbb"."""
    parts = np.array([int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    linear = np.where(parts > 0.04045, ((parts + 0.055) / 1.055) ** 2.4, parts / 12.92)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(color, ground):
    low, high = sorted([luminance(color), luminance(ground)])
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("color", COLORS)
def test_every_colour_stands_out_on_white_and_its_stand_in_on_dark(color):
    assert contrast(color, WHITE) > SEEN
    assert contrast(color_on_dark(color), DARK) > SEEN_ON_DARK


def test_colours_stay_different_on_dark():
    assert len({color_on_dark(color) for color in COLORS}) == len(COLORS)
