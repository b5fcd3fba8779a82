"""Complex curves have the degrees that the literature gives them, and critical points
of functions on them are found."""

import itertools

import numpy as np
import pytest

from bifurc.limits import Deadline
from bifurc.paths.critical import CriticalPoints
from bifurc.paths.curves import CurveEquations
from bifurc.paths.homogeneous import derivative, misfits
from tests.samples import one_in


def terms_of(text, names):
    sympy = pytest.importorskip("sympy")
    polynomial = sympy.Poly(sympy.sympify(text), *sympy.symbols(names))
    return {term: float(value) for term, value in polynomial.terms()}


def equations_of(texts, names):
    polynomials = tuple(terms_of(text, names) for text in texts)
    return CurveEquations(polynomials, len(names.split()))


def whole_section(equations, seed=0, most=300):
    rng, deadline = np.random.default_rng(seed), Deadline()
    section, paths = equations.whole_section(rng, deadline, most)
    assert paths.lost == 0
    return section


def degrees_of(equations, seed=0, most=300):
    section = whole_section(equations, seed, most)
    rng = np.random.default_rng(seed + 100)
    curves = equations.irreducible(section, rng, Deadline())
    assert curves.together == 0
    return curves.degrees


TWISTED = ["y - x^2", "z - x*y", "x*z - y^2"]
VIVIANI = ["x^2 + y^2 + z^2 - 4", "(x - 1)^2 + y^2 - 1"]
# equations, and the degrees of the irreducible curves
KNOWN = {
    "a circle": (["x^2 + y^2 - 1"], "x y", [2]),
    "a cubic with a node": (["y^2 - x^2*(x + 1)"], "x y", [3]),
    "a cubic with a cusp": (["y^2 - x^3"], "x y", [3]),
    "a circle and a line": (["(x^2 + y^2 - 1)*(x - 2*y)"], "x y", [2, 1]),
    "the twisted cubic, by two equations": (TWISTED[:2], "x y z", [3]),
    "the twisted cubic, by three": (TWISTED, "x y z", [3]),
    "Viviani's curve": (VIVIANI, "x y z", [4]),
    "two quadrics": (["x^2 + 2*y^2 - z^2 - 3", "x*y + z - 1"], "x y z", [4]),
    # Bertini's example of three lines (Bates, Hauenstein, Sommese and Wampler 2013)
    "three lines": (["x*z + y", "y*z + x"], "x y z", [1, 1, 1]),
    # Bjorck and Froberg 1991: two curves of degree 2
    "cyclic 4-roots": (
        [
            "x + y + z + w",
            "x*y + y*z + z*w + w*x",
            "x*y*z + y*z*w + z*w*x + w*x*y",
            "x*y*z*w - 1",
        ],
        "x y z w",
        [2, 2],
    ),
    "none": (["x^2 + 1", "x^2 + 2"], "x y z", []),
}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", KNOWN)
def test_degrees_are_those_of_the_literature(name, seed):
    texts, names, degrees = KNOWN[name]
    assert degrees_of(equations_of(texts, names), seed) == degrees


def test_the_degree_is_the_same_from_polynomials_with_the_same_monomials():
    # the product of degrees is 8, and 6 paths are allowed
    equations = equations_of(["x*y*z - 1", "x*y + y*z + 2*x + 1"], "x y z")
    assert degrees_of(equations, most=100) == degrees_of(equations, most=5)


def test_more_paths_than_are_allowed_are_not_followed():
    equations = equations_of(VIVIANI, "x y z")
    rng = np.random.default_rng(0)
    assert equations.whole_section(rng, Deadline(), 3) is None


@pytest.mark.parametrize("name", ["Viviani's curve", "three lines", "cyclic 4-roots"])
def test_the_curve_through_a_point_is_found_alone(name):
    texts, names, degrees = KNOWN[name]
    equations = equations_of(texts, names)
    point = equations.points(whole_section(equations))[0]
    curve = equations.curve_through(point, np.random.default_rng(1), Deadline(), 50)
    assert len(curve.solutions) in degrees


def bricard():
    """A 6R linkage with equal sides and right angles (Bertini's example; a test of
    HomotopyContinuation.jl): its joint axes z_2 to z_5."""
    names = [f"z{k}{axis}" for k in range(2, 6) for axis in "xyz"]
    sympy = pytest.importorskip("sympy")
    unknowns = sympy.symbols(" ".join(names))
    axes = [sympy.Matrix([1, 0, 0])]
    axes += [sympy.Matrix(unknowns[k : k + 3]) for k in range(0, 12, 3)]
    axes += [sympy.Matrix([0, 0, 1])]
    rows = [axis.dot(axis) - 1 for axis in axes[1:5]]
    rows += [one.dot(other) for one, other in itertools.pairwise(axes)]
    place = sympy.zeros(3, 1)
    for one, other in itertools.pairwise(axes):
        place += one.cross(other)
    rows += list(place - sympy.Matrix([0, 1, 0]))
    polynomials = []
    for row in rows:
        polynomial = sympy.Poly(sympy.expand(row), *unknowns)
        polynomials.append({term: float(value) for term, value in polynomial.terms()})
    return CurveEquations(tuple(polynomials), 12)


def test_bricards_linkage_moves_on_a_curve_of_degree_8():
    equations = bricard()
    rng = np.random.default_rng(2)
    point = None
    for _ in range(200):
        point = newton(equations, rng.normal(size=12))
        if point is not None:
            break
    curve = equations.curve_through(point, np.random.default_rng(0), Deadline(), 50)
    assert len(curve.solutions) == 8


def newton(equations, point):
    """A regular solution of the equations near a point, if there is one."""
    for _ in range(50):
        rows = np.array([value_of(one, point) for one in equations.polynomials])
        matrix = np.array(
            [
                [value_of(derivative(one, k), point) for k in range(equations.n)]
                for one in equations.polynomials
            ]
        )
        point = point - np.linalg.lstsq(matrix, rows, rcond=1e-8)[0]
    values = np.linalg.svd(matrix, compute_uv=False)
    is_solved = np.abs(rows).max() < 1e-12
    return point if is_solved and values[equations.n - 2] > 1e-3 else None


def value_of(polynomial, point):
    return sum(v * np.prod(point ** np.array(term)) for term, v in polynomial.items())


def critical_points(equations, is_distance, seed=0):
    section = whole_section(equations, seed)
    of = np.random.default_rng(3).normal(size=equations.n)
    function = CriticalPoints(equations, of, is_distance)
    rng = np.random.default_rng(seed + 100)
    paths = function.paths(section, rng, Deadline())
    assert len(paths.ends) == function.number_of_paths(len(section.solutions))
    return of, paths


# equations, critical points of a linear function and of a distance: 2 d + 2 g - 2 less
# cusps and what is at infinity, and degrees of the evolute (Euclidean distance degrees:
# Draisma, Horobet, Ottaviani, Sturmfels and Thomas 2016)
CRITICAL = {
    "a circle": (["x^2 + y^2 - 1"], "x y", 2, 2, 0),
    "an ellipse": (["x^2 + 4*y^2 - 1"], "x y", 2, 4, 0),
    "a smooth cubic": (["x^3 + 2*y^3 - x*y - 1"], "x y", 6, 9, 0),
    "a cubic with a node": (["x^3 + y^3 - 3*x*y"], "x y", 4, 7, 1),
    "a cardioid": (["(x^2+y^2)^2 + 4*x*(x^2+y^2) - 4*y^2"], "x y", 3, 3, 1),
    "two quadrics": (["x^2 + 2*y^2 - z^2 - 3", "x*y + z^2 - 1"], "x y z", 8, 12, 0),
}


@pytest.mark.parametrize("is_distance", [False, True], ids=["linear", "distance"])
@pytest.mark.parametrize("name", CRITICAL)
def test_critical_points_are_as_many_as_the_genus_says(name, is_distance):
    texts, names, linear, distance, singular = CRITICAL[name]
    equations = equations_of(texts, names)
    _, paths = critical_points(equations, is_distance)
    assert paths.lost == 0
    assert len(paths.regular) == (distance if is_distance else linear)
    places = {tuple(np.round(one, 4)) for one in paths.singular}
    assert len(places) == singular


@pytest.mark.parametrize("is_distance", [False, True], ids=["linear", "distance"])
def test_the_function_is_at_rest_at_critical_points(is_distance):
    equations = equations_of(VIVIANI, "x y z")
    of, paths = critical_points(equations, is_distance)
    for point in paths.regular:
        rows = [
            [value_of(derivative(one, k), point) for k in range(3)]
            for one in equations.polynomials
        ]
        slope = point - of if is_distance else of
        assert abs(np.linalg.det(np.array([*rows, slope]))) < 1e-9


@pytest.mark.parametrize("seed", one_in(2, range(4)))
def test_more_equations_than_needed_have_the_same_critical_points(seed):
    few = critical_points(equations_of(TWISTED[:2], "x y z"), False, seed)[1].regular
    more = critical_points(equations_of(TWISTED, "x y z"), False, seed)[1].regular
    equations = equations_of(TWISTED, "x y z")
    assert np.all(misfits(equations.polynomials, more) < 1e-12)
    gaps = np.abs(few[:, None] - more[None]).max(axis=2)
    assert np.all(gaps.min(axis=1) < 1e-9)


def test_too_few_equations_are_refused():
    with pytest.raises(ValueError, match="polynomials: 1 are not allowed for 3"):
        equations_of(["x + y + z"], "x y z")
