"""The extension that shows atlases with their picture in a notebook."""

from types import SimpleNamespace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.figures.notebook import atlas_page, load_ipython_extension
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


def circle_and_line():
    problem = FunctionProblem(
        lambda u: np.array([(u @ u - 1) * (u[0] - 0.3)]), [(-2, 2)] * 2
    )
    return explore(problem, settings=SearchSettings(starts=40))


class Formatter:
    """What IPython keeps for one kind of text: functions by the type they show."""

    def __init__(self):
        self.functions = {}

    def for_type(self, kind, function):
        self.functions[kind] = function


def test_the_extension_shows_every_atlas_with_its_picture():
    html = Formatter()
    formatters = {"text/html": html, "text/plain": Formatter()}
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters=formatters))
    load_ipython_extension(shell)
    assert html.functions == {Atlas: atlas_page}


def test_the_page_of_an_atlas_is_its_picture_and_its_tables():
    atlas = circle_and_line()
    page = atlas_page(atlas)
    assert page.startswith("<svg") and page.count("</svg>") == 1
    assert page.endswith(atlas._repr_html_())
    assert page == atlas_page(atlas)
