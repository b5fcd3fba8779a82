"""Problems of the literature, with the points that are printed there.

TEST_CON is Rheinboldt's collection of continuation problems, as J. Burkardt publishes
it; AUTO's demo is that of Doedel et al., AUTO-07P, 2012, chapter "ab".
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy
import sympy

import bifurc
from bifurc.singular.point import Kind
from tests.samples import one_in


def has_point(points, expected, digits) -> bool:
    """Whether one of the points is the expected one, to so many decimals."""
    return any(
        np.abs(u - np.array(expected)).max() < 0.6 * 10.0**-digits for u in points
    )


def test_the_a_to_b_reaction_of_auto_has_its_folds_and_its_hopf_point() -> None:
    def reaction(u):
        x, y, p = u
        rate = p * (1 - x) * np.exp(y)
        return [rate - x, 14 * rate - 3 * y]

    problem = bifurc.FunctionProblem(
        reaction, [(0, 1), (0, 8), (0, 0.16)], names=["x", "y", "p1"]
    )
    diagram = bifurc.explore(problem, parameter="p1").diagram
    folds = [(*fold.u[:2], 100 * fold.u[2]) for fold in diagram.folds]
    assert len(folds) == 2
    assert has_point(folds, (0.311023, 1.45144, 10.5739), 4)
    assert has_point(folds, (0.688982, 3.21525, 8.89318), 4)
    (hopf,) = diagram.hopf_points
    assert hopf.u == pytest.approx([0.895080, 4.17704, 0.130900], rel=3e-6)
    assert [one.unstable for one in diagram.stretches] in ([0, 1, 2, 0], [0, 2, 1, 0])


def test_freudenstein_and_roth_turn_where_the_closed_form_says() -> None:
    def homotopy(u):
        x, y, a = u
        return [
            x - y**3 + 5 * y**2 - 2 * y - 13 + 34 * (a - 1),
            x + y**3 + y**2 - 14 * y - 29 + 10 * (a - 1),
        ]

    problem = bifurc.FunctionProblem(
        homotopy, [(-20, 80), (-5, 6), (-2, 2)], names=["x", "y", "a"]
    )
    atlas = bifurc.explore(problem, parameter="a", events={"target": ("a", 1.0)})
    folds = [fold.u for fold in atlas.diagram.folds]
    assert has_point(folds, (20.48586, -0.8968053, 0.5875873), 5)
    assert has_point(folds, (61.02031, 2.230139, -0.6863528), 5)
    root = math.sqrt(22) / 3
    for fold, y in zip(sorted(folds, key=lambda u: u[1]), (-root, root), strict=True):
        y += 2 / 3
        assert fold[2] == pytest.approx((y**3 - 2 * y**2 - 6 * y + 4) / 12, abs=1e-13)
        assert fold[1] == pytest.approx(y, abs=1e-9)
    (target,) = atlas.diagram.events("target")
    assert target.u == pytest.approx([5, 4, 1], abs=1e-11)


# Linear and quadratic coefficients of the aircraft: TEST_CON problem 6.
LINEAR = np.array(
    [
        [-3.933, 0.107, 0.126, 0.0, -9.99, 0.0, -45.83],
        [0.0, -0.987, 0.0, -22.95, 0.0, -28.37, 0.0],
        [0.002, 0.0, -0.235, 0.0, 5.67, 0.0, -0.921],
        [0.0, 1.0, 0.0, -1.0, 0.0, -0.168, 0.0],
        [0.0, 0.0, -1.0, 0.0, -0.196, 0.0, -0.0071],
    ]
)


def aircraft(elevator):
    def equilibrium(u):
        roll, pitch, yaw, attack, sideslip, aileron = u
        state = [roll, pitch, yaw, attack, sideslip, elevator, aileron]
        quadratic = [
            8.39 * yaw * attack
            - 0.727 * pitch * yaw
            - 684.4 * attack * sideslip
            + 63.5 * attack * aileron,
            0.949 * roll * yaw + 0.173 * roll * sideslip,
            1.132 * attack * aileron - 0.716 * roll * pitch - 1.578 * roll * attack,
            -roll * sideslip,
            roll * attack,
        ]
        linear = [sum(a * x for a, x in zip(row, state, strict=True)) for row in LINEAR]
        return [a + b for a, b in zip(linear, quadratic, strict=True)]

    return bifurc.FunctionProblem(
        equilibrium,
        [(-6, 6), (-3, 3), (-1, 1), (-1, 1), (-1, 1), (-1, 1)],
        names=["roll", "pitch", "yaw", "attack", "sideslip", "aileron"],
    )


@pytest.mark.parametrize(
    "row",
    # of Rheinboldt's list the roll and the aileron; the first aileron is printed as
    # -0.0504, with a 0 too many
    one_in(
        3,
        [
            (-0.008, [2.8173, 3.7579, 4.1638], [-0.2049, 0.0062, -0.3776]),
            (0.0, [2.5873, 3.9005], [-0.1869, 0.5101]),
            (0.05, [2.3639], [-0.2957]),
            (-0.05, [2.9648], [-0.5048]),
            (0.1, [2.2992], [-0.6897]),
        ],
        lambda row: f"elevator {row[0]}",
    ),
)
def test_the_aircraft_turns_where_rheinboldt_says(row) -> None:
    elevator, roll, aileron = row
    diagram = bifurc.explore(aircraft(elevator), parameter="aileron").diagram
    folds = [fold.u[[0, 5]] for fold in diagram.folds]
    for expected in zip(roll, aileron, strict=True):
        assert has_point(folds, expected, 3)


@pytest.mark.parametrize(
    "angle, expected",
    [
        (0.25, [(0.5800046, 0.7846684, 2.004746), (2.777765, 0.5695726, -2.464886)]),
        (0.5, [(0.6305253, 0.9921379, 1.779294), (2.501894, 0.7202593, -1.846869)]),
        (1.0, [(0.7650624, 1.292679, 1.837450), (2.204188, 0.8010838, -1.253382)]),
    ],
)
def test_two_bars_under_a_skew_load_turn_where_melhem_says(angle, expected) -> None:
    diagram = bifurc.explore(bars(angle), parameter="load").diagram
    folds = [fold.u for fold in diagram.folds]
    assert len(folds) == 4
    for point in expected:
        assert has_point(folds, point, 5)


def test_two_bars_under_a_symmetric_load_buckle_in_pitchforks() -> None:
    atlas = bifurc.explore(bars(0.0), parameter="load")
    folds = sorted(fold.u[0] for fold in atlas.diagram.folds)
    gap = 2 / math.sqrt(3)
    np.testing.assert_allclose(folds, [2 - gap, 2 + gap], rtol=0, atol=1e-9)
    kinds = [one.kind for one in atlas.diagram.branchings]
    assert kinds == [Kind.SUPERCRITICAL] * 2
    heights = sorted(point.point.u[0] for point in atlas.bifurcations)
    gap = math.sqrt(2)
    np.testing.assert_allclose(heights, [2 - gap, 2 + gap], rtol=0, atol=1e-12)


def bars(angle):
    """Oden's two bars of height 2: TEST_CON problem 9."""

    def balance(u):
        x, y, load = u
        return [
            x**3 - 6 * x**2 + 8 * x + x * y**2 - 2 * y**2 - load * math.cos(angle),
            x**2 * y - 4 * x * y + y**3 + 2 * y - load * math.sin(angle),
        ]

    return bifurc.FunctionProblem(
        balance, [(-2, 6), (-4, 4), (-8, 8)], names=["x", "y", "load"]
    )


def test_cells_in_a_row_turn_where_rheinboldt_says() -> None:
    def kinetics(u):
        *x, p = u
        rates = [100 * v / (1 + v + v**2) for v in x]
        inner = [3 * x[i] - x[i - 1] - x[i + 1] for i in range(1, 4)]
        coupling = [2 * x[0] - x[1], *inner, 2 * x[4] - x[3]]
        return [a + b - p for a, b in zip(rates, coupling, strict=True)]

    problem = bifurc.FunctionProblem(kinetics, [(0, 30)] * 5 + [(0, 60)])
    atlas = bifurc.explore(
        problem,
        parameter="u6",
        settings=bifurc.SearchSettings(starts=30, certify=False),
    )
    uniform = [fold.u for fold in atlas.diagram.folds if np.ptp(fold.u[:5]) < 1e-6]
    assert len(uniform) == 2
    assert has_point(uniform, (*[1.048362] * 5, 34.35693), 4)
    assert has_point(uniform, (*[8.822219] * 5, 18.88707), 4)


@pytest.mark.exhaustive
def test_the_locus_of_folds_of_pp2_is_four_lines_without_a_fold() -> None:
    """AUTO-07p's predator and prey with det F_u = 0 appended: on the axis u2 = 0 the
    equations are linear in p1 and p2, so that nothing turns back along p2; its four lines
    leave u1 between 0 and 1.5 where p1 = p2 = 0."""
    u1, u2, p1, p2 = unknowns = sympy.symbols("u1 u2 p1 p2")
    prey = p2 * u1 * (1 - u1) - u1 * u2 - p1 * (1 - sympy.exp(-5 * u1))
    hunters = -u2 + 3 * u1 * u2
    det = sympy.Matrix([prey, hunters]).jacobian([u1, u2]).det()
    bounds = [(0, 1.5), (-0.5, 3), (-1, 2), (0, 6)]
    problem = bifurc.SymbolicProblem([prey, hunters, det], unknowns, bounds)
    settings = bifurc.SearchSettings(starts=10, certify=False)
    atlas = bifurc.explore(problem, parameter=p2, settings=settings)
    assert atlas.diagram.folds == ()
    lines = []
    for form in atlas.forms:
        points = form.branch.sample(50)
        along = points[-1] - points[0]
        assert np.linalg.matrix_rank(points - points[0], tol=1e-9) == 1
        assert np.abs(points[:, 1]).max() < 1e-7
        if abs(along[3]) > 1e-9:
            lines.append((points[:, 0].mean(), along[2] / along[3]))
    at = scipy.optimize.brentq(
        lambda u: (1 - 2 * u) * (np.exp(5 * u) - 1) - 5 * u * (1 - u), 0.3, 0.45
    )
    slopes = [
        (0.0, 1 / 5),
        (1 / 3, 2 / 9 / (1 - np.exp(-5 / 3))),
        (at, at * (1 - at) / (1 - np.exp(-5 * at))),
    ]
    np.testing.assert_allclose(sorted(lines), slopes, atol=1e-6)
    assert len(atlas.forms) == 4
