"""An atlas with everything that an atlas can hold, and what identical means."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from bifurc.atlas import Atlas, Event, NearMotion, Surface
from bifurc.diagrams.diagram import (
    Branching,
    Diagram,
    DiagramPoint,
    Stability,
    Stretch,
)
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering


def first_difference(a: object, b: object, where: str = "value") -> str:
    """The first place where two nestings of records, arrays and plain values differ in
    type or by one bit; empty where there is none."""
    if type(a) is not type(b):
        return f"{where}: {type(a)} and {type(b)}"
    if isinstance(a, np.ndarray):
        alike = a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        return "" if alike else f"{where}: {a!r} and {b!r}"
    if is_dataclass(a):
        names = [field.name for field in fields(a)]
        parts = [(f".{name}", getattr(a, name), getattr(b, name)) for name in names]
    elif isinstance(a, tuple | list):
        if len(a) != len(b):
            return f"{where}: {len(a)} and {len(b)} entries"
        parts = [(f"[{i}]", x, y) for i, (x, y) in enumerate(zip(a, b, strict=True))]
    elif isinstance(a, Mapping):
        if list(a) != list(b):
            return f"{where}: keys {list(a)} and {list(b)}"
        parts = [(f"[{key!r}]", a[key], b[key]) for key in a]
    else:
        return "" if a == b else f"{where}: {a!r} and {b!r}"
    differences = (first_difference(x, y, where + name) for name, x, y in parts)
    return next((text for text in differences if text), "")


@pytest.fixture(scope="session")
def difference() -> Callable[[object, object], str]:
    return first_difference


@pytest.fixture(scope="package")
def atlas() -> Atlas:
    """Two lines that cross on a torus and in a box: a closed and an open form, with
    everything an atlas can hold."""
    problem = FunctionProblem(
        lambda u: np.array([np.sin(u[0]) * np.sin(u[1])]),
        [[-np.inf, np.inf], [-2.0, 2.0]],
        names=("x", "y"),
        units=("rad", "rad"),
        periods=(2 * np.pi, np.inf),
    )
    curves = explore(problem, settings=SearchSettings(starts=40))
    assert {form.branch.closed for form in curves.forms} == {True, False}
    label = {
        "inactive": ("x",),
        "at": np.pi / 3,
        "fixed": {1: np.float64(0.1)},
        "free": [None, True],
    }
    named = curves.renamed(
        [f"Form {chr(945 + i)}, no. {i}" for i in range(3)],
        [label, {}, {"symmetry": "none"}],
    )
    branches = [form.branch for form in named.forms]
    closed = next(branch for branch in branches if branch.closed)
    opened = next(branch for branch in branches if not branch.closed)
    linkage = {
        "name": "a pair",
        "lengths": [1.0, 0.1 + 0.2],
        "twists": np.array([0.1, -0.0]),
        "offsets": (0, 1),
    }
    return replace(
        named,
        rigid=np.array([[0.1, 1 / 3]]),
        closure_gap=1e-300,
        near_motions=(
            NearMotion("one", 1e-9, closed, np.array([0.1, 0.2])),
            NearMotion("two", 2e-3, opened, np.array([-0.0, 0.2])),
            NearMotion("three", 1e-5, None, np.array([0.3, 0.2]), mobility=2),
        ),
        subject=linkage,
        near_misses=(Event(2, 1 / 3, np.array([0.1, 0.7]), value=1e-5, error=1e-20),),
        diagram=Diagram(
            "y",
            (
                DiagramPoint(
                    "F1",
                    Kind.FOLD,
                    1,
                    1 / 3,
                    np.array([0.1, -0.0]),
                    7.0,
                    error=0.2,
                ),
                DiagramPoint("E1", Kind.EVENT, 0, 0.0, np.zeros(2), -1e-300, "a name"),
            ),
            (
                Stretch(0, 0.0, 2 / 3, Stability.UNSTABLE, 2),
                Stretch(1, 0.1, 7.0, Stability.UNKNOWN, -1),
            ),
            (Branching(1, Kind.SUBCRITICAL),),
            ("event 'a name': it jumps", "and another"),
        ),
        dead_points=(
            Event(0, 2 / 3, np.array([0.3, -0.0]), index=1),
            Event(1, 0.0, np.zeros(2), index=0),
        ),
        surfaces=(
            Surface(2, np.eye(2), note="not all of it"),
            Surface(3, np.ones((3, 2)) / 7),
            Surface(2, np.zeros((0, 2)), "plane", two_charts(curves.periods)),
        ),
    )


def two_charts(periods: np.ndarray) -> ChartAtlas:
    """Two triangles with an edge in common."""
    return ChartAtlas(
        centers=np.array([[0.0, 0.1], [0.3, 0.2]]),
        bases=np.stack([np.eye(2), np.eye(2)[::-1]]),
        radii=np.array([0.5, 0.25]),
        neighbours=np.array([[0, 1]]),
        vertices=np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]),
        polygons=np.array([0, 1, 2, 1, 3, 2]),
        polygon_sizes=np.array([3, 3]),
        areas=np.array([0.5, 0.75]),
        area_errors=np.array([1e-9, 0.125]),
        periods=periods,
        outcome=Covering.CHART_LIMIT,
    )
