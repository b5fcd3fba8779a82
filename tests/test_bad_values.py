"""Bad values at the front door end in an error of these packages that names the thing
and says what is allowed."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

import bifurc
import linkages
from bifurc import BifurcError, FunctionProblem, SearchSettings, TraceSettings
from bifurc.seeds import Seeds
from linkages import Closure, Loop

NAN = float("nan")
INF = float("inf")
SQUARE = [(-2.0, 2.0), (-2.0, 2.0)]


def circle_equation(u):
    return np.array([u[0] ** 2 + u[1] ** 2 - 1.0])


CIRCLE = FunctionProblem(circle_equation, SQUARE)
ATLAS = bifurc.explore(CIRCLE, settings=SearchSettings(starts=20))
BENNETT = linkages.load("bennett")
BENNETT_ATLAS = linkages.map_linkage(BENNETT)
BRANCH = ATLAS.forms[0].branch


def problem(function=circle_equation, bounds=SQUARE, **options):
    return FunctionProblem(function, bounds, **options)


def with_jacobian(row):
    return problem(jacobian=lambda u: np.array(row(u), dtype=float))


def seeds_at(points):
    return Seeds(points, np.ones(len(points), bool), np.empty(0), np.empty((0, 2)))


# what is tried, what the error names
CASES: dict[str, tuple[Callable[[], object], str]] = {
    "a function that is none": (lambda: problem(3), "function"),
    "no function": (lambda: problem(None), "function"),
    "a function of text": (lambda: problem(lambda u: "a"), "value of the function"),
    "a function of nothing": (lambda: problem(lambda u: None), "value of the function"),
    "a function of a number": (
        lambda: problem(lambda u: u[0]),
        "value of the function",
    ),
    "a function of a matrix": (
        lambda: problem(lambda u: np.eye(2)),
        "value of the function",
    ),
    "a function of an empty vector": (
        lambda: problem(lambda u: np.empty(0)),
        "value of the function",
    ),
    "a function that is nowhere finite": (
        lambda: problem(lambda u: np.array([NAN])),
        "value of the function",
    ),
    "a number of equations that changes": (
        lambda: problem(lambda u: np.zeros(1 + int(u[0] > 0))),
        "number of equations",
    ),
    "no bounds": (lambda: problem(bounds=None), "bounds"),
    "bounds of text": (lambda: problem(bounds="ab"), "bounds"),
    "bounds out of order": (lambda: problem(bounds=[(1, -1), (0, 1)]), "bounds"),
    "bounds that are no numbers": (
        lambda: problem(bounds=[(NAN, 1), (0, 1)]),
        "bounds",
    ),
    "ragged bounds": (lambda: problem(bounds=[(0, 1), (0,)]), "bounds"),
    "empty bounds": (lambda: problem(bounds=[]), "bounds"),
    "a jacobian that is none": (lambda: problem(jacobian=3), "jacobian"),
    "a jacobian of another shape": (
        lambda: with_jacobian(lambda u: np.eye(2)),
        "shape of the jacobian",
    ),
    "a jacobian with one dimension": (
        lambda: with_jacobian(lambda u: [2 * u[0], 2 * u[1]]),
        "shape of the jacobian",
    ),
    "a jacobian of another function": (
        lambda: with_jacobian(lambda u: [[2 * u[0], -2 * u[1]]]),
        "jacobian[0, 1]",
    ),
    "a jacobian that is not finite": (
        lambda: with_jacobian(lambda u: [[NAN, 2 * u[1]]]),
        "jacobian",
    ),
    "a place on a branch that is no number": (lambda: BRANCH.begun_at(NAN), "s"),
    "a point that is no number": (lambda: BRANCH.passes([NAN, 0.0], 0.1), "point"),
    "a point of another shape": (lambda: BRANCH.passes([[1.0, 0.0]], 0.1), "point"),
    "a distance that is no number": (lambda: BRANCH.passes([1.0, 0.0], NAN), "within"),
    "a negative distance": (lambda: BRANCH.nearest([[1.0, 0.0]], -1.0), "within"),
    "a distance of text": (lambda: BRANCH.nearest([[1.0, 0.0]], "a"), "within"),
    "complex points": (lambda: BRANCH.nearest([[1j, 0.0]]), "points"),
    "an unknown that there is not": (lambda: BRANCH.turning_points(2), "unknown"),
    "an unknown that is no number": (lambda: BRANCH.turning_points("a"), "unknown"),
    "half a derivative": (lambda: BRANCH(0.0, 1.5), "derivative"),
    "half a turn": (lambda: BRANCH.moved_by_periods([0.5, 0]), "turns"),
    "turns of other unknowns": (lambda: BRANCH.moved_by_periods([1]), "turns"),
    "one configuration for many": (
        lambda: Closure(BENNETT.loop).residuals([1.0, 2.0, 3.0, 4.0]),
        "shape of points",
    ),
    "configurations of another loop": (
        lambda: Closure(BENNETT.loop).jacobians([[1.0, 2.0]]),
        "shape of points",
    ),
    "starts of nothing": (
        lambda: Closure(BENNETT.loop).project(None),
        "shape of starts",
    ),
    "a sphere of no size": (
        lambda: Closure(BENNETT.loop).project_to_sphere(
            np.zeros((1, 4)), np.zeros(4), 0.0
        ),
        "radius",
    ),
    "one name for two unknowns": (lambda: problem(names=["a"]), "number of names"),
    "names that are no texts": (lambda: problem(names=3), "names"),
    "a text for names": (lambda: problem(names="ab"), "names"),
    "one name twice": (lambda: problem(names=["a", "a"]), "names"),
    "one unit for two unknowns": (lambda: problem(units=["mm"]), "number of units"),
    "units that are no texts": (lambda: problem(units=[1, 2]), "units"),
    "a negative period": (lambda: problem(periods=[-1, 1]), "periods"),
    "a period that is no number": (lambda: problem(periods=[NAN, 1]), "periods"),
    "periods of text": (lambda: problem(periods="ab"), "periods"),
    "a period too few": (lambda: problem(periods=[1.0]), "number of periods"),
    "no problem to explore": (lambda: bifurc.explore(None), "problem"),
    "a loop to explore": (lambda: bifurc.explore(BENNETT.loop), "problem"),
    "settings of another type": (
        lambda: bifurc.explore(CIRCLE, settings=200),
        "settings",
    ),
    "a fraction for a seed": (lambda: bifurc.explore(CIRCLE, seed=0.5), "seed"),
    "a negative seed": (lambda: bifurc.explore(CIRCLE, seed=-1), "seed"),
    "an array for seeds": (
        lambda: bifurc.explore(CIRCLE, seeds=np.zeros((1, 2))),
        "seeds",
    ),
    "seeds in three unknowns": (
        lambda: bifurc.explore(CIRCLE, seeds=seeds_at(np.zeros((1, 3)))),
        "shape of the seeds",
    ),
    "progress that is no function": (
        lambda: bifurc.explore(CIRCLE, progress=3),
        "progress",
    ),
    "no problem to trace": (lambda: bifurc.trace_branch(None, [1, 0]), "problem"),
    "a start in one unknown": (
        lambda: bifurc.trace_branch(CIRCLE, [1.0]),
        "shape of start",
    ),
    "a start that is no number": (
        lambda: bifurc.trace_branch(CIRCLE, [NAN, 0]),
        "start",
    ),
    "a start of text": (lambda: bifurc.trace_branch(CIRCLE, "ab"), "start"),
    "a direction in one unknown": (
        lambda: bifurc.trace_branch(CIRCLE, [1, 0], [1]),
        "shape of direction",
    ),
    "a direction of length zero": (
        lambda: bifurc.trace_branch(CIRCLE, [1, 0], [0, 0]),
        "direction",
    ),
    "a direction that is no number": (
        lambda: bifurc.trace_branch(CIRCLE, [1, 0], [0, NAN]),
        "direction",
    ),
    "a number for settings of tracing": (
        lambda: bifurc.trace_branch(CIRCLE, [1, 0], None, 3),
        "settings",
    ),
    "pieces of order 1": (lambda: TraceSettings(order=1), "order"),
    "pieces that are too short": (lambda: TraceSettings(order=4), "order"),
    "pieces of order 99": (lambda: TraceSettings(order=99), "order"),
    "pieces of half an order": (lambda: TraceSettings(order=3.5), "order"),
    "a tolerance of text": (lambda: TraceSettings(tolerance="a"), "tolerance"),
    "a tolerance that is no number": (
        lambda: TraceSettings(tolerance=NAN),
        "tolerance",
    ),
    "a tolerance of zero": (lambda: TraceSettings(tolerance=0.0), "tolerance"),
    "steps out of order": (lambda: TraceSettings(shortest=3.0), "shortest"),
    "a length that is no number": (lambda: TraceSettings(max_length=NAN), "max_length"),
    "no starts": (lambda: SearchSettings(starts=0), "starts"),
    "true starts": (lambda: SearchSettings(starts=True), "starts"),
    "starts of text": (lambda: SearchSettings(starts="a"), "starts"),
    "a budget of zero": (lambda: SearchSettings(budget=0.0), "budget"),
    "a budget that is no number": (lambda: SearchSettings(budget=NAN), "budget"),
    "a budget of text": (lambda: SearchSettings(budget="a"), "budget"),
    "fewer charts than none": (lambda: SearchSettings(charts=-1), "charts"),
    "a word for count": (lambda: SearchSettings(count="yes"), "count"),
    "a number for tracing": (lambda: SearchSettings(tracing=3), "tracing"),
    "a loose tolerance in a search": (
        lambda: SearchSettings(tracing=TraceSettings(tolerance=1e-4)),
        "tolerance",
    ),
    "no atlas to save": (lambda: bifurc.save_atlas(None, "a.nc"), "atlas"),
    "no atlas for a dataset": (lambda: bifurc.to_dataset({}), "atlas"),
    "no dataset for an atlas": (lambda: bifurc.from_dataset(None), "dataset"),
    "a dataset of something else": (
        lambda: bifurc.from_dataset(xr.Dataset()),
        "dataset",
    ),
    "a folder for a file": (lambda: bifurc.load_atlas("."), "folder"),
    "no atlas for a graph": (lambda: bifurc.transition_graph(None), "atlas"),
    "no atlas for a graph of arcs": (lambda: bifurc.arc_graph(None), "atlas"),
    "no atlas for a route": (lambda: bifurc.find_route(None, "a", "b"), "atlas"),
    "a route from nowhere": (
        lambda: bifurc.find_route(BENNETT_ATLAS, None, "Bennett form"),
        "configuration",
    ),
    "a route from an unknown form": (
        lambda: bifurc.find_route(BENNETT_ATLAS, "Form 9", "Bennett form"),
        "Form 9",
    ),
    "a route from two angles of four": (
        lambda: bifurc.find_route(BENNETT_ATLAS, [1.0, 2.0], "Bennett form"),
        "configuration",
    ),
    "a route from no number": (
        lambda: bifurc.find_route(BENNETT_ATLAS, [NAN] * 4, "Bennett form"),
        "configuration",
    ),
    "a route from off the forms": (
        lambda: bifurc.find_route(BENNETT_ATLAS, [0.1] * 4, "Bennett form"),
        "away from the nearest form",
    ),
    "a route of no points": (
        lambda: bifurc.find_route(ATLAS, "Form 1", "Form 1", count=0),
        "count",
    ),
    "a route of half a point": (
        lambda: bifurc.find_route(ATLAS, "Form 1", "Form 1", count=2.5),
        "count",
    ),
    "a route with a number for a problem": (
        lambda: bifurc.find_route(ATLAS, "Form 1", "Form 1", problem=3),
        "problem",
    ),
    "no problem for certificates": (
        lambda: bifurc.certify_atlas(None, ATLAS),
        "problem",
    ),
    "no atlas for certificates": (lambda: bifurc.certify_atlas(CIRCLE, None), "atlas"),
    "certificates by another problem": (
        lambda: bifurc.certify_atlas(CIRCLE, BENNETT_ATLAS),
        "unknowns of the atlas",
    ),
    "no atlas to draw": (lambda: bifurc.plot_transition_map(None), "atlas"),
    "an unknown to draw that is none": (
        lambda: bifurc.plot_transition_map(ATLAS, joints=(1, 7)),
        "7",
    ),
    "a negative derivative": (lambda: BRANCH(0.0, -1), "derivative"),
    "fewer samples than none": (lambda: BRANCH.sample(-1), "count"),
    "the foot of a point in three unknowns": (
        lambda: BRANCH.nearest([1.0, 2.0, 3.0]),
        "shape of the points",
    ),
    "the foot of no point": (lambda: BRANCH.nearest([NAN, 1.0]), "points"),
    "a name with a typo": (lambda: linkages.load("benett"), "benett"),
    "no name": (lambda: linkages.load(None), "None"),
    "a parameter with a typo": (lambda: linkages.load("bennett", alhpa=1.0), "alhpa"),
    "a parameter of text": (lambda: linkages.load("bennett", alpha="x"), "alpha"),
    "a parameter that is no number": (
        lambda: linkages.load("bennett", alpha=NAN),
        "alpha",
    ),
    "no value of a parameter": (lambda: linkages.load("bennett", alpha=None), "alpha"),
    "a loop of three joints": (lambda: Loop((1,) * 3, (0,) * 3, (0,) * 3), "joints"),
    "a loop of thirteen joints": (
        lambda: Loop((1,) * 13, (0,) * 13, (0,) * 13),
        "joints",
    ),
    "a twist too few": (lambda: Loop((1,) * 4, (0,) * 3, (0,) * 4), "twists"),
    "a length that is not finite": (
        lambda: Loop((1, 1, 1, INF), (0,) * 4, (0,) * 4),
        "length",
    ),
    "a loop of text": (lambda: Loop("abcd", (0,) * 4, (0,) * 4), "length"),
    "a complex length": (lambda: Loop((1j,) * 4, (0,) * 4, (0,) * 4), "length"),
    "no loop": (lambda: Loop(None, None, None), "length"),
    "axes of no direction": (
        lambda: linkages.loop_from_axes(np.zeros((4, 3)), np.zeros((4, 3))),
        "direction",
    ),
    "points in a plane": (
        lambda: linkages.loop_from_axes(np.zeros((4, 2)), np.ones((4, 3))),
        "points",
    ),
    "points that are no numbers": (
        lambda: linkages.loop_from_axes(np.full((4, 3), NAN), np.ones((4, 3))),
        "points",
    ),
    "no loop to close": (lambda: Closure(None), "subject"),
    "no linkage to map": (lambda: linkages.map_linkage(None), "linkage"),
    "a name to map": (lambda: linkages.map_linkage("bennett"), "linkage"),
    "settings of another type for a map": (
        lambda: linkages.map_linkage(BENNETT, settings=3),
        "settings",
    ),
    "the loop of a circle": (lambda: linkages.loop_of(ATLAS), "subject"),
    "the loop of nothing": (lambda: linkages.loop_of(None), "atlas"),
    "assemblies of seven joints": (
        lambda: linkages.isolated_assemblies(Loop((1.0,) * 7, (0.3,) * 7, (0.0,) * 7)),
        "joints",
    ),
    "assemblies of nothing": (lambda: linkages.isolated_assemblies(None), "loop"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_bad_value_is_refused_by_name(case: str) -> None:
    attempt, named = CASES[case]
    with pytest.raises(BifurcError) as caught:
        attempt()
    assert named in str(caught.value)


def test_a_function_that_is_not_defined_everywhere_is_followed_where_it_is() -> None:
    def equation(u):
        with np.errstate(invalid="ignore"):
            return np.array([np.sqrt(u[0]) - u[1]])

    atlas = bifurc.explore(
        FunctionProblem(equation, [(-1.0, 1.0), (-1.0, 2.0)]),
        settings=SearchSettings(starts=20),
    )
    (form,) = atlas.forms
    np.testing.assert_allclose(form.branch.sample(50)[:, 1].max(), 1.0, atol=1e-9)


def test_atlases_compare_by_identity() -> None:
    other = bifurc.explore(CIRCLE, settings=SearchSettings(starts=20))
    assert other != ATLAS
    assert len({ATLAS, other, ATLAS}) == 2
    assert ATLAS.forms[0] != other.forms[0]


def test_nothing_is_near_a_branch_of_no_pieces() -> None:
    nowhere = FunctionProblem(lambda u: np.array([u @ u + 1.0]), SQUARE)
    branch = bifurc.trace_branch(nowhere, [0.5, 0.5])
    assert not len(branch.pieces)
    distances, _ = branch.nearest([[0.0, 0.0], [1.0, 1.0]])
    assert np.all(np.isinf(distances))
