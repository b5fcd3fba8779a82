"""What an atlas says of itself, on curves drawn by hand."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.completeness import Completeness
from bifurc.errors import ProblemError, RouteError
from bifurc.search.answer.completeness import SearchDoubt
from bifurc.torus import wrap
from tests.bifurc.drawn_atlas import draw, ring


def test_wrapped_angles_lie_within_half_a_period_and_its_ends_are_one() -> None:
    periods = np.array([2 * np.pi, np.inf])
    angles = np.pi * np.array([-1, -1 + 1e-14, -1 - 1e-14, 1 + 1e-14, 3, -5, 1])
    points = np.stack([angles, angles], axis=1)
    wrapped = wrap(points, periods)
    assert np.all(wrapped[:, 0] == np.pi)
    assert np.all(wrapped[:, 1] == angles)
    near_the_end = wrap(np.array([-np.pi + 1e-9, 7.0]), periods)
    assert near_the_end == pytest.approx([-np.pi + 1e-9, 7.0], abs=1e-15)


def test_a_form_is_found_by_its_name_or_an_unambiguous_part() -> None:
    branches = {"Form I": ring(0.0), "Form II": ring(1.0), "Bennett 4R": ring(2.0)}
    atlas = draw(branches, {})
    names = ("Form I", "form ii", "bennett", "4R")
    assert [atlas.form(name) for name in names] == [0, 1, 2, 2]
    with pytest.raises(ProblemError, match="name: 3 is not allowed"):
        atlas.form(3)
    with pytest.raises(RouteError):
        atlas.form("Form")


def test_forms_keep_everything_but_their_names_when_renamed() -> None:
    atlas = draw({"a": ring(0.0), "b": ring(1.0)}, {})
    renamed = atlas.renamed(["Form I", "Form II"], [{"symmetry": "line"}, {}])
    assert [f.name for f in renamed.forms] == ["Form I", "Form II"]
    assert renamed.forms[0].labels["symmetry"] == "line"
    assert renamed.forms[0].branch is atlas.forms[0].branch
    doubt = SearchDoubt.ONE_CURVE.of_forms(1, 0, point="B1")
    doubtful = replace(atlas, completeness=Completeness((), (doubt,), 0.1))
    assert "ends of Form 2 and Form 1 at B1" in doubtful.completeness.statement
    named = doubtful.renamed(["a", "b"]).completeness
    assert "ends of b and a at B1" in named.statement
    with pytest.raises(ProblemError, match="2 different names"):
        atlas.renamed(["same", "same"])


def test_the_components_are_counted() -> None:
    atlas = draw({"a": ring(0.0), "b": ring(1.0)}, {})
    other = replace(atlas.forms[1], component=1)
    assert replace(atlas, forms=(atlas.forms[0], other)).components == 2


def test_angles_are_taken_to_within_half_a_period_and_pi_stays_pi() -> None:
    periods = np.array([2 * np.pi, np.inf])
    points = np.array(
        [[-np.pi, -50.0], [np.pi, 50.0], [7.0, 0.0], [-np.pi + 1e-3, 0.0]]
    )
    expected = np.array(
        [[np.pi, -50.0], [np.pi, 50.0], [7.0 - 2 * np.pi, 0.0], [-np.pi + 1e-3, 0.0]]
    )
    np.testing.assert_allclose(wrap(points, periods), expected, atol=1e-14)
