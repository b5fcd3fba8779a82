"""Curves of many unknowns, found by sparse matrices, against what is known of them."""

import numpy as np
import pytest

import bifurc
from bifurc.search import many_unknowns
from bifurc.search.explore import explore

M = 109  # unknowns beside the parameter: sparse, and quick


@pytest.fixture(autouse=True)
def _few_are_many(monkeypatch):
    monkeypatch.setattr(many_unknowns, "MANY", 100)


def second(u, length=1.0):
    walls = np.concatenate([[0.0], u, [0.0]])
    step = length / (M + 1)
    return (walls[2:] - 2 * walls[1:-1] + walls[:-2]) / step**2


def bratu_with_parameter_first(x):
    return second(x[1:]) + x[0] * np.exp(x[1:])


def cubic(x):
    u, p = x[:-1], x[-1]
    return p * u + second(u, np.pi) - u**3


def wave(number):
    return 4 * np.sin(0.5 * number * np.pi / (M + 1)) ** 2 / (np.pi / (M + 1)) ** 2


def test_the_fold_of_a_field_is_found_within_its_bounds():
    names = ["p", *(f"u{k}" for k in range(1, M + 1))]
    bounds = [(0, 5), *[(-1, 10)] * M]
    problem = bifurc.FunctionProblem(bratu_with_parameter_first, bounds, names=names)
    middle = names[(M + 1) // 2]
    atlas = explore(problem, parameter="p", events={"one": (middle, 1.0)})
    (form,) = atlas.forms
    (fold,) = atlas.diagram.folds
    step = 1 / (M + 1)
    assert abs(fold.u[0] - 3.513830719) < 2 * step**2  # its limit
    (event,) = atlas.diagram.events("one")
    ends = form.branch(np.array([0.0, form.branch.length]))
    highest = ends[:, 1:].max(axis=1)
    assert np.allclose(sorted(highest), [0.0, 10.0], atol=1e-6)
    assert abs(event.u[(M + 1) // 2] - 1.0) < 1e-9
    s = np.linspace(0, form.branch.length, 50)
    gaps = [np.abs(bratu_with_parameter_first(u)).max() for u in form.branch(s)]
    assert max(gaps) < 1e-6 / step**2
    assert np.allclose(np.linalg.norm(form.branch(s, 1), axis=1), 1.0, atol=1e-6)
    assert form.branch(fold.s)[0] == pytest.approx(fold.u[0], abs=1e-6)
    assert atlas.completeness.level is bifurc.Level.ESTIMATED
    assert atlas.completeness.is_in_doubt


def test_curves_that_leave_crossings_are_followed():
    bounds = {**{f"u{k}": (-3, 3) for k in range(M)}, "p": (0, 3)}
    problem = bifurc.FunctionProblem(cubic, bounds)
    atlas = explore(problem, parameter="p", is_flow=False)
    (crossing,) = atlas.bifurcations
    assert abs(crossing.point.u[-1] - wave(1)) < 1e-9
    assert len(atlas.forms) == 2 and atlas.components == 1
    assert sorted(form for form, _ in crossing.passes) == [0, 1]
    assert not crossing.note and not atlas.diagram.folds
    waves = [np.abs(form.branch.ends[:, :-1]).max() > 0.5 for form in atlas.forms]
    assert sorted(waves) == [False, True]


def test_what_time_leaves_is_said():
    bounds = {**{f"u{k}": (-3, 3) for k in range(M)}, "p": (0, 3)}
    problem = bifurc.FunctionProblem(cubic, bounds)
    settings = bifurc.SearchSettings(budget=1e-3)
    atlas = explore(problem, parameter="p", settings=settings)
    assert atlas.provenance.out_of_time
    assert atlas.completeness.level is bifurc.Level.OUT_OF_TIME
