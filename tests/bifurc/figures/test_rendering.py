"""Both formats at once: the same pictures as matplotlib's own."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from bifurc.atlas import Atlas
from bifurc.figures.plotting import (
    RESOLUTION,
    plot_form_graph,
    plot_joint_angles,
    plot_singular_values,
    plot_transition_map,
)
from bifurc.figures.rc import drawing_style
from bifurc.figures.rendering import LONGEST, contents_of, render

PLOTS = [plot_transition_map, plot_joint_angles, plot_singular_values, plot_form_graph]


def saved(figure: Figure, ending: str, resolution: float) -> bytes:
    stream = io.BytesIO()
    metadata = {"Date": None, "Creator": None} if ending == "svg" else None
    figure.savefig(stream, format=ending, dpi=resolution, metadata=metadata)
    return stream.getvalue()


def pixels(content: bytes) -> np.ndarray:
    image = Image.open(io.BytesIO(content)).convert("RGB")
    return np.asarray(image, dtype=float) / 255


@pytest.mark.parametrize("plot", PLOTS)
def test_the_svg_file_is_that_of_matplotlib(plot, parallelogram: Atlas) -> None:
    with drawing_style():
        ours = render(plot(parallelogram), 100).svg
        theirs = saved(plot(parallelogram), "svg", 100)
    assert ours == theirs


@pytest.mark.parametrize("plot", PLOTS)
def test_the_png_file_differs_from_that_of_matplotlib_by_parts_of_a_pixel(
    plot, parallelogram: Atlas
) -> None:
    """Texts stand elsewhere by up to a pixel: few pixels are far off, and coarser ones
    agree."""
    with drawing_style():
        ours = pixels(render(plot(parallelogram), RESOLUTION).png)
        theirs = pixels(saved(plot(parallelogram), "png", RESOLUTION))
    assert ours.shape == theirs.shape
    assert np.mean(np.abs(ours - theirs) > 0.3) < 0.02
    assert np.abs(coarse(ours) - coarse(theirs)).max() < 0.1


def coarse(image: np.ndarray) -> np.ndarray:
    """Means over squares of 20 x 20 pixels."""
    rows, columns = (20 * (size // 20) for size in image.shape[:2])
    blocks = image[:rows, :columns].reshape(rows // 20, 20, columns // 20, 20, 3)
    return blocks.mean(axis=(1, 3))


def test_of_a_long_text_the_beginning_is_shown():
    figure = Figure()
    texts = figure.supxlabel("x" * 10_000), figure.suptitle("y" * LONGEST)
    contents_of(figure, RESOLUTION, ["svg"])
    shown = [text.get_text() for text in texts]
    assert shown == ["x" * (LONGEST - 1) + "…", "y" * LONGEST]
