"""Distances of segments: against exact ones, in any position and of any size."""

import numpy as np
import pytest

from linkages.links.distances import segment_distances

ORIGIN, X, Y, Z = np.zeros(3), *np.eye(3)


@pytest.mark.parametrize("size", [1e-100, 1e-9, 1.0, 1e100])
@pytest.mark.parametrize(
    ("ends", "distance"),
    [
        ((-X, X, Z - Y, Z + Y), 1.0),  # crosswise
        ((ORIGIN, X, 2 * X, 3 * X), 1.0),  # on one line
        ((ORIGIN, X, 3 * X, 2 * X), 1.0),
        ((ORIGIN, X, Y, X + Y), 1.0),  # beside each other
        ((ORIGIN, 4 * X, X + Y, 2 * X + Y), 1.0),
        ((ORIGIN, X, 2 * X, 2 * X), 1.0),  # a point
        ((X, X, ORIGIN, ORIGIN), 1.0),
        ((ORIGIN, X, 2 * X - Y, 2 * X + Y), 1.0),
        ((-X, X, -Y, Y), 0.0),
    ],
)
def test_known_distances(ends, distance, size):
    scaled = [size * end for end in ends]
    assert segment_distances(*scaled) == pytest.approx(
        distance * size, abs=1e-12 * size
    )


@pytest.mark.parametrize("lean", [0.0, 1e-14, 1e-11, 1e-9, 1e-8, 1e-7, 1e-4, 1.0])
def test_no_point_of_either_is_nearer_also_where_they_are_nearly_parallel(lean):
    random = np.random.default_rng(5)
    a, along, c = random.normal(size=(3, 300, 3))
    other = along * random.uniform(-2, 2, (300, 1)) + lean * random.normal(size=a.shape)
    distances = segment_distances(a, a + along, c, c + other)
    shares = np.linspace(0, 1, 41)
    first = a[:, None] + shares[:, None] * along[:, None]
    second = c[:, None] + shares[:, None] * other[:, None]
    seen = np.linalg.norm(first[:, :, None] - second[:, None], axis=-1).min(axis=(1, 2))
    assert np.all(distances <= seen + 1e-12)
    assert np.all(distances >= seen - 0.06 * np.linalg.norm(along, axis=1))
    swapped = segment_distances(c, c + other, a, a + along)
    assert swapped == pytest.approx(distances, abs=1e-12)
