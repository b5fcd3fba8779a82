"""Lines on which quadratic forms vanish together."""

import numpy as np
import pytest

from bifurc.singular.tangent_cone import tangent_cone
from tests.samples import one_in


def spread(size, count=200):
    half = np.random.default_rng(size).normal(size=(count, size))
    half /= np.linalg.norm(half, axis=1)[:, None]
    return np.concatenate([half, -half])


def forms_through(lines, rng):
    """A basis of all quadratic forms (w, k, k) that vanish on ``lines`` (d, k)."""
    size = lines.shape[1]
    products = np.einsum("di,dj->dij", lines, lines).reshape(len(lines), -1)
    symmetric = np.eye(size * size).reshape(-1, size, size)
    symmetric = (symmetric + symmetric.transpose(0, 2, 1)).reshape(-1, size * size)
    _, sigma, right = np.linalg.svd(products @ symmetric)
    rank = np.count_nonzero(sigma > 1e-9 * sigma[0])
    rows = right[rank:] @ symmetric
    _, sigma, right = np.linalg.svd(rows)
    independent = right[: np.count_nonzero(sigma > 1e-9 * sigma[0])]
    mix = rng.normal(size=(len(independent), len(independent)))
    return (mix @ independent).reshape(-1, size, size)


@pytest.mark.parametrize("seed", one_in(4, range(8)))
@pytest.mark.parametrize(("size", "count"), [(3, 1), (3, 3), (4, 5), (5, 6)])
def test_more_forms_than_needed_leave_the_lines_through_which_they_were_laid(
    size, count, seed
):
    rng = np.random.default_rng(seed)
    lines = rng.normal(size=(count, size))
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    cone = tangent_cone(forms_through(lines, rng), spread(size))
    assert cone.is_whole
    assert len(cone.lone) == 2 * count
    along = np.abs(cone.lone @ lines.T).max(axis=1)
    assert along == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("seed", one_in(4, range(12)))
@pytest.mark.parametrize("size", [3, 4, 5])
def test_as_many_forms_as_needed_have_the_lines_that_many_starts_find(seed, size):
    rng = np.random.default_rng(seed)
    forms = rng.normal(size=(size - 1, size, size))
    forms = forms + forms.transpose(0, 2, 1)
    cone = tangent_cone(forms, spread(size, 10))
    assert cone.is_whole
    assert len(cone.lone) <= 2 * 2 ** (size - 1)
    values = np.einsum("di,wij,dj->dw", cone.lone, forms, cone.lone)
    assert np.abs(values).max(initial=0.0) < 1e-12
    assert len(tangent_cone(forms, spread(size, 3000)).lone) == len(cone.lone)


def test_what_no_start_comes_to_is_the_end_of_a_path():
    """From starts at one line only the other seven are found as well."""
    diagonals = [[1, -1, 0, 0], [0, 1, -1, 0], [0, 0, 1, -1]]
    squares = np.array([np.diag(row) for row in diagonals], float)
    one = np.array([[1.0, 1.0, 1.0, 1.0]]) / 2
    cone = tangent_cone(squares, np.concatenate([one, -one]))
    assert cone.is_whole
    assert len(cone.lone) == 16
    assert np.abs(np.abs(cone.lone) - 0.5).max() < 1e-12


@pytest.mark.parametrize(
    "forms",
    [
        pytest.param([np.diag([1.0, -1.0, 0.0])], id="a cone of a curve"),
        pytest.param(
            [np.diag([1.0, 0.0, 0.0]), np.diag([0.0, 1.0, 0.0])], id="a double line"
        ),
        pytest.param(
            [np.diag([1.0, -1.0, 0.0]), np.diag([2.0, -2.0, 0.0])],
            id="one form, given twice",
        ),
    ],
)
def test_where_lines_are_not_alone_nothing_is_said_to_be_whole(forms):
    assert not tangent_cone(np.array(forms), spread(3)).is_whole


def test_forms_of_rounding_are_none():
    noise = 1e-12 * np.random.default_rng(0).normal(size=(2, 3, 3))
    cone = tangent_cone(noise + noise.transpose(0, 2, 1), spread(3))
    assert not cone.is_whole
    assert not len(cone.lone)


def test_definite_forms_have_no_line():
    forms = np.array([np.eye(3), np.diag([1.0, 2.0, 3.0])])
    cone = tangent_cone(forms, spread(3))
    assert cone.is_whole
    assert not len(cone.lone)
