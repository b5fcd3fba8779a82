"""What a prompt and a notebook show of an atlas: a few telling lines, and tables."""

from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from bifurc.atlas import SHOWN, SHOWN_IN_NOTEBOOK, Atlas, Surface
from bifurc.completeness import Level
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """A circle that a line crosses twice, and an arc that comes near to them."""
    problem = FunctionProblem(
        lambda u: np.array(
            [(u[0] ** 2 + u[1] ** 2 - 1) * u[1] * ((u[0] - 3) ** 2 + u[1] ** 2 - 0.25)]
        ),
        [(-2, 4)] * 2,
    )
    return explore(problem, settings=SearchSettings(starts=60))


@pytest.fixture(scope="module")
def nothing() -> Atlas:
    problem = FunctionProblem(lambda u: np.array([u @ u + 0.5]), [(-2, 2)] * 2)
    return explore(problem, settings=SearchSettings(starts=10))


class Reader(HTMLParser):
    """The tags and the texts of a piece of HTML; every tag must be closed in turn."""

    def __init__(self, text: str):
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.seen.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def test_a_prompt_shows_forms_bifurcations_and_the_level_in_a_few_lines(atlas):
    lines = repr(atlas).splitlines()
    assert len(lines) == 2 + len(atlas.forms) + len(atlas.points)
    assert lines[0].startswith("<Atlas of u1, u2: 3 forms, 1 component, 4 bifurcations")
    for form, line in zip(atlas.forms, lines[1:], strict=False):
        assert line.startswith(f"  {form.name}: length {form.branch.length:.6g}, ")
        assert ("closed" in line) == form.branch.closed
    for point in atlas.points:
        names = ", ".join(atlas.forms[form].name for form, _ in point.passes)
        assert f"  {point.name}: bifurcation of {names}" in lines
    assert lines[-1] == "  completeness: counted>"
    assert len(repr(atlas)) < 1000


def test_of_many_things_the_first_are_shown_and_the_others_counted(atlas):
    many = replace(atlas, forms=atlas.forms[:1] * (SHOWN + 5), points=())
    assert "and 5 more forms" in repr(many)
    assert len(repr(many).splitlines()) == SHOWN + 3
    rigid = replace(atlas, rigid=np.zeros((SHOWN_IN_NOTEBOOK + 7, 2)))
    assert f"{SHOWN_IN_NOTEBOOK + 7} rigid assemblies" in repr(rigid)
    assert "and 7 more" in Reader(rigid._repr_html_()).texts


def test_an_atlas_of_nothing_says_so(nothing):
    assert repr(nothing) == "<Atlas of u1, u2: nothing\n  completeness: counted>"
    assert "table" not in Reader(nothing._repr_html_()).seen


def test_every_part_of_an_atlas_is_one_short_line(atlas):
    surface = Surface(2, np.zeros((3, 2)), "surface 1", note="a remark")
    parts = [*atlas.forms, *atlas.points, *atlas.dead_points, surface]
    for part in parts:
        assert len(repr(part)) < 120
        assert "\n" not in repr(part) and "array" not in repr(part)
    form, point, event = atlas.forms[0], atlas.points[0], atlas.dead_points[0]
    assert repr(form.name) in repr(form)
    assert "bifurcation, rank 0, forms[" in repr(point)
    assert f"dead point of unknown {event.index + 1} on forms[{event.form}]" in repr(
        event
    )
    assert "near miss 0.25" in repr(replace(event, value=0.25, index=-1))
    assert repr(surface) == "<Surface 'surface 1': dimension 2, 3 samples, a remark>"


def test_near_misses_are_shown_with_their_values(atlas):
    miss = replace(atlas.dead_points[0], form=1, value=0.0625, index=-1)
    missed = replace(atlas, near_misses=(miss,))
    assert f"  near miss: 0.0625 on {atlas.forms[1].name}" in repr(missed).splitlines()
    assert "0.0625" in Reader(missed._repr_html_()).texts


def test_a_notebook_shows_tables_of_forms_points_and_completeness(atlas):
    reader = Reader(atlas._repr_html_())
    titles = [text for text in reader.texts if text in ("Forms", "Singular points")]
    assert titles == ["Forms", "Singular points"]
    assert reader.seen.count("tr") == 2 + len(atlas.forms) + len(atlas.points)
    assert "Completeness: counted." in reader.texts
    assert any(atlas.completeness.statement in text for text in reader.texts)


def test_names_cannot_break_the_html_of_a_notebook(atlas):
    names = ["<script>alert('1')</script>", "a & b", '"quoted"']
    reader = Reader(atlas.renamed(names)._repr_html_())
    assert "script" not in reader.seen
    assert set(names) <= set(reader.texts)


def test_levels_are_the_words_that_files_and_screens_show():
    words = ["counted", "certified", "estimated", "out of time", "interrupted"]
    assert list(Level) == words
    assert f"{Level.OUT_OF_TIME}" == "out of time"
