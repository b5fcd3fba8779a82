"""Many bracketed roots at once."""

import numpy as np

from bifurc.numerics.roots import bracketed_roots


def test_roots_of_different_functions_are_found_to_rounding():
    targets = np.array([0.1, 1.0, 2.5, 1e-3, 7.0])
    roots = bracketed_roots(lambda x: x**3 - targets, np.full(5, -1.0), np.full(5, 3.0))
    assert np.allclose(roots, np.cbrt(targets), rtol=4e-16, atol=2e-15)


def test_a_root_at_the_end_or_in_the_middle_of_a_bracket_is_found():
    roots = bracketed_roots(lambda x: x, np.array([-1.0, -1e-9]), np.array([1.0, 3.0]))
    assert np.all(np.abs(roots) < 1e-15)


def test_a_steep_function_is_bisected():
    roots = bracketed_roots(
        lambda x: np.sign(x - 0.3) * np.abs(x - 0.3) ** 0.1,
        np.array([-5.0]),
        np.array([4.0]),
    )
    assert abs(roots[0] - 0.3) < 1e-15


def test_no_brackets_give_no_roots():
    assert bracketed_roots(np.sin, np.empty(0), np.empty(0)).shape == (0,)


def test_the_method_is_that_of_scipy():
    from scipy.optimize.elementwise import find_root

    def function(x):
        return np.cos(x) - 0.3 * x**3

    low, high = np.array([-1.0, 0.0, 0.5]), np.array([2.0, 3.0, 9.0])
    evaluations = []

    def counted(x):
        evaluations.append(len(x))
        return function(x)

    roots = bracketed_roots(counted, low, high)
    theirs = find_root(function, (low, high))
    assert np.allclose(roots, theirs.x, rtol=1e-14)
    assert len(evaluations) <= theirs.nfev.max() + 2
