"""Tori: the same surface by two circles, and the 5R as the generalized Goldberg
linkage."""

import itertools

import numpy as np
import pytest

from linkages.families.bennett import bennett
from linkages.families.goldberg_5r import generalized_goldberg
from linkages.families.tori import ENTRIES, companion, torus_4r, torus_5r, torus_link
from linkages.loop import Loop
from linkages.values import GeometryError

FIVE_BARS = [entry for entry in ENTRIES if entry.name.startswith("torus-5r")]
EXAMPLE = {"r1": 1.5, "s1": 0.9, "chi1": 0.8, "theta1": 0.25}


def surface(
    r: float, s: float, chi: float, theta: float, phi: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the axis and height of the circle's points, equation (2.2) of Bil
    and Budniak (2015)."""
    x = s * np.cos(phi) * np.cos(theta) + r
    y = s * np.sin(phi) * np.cos(chi) + s * np.cos(phi) * np.sin(theta) * np.sin(chi)
    z = s * np.sin(phi) * np.sin(chi) - s * np.cos(phi) * np.sin(theta) * np.cos(chi)
    return np.hypot(x, y), z


def torus_angles(torus, radius):
    """chi and theta (rad) of the circle of a torus link whose centre is at
    ``radius``."""
    sine, cosine = np.sin(torus.link.twist), np.cos(torus.link.twist)
    theta = np.arcsin(torus.shift * sine**2 / radius)
    return np.arctan2(torus.link.length * sine / radius, cosine), theta


@pytest.mark.parametrize("mirrored", [False, True])
def test_companion_circle_draws_the_same_surface(mirrored):
    torus = torus_link(1.5, 0.8, 0.25)
    _, other, other_pin = companion(torus, 0.9, mirrored)
    phi = np.linspace(-3, 3, 13)
    chi, theta = torus_angles(other, other.radius)
    radii, heights = surface(1.5, 0.9, 0.8, 0.25, phi)
    radii_2, heights_2 = surface(other.radius, other_pin.radius, chi, theta, phi)
    assert np.allclose(radii, radii_2, atol=1e-14)
    assert np.allclose(heights, heights_2, atol=1e-14)


def test_companion_of_the_example_has_the_published_size():
    _, other, other_pin = companion(torus_link(1.5, 0.8, 0.25), 0.9)
    assert other.radius == pytest.approx(0.866203074497218, abs=1e-14)
    assert other_pin.radius == pytest.approx(1.519767164315497, abs=1e-14)


def test_four_bar_of_tori_is_a_bennett_linkage():
    loop = torus_4r(**EXAMPLE, mirrored=True)
    a, alpha, _ = loop.arrays
    wanted = bennett(a[0], alpha[0], alpha[1])
    for one, other in zip(loop.arrays, wanted.arrays, strict=True):
        assert np.allclose(one, other, atol=1e-14)


def axes_turned(loop: Loop, which: tuple[bool, ...]) -> Loop:
    """The same linkage with these axes pointing the other way, lengths made positive,
    twists in (-pi, pi]."""
    lengths, twists, offsets = (x.copy() for x in loop.arrays)
    for i in np.flatnonzero(which):
        offsets[i] *= -1
        twists[[i - 1, i]] += np.pi
    turned = lengths < 0
    lengths[turned], twists[turned] = -lengths[turned], -twists[turned]
    twists = np.angle(np.exp(1j * twists))
    return Loop(tuple(lengths), tuple(twists), tuple(offsets))


def as_generalized_goldberg(loop: Loop) -> float:
    """Smallest difference between ``loop`` and a generalized Goldberg 5R with its links
    12, 45, 51."""
    best = np.inf
    for which in itertools.product((False, True), repeat=5):
        read = axes_turned(loop.relabelled(3), which)
        lengths, twists, offsets = read.arrays
        if not all(0 < twists[i] < np.pi for i in (0, 2, 3, 4)):
            continue
        c, s = np.cos(twists), np.sin(twists)
        for sign, joined in itertools.product((1, -1), (twists[1], -twists[1])):
            cosine = (c[3] * c[4] - np.cos(joined)) / (s[3] * s[4])
            kink = sign * np.arccos(np.clip(cosine, -1, 1))
            try:
                model = generalized_goldberg(
                    lengths[4], twists[4], twists[0], twists[3], kink
                )
            except GeometryError:
                continue
            here = axes_turned(
                Loop(model.lengths, model.twists, model.offsets), (False,) * 5
            ).arrays
            gap = max(
                np.abs(here[0] - lengths).max(),
                np.abs(np.sin((here[1] - twists) / 2)).max(),
                np.abs(here[2] - offsets).max(),
            )
            best = min(best, float(gap))
    return best


@pytest.mark.parametrize("entry", FIVE_BARS, ids=lambda entry: entry.name)
def test_five_bar_of_tori_is_the_generalized_goldberg_linkage(entry):
    rng = np.random.default_rng(20)
    for values in [entry.defaults, *(entry.draw(rng) for _ in range(8))]:
        loop = entry.build(**values)
        extent = np.abs(np.concatenate(loop.arrays)).max()
        assert (
            as_generalized_goldberg(loop) < 1e-9 * extent
        )  # arccos and 1/sin^2 of the composite twist amplify


def test_there_are_sixteen_variants():
    assert len(FIVE_BARS) == 16


def test_plain_bennett_loops_give_the_goldberg_linkage():
    alpha, beta = np.radians([70.0, 35.0])
    r1, s1 = 1.7 * np.sin([alpha, beta])
    ratio = np.sin(np.radians(55.0)) / np.sin(beta)
    loop = torus_5r(r1, s1, alpha, 0.0, ratio, 0.0)
    assert sorted(np.abs(loop.arrays[0])) == pytest.approx(
        sorted([s1, s1, r1, s1 * ratio, r1 + s1 * ratio]), abs=1e-12
    )
    assert np.abs(loop.arrays[2]).max() < 1e-12


def test_tori_refuse_what_cannot_be():
    with pytest.raises(GeometryError, match="s/r of torus 4"):
        torus_5r(**EXAMPLE, ratio=0.7, delta=0.6)
    with pytest.raises(GeometryError, match="radius of the circle"):
        companion(torus_link(1.0, 1.2, 0.0), 2.0)
    with pytest.raises(GeometryError, match="between the axes"):
        torus_link(1.0, 0.0, 0.0)
