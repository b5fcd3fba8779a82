"""From a loop to its map with named forms."""

import time

import numpy as np
import pytest

from bifurc.limits import Deadline, until
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages import labelling
from linkages.catalogue import UnknownLinkageError, entry
from linkages.entry import UnknownParameterError
from linkages.labels import FormLabels
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.subject import as_subject
from linkages.values import GeometryError
from tests.linkages.mechanisms.known_mechanisms import geared_five_bar


def test_the_forms_of_a_named_linkage_bear_the_names_of_its_source():
    atlas = map_linkage(load("special-double-subtractive-goldberg"))
    bennett = atlas.forms[atlas.form("Form II (Bennett 4R)")]
    labels = FormLabels.of(bennett)
    assert labels.inactive_joints == (3, 6)
    assert np.abs(labels.inactive_angles) == pytest.approx(np.pi)
    names = sorted(form.name.split(" (")[0] for form in atlas.forms)
    assert names == ["Form I", "Form II", "Form III", "Form IV"]


def test_every_form_says_how_well_it_closes_and_the_atlas_what_was_mapped():
    atlas = map_linkage(load("parallelogram", b=3.0))
    assert all(0 < FormLabels.of(f).max_residual < 1e-12 for f in atlas.forms)
    assert atlas.subject == {
        "name": "parallelogram",
        "lengths": [1.0, 3.0, 1.0, 3.0],
        "twists": [0.0] * 4,
        "offsets": [0.0] * 4,
    }


def test_a_loop_without_a_source_is_mapped_too():
    atlas = map_linkage(Loop((1, 2, 1, 2), (0, 0, 0, 0), (0, 0, 0, 0), "mine"), seed=3)
    assert atlas.subject["name"] == "mine"
    assert atlas.provenance.seed == 3
    assert len(atlas.forms) == 2


def test_a_name_or_a_parameter_that_does_not_exist_is_refused():
    with pytest.raises(UnknownLinkageError, match="bennett"):
        map_linkage(load("benet"))
    with pytest.raises(UnknownParameterError, match="one of a, alpha, beta"):
        map_linkage(load("bennett", gamma=1.0))


def test_a_name_in_place_of_a_linkage_is_refused():
    with pytest.raises(GeometryError, match=r"'bennett' .* `linkages\.load`"):
        map_linkage("bennett")


def test_a_map_is_certified_unless_the_settings_say_otherwise():
    loop = entry("bennett").build()
    atlas = map_linkage(loop, settings=SearchSettings(starts=20))
    assert atlas.forms[0].certificate.status == "certified"
    without = map_linkage(loop, settings=SearchSettings(starts=20, certify=False))
    assert without.forms[0].certificate is None


def test_a_form_is_no_near_motion():
    # two stiff assemblies, from which a step aside leads to the form
    parameters = {"a": 1.5, "c": 2.3, "shift": -0.9}
    angles = {
        "alpha": 100,
        "beta": 25,
        "gamma": 70,
        "delta": 80,
        "kink_1": -105,
        "kink_2": 110,
    }
    radians = {name: np.radians(angle) for name, angle in angles.items()}
    for seed in range(2):
        atlas = map_linkage(load("waldron-hybrid", **parameters, **radians), seed=seed)
        assert (len(atlas.forms), len(atlas.rigid)) == (1, 2)
        assert not atlas.near_motions
        distances, _ = atlas.forms[0].branch.nearest(atlas.rigid)
        assert distances.min() > 1e-3


def test_near_motions_do_not_depend_on_the_seed():
    exact = entry("special-wohlhart-double-goldberg").build()
    twists = (exact.twists[0] + 2e-5, *exact.twists[1:])
    loop = Loop(exact.lengths, twists, exact.offsets)
    maps = [map_linkage(loop, seed=seed) for seed in (0, 3)]
    for atlas in maps:
        assert [near.is_closed for near in atlas.near_motions] == [True, True]
        for near, same in zip(atlas.near_motions, maps[0].near_motions, strict=True):
            assert near.length == pytest.approx(same.length, rel=1e-9)
            assert near.misclosure == pytest.approx(same.misclosure, rel=1e-7)
            assert near.sample == pytest.approx(same.sample, abs=1e-6)


@pytest.mark.parametrize("error", [1e-3, 1e-6])
def test_a_loop_beside_one_of_mobility_two_nearly_moves_over_a_surface(error):
    twists = (error, 0.0, 0.0, 0.0, 0.0)
    atlas = map_linkage(Loop((1.0, 1.3, 0.9, 1.1, 1.2), twists, (0.0,) * 5))
    (near,) = atlas.near_motions
    assert near.mobility == 2
    assert near.misclosure == pytest.approx(error, rel=1e-5)


def test_where_a_loop_nearly_moves_more_assemblies_are_not_ruled_out():
    twists = np.radians([100, 40, 100, 40])
    atlas = map_linkage(Loop((1.0, 0.65, 1.0, 0.65), tuple(twists), (0.0,) * 4))
    assert len(atlas.near_motions) == 1
    assert atlas.completeness.level == "estimated"
    assert "there may be more isolated solutions" in atlas.completeness.statement


@pytest.mark.parametrize("size", [1e308, 1e150, 1e-150, 1e-320])
def test_lengths_whose_squares_are_no_doubles_are_refused(size):
    loop = Loop((size,) * 4, (0.0,) * 4, (0.0,) * 4)
    with pytest.raises(GeometryError, match="choose another unit"):
        map_linkage(loop)


QUICK = SearchSettings(starts=20, certify=False)


@pytest.mark.parametrize(
    ("linkage", "slow"),
    [(load("bennett"), "name_forms"), (geared_five_bar(), "largest_residual")],
    ids=["loop", "mechanism"],
)
def test_where_there_is_no_time_for_names_forms_have_numbers(
    linkage, slow, monkeypatch
):
    def last(*args: object) -> None:
        while True:
            time.sleep(0.01)

    subject = as_subject(linkage)
    found = explore(subject.traced, settings=QUICK)
    named = subject.labelled(found)
    monkeypatch.setattr(labelling, slow, last)
    with until(Deadline(0.1)):
        atlas = subject.labelled(found)
    assert atlas.subject.keys() <= named.subject.keys()
    assert [form.name for form in atlas.forms] == [form.name for form in found.forms]
    said = [one.text for one in atlas.completeness.claims]
    (unnamed,) = (one for one in said if "before forms were named" in one)
    assert unnamed not in [one.text for one in named.completeness.claims]


def test_the_search_of_a_map_has_what_is_left_of_a_budget_around_it():
    with until(Deadline(0.0)):
        atlas = map_linkage(load("bennett"))
    assert atlas.provenance.out_of_time
