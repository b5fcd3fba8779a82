"""Mechanisms made with errors: the equations say what the bodies do."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bifurc.numerics.null_spaces import correct_to_valley
from bifurc.system import relative_gaps
from linkages.closure.closure import Closure
from linkages.closure.errors import draw_errors
from linkages.mechanisms.joint import transforms
from linkages.structure.structure import ClosureKind, Structure
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case
from tests.linkages.mechanisms.spatial_mechanisms import (
    one_of_each,
    platform,
    rods,
    samples,
)
from tests.linkages.mechanisms.test_size import spatial_four_bar


def case(name):
    return mechanism_of_case(cases()[name])


def with_errors(mechanism, error, seed=1):
    errors = draw_errors(Structure(mechanism), error, np.random.default_rng(seed))
    return Closure(mechanism, errors), errors


def displacement(errors, pair, side, unit):
    """The error (4, 4) of a joint on one of its bodies: a turn, then a shift."""
    turn = Rotation.from_rotvec(errors.turns[pair, side]).as_matrix()
    place = errors.places[pair]
    result = np.eye(4)
    result[:3, :3] = turn
    result[:3, 3] = place - turn @ place + unit * errors.shifts[pair, side]
    return result


def chain_transform(problem, errors, closure, point):
    """The transform (4, 4) from the last body of a chain to its first one."""
    structure = problem.structure
    result = np.eye(4)
    for number, sign in closure.chain:
        step = displacement(errors, number, 0, structure.unit)
        for variable in structure.variables_of(number):
            values = structure.values(point[None], variable)
            motion = structure.mechanism.variables[variable].motion
            step = step @ transforms(motion, values)[0]
        step = step @ displacement(errors, number, 1, structure.unit)
        result = result @ (step if sign > 0 else np.linalg.inv(step))
    return result


def motor_of(transform, frame):
    """Twice the vector parts (6,) of the motor of a transform (4, 4) in a frame."""
    place = transform[:3, :3] @ frame.origin + transform[:3, 3]
    rotation = frame.axes @ transform[:3, :3] @ frame.axes.T
    translation = frame.point(place)
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    vector = np.array([x, y, z])
    dual = 0.5 * (w * translation + np.cross(translation, vector))
    return 2 * np.concatenate([vector, dual])


@pytest.mark.parametrize(
    "mechanism",
    [
        case("Bennett geometry with joints CRCR"),
        case("planar slider-crank RRRP"),
        case("Miura-ori, one vertex (spherical 4R)"),
        case("Miura-ori, 3 x 3 vertices"),
        one_of_each(),
        rods(),
    ],
    ids=str,
)
def test_the_equations_are_those_of_joints_that_are_off_on_their_bodies(mechanism):
    problem, errors = with_errors(mechanism, 0.03)
    structure = problem.structure
    unit = structure.unit
    rng = np.random.default_rng(2)
    for point in 0.5 * samples(problem, rng, 5):
        (values,) = problem.residuals(point[None])
        for number, closure in enumerate(structure.closures):
            residual = values[problem.parts.rows[number]]
            transform = chain_transform(problem, errors, closure, point)
            off = unit * errors.points[number]
            first, second = closure.first + off[0], closure.second + off[1]
            arrival = transform[:3, :3] @ second + transform[:3, 3]
            if closure.kind is ClosureKind.POINT:
                assert np.allclose(residual, (arrival - first) / unit, atol=1e-13)
            elif closure.kind is ClosureKind.ROD:
                rest = closure.rod.length / unit
                length = rest + errors.rods[number]
                square = np.sum((arrival - first) ** 2) / unit**2
                expected = (square - length**2) / (2 * length)
                assert residual[0] == pytest.approx(expected, abs=1e-13)
            else:
                expected = motor_of(transform, structure.placement(closure))
                # two motors of opposite signs are one displacement
                sign = np.sign(expected @ residual)
                assert np.allclose(residual, sign * expected, atol=1e-12)


@pytest.mark.parametrize(
    "mechanism",
    [spatial_four_bar(), rods(), platform((0.0, 0.0, 0.0, 0.0, 0.0, None))],
    ids=["RCCC", "RSSP", "six legs, one driven"],
)
def test_what_is_not_overconstrained_closes_with_errors_as_well(mechanism):
    nominal = Closure(mechanism)
    problem, _ = with_errors(mechanism, 1e-3)
    starts = nominal.reference + 0.1 * np.random.default_rng(0).normal(
        size=(8, nominal.n)
    )
    points, gaps = nominal.project(starts)
    points = points[gaps < 1e-13]
    assert len(points)
    before = relative_gaps(problem, points)
    valley, gaps = correct_to_valley(problem, points)
    assert before.min() > 1e-5
    assert gaps.max() < 1e-12
    assert np.abs(valley - points).max() > 1e-5


@pytest.mark.parametrize(
    "name",
    [
        "Bennett geometry with joints CRCR",
        "planar slider-crank RRRP",
        "Sarrus linkage of 3 RRR chains",
        "parallelogram lattice 2 x 2",
    ],
)
def test_the_gap_of_what_is_overconstrained_grows_as_the_error(name):
    mechanism = case(name)
    nominal = Closure(mechanism)
    gaps = []
    for error in (1e-4, 1e-6):
        problem, _ = with_errors(mechanism, error)
        _, left = correct_to_valley(problem, nominal.reference[None])
        gaps.append(float(left[0]))
    assert gaps[0] > 1e-6
    assert gaps[0] / gaps[1] == pytest.approx(100.0, rel=0.05)


def test_errors_of_zero_change_nothing():
    mechanism = case("Bennett geometry with joints CRCR")
    nominal = Closure(mechanism)
    problem, errors = with_errors(mechanism, 0.0)
    assert not any(
        map(np.any, (errors.turns, errors.shifts, errors.points, errors.rods))
    )
    points = samples(nominal, np.random.default_rng(0), 4)
    assert np.array_equal(problem.residuals(points), nominal.residuals(points))


def test_a_seed_gives_the_same_errors_to_another_scale():
    structure = Structure(platform((None,) * 6))
    small = draw_errors(structure, 1e-6, np.random.default_rng(4))
    large = draw_errors(structure, 1e-2, np.random.default_rng(4))
    for one, other in (
        (small.turns, large.turns),
        (small.shifts, large.shifts),
        (small.points, large.points),
        (small.rods, large.rods),
    ):
        assert np.allclose(1e4 * one, other, rtol=1e-12)
    drawn = np.concatenate([large.turns.ravel(), large.shifts.ravel()])
    assert np.std(drawn) == pytest.approx(1e-2, rel=0.15)


@pytest.mark.parametrize("error", [-1.0, np.nan, np.inf])
def test_errors_that_are_none_are_refused(error):
    structure = Structure(rods())
    with pytest.raises(GeometryError, match="error"):
        draw_errors(structure, error, np.random.default_rng(0))
