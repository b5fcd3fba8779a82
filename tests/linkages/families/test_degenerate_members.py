"""Special values of the parameters make a loop or are refused with a reason: nothing
else is raised, and no loop has numbers that rounding made."""

import itertools

import numpy as np
import pytest

from linkages.catalogue import catalogue, entry
from linkages.entry import ParameterKind
from linkages.families.goldberg_5r import syncopated_goldberg
from linkages.families.waldron import yu_baker
from linkages.loop import Loop
from linkages.values import GeometryError
from tests.samples import one_in

SPECIAL_ANGLES = np.radians([0, 30, 45, 60, 90, 120, 135, 180, -45, -90, 360])
SPECIAL_LENGTHS = (0.0, 1.0, -1.0, 2.0)
HUGE = 1e6  # times the parameters: what divisions by rounding errors make


def built_or_refused(found, values):
    """Whether the member is built; a refusal says what is allowed."""
    try:
        loop = found.build(**values)
    except GeometryError as refusal:
        assert refusal.name
        assert refusal.allowed
        assert "nan" not in str(refusal.value)
        return False
    assert isinstance(loop, Loop)
    size = max(1.0, *(abs(value) for value in values.values()))
    assert all(np.abs(row).max() < HUGE * size for row in loop.arrays), values
    if found.patterns is not None:
        theta = np.linspace(-3, 3, loop.n)
        for pattern in found.patterns(**values):
            assert np.all(np.isfinite(pattern.residual(theta))), (pattern.name, values)
    return True


def special_members(found, rng, count):
    """Parameters with equal, right, supplementary, zero and half-turn angles, and with
    equal, zero and negative lengths."""
    angles = [p.name for p in found.parameters if p.kind is ParameterKind.ANGLE]
    others = [p.name for p in found.parameters if p.kind is not ParameterKind.ANGLE]
    for _ in range(count):
        values = found.draw(rng)
        for name in angles:
            if rng.random() < 0.6:
                values[name] = float(rng.choice(SPECIAL_ANGLES))
        for name in others:
            if rng.random() < 0.2:
                values[name] = float(rng.choice(SPECIAL_LENGTHS))
        yield values
    for one, other in itertools.permutations(angles, 2):
        for x in (found.defaults[one], np.pi / 2, np.pi / 4):
            for y in (x, np.pi - x, -x, np.pi + x, 2 * np.pi - x):
                yield {**found.defaults, one: x, other: y}
    for one, other in itertools.permutations(others, 2):
        for x in (found.defaults[one], 0.0, -1.0):
            yield {**found.defaults, one: x, other: x}


@pytest.mark.parametrize("name", one_in(4, catalogue()))
def test_special_parameters_make_a_loop_or_are_refused(name):
    found, rng = entry(name), np.random.default_rng(0)
    members = list(special_members(found, rng, 300))
    built = [built_or_refused(found, values) for values in members]
    assert any(built)


def test_equal_twists_of_a_syncopated_goldberg_linkage_are_refused_by_name():
    alpha, beta, gamma = np.radians([30.0, 45.0, 45.0])
    with pytest.raises(GeometryError, match=r"twist of a link: 0\.785398 rad"):
        syncopated_goldberg(1.0, float(alpha), float(beta), float(gamma))


def test_equal_twists_of_a_yu_baker_linkage_are_refused_by_name():
    twists = [float(x) for x in np.radians([35.0, 62.0, 50.0, 50.0])]
    with pytest.raises(GeometryError, match="different from"):
        yu_baker(1.0, *twists)


def test_a_wohlhart_linkage_with_supplementary_twists_has_its_four_forms():
    """alpha + gamma = pi, where the slope of Forms III and IV is 0/0."""
    twists = [float(x) for x in np.radians([135.0, 90.0, 45.0, 60.0])]
    found = entry("wohlhart-double-goldberg")
    names = ("alpha", "beta", "gamma", "delta")
    parameters = {**found.defaults, **dict(zip(names, twists, strict=True))}
    assert built_or_refused(found, parameters)
    assert len(found.patterns(**parameters)) == 4


@pytest.mark.parametrize(
    "name", ["subtractive-goldberg-5r", "double-subtractive-goldberg"]
)
def test_equal_links_of_a_subtractive_linkage_cancel_and_are_refused(name):
    with pytest.raises(GeometryError, match=r"greater than 0|alpha"):
        entry(name).build(alpha=0.9, gamma=0.9)
