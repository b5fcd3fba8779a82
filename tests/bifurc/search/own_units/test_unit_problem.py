"""A search in units of its own: the same atlas whatever the user's units are."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import diags_array, vstack
from scipy.special import ellipe

import bifurc
from bifurc.branch import Outcome
from bifurc.completeness import Claim
from bifurc.curves.certificate import CertificateStatus
from bifurc.search.own_units.restated import restated_branch
from bifurc.search.own_units.unit_problem import in_own_units
from bifurc.seeds import Audit
from bifurc.system import Curvature, jacobian_at
from bifurc.systems.equation_file import read_equations
from bifurc.units import Units
from tests.samples import one_in

BOX = [(-2.0, 2.0), (-2.0, 2.0)]


def lemniscate(size):
    def function(u):
        x, y = u
        return [(x**2 + y**2) ** 2 - size**2 * (x**2 - y**2)]

    return function


def circle(radius):
    return lambda u: [u[0] ** 2 + u[1] ** 2 - radius**2]


def counts(atlas):
    kinds = sorted(point.kind.value for point in atlas.points)
    closed = sorted(form.branch.closed for form in atlas.forms)
    return closed, kinds, len(atlas.surfaces), len(atlas.rigid)


def explored(function, bounds=BOX, **options):
    return bifurc.explore(bifurc.FunctionProblem(function, bounds, **options))


def test_a_problem_that_is_in_such_units_stays_as_it_is():
    assert in_own_units(bifurc.FunctionProblem(circle(1.0), BOX)) is None


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0])
def test_a_curve_far_smaller_than_its_bounds_is_found_with_its_crossing(size):
    atlas = explored(lemniscate(size))
    assert counts(atlas) == ([True], ["bifurcation"], 0, 0)
    # twice the lemniscate constant
    assert atlas.forms[0].branch.length == pytest.approx(5.244115108584240 * size)


def explored_of_size(size):
    bounds = [(-2 * size, 2 * size)] * 2
    problem = bifurc.FunctionProblem(lemniscate(size), bounds, names=["x", "y"])
    return bifurc.explore(problem, parameter="x")


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3, 30.0, 1e6, 1e9])
def test_a_lemniscate_of_any_size_is_the_same(size) -> None:
    atlas = explored_of_size(size)
    reference = explored_of_size(1.0)
    assert len(atlas.forms) == len(reference.forms) == 1
    (form,), (expected,) = atlas.forms, reference.forms
    assert form.branch.closed
    assert form.branch.length == pytest.approx(size * expected.branch.length, rel=1e-9)
    s = expected.branch.arclengths(20)
    gaps = form.branch(size * s) - size * expected.branch(s)
    assert np.abs(gaps).max() < 1e-8 * size
    (point,) = atlas.bifurcations
    assert np.abs(point.point.u).max() < 1e-9 * size
    assert len(atlas.dead_points) == len(reference.dead_points)
    assert len(atlas.diagram.folds) == 2
    largest = form.profile.values.max()
    assert largest == pytest.approx(expected.profile.values.max(), rel=1e-2)


@pytest.mark.parametrize("is_recorded", [True, False])
def test_a_circle_of_a_million_is_one_closed_form(is_recorded):
    bounds = [(-2e6, 2e6)] * 2
    atlas = explored(circle(1e6), bounds, is_recorded=is_recorded)
    assert counts(atlas) == ([True], [], 0, 0)
    assert atlas.forms[0].branch.length == pytest.approx(2e6 * np.pi, rel=1e-12)


@pytest.mark.parametrize("width", [1e-2, 1e-5])
def test_a_narrow_ellipse_is_closed_and_stated_in_the_users_arclength(width):
    atlas = explored(lambda u: [(u[0] / width) ** 2 + u[1] ** 2 - 1.0])
    assert counts(atlas) == ([True], [], 0, 0)
    branch = atlas.forms[0].branch
    assert branch.length == pytest.approx(4.0 * ellipe(1.0 - width**2), rel=1e-9)
    x, y = branch.sample(200).T
    assert np.abs((x / width) ** 2 + y**2 - 1.0).max() < 1e-9
    speeds = np.linalg.norm(branch(np.linspace(0.1, 3.9, 50), 1), axis=1)
    assert np.abs(speeds - 1.0).max() < 1e-6


@pytest.mark.parametrize("factor", [1e-6, 1e3, 1e6])
def test_an_equation_times_a_factor_changes_nothing(factor):
    def function(u):
        x, y, z = u
        return [x**2 + y**2 + z**2 - 1.0, factor * (z - 0.3 * x)]

    atlas = explored(function, [(-2.0, 2.0)] * 3)
    assert counts(atlas) == ([True], [], 0, 0)


def test_two_lines_close_to_each_other_are_two():
    atlas = explored(lambda u: [u[1] * (u[1] - 1e-5)])
    assert counts(atlas) == ([False, False], [], 0, 0)


def test_two_circles_closer_than_their_pieces_are_long_are_two():
    outer = circle(1.0001)
    inner = circle(1.0)
    atlas = explored(lambda u: [inner(u)[0] * outer(u)[0]])
    assert counts(atlas) == ([True, True], [], 0, 0)


def test_an_isolated_point_is_not_looked_for_ever_closer():
    atlas = explored(lambda u: [u[0] ** 2 + u[1] ** 4])
    assert counts(atlas) == ([], ["isolated"], 0, 0)


# --- unknowns without bounds, and circles ---------------------------------------------

ANYWHERE = [(-np.inf, np.inf)] * 2


def test_a_curve_without_bounds_is_one_form_and_says_that_it_goes_on() -> None:
    problem = bifurc.FunctionProblem(lambda u: [u[1] - u[0] ** 2], ANYWHERE)
    (form,) = bifurc.explore(problem).forms
    assert form.branch.outcome is bifurc.Outcome.LEFT_REGION
    ends = form.branch(np.array([0.0, form.branch.length]))
    assert np.abs(ends[:, 1]).min() > 10


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("radius", one_in(3, [1e-6, 1e-2, 1.0, 1e6]))
def test_a_circle_without_bounds_is_found_whatever_its_size(radius, is_recorded):
    problem = bifurc.FunctionProblem(
        circle(radius),
        ANYWHERE,
        is_recorded=is_recorded,
    )
    (form,) = bifurc.explore(problem, settings=bifurc.SearchSettings(starts=40)).forms
    assert form.branch.closed
    assert form.branch.length == pytest.approx(2 * np.pi * radius, rel=1e-11)


def test_bounds_on_one_side_are_kept() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] - u[0] ** 2], [(500.0, np.inf), (-np.inf, np.inf)]
    )
    assert problem.domain.bounds[0, 0] == 500.0
    assert problem.domain.bounds[0, 1] > 1000.0


@pytest.mark.parametrize("begin", [0.0, -np.pi, 1.0])
def test_bounds_of_one_period_are_a_circle(begin):
    bounds = [(begin, begin + 2 * np.pi), (-2.0, 2.0)]
    atlas = explored(
        lambda u: [np.sin(u[0]) - u[1]], bounds, periods=[2 * np.pi, np.inf]
    )
    assert counts(atlas) == ([True], [], 0, 0)
    assert atlas.forms[0].branch.winding.tolist() == [1, 0]


def test_narrower_bounds_are_limits_on_a_circle():
    bounds = [(2.0, 5.0), (-2.0, 2.0)]
    atlas = explored(
        lambda u: [np.sin(u[0]) - u[1]], bounds, periods=[2 * np.pi, np.inf]
    )
    assert counts(atlas) == ([False], [], 0, 0)
    ends = atlas.forms[0].branch(np.array([0.0, atlas.forms[0].branch.length]))
    assert sorted(ends[:, 0]) == pytest.approx([2.0, 5.0])


# --- multiplicity and points of higher order ------------------------------------------


@pytest.mark.parametrize("multiplicity", [2, 3])
def test_a_multiple_curve_is_one_with_its_multiplicity(multiplicity):
    atlas = explored(lambda u: [(u[0] ** 2 + u[1] ** 2 - 1.0) ** multiplicity])
    assert counts(atlas) == ([True], [], 0, 0)
    assert atlas.forms[0].multiplicity == multiplicity
    again = bifurc.from_dataset(bifurc.to_dataset(atlas))
    assert again.forms[0].multiplicity == multiplicity


def test_a_multiple_curve_has_the_crossings_of_the_simple_one():
    atlas = explored(lambda u: [lemniscate(1.0)(u)[0] ** 2])
    assert counts(atlas) == ([True], ["bifurcation"], 0, 0)


@pytest.mark.parametrize("stretch", [1e-4, 1 / 12, 3.0, 12.0, 40.0, 1e4])
@pytest.mark.parametrize("unknown", [0, 1])
def test_a_double_lemniscate_has_its_node_whatever_the_units(stretch, unknown):
    sizes = np.ones(2)
    sizes[unknown] = stretch
    bounds = sizes[:, None] * np.array(BOX)
    atlas = explored(lambda u: [lemniscate(1.0)(u / sizes)[0] ** 2], bounds)
    assert counts(atlas) == ([True], ["bifurcation"], 0, 0)
    assert [form.multiplicity for form in atlas.forms] == [2]


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("stretch", [1 / 12, 1.0, 12.0])
def test_an_isolated_point_is_found_where_starts_come_to_it_slowly(power, stretch):
    def cubic(u):
        x, y = u[0], u[1] / stretch
        return [(y**2 - x**2 * (x - 1.0)) ** power]

    atlas = explored(cubic, [(-1.0, 2.0), (-2.0 * stretch, 2.1 * stretch)])
    assert counts(atlas) == ([False], ["isolated"], 0, 0)
    assert np.linalg.norm(atlas.points[0].point.u) < 1e-7 * stretch


@pytest.mark.parametrize(
    "function",
    [
        lambda u: [u[0] ** 2 * u[1]],
        lambda u: [u[0] ** 3 - u[0] ** 2 * u[1]],  # expanded
        lambda u: [np.sin(u[0]) ** 2 * (u[1] - u[0])],
    ],
)
def test_each_form_has_a_multiplicity_of_its_own(function):
    atlas = explored(function)
    assert counts(atlas) == ([False, False], ["bifurcation"], 0, 0)
    assert sorted(form.multiplicity for form in atlas.forms) == [1, 2]


def test_multiplicities_of_several_equations_multiply():
    box = [(-1.0, 1.0), (-1.0, 1.1), (-1.0, 1.2)]
    atlas = explored(lambda u: [(u[0] * u[1]) ** 2, (u[2] - u[0]) ** 3], box)
    assert counts(atlas) == ([False, False], ["bifurcation"], 0, 0)
    assert [form.multiplicity for form in atlas.forms] == [6, 6]


def test_a_crossing_on_double_curves_has_the_germ_of_the_simple_ones():
    atlas = explored(lambda u: [(u[1] ** 2 - u[0] ** 5) ** 2])
    (point,) = atlas.points
    assert point.kind is bifurc.Kind.CUSP
    assert point.point.is_through is False  # as exact equations tell


def double_lines(u):
    return np.array([u[2], u[2] - (u[0] * u[1]) ** 2])


@pytest.mark.parametrize("is_recorded", [True, False])
def test_double_curves_that_are_no_squares_have_their_crossings(is_recorded):
    box = [(-1.0, 1.0), (-1.0, 1.1), (-1.0, 1.2)]
    problem = bifurc.FunctionProblem(double_lines, box, is_recorded=is_recorded)
    atlas = bifurc.explore(problem, settings=bifurc.SearchSettings(starts=16))
    assert counts(atlas) == ([False, False], ["bifurcation"], 0, 0)
    assert [form.multiplicity for form in atlas.forms] == [2, 2]
    assert np.linalg.norm(atlas.points[0].point.u) < 1e-8


def test_a_multiplicity_that_is_not_computed_is_in_doubt():
    atlas = explored(lambda u: [u[2] - u[0] ** 3, u[2]], [(-1.0, 1.0)] * 3)
    multiplicities = [form.multiplicity for form in atlas.forms]
    is_told = "has a multiplicity" in atlas.completeness.statement
    assert multiplicities == [3] or is_told


def test_a_ramphoid_cusp_is_one_point_where_the_exact_equations_have_it():
    atlas = explored(lambda u: [(u[1] - u[0] ** 2) ** 2 - u[0] ** 5])
    (point,) = atlas.points
    assert point.kind is bifurc.Kind.CUSP
    assert np.linalg.norm(point.point.u) < 1e-7


def test_a_contact_of_high_order_is_one_bifurcation():
    atlas = explored(lambda u: [u[1] ** 2 - u[0] ** 8])
    assert counts(atlas) == ([False, False], ["bifurcation"], 0, 0)
    assert len(atlas.points[0].point.half_branches) == 4


def test_one_branch_passes_where_its_curvature_is_infinite():
    atlas = explored(lambda u: [u[0] ** 5 - u[1] ** 3])
    assert counts(atlas) == ([False], ["rank drop"], 0, 0)
    assert len(atlas.points[0].passes) == 1


def test_crossings_next_to_each_other_have_their_own_half_branches():
    atlas = explored(lambda u: [u[1] * (u[1] - 1e-3) * (u[0] ** 2 + u[1] ** 2 - 1.0)])
    assert counts(atlas)[1] == ["bifurcation"] * 4
    assert all(len(point.point.half_branches) == 4 for point in atlas.points)


# --- classes with answers of their own, and many unknowns -----------------------------


class Hyperbola(bifurc.FunctionProblem):
    """x y = (size / 10)^2 within 2 sizes, with a bound on F'' and an audit."""

    def __init__(self, size):
        gap = 0.01 * size**2
        super().__init__(lambda u: [u[0] * u[1] - gap], [(-2 * size, 2 * size)] * 2)
        self.audited = []

    def hessians(self, points):
        return np.tile([[0.0, 1.0], [1.0, 0.0]], (len(points), 1, 1, 1))

    @property
    def curvature(self):
        bound = 1.0 / self.magnitude
        return Curvature(bound, lambda reach: np.full_like(reach, bound))

    def seeds(self, rng, count, deadline=None):
        def audit(branches, seconds):
            self.audited.extend(branches)
            return Audit(
                (Claim("test", "nothing is missing", level=bifurc.Level.COUNTED),),
                np.empty((0, 2)),
            )

        return replace(super().seeds(rng, count), audit=audit)


@pytest.mark.parametrize("size", [1e-5, 1.0, 1e6])
def test_what_a_class_answers_in_its_own_way_counts_in_any_unit(size):
    problem = Hyperbola(size)
    settings = bifurc.SearchSettings(starts=40, certify=True)
    atlas = bifurc.explore(problem, settings=settings)
    assert counts(atlas) == ([False, False], [], 0, 0)
    assert atlas.completeness.level is bifurc.Level.COUNTED
    for branch in problem.audited:
        assert np.abs(problem.residuals(branch.sample(9))).max() < 1e-12 * size**2
    for form in atlas.forms:
        assert form.certificate.status is CertificateStatus.CERTIFIED
        assert form.certificate.bound == pytest.approx(problem.curvature.bound)


@pytest.mark.parametrize("size", [1e-5, 1e5])
def test_a_hessian_of_a_class_is_restated(size):
    problem = Hyperbola(size)
    own = in_own_units(problem)
    point = np.array([0.3, 0.2])
    exact = bifurc.FunctionProblem.hessians(own, point[None])
    assert own.hessians(point[None]) == pytest.approx(exact, rel=1e-12)


def test_a_class_with_a_march_of_its_own_stays_as_it_is():
    class Marching(bifurc.FunctionProblem):
        def march(self, start, tangent, settings):
            return super().march(start, tangent, settings)

    assert in_own_units(Marching(circle(1e3), [(-2e3, 2e3)] * 2)) is None


@pytest.mark.parametrize("is_recorded", [True, False])
def test_many_unknowns_are_counted_in_one_unit_with_a_sparse_jacobian(is_recorded):
    n, size = 120, 1e6

    def function(u):
        first = [u[0] ** 2 + u[1] ** 2 - size**2]
        return np.concatenate([first, u[2:] - 0.5 * u[1:-1]])

    def jacobian(u):
        own = diags_array([-0.5, 1.0], offsets=[1, 2], shape=(n - 2, n))
        first = np.concatenate([2 * u[:2], np.zeros(n - 2)])
        return vstack([first[None], own]).tocsc()

    problem = bifurc.FunctionProblem(
        function,
        [(-2 * size, 2 * size)] * n,
        jacobian=jacobian,
        is_recorded=is_recorded,
    )
    own = in_own_units(problem)
    unit = 2.0**20
    assert np.all(own.own_units.sizes == unit)
    point = np.linspace(-1.0, 1.0, n)
    assert np.array_equal(own.residuals(point)[0], problem.residuals(unit * point)[0])
    expected = unit * jacobian_at(problem, unit * point).toarray()
    assert jacobian_at(own, point).toarray() == pytest.approx(expected, rel=1e-12)
    assert own.magnitude == unit * problem.magnitude


def test_more_unknowns_than_are_compiled_are_found_in_any_size():
    # its Jacobian has no large diagonal: sparse LU with small pivots loses all digits
    size, n = 1e6, 110

    def chain(u):
        v = u / size
        rest = [v[k] - 0.5 * v[k - 1] - 0.3 * v[0] * v[1] for k in range(2, n)]
        return [v[0] ** 2 + v[1] ** 2 - 1, *rest]

    problem = bifurc.FunctionProblem(chain, [(-2 * size, 2 * size)] * n)
    atlas = bifurc.explore(
        problem, settings=bifurc.SearchSettings(starts=4, certify=False)
    )
    (form,) = atlas.forms
    assert form.branch.closed
    turns = np.linspace(0.0, 2 * np.pi, 20001)
    circle = np.stack([np.cos(turns), np.sin(turns)])
    course = [*circle]
    for _ in range(2, n):
        course.append(0.5 * course[-1] + 0.3 * circle[0] * circle[1])
    length = np.linalg.norm(np.diff(course, axis=1), axis=0).sum()
    assert form.branch.length / size == pytest.approx(length, rel=1e-6)


def test_a_curve_on_whose_flat_end_all_starts_stop_is_followed_whole():
    # an amplifier that is saturated at nearly every start
    file = Path(__file__).parents[4] / "data" / "problems" / "trigger_circuit.toml"
    atlas = read_equations(file).explore()
    (form,) = atlas.forms
    assert form.branch.outcome is Outcome.LEFT_REGION
    outputs = sorted(fold.u[5] for fold in atlas.diagram.folds)
    assert outputs == pytest.approx([1.16602, 9.60900], abs=1e-5)


def test_two_lines_are_two_though_the_function_loses_the_digits_between_them() -> None:
    y = 0.64042265
    problem = bifurc.FunctionProblem(
        lambda u: [(u[1] + y) * ((u[1] + y) - 1e-5)], [(-2, 2), (-2.6, 1.4)]
    )
    assert len(bifurc.explore(problem).forms) == 2


def test_one_branch_passes_that_looks_like_a_cusp_from_afar() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[0] ** 3 - (10 * u[1]) ** 4], [(-1, 1.1), (-0.12, 0.1)]
    )
    atlas = bifurc.explore(problem)
    (point,) = atlas.points
    assert (point.kind, point.note) == (bifurc.Kind.RANK_DROP, "")
    assert len(atlas.forms) == 1


@pytest.mark.parametrize("angle", [0.1, 0.68, 3.0])
def test_a_flat_isolated_point_is_found_where_starts_stop_short(angle) -> None:
    c, s = np.cos(angle), np.sin(angle)
    problem = bifurc.FunctionProblem(
        lambda u: [(c * u[1] - s * u[0]) ** 2 + (c * u[0] + s * u[1]) ** 4],
        [(-1.3, 1.2), (-1.1, 1.4)],
    )
    atlas = bifurc.explore(problem)
    assert [point.kind for point in atlas.points] == [bifurc.Kind.ISOLATED]
    assert not atlas.forms


def test_flat_places_that_are_not_settled_are_in_doubt() -> None:
    problem = bifurc.FunctionProblem(
        lambda u: [u[1] ** 2 + u[0] ** 2 + 1e-11], [(-1.3, 1.2), (-1.1, 1.4)]
    )
    settings = bifurc.SearchSettings(starts=40, near_motions=False)
    atlas = bifurc.explore(problem, settings=settings)
    assert not atlas.forms and not atlas.points
    assert "about nothing that is listed" in atlas.completeness.statement


@pytest.mark.parametrize("room", [33.0, 1e2, 1e4])
def test_a_surface_far_smaller_than_its_bounds_is_counted_in_its_own_units(
    room,
) -> None:
    def sphere(u):
        return [u[0] ** 2 + u[1] ** 2 + u[2] ** 2 - 1.0]

    own = in_own_units(bifurc.FunctionProblem(sphere, [(-room, room)] * 3))
    assert own is not None
    assert np.abs(own.own_units.outwards(own.region.T)).max() < 4.0


def test_two_planes_next_to_each_other_are_counted_in_units_of_their_distance() -> None:
    planes = bifurc.FunctionProblem(lambda u: [u[2] * (u[2] - 0.01)], [(-2, 2)] * 3)
    own = in_own_units(planes)
    assert own is not None
    assert own.own_units.sizes[2] < 0.01 < own.own_units.sizes[0]


def two(curve):
    """Two curves of one shape, so far apart."""
    return lambda apart: lambda u: [curve(*u) * (curve(*u) - apart)]


def square(f, c):
    """(f - c)^2 multiplied out, with coefficients that are rounded."""
    return f**2 - 2 * c * f + c**2


NEAR_CURVES = {
    "circles": two(lambda x, y: x**2 + y**2 - 1),
    "lines": two(lambda x, y: y - 0.3 * x),
    "parabolas": two(lambda x, y: y - x**2),
    "none": lambda apart: lambda u: [(u[1] - u[0] ** 2) ** 2 + apart**2],
    "upright lines": lambda apart: lambda u: [square(u[0], 0.1) - apart**2],
    "lines in a sum": lambda apart: (
        lambda u: [u[1] - u[2] + square(u[0], 0.1) - apart**2, u[1] - u[2]]
    ),
}


@pytest.mark.parametrize("apart", one_in(2, [3e-6, 1e-6, 1e-8, 1e-10]))
@pytest.mark.parametrize("name", NEAR_CURVES)
def test_curves_next_to_each_other_are_never_one_without_a_word(name, apart) -> None:
    bounds = [*BOX, (-2.5, 2.6)] if name == "lines in a sum" else BOX
    problem = bifurc.FunctionProblem(NEAR_CURVES[name](apart), bounds)
    atlas = bifurc.explore(problem)
    kinds = [doubt.kind for doubt in atlas.completeness.doubts]
    assert len(atlas.forms) == 2 or "several curves" in kinds


@pytest.mark.parametrize(
    "function",
    [
        lambda u: [1 - np.cos(u[0] - u[1])],
        lambda u: [np.exp(u[0] - u[1]) - 1 - u[0] + u[1]],
        lambda u: [u[0] ** 2 - 0.2 * u[0] * u[1] + 0.01 * u[1] ** 2],
        lambda u: [u[0] ** 2 - 0.2 * u[0] + 0.01],
        lambda u: [np.sin(u[0]) ** 2 - 0.2 * np.sin(u[0]) + 0.01],
    ],
)
def test_a_double_curve_is_one(function) -> None:
    atlas = bifurc.explore(bifurc.FunctionProblem(function, BOX))
    assert [form.multiplicity for form in atlas.forms] == [2]
    assert not atlas.completeness.doubts


@pytest.mark.parametrize("c", [0.1, 0.7, np.pi / 20])
def test_a_line_that_coefficients_make_double_to_rounding_is_in_doubt(c) -> None:
    atlas = bifurc.explore(bifurc.FunctionProblem(lambda u: [square(u[0], c)], BOX))
    assert [form.multiplicity for form in atlas.forms] == [2]
    (doubt,) = atlas.completeness.doubts
    assert doubt.kind == "several curves"
    assert doubt.amount < 1e-7


@pytest.mark.parametrize(
    ("text", "multiplicity", "length"),
    [
        ("x^2 - 0.6*x + 0.09", 2, 4.0),
        ("x^2 + 1.4*x + 0.49", 2, 4.0),
        ("x^2 - 2*x/3 + 1/9", 2, 4.0),
        ("x^3 - 0.9*x^2 + 0.27*x - 0.027", 3, 4.0),
        ("(x^2 + y^2)^2 - 1.62*(x^2 + y^2) + 0.6561", 2, 1.8 * np.pi),
    ],
)
def test_powers_that_rounding_of_decimals_hides_are_one_curve(
    tmp_path, text, multiplicity, length
):
    path = tmp_path / "power.toml"
    bounds = "x = [-2, 2]\ny = [-2, 2]"
    path.write_text(f'equations = ["{text}"]\n[unknowns]\n{bounds}\n')
    (form,) = read_equations(path).explore().forms
    assert form.multiplicity == multiplicity
    assert form.branch.length == pytest.approx(length)


def test_a_branch_that_ends_with_a_piece_of_no_length_is_restated():
    problem = bifurc.FunctionProblem(lambda u: [u[1] - u[0] ** 2], [(-1, 1), (-1, 2)])
    (form,) = bifurc.explore(problem).forms
    branch = form.branch
    end, radius = branch.length, branch.radii[-1]
    last = np.zeros((1, *branch.pieces.shape[1:]))
    last[0, :2] = branch(end), radius * branch(end, 1)
    longer = replace(
        branch,
        pieces=np.concatenate([branch.pieces, last]),
        centers=np.append(branch.centers, end),
        radii=np.append(branch.radii, radius),
        breaks=np.append(branch.breaks, end),
        residuals=np.append(branch.residuals, branch.residuals[-1]),
    )
    units = Units(np.zeros(2), np.array([1e-3, 1e3]), np.ones(1))
    expected = restated_branch(branch, units, problem.domain.periods)
    course = restated_branch(longer, units, problem.domain.periods)
    assert len(course.branch.pieces) == len(expected.branch.pieces)
    arclengths = expected.arclengths(np.linspace(0.0, end, 7))
    assert course.arclengths(np.linspace(0.0, end, 7)) == pytest.approx(arclengths)
    assert course.branch(arclengths) == pytest.approx(expected.branch(arclengths))
