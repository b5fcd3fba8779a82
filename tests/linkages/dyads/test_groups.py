"""Groups larger than a dyad: all complex assemblies, and the real ones among them."""

from itertools import combinations

import numpy as np
import pytest

from bifurc.completeness import Level
from linkages.closure.closure import Closure
from linkages.dyads import generic
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.group import (
    Group,
    Pattern,
    all_assemblies,
    generic_of,
    group_of,
)
from linkages.dyads.slices import built_at_once, for_subject
from linkages.files.bars import read_bars
from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.statements import LinkageClaim
from tests.linkages.modules.common_types import on_sphere
from tests.samples import one_in

# Two triangles joined by three bars, with lengths of bars between points 1 to 6 for
# which all complex assemblies are real.
PRISM = {
    (1, 2): 2.0,
    (1, 3): 2.0,
    (2, 3): 2.0,
    (1, 4): 7 / 4,
    (3, 6): 27 / 10,
    (2, 5): 197 / 100,
    (4, 5): 11 / 5,
    (4, 6): 29 / 10,
    (5, 6): 43 / 20,
}


def pattern_of_bars(bars, is_spherical=False):
    """Points (numbers from 0) joined by bars; the first bar stands."""
    return Pattern(tuple(bars[1:]), 2, is_spherical)


def lengths_of(bars, places):
    return np.array([abs(places[end] - places[start]) for start, end in bars])


def assemblies_of_bars(bars, lengths):
    own = [(0j, complex(length)) for length in lengths[1:]]
    found = all_assemblies(pattern_of_bars(bars), own, [0j, complex(lengths[0])])
    assert not found.singular
    return found.places


def bars_of_prism():
    return [(start - 1, end - 1) for start, end in PRISM]


def test_a_prism_has_24_real_assemblies():
    bars, lengths = bars_of_prism(), np.array(list(PRISM.values()))
    assemblies = assemblies_of_bars(bars, lengths)
    assert len(assemblies) == 24
    for places in assemblies:
        assert np.allclose(lengths_of(bars, places), lengths, atol=1e-13)
    gaps = np.abs(assemblies[:, None] - assemblies[None]).max(axis=2)
    assert np.min(gaps[~np.eye(24, dtype=bool)]) > 1e-3
    # with each its mirror image
    mirrored = np.abs(assemblies[:, None] - assemblies.conj()[None]).max(axis=2)
    assert np.all(mirrored.min(axis=1) < 1e-12)


K33 = [(i, j) for i in (0, 2, 4) for j in (1, 3, 5)]
TRIAD = ((3, 4, 5), (0, 3), (1, 4), (2, 5))
SEVEN_BAR = ((0, 4), (1, 5), (4, 5, 6), (2, 7), (6, 7, 8), (3, 8))
# Numbers of complex assemblies: of Baranov trusses (Rojas and Thomas 2011), of the
# seven-bar with a quaternary link that stands (Innocenti 1995), and on a sphere, with
# reflections (Gallet, Grasegger, Legersky and Schicho 2021; the triad: Gosselin,
# Sefrioui and Richard 1994)
KNOWN = {
    # a ternary link on three bars, the group of the third class, 3-RPR
    "triad": (Pattern(TRIAD, 3), 6),
    "K(3,3)": (pattern_of_bars(K33), 16),
    "prism": (pattern_of_bars(bars_of_prism()), 24),
    "seven-bar": (Pattern(SEVEN_BAR, 4), 18),
    "triad on a sphere": (Pattern(TRIAD, 3, is_spherical=True), 8),
    "K(3,3) on a sphere": (pattern_of_bars(K33, is_spherical=True), 16),
    "prism on a sphere": (pattern_of_bars(bars_of_prism(), is_spherical=True), 32),
}


@pytest.mark.parametrize("name", KNOWN)
def test_the_count_of_complex_assemblies_is_that_of_the_literature(name):
    pattern, count = KNOWN[name]
    assert pattern.is_square
    found = generic_of(pattern)
    assert found.are_all
    assert found.count == count


def renumbered(pattern, rng):
    """The pattern with its pins and bodies in another order, and the new number of every
    pin."""
    standing = rng.permutation(pattern.standing)
    others = pattern.standing + rng.permutation(pattern.pins - pattern.standing)
    number = np.concatenate([standing, others])
    order = rng.permutation(len(pattern.bodies))
    bodies = [number[rng.permutation(pattern.bodies[k])].tolist() for k in order]
    return pattern._replace(bodies=tuple(map(tuple, bodies))), number


@pytest.mark.parametrize("name", KNOWN)
def test_the_numbers_of_pins_make_no_other_type(name):
    rng = np.random.default_rng(28)
    pattern, _ = KNOWN[name]
    assert {group_of(renumbered(pattern, rng)[0]) for _ in range(20)} == {
        group_of(pattern)
    }


@pytest.mark.parametrize("name", ["triad", "seven-bar", "prism on a sphere"])
def test_assemblies_do_not_depend_on_the_numbers_of_pins(name):
    rng = np.random.default_rng(28)
    pattern, _ = KNOWN[name]
    places = rng.normal(size=(pattern.pins, 2)) @ [1.0, 1j]
    known = all_assemblies(
        pattern,
        [places[list(pins)] for pins in pattern.bodies],
        places[: pattern.standing],
    ).places
    other, number = renumbered(pattern, rng)
    there = places[np.argsort(number)]
    again = all_assemblies(
        other, [there[list(pins)] for pins in other.bodies], there[: pattern.standing]
    ).places[:, number]
    gaps = np.abs(known[:, None] - again[None]).max(axis=2)
    assert len(known) == len(again) > 0
    assert np.all(gaps.min(axis=1) < 1e-9)


@pytest.mark.parametrize("seed", one_in(5, range(10)))
def test_the_assemblies_are_the_same_from_whatever_generic_member(seed, monkeypatch):
    bars = bars_of_prism()
    lengths = lengths_of(bars, np.exp(1j * np.arange(6) ** 2) + 0.1 * np.arange(6))
    known = assemblies_of_bars(bars, lengths)

    monkeypatch.setattr(generic, "SEED", 1000 + 10 * seed)
    another = generic.find_generic(group_of(pattern_of_bars(bars)), 24)
    monkeypatch.setattr(Group, "generic", another)
    again = assemblies_of_bars(bars, lengths)
    assert len(known) == len(again) > 0
    assert len(known) % 2 == 0
    gaps = np.abs(known[:, None] - again[None]).max(axis=2)
    assert np.all(gaps.min(axis=1) < 1e-11)


def test_assemblies_that_move_are_not_said_to_be_all():
    # opposite sides of three parallelograms
    bars = bars_of_prism()
    places = np.array([0, 1, 0.3 + 0.8j, 0.5 - 1j, 1.5 - 1j, 0.8 - 0.2j])
    own = [(0j, complex(length)) for length in lengths_of(bars, places)[1:]]
    found = all_assemblies(pattern_of_bars(bars), own, [0j, 1.0 + 0j])
    assert found.singular == 8
    assert len(found.places) == 16  # as 1500 random starts of Newton's method


# Directions of bodies in the fourth of the six assemblies of full rank of Innocenti's
# seven-bar with the lengths of Roberts' cognates, four of which are complex (Sommese,
# Verschelde and Wampler 2001; the tutorial `sevenbartut` of PHCpack)
ROBERTS = [
    -5.49340801920855e-01 - 8.35598398361888e-01j,
    -9.74098087752273e-01 + 2.26125884049935e-01j,
    1.78912046655936e-01 - 9.83865071827120e-01j,
    4.72153176961024e-02 - 9.98884734979395e-01j,
]
ROBERTS_JOINTS = {
    "O": ("frame", "crank"),
    "P": ("frame", "rocker", "lever"),
    "Q": ("frame", "arm"),
    "A": ("crank", "plate"),
    "B": ("rocker", "plate"),
    "C": ("plate", "wing"),
    "D": ("lever", "wing"),
    "E": ("arm", "wing"),
}


def roberts_seven_bar():
    plate, rocker, lever, wing = ROBERTS
    ratio = (-0.11 + 0.49j) / 0.46
    o, p = 0.0, 1.2 / ratio
    b, d = p + 0.41 * rocker, p + abs(-0.11 + 0.49j) * lever
    places = {
        "O": o,
        "P": p,
        "Q": p + 1.2,
        "A": b - 0.46 * plate,
        "B": b,
        "C": b + (-0.11 + 0.49j) * plate,
        "D": d,
        "E": d + 0.41 * ratio * wing,
    }
    return Mechanism(
        tuple(
            Joint(
                name,
                JointKind.REVOLUTE,
                bodies,
                (places[name].real, places[name].imag, 0.0),
                (0.0, 0.0, 1.0),
            )
            for name, bodies in ROBERTS_JOINTS.items()
        )
    )


def test_assemblies_of_full_rank_are_all_there_beside_a_motion():
    """The cubic curve of the literature is one closed form, and two of the six other
    solutions are real."""
    atlas = map_linkage(roberts_seven_bar())
    assert [form.branch.closed for form in atlas.forms] == [True]
    assert len(atlas.rigid) == 2
    (claim,) = (
        one
        for one in atlas.completeness.claims
        if LinkageClaim.REGULAR_OF_GROUPS.is_kind_of(one)
    )
    assert claim.data["complex"] - claim.data["singular"] == 6
    assert atlas.completeness.level is Level.CERTIFIED


def test_what_moves_beside_a_bar_too_many_is_not_followed():
    """A prism with a further bar, and a chain of three bars across it."""
    bars = [*bars_of_prism(), (0, 4), (0, 6), (6, 7), (7, 2)]
    assert pattern_of_bars(bars).is_square
    places = np.exp(1j * np.arange(8) ** 2)
    with pytest.raises(UnfollowedError, match="it moves"):
        assemblies_of_bars(bars, lengths_of(bars, places))


# frameworks in which all paths run away from the assemblies until as little is left as
# the square of the short bar
WITH_A_SHORT_BAR = {
    "between free points": (77, (2, 3)),
    "that stands": (227, (0, 2)),
}


@pytest.mark.parametrize("short", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("name", WITH_A_SHORT_BAR)
def test_a_short_bar_hides_no_assembly(name, short):
    seed, (start, end) = WITH_A_SHORT_BAR[name]
    bars, places = random_framework(np.random.default_rng(seed), 7)
    places[end] = places[start] + short
    swapped = np.arange(7)
    swapped[[1, 2]] = 2, 1
    if bars[0] == (0, 2):
        bars = [tuple(swapped[list(bar)].tolist()) for bar in bars]
        places = places[swapped]
    lengths = lengths_of(bars, places)
    try:
        known = assemblies_of_bars(bars, lengths)
    except UnfollowedError:
        assert short < 1e-4
        return
    there = (places - places[0]) * lengths[0] / (places[1] - places[0])
    assert np.abs(known - there).max(axis=1).min() < 1e-9
    assert len(known) % 2 == 0


# --- mechanisms -----------------------------------------------------------------------


def framework(bars, points):
    """Points and bars as a file; the first bar stands."""
    return read_bars(
        {
            "fixed": [str(point) for point in bars[0]],
            "bars": [list(map(str, bar)) for bar in bars[1:]],
            "points": {str(k): [p.real, p.imag] for k, p in enumerate(points)},
        },
        "framework",
    )


def random_framework(rng, points):
    """A random minimally rigid graph by Henneberg's two steps, and places of its
    points."""
    bars = {(0, 1)}
    for new in range(2, points):
        ends = [int(end) for end in rng.choice(new, 2, replace=False)]
        split = sorted(bars)[rng.integers(len(bars))]
        others = [point for point in range(new) if point not in split]
        if others and rng.random() < 0.7:
            bars.discard(split)
            ends = [*split, others[rng.integers(len(others))]]
        bars |= {(end, new) for end in ends}
    places = rng.normal(size=points) + 1j * rng.normal(size=points)
    return sorted(bars), places


def built(mechanism):
    closure = Closure(mechanism)
    given = closure, closure.structure, np.random.default_rng(0), 0
    return built_at_once(*given) or for_subject(*given)


def test_the_answer_says_how_many_of_the_complex_assemblies_are_real():
    bars = bars_of_prism()
    lengths = list(PRISM.values())
    places = assemblies_of_bars(bars, np.array(lengths))[0]
    atlas = map_linkage(framework(bars, places))
    assert atlas.completeness.level is Level.CERTIFIED
    assert len(atlas.rigid) == 24
    text = atlas.completeness.statement
    assert "24 of 24 complex assemblies are real, and all 24 were followed" in text


@pytest.mark.parametrize("seed", one_in(50, range(500)))
def test_counts_of_random_frameworks_are_the_combinatorial_ones(seed):
    """By Capco, Gallet, Grasegger, Koutschan, Lubbes and Schicho (2018)."""
    lnumber = pytest.importorskip("lnumber")
    rng = np.random.default_rng(seed)
    points = 6 + seed % 5
    bars, places = random_framework(rng, points)
    slices = built(framework(bars, places))
    bits = [int(pair in bars) for pair in combinations(range(points), 2)]
    number = lnumber.lnumber(int("".join(map(str, bits)), 2))
    assert len(slices.starts) % 2 == 0
    if slices.counts:  # dyads alone do else
        assert slices.counts == (number,)


# --- on a sphere ----------------------------------------------------------------------


@pytest.mark.parametrize("seed", one_in(8, range(60)))
def test_a_framework_on_a_sphere_has_all_its_assemblies(seed):
    rng = np.random.default_rng(seed)
    bars, _ = random_framework(rng, 5 + seed % 3)
    mechanism = on_sphere(rng.normal(size=(5 + seed % 3, 3)), bars)
    slices = built(mechanism)
    known = slices.starts
    assert len(known) % 2 == 0
    closure = Closure(mechanism)
    assert np.abs(closure.residuals(known)).max() < 1e-9
    starts = rng.uniform(-np.pi, np.pi, size=(500, closure.n))
    points, gaps = closure.project(starts)
    points = points[gaps < 1e-10]
    turns = np.exp(1j * points[:, None]) - np.exp(1j * known[None])
    assert np.all(np.abs(turns).max(axis=2).min(axis=1, initial=np.inf) < 1e-6)
