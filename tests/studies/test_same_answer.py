"""The same document of a map from every seed, with other kernels and through noise."""

import copy
import json

import pytest

from studies.document_differences import differences
from studies.same_answer import Batch, compare, describe
from studies.same_answer_maps import map_document, noisy_document

# mirror images, symmetric forms, rank drops, rigid assemblies, dead points by the dozen
SAMPLE = [
    "parallelogram",
    "spherical-four-bar",
    "special-double-subtractive-goldberg",
    "bricard-line-symmetric-zero-offset",
    "bricard-octahedral-plane-symmetric",
    "yu-baker-two-ratios",
]


@pytest.fixture(scope="module")
def document():
    return map_document("yu-baker", 0)


@pytest.mark.parametrize("name", SAMPLE)
def test_documents_agree_from_other_seeds_and_through_noise(name):
    reference = map_document(name, 0)
    for other in (map_document(name, 3), noisy_document(name, 5)):
        assert differences(reference, other) == []


# At its rank drops two nearly parallel equations have a root in common, where the
# rounding of one is thirty times that of the other.
def test_a_rank_drop_with_nearly_parallel_equations_stays_one_through_noise(document):
    for draw in range(8):
        assert differences(document, noisy_document("yu-baker", draw)) == []


def test_a_document_survives_json(document):
    assert differences(document, json.loads(json.dumps(document))) == []


@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("forms", lambda forms: forms[0].update(length=forms[0]["length"] + 1e-6)),
        ("forms", lambda forms: forms[0].update(name="Form 7")),
        ("forms", lambda forms: forms[0]["winding"].__setitem__(0, 5)),
        ("rank_drops", lambda drops: drops.pop()),
        ("rank_drops", lambda drops: drops[0]["theta"].__setitem__(0, 1e-4)),
        ("near_misses", lambda misses: misses[0].update(singular_value=0.0195)),
        ("rigid_assemblies", lambda rigid: rigid[0].__setitem__(0, 0.5)),
        ("forms", lambda forms: forms.pop()),
        ("completeness", lambda level: level.update(certainty="certified")),
    ],
)
def test_every_difference_is_seen(document, key, change):
    other = copy.deepcopy(document)
    change(other[key])
    lines = differences(document, other)
    assert len(lines) == 1
    assert lines[0].startswith(key)


def test_what_belongs_to_the_run_is_no_difference(document):
    other = copy.deepcopy(document)
    other.update(seconds=1.0, seed=7)
    other["completeness"]["missed_probability"] = 0.5
    other["rigid_assemblies"][0][0] += 6.283185307179586
    assert differences(document, other) == []


def test_another_processor_gives_the_same_document(tmp_path):
    reference = tmp_path / "reference.json"
    documents = {"bennett": map_document("bennett", 0)}
    reference.write_text(json.dumps(documents), encoding="utf-8")
    batch = Batch("Nehalem", seeds=1, draws=1)
    comparisons = list(compare(reference, ["bennett"], batch))
    assert [comparison.lines for comparison in comparisons] == [[], []]
    assert "rounding noise, 1 draws" in describe([(batch, comparisons)])


def test_a_form_that_one_march_leaves_with_a_kink_is_certified_all_the_same():
    """With this noise the march comes to a stop next to a rank drop."""
    name = "double-subtractive-goldberg-type-iv"
    assert differences(map_document(name, 0), noisy_document(name, 1)) == []
