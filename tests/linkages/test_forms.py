"""Forms are recognised, labelled and named."""

import numpy as np
import pytest

from linkages.catalogue import entry
from linkages.forms import identify_form, name_forms
from linkages.labelling import nearly_symmetric
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.values import GeometryError


def _loop_and_patterns(case):
    linkage = entry(case["linkage"])
    values = linkage.complete(case["parameters"])
    patterns = linkage.patterns(**values) if linkage.patterns else ()
    return linkage.build(**values), patterns


def _case(reference_cases, linkage, parameters=0):
    for case in reference_cases:
        if case["linkage"] == linkage and len(case["parameters"]) == parameters:
            return case
    raise LookupError(linkage)


@pytest.fixture(scope="module")
def traced(reference_cases, trace_form):
    """(case, loop, patterns, samples of every form) of all reference cases."""
    out = []
    for case in reference_cases:
        loop, patterns = _loop_and_patterns(case)
        forms = [trace_form(loop, form["theta"]) for form in case["forms"]]
        out.append((case, loop, patterns, forms))
    return out


def test_every_form_of_the_reference_cases_is_given_its_name(traced, closure_gap):
    for case, loop, patterns, forms in traced:
        assert max(closure_gap(loop, samples) for samples in forms) < 1e-12
        names = [identity.name for identity in name_forms(forms, loop, patterns)]
        assert names == [form["name"] for form in case["forms"]], case["linkage"]


def test_names_do_not_depend_on_start_direction_wrapping_or_order(traced):
    rng = np.random.default_rng(3)
    for case, loop, patterns, forms in traced:
        changed = []
        for samples in forms:
            start = rng.integers(len(samples))
            direction = rng.choice([-1, 1])
            turned = np.roll(samples[:-1], start, axis=0)[::direction]
            changed.append(np.arctan2(np.sin(turned), np.cos(turned)))
        identities = name_forms(changed[::-1], loop, patterns)
        names = [identity.name for identity in identities]
        assert names == [form["name"] for form in case["forms"]][::-1], case["linkage"]


def test_inactive_joints_come_with_their_angles(traced):
    for case, loop, patterns, forms in traced:
        linkage = case["linkage"]
        for form, samples in zip(case["forms"], forms, strict=True):
            name = form["name"]
            labels = identify_form(samples, loop, patterns).labels
            joints, angles = labels.inactive_joints, labels.inactive_angles
            if linkage == "special-double-subtractive-goldberg" and "Bennett" in name:
                assert joints == (3, 6)
                assert angles == pytest.approx((np.pi, np.pi), abs=1e-9)
            if linkage.startswith("reconfigurable") and "Bennett" in name:
                assert joints == (2, 5)
                assert angles == pytest.approx(np.radians([-70, -70]), abs=1e-9)
            if "6R" in name or "original" in name:
                assert joints == ()


def test_symmetries_are_recognised(traced):
    expected = {
        "Form I (original)": "theta_i = theta_{i+3}",
        "Form I' (revised)": "theta_i = -theta_{i+3}",
        "threefold form": "theta_i = theta_{i+2}",
        "antiparallelogram form": "theta_i = -theta_{i+2}",
        "Form III (non-constructive 6R)": "",
    }
    seen = set()
    for case, loop, _, forms in traced:
        for form, samples in zip(case["forms"], forms, strict=True):
            if form["name"] in expected:
                seen.add(form["name"])
                labels = identify_form(samples, loop).labels
                assert labels.symmetry == expected[form["name"]]
    assert seen == set(expected)


def test_a_bennett_form_is_found_without_the_patterns_of_the_entry(traced):
    names = set()
    for case, loop, _, forms in traced:
        for form, samples in zip(case["forms"], forms, strict=True):
            if "Bennett 4R" in form["name"]:
                names.add(identify_form(samples, loop).name)
    assert names == {
        "Bennett 4R form (joints 3,6 inactive) asymmetric",
        "Bennett 4R form (joints 2,5 inactive) asymmetric",
        "Bennett 4R form (joints 2,5 inactive) line-symmetric",
    }


def test_relabelled_joints_move_the_inactive_ones(reference_cases, trace_form):
    case = _case(reference_cases, "special-double-subtractive-goldberg")
    loop, _ = _loop_and_patterns(case)
    form = next(f for f in case["forms"] if "Bennett" in f["name"])
    samples = np.roll(trace_form(loop, form["theta"]), -1, axis=1)
    assert identify_form(samples, loop.relabelled(1)).labels.inactive_joints == (2, 5)


def test_forms_of_one_pattern_are_lettered_and_unknown_ones_numbered(
    reference_cases, trace_form
):
    case = _case(reference_cases, "wohlhart-symmetric", 1)
    loop, patterns = _loop_and_patterns(case)
    forms = [trace_form(loop, form["theta"]) for form in case["forms"]]
    by_pattern = {identity.name for identity in name_forms(forms, loop, patterns)}
    assert by_pattern == {"threefold form a", "threefold form b"}
    by_number = {identity.name for identity in name_forms(forms, loop)}
    assert by_number == {"Form 1", "Form 2"}


def test_a_relabelled_parallelogram_keeps_its_names(reference_cases, trace_form):
    case = _case(reference_cases, "kite")
    loop, _ = _loop_and_patterns(case)
    turned = loop.relabelled(1)
    traced_forms = [trace_form(loop, form["theta"]) for form in case["forms"]]
    forms = [np.roll(samples, -1, axis=1) for samples in traced_forms]
    names = [identity.name for identity in name_forms(forms, turned)]
    assert names == ["folded form (joints 2,4 inactive)", "kite form"]


def test_a_single_configuration_is_a_rigid_assembly(reference_cases):
    case = _case(reference_cases, "bricard-line-symmetric")
    loop, _ = _loop_and_patterns(case)
    identity = identify_form(np.array([case["forms"][0]["theta"]]), loop)
    assert identity.name == "rigid assembly"


def test_samples_of_another_number_of_joints_are_refused(reference_cases):
    loop, _ = _loop_and_patterns(_case(reference_cases, "bricard-line-symmetric"))
    with pytest.raises(GeometryError, match="shape of the samples"):
        identify_form(np.zeros((3, 5)), loop)


def form_beside(first: float, second: float) -> np.ndarray:
    """Samples (m, 4) of a closed form on which the cosine of joint 1 stays what it is,
    and that of joint 2 has about a given mean."""
    around = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
    angles = np.arccos([first, second, 0.1, 0.2])
    turning = 0.1 * np.sin(around[:, None] + np.arange(4))
    turning[:, 0] = 0.0
    return angles + turning


@pytest.mark.parametrize("error", [1e-12, -1e-12])
def test_the_order_of_forms_does_not_hang_on_the_last_bits(error):
    # the cosines lie on the two sides of where four decimals are rounded up
    low, high = form_beside(0.30005 + error, 0.2), form_beside(0.30005 - error, 0.4)
    identities = name_forms([low, high], entry("bennett").build())
    letters = [identity.name.split(" (")[0][-1] for identity in identities]
    assert letters == ["b", "a"]


@pytest.mark.parametrize("error", [0.0, 4e-16, -4e-16])
def test_equal_links_are_equal_but_for_rounding(error):
    # both lengths lie where nine decimals would be cut off
    lengths = (1.2499999995, 0.7500000005, 0.7500000005 + error, 1.2499999995 - error)
    zeros = (0.0,) * 4
    atlas = map_linkage(Loop(lengths, zeros, zeros))
    names = {form.name for form in atlas.forms}
    assert names == {"kite form", "folded form (joints 1,3 inactive)"}


def test_what_a_form_misses_of_its_symmetry_is_said_unless_it_is_rounding():
    turn = np.linspace(0.0, 2 * np.pi, 50)
    exact = np.stack([turn, 0.5 * np.sin(turn)] * 2, axis=1)
    loop = entry("bennett").build()
    for missed, by_rounding, said in (
        (0.0, 0.0, 0.0),
        (2e-6, 0.0, 1e-6),
        (2e-6, 1e-5, 0.0),
    ):
        angles = exact + np.array([missed, 0.0, 0.0, 0.0])
        identity = identify_form(angles, loop, by_rounding=by_rounding)
        assert identity.labels.symmetry == "theta_i = theta_{i+2}"
        assert identity.asymmetry == pytest.approx(said, rel=1e-6)


def test_a_linkage_that_nearly_has_a_symmetry_says_so():
    lengths, twists, offsets = entry("bennett").build().arrays
    atlas = map_linkage(load("bennett"))
    loop = Loop(lengths, twists, offsets)
    samples = atlas.forms[0].branch.sample(100) + np.array([1e-6, 0.0, 0.0, 0.0])
    (identity,) = name_forms([samples], loop)
    assert identity.asymmetry == pytest.approx(5e-7, rel=1e-3)
    said = nearly_symmetric([identity])
    assert [one.text for one in said] == [
        "the symmetry of 1 form holds only nearly: sines of half of what the angles miss of "
        "it are up to 5.0e-07"
    ]
