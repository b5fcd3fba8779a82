"""Components in which groups of unknowns move independently of each other."""

import numpy as np
import pytest

import bifurc
from bifurc.files.dataset import from_dataset, to_dataset
from bifurc.isometry import Isometry, recount_atlas
from bifurc.settings import SearchSettings
from bifurc.surfaces.factor import Factor, describe_product, product_of

SETTINGS = SearchSettings(charts=300, starts=60)
CIRCLE = 2 * np.pi


def explored(equations, names, reach=2.0, seed=0, settings=SETTINGS):
    bounds = dict.fromkeys(names, (-reach, reach))
    problem = bifurc.FunctionProblem(equations, bounds)
    return bifurc.explore(problem, settings=settings, seed=seed)


def circles(u):
    """As many circles as there are pairs of unknowns."""
    return [x**2 + y**2 - 1 for x, y in zip(u[::2], u[1::2], strict=True)]


@pytest.mark.parametrize("count", [2, 3, 4])
def test_circles_have_one_product(count):
    atlas = explored(circles, "abcdefgh"[: 2 * count])
    (surface,) = atlas.surfaces
    assert surface.dimension == count
    sizes = [factor.size for factor in surface.factors]
    assert sizes == pytest.approx([CIRCLE] * count, rel=1e-9)
    pairs = [(2 * k, 2 * k + 1) for k in range(count)]
    assert sorted(factor.unknowns for factor in surface.factors) == pairs
    assert f"the product of {count} closed curves" in repr(atlas)
    assert not atlas.completeness.is_in_doubt


@pytest.mark.parametrize("seed", range(3))
def test_components_multiply(seed):
    def equations(u):
        two = (u[0] ** 2 + u[1] ** 2 - 1) * (u[0] ** 2 / 4 + u[1] ** 2 / 9 - 1)
        cubic = u[3] ** 2 - u[2] * (u[2] - 1) * (u[2] + 1)
        return [two, cubic, u[4] ** 2 + u[5] ** 2 - 1]

    atlas = explored(equations, "xyzwab", reach=4.0, seed=seed)
    assert len(atlas.surfaces) == 4
    kinds = sorted(product_of(surface.factors) for surface in atlas.surfaces)
    open_one = "the product of 2 closed curves and 1 open curve"
    assert kinds == [open_one] * 2 + ["the product of 3 closed curves"] * 2


# one start reaches one component, and the others are made of its curves only where some
# other start has been on each of them
def test_components_that_no_start_reaches_are_put_together():
    def equations(u):
        return [
            (u[0] ** 2 + u[1] ** 2 - 1) * (u[0] ** 2 + u[1] ** 2 - 4),
            u[2] ** 2 - 1,
        ]

    def both(u):
        return [*equations(u[:3]), *equations(u[3:])]

    names = "abcdef"
    problem = bifurc.FunctionProblem(both, dict.fromkeys(names, (-3, 3)))
    places = [[1, 0, 1, 2, 0, 1], [0, 2, 1, 0, 1, 1]]
    seeds = bifurc.Seeds(
        points=np.array(places, dtype=float),
        random=np.ones(2, dtype=bool),
        gaps=np.empty(0),
        missed=np.empty((0, 6)),
    )
    atlas = bifurc.explore(problem, seeds=seeds, settings=SETTINGS)
    sizes = sorted(
        tuple(factor.size / CIRCLE for factor in surface.factors)
        for surface in atlas.surfaces
    )
    assert np.round(sizes, 6).tolist() == [[1, 1], [1, 2], [2, 1], [2, 2]]


def test_a_plane_is_a_factor_of_its_own():
    def equations(u):
        return [u[0] ** 2 + u[1] ** 2 - 1, u[2] + u[3] + u[4] + u[5] - 0.5]

    atlas = explored(equations, "xyabcd")
    (surface,) = atlas.surfaces
    assert surface.dimension == 4
    factors = {factor.dimension: factor for factor in surface.factors}
    assert factors[3].unknowns == (2, 3, 4, 5)
    assert not factors[3].is_closed
    assert factors[3].size is None


def test_a_sphere_is_a_factor_of_its_own():
    def equations(u):
        return [u[0] ** 2 + u[1] ** 2 - 1, u[2] ** 2 + u[3] ** 2 + u[4] ** 2 - 1]

    atlas = explored(equations, "xyabc")
    (surface,) = atlas.surfaces
    assert product_of(surface.factors) == (
        "the product of 1 closed curve and 1 closed surface"
    )
    (sphere,) = [one for one in surface.factors if one.dimension == 2]
    assert sphere.size == pytest.approx(4 * np.pi, rel=1e-3)


@pytest.mark.parametrize("strength", [1e-2, 1e-4, 1e-6])
def test_what_depends_on_each_other_is_no_product(strength):
    def equations(u):
        ring = u[0] ** 2 + u[1] ** 2 - 1 + strength * u[2]
        return [ring, u[2] ** 2 + u[3] ** 2 - 1]

    atlas = explored(equations, "xyzw", settings=SearchSettings(charts=1500, starts=60))
    (surface,) = atlas.surfaces
    assert not surface.factors
    assert surface.complete


def test_a_torus_in_space_is_no_product():
    def equations(u):
        return [
            (u[0] ** 2 + u[1] ** 2 + u[2] ** 2 + 3.5) ** 2
            - 16 * (u[0] ** 2 + u[1] ** 2)
        ]

    atlas = explored(equations, "xyz", reach=3.0)
    assert [surface.factors for surface in atlas.surfaces] == [()]


def test_charts_that_ran_out_leave_no_doubt_about_a_product():
    def equations(u):
        return [u[0] ** 2 + u[1] ** 2 - 1, u[2] ** 2 + u[3] ** 2 / 400 - 1]

    atlas = explored(equations, "xyzw", reach=30.0)
    (surface,) = atlas.surfaces
    assert surface.charts is not None
    assert not surface.complete
    assert not surface.is_short_of_charts
    assert not atlas.completeness.is_in_doubt


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_units_make_no_difference(unit):
    def equations(u):
        x, y, z, w = (value / unit for value in u)
        return [x**2 + y**2 - 1, z**2 + w**2 - 4]

    atlas = explored(equations, "xyzw", reach=3 * unit)
    (surface,) = atlas.surfaces
    sizes = [factor.size for factor in surface.factors]
    assert sizes == pytest.approx([unit * CIRCLE, 2 * unit * CIRCLE], rel=1e-8)


def test_products_come_back_from_a_dataset_and_in_other_unknowns():
    atlas = explored(circles, "abcd")
    again = from_dataset(to_dataset(atlas))
    factors = atlas.surfaces[0].factors
    assert again.surfaces[0].factors == factors
    order = np.array([2, 3, 0, 1])
    isometry = Isometry(order, np.ones(4), np.zeros(4))
    moved = recount_atlas(atlas, isometry, ["c", "d", "a", "b"]).surfaces[0].factors
    assert [one.unknowns for one in moved] == [(2, 3), (0, 1)]
    words = describe_product(factors, atlas.names)
    assert (
        words == "the product of a closed curve of a, b; and of a closed curve of c, d"
    )


def test_a_part_of_many_dimensions_is_said_to_be_one():
    factors = [Factor((0,), 1, True, 1.0), Factor((1, 2, 3, 4), 3, False, None)]
    words = "the product of 1 closed curve and 1 open part of dimension 3"
    assert product_of(factors) == words
