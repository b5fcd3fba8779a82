"""The whole search on problems with known answers, however redundant the equations."""

import numpy as np
import pytest

from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings, TraceSettings
from bifurc.singular.point import Kind

# function, bounds, lengths of the forms, bifurcations (place, number of passes)
KNOWN = {
    "circle": (lambda x, y: x * x + y * y - 1, 2.0, [2 * np.pi], []),
    "pitchfork": (
        lambda x, y: x * y - x**3,
        2.0,
        [4.0, 2 * (0.5 * np.sqrt(2) * 3 + 0.25 * np.arcsinh(2 * np.sqrt(2)))],
        [((0, 0), 2)],
    ),
    "two crossing lines": (
        lambda x, y: (x - y) * (x + 2 * y - 0.3),
        1.0,
        [2 * np.sqrt(2), np.sqrt(5)],
        [((0.1, 0.1), 2)],
    ),
    "lemniscate": (
        lambda x, y: (x * x + y * y) ** 2 - x * x + y * y,
        2.0,
        [5.244115108584239],
        [((0, 0), 2)],
    ),
    "triple crossing": (
        lambda x, y: x * (x - y) * (x + y),
        1.0,
        [2 * np.sqrt(2)] * 2 + [2.0],
        [((0, 0), 3)],
    ),
    "two circles apart": (
        lambda x, y: ((x - 1) ** 2 + y * y - 0.5) * ((x + 1) ** 2 + y * y - 0.25),
        2.0,
        [2 * np.pi * np.sqrt(0.5), np.pi],
        [],
    ),
    "hyperbola": (lambda x, y: x * y - 1e-4, 1.0, [1.983056] * 2, []),
}
ROTATION = np.linalg.qr(np.random.default_rng(5).normal(size=(5, 5)))[0][:, 0]
COPIES = {
    "as it is": lambda f: np.array([f]),
    "equation repeated": lambda f: np.array([f, f, f]),
    "rows scaled by 1e3": lambda f: np.array([1e3 * f, f]),
    "rotated into five rows": lambda f: ROTATION * f,
}


def check_known(name, atlas, exactness=1e-11):
    """Asserts that an atlas is the known one, its curves to ``exactness``."""
    function, _, lengths, bifurcations = KNOWN[name]
    traced = [form.branch.length for form in atlas.forms]
    assert traced == pytest.approx(sorted(lengths, reverse=True), abs=1e-6)
    assert not any(point.note for point in atlas.points)
    assert len(atlas.points) == len(atlas.bifurcations) == len(bifurcations)
    for point, (place, passes) in zip(atlas.bifurcations, bifurcations, strict=True):
        assert np.linalg.norm(point.point.u - place) <= point.point.error
        assert np.linalg.norm(point.point.u - place) < (1e-12 if passes == 2 else 1e-6)
        assert len(point.passes) == passes
    for form in atlas.forms:
        gaps = np.abs([function(*u) for u in form.branch.sample(500)])
        assert gaps.max() < exactness


@pytest.mark.parametrize("copy", COPIES)
@pytest.mark.parametrize("name", KNOWN)
def test_redundant_equations_change_nothing(name, copy):
    function, bound, _, _ = KNOWN[name]
    atlas = explore(
        FunctionProblem(lambda u: COPIES[copy](function(*u)), [(-bound, bound)] * 2),
        settings=SearchSettings(starts=40),
    )
    check_known(name, atlas)


# Orders and tolerances at the ends of what is allowed, and between.
@pytest.mark.parametrize(("order", "tolerance"), [(6, 1e-13), (30, 1e-13), (4, 1e-9)])
@pytest.mark.parametrize("name", [name for name in KNOWN if "triple" not in name])
def test_pieces_of_any_order_give_the_same_atlas(name, order, tolerance):
    function, bound, _, _ = KNOWN[name]
    tracing = TraceSettings(order=order, tolerance=tolerance)
    atlas = explore(
        FunctionProblem(lambda u: [function(*u)], [(-bound, bound)] * 2),
        settings=SearchSettings(starts=40, tracing=tracing),
    )
    check_known(name, atlas, exactness=30 * max(tolerance, 1e-12))


@pytest.mark.parametrize("beside", [0.0, 1e-4, 0.3])
def test_an_unknown_that_slows_down_at_a_crossing_has_no_dead_point(beside):
    # what is traced across a crossing is known less well there: y' = 3 x^2 but for 1e-9
    problem = FunctionProblem(
        lambda u: [(u[0] - beside) * (u[1] - u[0] ** 3)], [(-1, 1)] * 2
    )
    for seed in range(3):
        atlas = explore(problem, settings=SearchSettings(starts=40), seed=seed)
        assert len(atlas.forms) == 2
        assert not atlas.dead_points


@pytest.mark.parametrize("shift", [0.0, 1e-15, -1e-15, 4e-14, -4e-14])
def test_angles_lie_within_half_a_turn_and_those_beside_its_end_at_the_end(shift):
    # zeros at 0, 120 and 240 degrees, and at 60, 180 and 300: all are rigid assemblies
    problem = FunctionProblem(
        lambda u: np.array([np.sin(3 * (u[0] - shift)), u[1] - 0.5]),
        [(-np.inf, np.inf), (0, 1)],
        periods=[2 * np.pi, np.inf],
    )
    expected = np.array([-120, -60, 0, 60, 120, 180]) * np.pi / 180
    for seed in range(2):
        atlas = explore(problem, settings=SearchSettings(starts=60), seed=seed)
        assert atlas.rigid[:, 0] == pytest.approx(expected, abs=1e-12)
        assert atlas.rigid[-1, 0] == np.pi


def test_central_differences_give_the_same_answer_and_say_so():
    def rounded(u):  # np.float64 refuses complex numbers
        x, y = (np.float64(v) for v in u)
        return np.array([x * y - x**3])

    atlas = explore(
        FunctionProblem(rounded, [(-2, 2)] * 2), settings=SearchSettings(starts=30)
    )
    assert atlas.provenance.derivatives == "central differences"
    assert len(atlas.forms) == 2
    assert [p.kind for p in atlas.points] == [Kind.BIFURCATION]
    # second derivatives are differences of differences: the place is known to their
    # accuracy
    assert np.linalg.norm(atlas.points[0].point.u) < 1e-6


def test_both_sides_of_a_pitchfork_are_found_from_a_start_on_the_side_branch():
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[1] - u[0] ** 3]), [(-2, 2)] * 2
    )
    for start in ((1.2, 1.44), (0.0, -1.5)):
        atlas = explore(problem, seeds=_only(start))
        assert len(atlas.forms) == 2
        assert len(atlas.bifurcations) == 1


def _only(*points):
    points = np.array(points, dtype=float)
    is_random = np.zeros(len(points), dtype=bool)
    return Seeds(points, is_random, np.empty(0), np.empty((0, points.shape[1])))


def test_a_square_problem_with_a_parameter_is_a_curve_like_any_other():
    # imperfect pitchfork x^3 - a x + 0.1 = 0: two arcs, one of them with a fold, no
    # bifurcation
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 3 - u[1] * u[0] + 0.1]),
        [(-2, 2), (-1, 2)],
        names=("x", "a"),
    )
    atlas = explore(problem, settings=SearchSettings(starts=60))
    assert len(atlas.forms) == 2
    assert not atlas.points
    folds = [event.u for event in atlas.dead_points if event.index == 1]
    assert len(folds) == 1
    x = (0.1 / 2) ** (1 / 3)  # 3 x^2 = a and x^3 - a x + 0.1 = 0
    assert folds[0] == pytest.approx([x, 3 * x * x], abs=1e-9)


def test_no_solution_is_no_form_and_the_gap_is_the_smallest_residual():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 + 0.5]), [(-2, 2)] * 2
    )
    atlas = explore(problem, settings=SearchSettings(starts=20))
    assert not atlas.forms
    assert not atlas.points
    assert atlas.closure_gap * problem.magnitude == pytest.approx(0.5, rel=0.5)


def test_isolated_solutions_are_rigid_and_found_once():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 - 1, u[1] ** 2 - 4 * u[0] ** 2]), [(-3, 3)] * 2
    )
    atlas = explore(problem, settings=SearchSettings(starts=60))
    assert not atlas.forms
    assert sorted(map(tuple, np.round(atlas.rigid, 12))) == [
        (-1, -2),
        (-1, 2),
        (1, -2),
        (1, 2),
    ]


# --- loops that do not move -----------------------------------------------------------------------------


# --- surfaces, redundant joints, many joints --------------------------------------------------------------


# --- use ----------------------------------------------------------------------------------------------


def test_a_search_interrupted_before_anything_was_found_is_an_empty_atlas():
    problem = FunctionProblem(
        lambda u: np.array([u[0] ** 2 + u[1] ** 2 - 1]), [(-2, 2)] * 2
    )

    def interrupted(rng, count, deadline):
        raise KeyboardInterrupt

    problem.seeds = interrupted
    atlas = explore(problem)
    assert atlas.provenance.interrupted is True
    assert not atlas.forms


def test_no_starts_are_refused():
    with pytest.raises(ProblemError, match="starts: 0 is not allowed"):
        explore(
            FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-1, 1)] * 2),
            settings=SearchSettings(starts=0),
        )


@pytest.mark.parametrize("seed", [-1, 1.5, None, "a", 2**70])
def test_a_seed_that_is_no_whole_number_is_refused(seed):
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-1, 1)] * 2)
    with pytest.raises(ProblemError, match="seed"):
        explore(problem, seed=seed)


def test_curves_are_followed_more_closely_than_points_are_told_apart():
    with pytest.raises(ProblemError, match=r"tolerance: 1e-06 .* at most 1e-07"):
        SearchSettings(tracing=TraceSettings(tolerance=1e-6))
    assert SearchSettings(tracing=TraceSettings(tolerance=1e-7)).tracing.tolerance


@pytest.mark.parametrize("settings", [None, {}, 200])
def test_settings_of_another_type_are_refused(settings):
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-1, 1)] * 2)
    with pytest.raises(ProblemError, match="settings"):
        explore(problem, settings=settings)
    with pytest.raises(ProblemError, match=r"starts: 1\.5"):
        SearchSettings(starts=1.5)


@pytest.mark.parametrize("stiffness", [1e-7, 1e-5, 1e-3])
def test_an_assembly_is_rigid_however_little_stiff_it_is(stiffness):
    box = [(-1.0, 1.0)] * 2
    problem = FunctionProblem(lambda u: [u[1] - u[0] ** 2, stiffness * u[0]], box)
    atlas = explore(problem, settings=SearchSettings(starts=20))
    assert not atlas.forms and not atlas.points
    assert atlas.rigid == pytest.approx(np.zeros((1, 2)), abs=1e-6)


def test_one_start_within_a_budget_is_enough_to_answer():
    def small_circle(u):
        return [u[0] ** 2 + u[1] ** 2 - 1e-4]

    problem = FunctionProblem(small_circle, [(-2, 2)] * 2)
    settings = SearchSettings(starts=1, budget=50.0, near_motions=False)
    assert len(explore(problem, settings=settings).forms) == 1


def test_two_flat_points_are_both_found_or_one_is_said_to_be_open():
    def both(u):
        x, y = u
        return [((x - 1) ** 4 + y**4) * ((x + 1) ** 4 + y**4)]

    atlas = explore(FunctionProblem(both, [(-2.1, 2), (-1.2, 1)]), seed=1)
    found = {round(float(point.point.u[0])) for point in atlas.points}
    assert found == {-1, 1} or "there may be more solutions" in (
        atlas.completeness.statement
    )


@pytest.mark.parametrize("seed", [0, 2])
def test_crossings_next_to_each_other_that_boxes_show_are_told_apart(seed):
    problem = FunctionProblem(
        lambda u: [
            ((u[0] + 0.4) ** 2 + (u[1] + 0.3) ** 2 - 0.25)
            * (u[0] - 0.499)
            * (u[0] - 0.501)
            * (u[1] - 0.5)
        ],
        [(-1.0, 1.0)] * 2,
    )
    atlas = explore(problem, settings=SearchSettings(starts=1), seed=seed)
    assert len(atlas.forms) == 4
    assert [len(p.point.half_branches) for p in atlas.points] == [4, 4]
    assert not any(point.note for point in atlas.points)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_three_crossings_in_a_small_triangle_are_found(seed):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-0.5, 0.5, 2)
    angles = np.sort(rng.uniform(0, np.pi, 3))
    offsets = 3e-3 * rng.uniform(0.5, 1, 3) * [1, -1, 1]

    def function(u):
        value = (u[0] ** 2 + u[1] ** 2 - 2.2) * (u[1] - 0.2 * u[0] ** 2 - 1.3)
        for angle, offset in zip(angles, offsets, strict=True):
            along = np.cos(angle) * (u[0] - x) + np.sin(angle) * (u[1] - y)
            value = value * (along - offset)
        return [value]

    problem = FunctionProblem(function, [(-2, 2.1), (-2.05, 2.15)])
    atlas = explore(problem, settings=SearchSettings(near_motions=False))
    beside = [np.hypot(*(p.point.u - [x, y])) < 0.06 for p in atlas.points]
    assert sum(beside) == 3
