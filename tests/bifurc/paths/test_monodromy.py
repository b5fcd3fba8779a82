"""All solutions of generic members of families with known counts."""

import numpy as np
import pytest

from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal
from bifurc.paths.monodromy import (
    CurveOverLine,
    Effort,
    Fibre,
    GenericSolutions,
    _enlarged,
    _trace,
    _Ways,
    solve_generic,
)
from tests.samples import one_in

PRISM = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)]
SEVEN_POINTS = [
    *((0, 1), (0, 2), (1, 2), (0, 3), (1, 4), (3, 4)),
    *((2, 5), (3, 5), (4, 6), (5, 6), (2, 6)),
]
BIPARTITE = [(i, j) for i in range(3) for j in range(3, 6)]


def framework(edges, points):
    """Points in the plane with given distances; the first edge stands still."""

    def equations(x, p):
        base = {edges[0][0]: (0.0, 0.0), edges[0][1]: (1.0, 1.0)}
        others = [point for point in range(points) if point not in base]
        places = {point: x[2 * k : 2 * k + 2] for k, point in enumerate(others)}
        places |= base
        return [
            (places[i][0] - places[j][0]) * (places[i][1] - places[j][1]) - squared
            for (i, j), squared in zip(edges[1:], p, strict=True)
        ]

    return Family.of(equations, 2 * points - 4, len(edges) - 1)


def generic_solutions(family, seed=0, **options):
    """Those of a member that a random configuration gives, whose equations are
    functions of it minus the parameters."""
    rng = np.random.default_rng(seed)
    start = complex_normal(rng, family.n)
    parameters = family.residuals(start[None], np.zeros(family.parameters))[0]
    return solve_generic(family, start, parameters, rng, **options)


@pytest.mark.parametrize("seed", one_in(3, range(3)))
@pytest.mark.parametrize(
    ("edges", "count"),
    # Borcea and Streinu 2004; Walter and Husty 2007; the most that seven points have:
    # Capco, Gallet, Grasegger, Koutschan, Lubbes and Schicho 2018
    [(PRISM, 24), (BIPARTITE, 16), (SEVEN_POINTS, 56)],
    ids=["prism", "K(3,3)", "seven points"],
)
def test_the_count_of_a_framework_is_that_of_the_literature(edges, count, seed):
    points = 1 + max(map(max, edges))
    known = generic_solutions(framework(edges, points), seed)
    assert known.are_all
    assert known.count == count


def test_a_univariate_polynomial_has_as_many_roots_as_its_degree():
    family = Family.of(lambda x, p: [x[0] ** 7 + p[1] * x[0] - p[0]], 1, 2)
    start, slope = 0.3 + 0.4j, 0.7 - 0.2j
    known = solve_generic(
        family,
        np.array([start]),
        np.array([start**7 + slope * start, slope]),
        np.random.default_rng(1),
    )
    assert known.are_all
    assert known.count == 7


def test_the_trace_test_misses_a_point_that_is_left_out():
    family = framework(PRISM, 6)
    rng = np.random.default_rng(0)
    known = generic_solutions(family)
    sizes, looked_at = np.ones(family.parameters), np.arange(family.n) < 2
    curve = CurveOverLine(family, known.fibre, sizes, looked_at, rng)
    effort = Effort(Deadline())
    curve.find_points(rng, effort)
    while not GenericSolutions(known.fibre, curve.trace(effort)).are_all:
        curve.find_points(rng, effort)
    assert len(curve.solutions) == 24
    section = curve.section
    for missing in range(0, len(section.solutions), 7):
        left = np.delete(section.solutions, missing, axis=0)
        curve.section = Fibre(section.parameters, left)
        assert curve.trace(effort) > 1e-3


def test_a_solution_that_closed_ways_do_not_reach_is_found_on_the_curve():
    """As the trace test is asked of it, not of the solutions that are known."""
    family = framework(PRISM, 6)
    known = generic_solutions(family).fibre
    one = Fibre(known.parameters, known.solutions[:1])
    rng, effort = np.random.default_rng(1), Effort(Deadline())
    sizes, looked_at = np.ones(family.parameters), np.arange(family.n) < 2
    curve = CurveOverLine(family, one, sizes, looked_at, rng)
    while not GenericSolutions(one, curve.trace(effort)).are_all:
        curve.find_points(rng, effort)
    assert len(curve.solutions) == 24


def test_no_more_paths_than_are_allowed_are_followed():
    family = framework(PRISM, 6)
    fibre = generic_solutions(family).fibre
    effort = Effort(Deadline(), most=100)
    ways = _Ways(np.ones(family.parameters), quiet=60)
    _enlarged(family, fibre, ways, np.random.default_rng(0), effort)
    assert 100 < effort.followed <= 100 + 3 * 24


def test_what_is_not_tested_for_lack_of_time_is_not_said_to_be_all():
    known = generic_solutions(framework(PRISM, 6), effort=Effort(Deadline(0.0)))
    assert known.trace is None
    assert not known.are_all


def test_no_more_solutions_than_are_asked_for_are_looked_for():
    known = generic_solutions(framework(PRISM, 6), most=5)
    assert not known.are_all
    assert 5 < known.count <= 24


def test_a_start_that_is_no_solution_is_refused():
    family = framework(PRISM, 6)
    with pytest.raises(ValueError, match="start: it is not allowed"):
        solve_generic(family, np.ones(8), np.ones(8), np.random.default_rng(0))


def platform(x, p):
    """Three points of a platform at x (9,), the others as it has them, on six legs: base
    points (6, 3), squares of the lengths of legs (6,), products of the sides of the
    three points (3,), and where the others are (3, 3), in p."""
    first, second, third = x[:3], x[3:6], x[6:]
    base, legs, sides, others = p[:18], p[18:24], p[24:27], p[27:]
    side, other = second - first, third - first
    normal = np.array(
        [side[k - 2] * other[k - 1] - side[k - 1] * other[k - 2] for k in range(3)]
    )
    points = [first, second, third]
    for k in range(3):
        along, across, above = others[3 * k : 3 * k + 3]
        points.append(first + along * side + across * other + above * normal)
    products = [(side * side).sum(), (other * other).sum(), (side * other).sum()]
    gaps = [point - base[3 * k : 3 * k + 3] for k, point in enumerate(points)]
    squares = [(gap * gap).sum() for gap in gaps]
    return [
        value - given
        for value, given in zip([*squares, *products], [*legs, *sides], strict=True)
    ]


def test_a_platform_on_six_legs_has_40_complex_assemblies():
    """Ronga and Vust 1995; Raghavan 1993."""
    family = Family.of(platform, 9, 36)
    rng = np.random.default_rng(0)
    start, parameters = complex_normal(rng, 9), complex_normal(rng, 36)
    parameters[18:27] = 0.0
    parameters[18:27] = family.residuals(start[None], parameters)[0]
    ways = _Ways(np.ones(36), quiet=3)
    fibre = Fibre(parameters, start[None])
    fibre = _enlarged(family, fibre, ways, rng, Effort(Deadline()))
    assert len(fibre.solutions) == 40


def test_a_trace_of_no_points_says_nothing():
    family = framework(PRISM, 6)
    nothing = Fibre(np.ones(family.parameters, dtype=complex), np.empty((0, family.n)))
    assert _trace(family, nothing, 0, 1.0, Effort(Deadline())) is None
