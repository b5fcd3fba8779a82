"""Paths of solutions of systems with known solutions."""

import numpy as np
import pytest

from bifurc.limits import Deadline
from bifurc.paths import follow
from bifurc.paths.family import Family
from bifurc.paths.follow import PathEnd, distinct, follow_paths


def family_of_powers(degree):
    """x^degree = p."""
    return Family.of(lambda x, p: [x[0] ** degree - p[0]], 1, 1)


def ends_of(family, starts, first, last, **options):
    starts = np.array(starts, dtype=complex).reshape(-1, family.n)
    return follow_paths(family, starts, np.array(first), np.array(last), **options)


def sorted_ends(paths):
    """The ends of paths of one unknown, by their imaginary parts."""
    return sorted(paths.points[:, 0].tolist(), key=lambda end: (end.imag, end.real))


def test_regular_ends_are_exact_to_rounding():
    family = Family.of(
        lambda x, p: [x[0] ** 2 + x[1] ** 2 - p[0], x[0] * x[1] - p[1]], 2, 2
    )
    # (x + y)^2 = p0 + 2 p1, (x - y)^2 = p0 - 2 p1
    both = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    sums, gaps = np.sqrt(5 + 2j), np.sqrt(1 - 2j)
    starts = [((s * sums + d * gaps) / 2, (s * sums - d * gaps) / 2) for s, d in both]
    paths = ends_of(family, starts, [3.0, 1 + 1j], [5.0, 2.0])
    assert np.all(paths.ends == PathEnd.REGULAR)
    known = {(2, 1), (1, 2), (-2, -1), (-1, -2)}
    assert {tuple(np.rint(point.real).astype(int)) for point in paths.points} == known
    assert np.abs(paths.points - np.rint(paths.points.real)).max() < 1e-14


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_a_path_goes_round_a_singular_end_as_often_as_solutions_meet_there(degree):
    family = Family.of(lambda x, p: [(x[0] - 1.0) ** degree - p[0]], 1, 1)
    starts = 1.0 + np.exp(2j * np.pi * np.arange(degree) / degree)
    paths = ends_of(family, starts, [1.0], [0.0])
    assert np.all(paths.ends == PathEnd.SINGULAR)
    assert np.all(paths.windings == degree)
    # the mean round the end has all digits but those of closing
    assert np.abs(paths.points - 1.0).max() < 1e-7


def test_ends_at_infinity_are_told_from_finite_ones():
    # of the solutions of p x^3 + x^2 = 1 one goes to infinity as p goes to 0
    family = Family.of(lambda x, p: [p[0] * x[0] ** 3 + x[0] ** 2 - 1.0], 1, 1)
    starts = np.roots([1.0 + 0.5j, 1.0, 0.0, -1.0])
    paths = ends_of(family, starts, [1.0 + 0.5j], [0.0])
    assert sorted(paths.ends.tolist()) == [0, 0, PathEnd.AT_INFINITY]
    assert np.allclose(sorted(paths.regular[:, 0].real), [-1.0, 1.0], atol=1e-14)


def test_two_paths_to_infinity_together_do_not_end_at_their_mean():
    # p x^2 = 1: they go round infinity, and their mean is 0
    family = Family.of(lambda x, p: [p[0] * x[0] ** 2 - 1.0], 1, 1)
    paths = ends_of(family, [1.0, -1.0], [1.0], [0.0])
    assert np.all(paths.ends == PathEnd.AT_INFINITY)


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5, 1e-7])
def test_paths_that_pass_each_other_closely_do_not_jump(gap):
    # x^2 = s^2 + gap^2 while s goes from 1 to -1
    family = Family.of(lambda x, p: [x[0] ** 2 - p[0] ** 2 - gap**2], 1, 1)
    end = np.sqrt(1.0 + gap**2)
    paths = ends_of(family, [end, -end], [1.0], [-1.0])
    assert np.all(paths.ends == PathEnd.REGULAR)
    assert np.allclose(paths.points[:, 0], [end, -end], rtol=1e-14)


def test_a_start_that_is_no_solution_is_said():
    paths = ends_of(family_of_powers(2), [1.0, 5.0], [1.0], [2.0])
    assert paths.ends.tolist() == [PathEnd.REGULAR, PathEnd.NO_START]
    assert paths.reasons() == ["the start is no solution"]


def test_paths_through_a_singular_member_are_led_round_it():
    # at p = 0, half way, the solutions meet
    paths = ends_of(family_of_powers(2), [1.0, -1.0], [1.0], [-1.0])
    assert np.all(paths.is_regular)
    assert sorted_ends(paths) == pytest.approx([-1j, 1j])


def test_a_path_through_a_singular_member_is_lost_and_says_so(monkeypatch):
    monkeypatch.setattr(follow, "DETOURS", ())
    paths = ends_of(family_of_powers(2), [1.0, -1.0], [1.0], [-1.0])
    assert np.all(paths.is_lost)
    assert set(paths.reasons()) <= {"steps became too small", "more than 3000 steps"}
    assert np.allclose(paths.rests, 0.5, atol=1e-6)


def test_a_path_that_is_led_round_does_not_end_where_another_one_does():
    # where two of three solutions meet half way; round that they may change places
    family = Family.of(lambda x, p: [(x[0] ** 2 - p[0]) * (x[0] - 3.0)], 1, 1)
    for side in (1.0, -1.0):
        paths = ends_of(family, [side, 3.0, -side], [1.0], [-1.0])
        assert sorted_ends(paths) == pytest.approx([-1j, 3.0, 1j])


def test_where_terms_cancel_ends_are_exact_to_rounding():
    # (x - 1)^3 = p; doubles leave 1e-16 / 3e-6
    def equations(x, p):
        return [((x[0] - 3.0) * x[0] + 3.0) * x[0] - 1.0 - p[0]]

    family = Family.of(equations, 1, 1)
    turns = np.exp(2j * np.pi * np.arange(3) / 3)
    paths = ends_of(family, 1.0 + turns, [1.0], [1e-9])
    assert np.all(paths.is_regular)
    assert np.abs(paths.points[:, 0] - (1.0 + 1e-3 * turns)).max() < 1e-15


def test_no_path_is_begun_after_a_deadline():
    paths = ends_of(family_of_powers(2), [1.0], [1.0], [2.0], deadline=Deadline(0.0))
    assert paths.reasons() == ["out of time"]


def test_of_more_equations_than_unknowns_what_solves_all_is_told_apart():
    # x = p0, y = p1 and (x - p0) (y - 5) = 0; generic combinations of them have one
    # more solution
    def equations(x, p):
        return [x[0] - p[0], x[1] - p[1], (x[0] - p[0]) * (x[1] - 5.0)]

    family = Family.of(equations, 2, 2)
    matrix = family.combinations
    first = np.array([1.0 + 1j, 2.0 - 1j])
    # with u = x - p0, v = y - p1: a row is a u + b v + c u (v + p1 - 5)
    a, b, c = matrix.T
    v = (c * (first[1] - 5.0) + a) / -c
    # eliminated by hand: (a0 + c0 w) / b0 = (a1 + c1 w) / b1 with w = y - 5
    w = (a[0] * b[1] - a[1] * b[0]) / (c[1] * b[0] - c[0] * b[1])
    v = w + 5.0 - first[1]
    u = -b[0] * v / (a[0] + c[0] * w)
    starts = np.array([first, first + np.array([u, v])])
    paths = follow_paths(family, starts, first, np.array([3.0, 4.0]))
    assert np.all(paths.is_regular)
    assert paths.solves_all.tolist() == [True, False]
    assert np.allclose(paths.regular, [[3.0, 4.0]], atol=1e-13)


def test_fewer_equations_than_unknowns_are_refused():
    with pytest.raises(ValueError, match="equations: 1 are not allowed for 2 unknowns"):
        Family.of(lambda x, p: [x[0] + x[1] - p[0]], 2, 1)


def test_the_first_of_equal_points_is_kept():
    points = np.array([[1.0, 2j], [3.0, 0.0], [1.0 + 1e-12, 2j], [3.0, 1e-3]])
    assert np.array_equal(distinct(points), points[[0, 1, 3]])


@pytest.mark.parametrize("place", [1e-3, 1e-5, 1e-7])
def test_ends_of_paths_that_meet_beside_the_end_are_regular(place):
    # x^2 = p - place, and p goes to 0: the mean of both ends is no solution
    family = Family.of(lambda x, p: [(x[0] - 1.0) ** 2 - p[0] + place], 1, 1)
    start = np.sqrt(1.0 + 0.5j - place)
    paths = ends_of(family, [1.0 + start, 1.0 - start], [1.0 + 0.5j], [0.0])
    assert np.all(paths.ends == PathEnd.REGULAR)
    half = np.sqrt(place)
    assert np.allclose(np.sort(paths.points[:, 0].imag), [-half, half], rtol=1e-6)
