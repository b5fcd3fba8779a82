"""Forms beside free slides, and forms that have nothing to do with each other."""

import itertools

import pytest

from bifurc.settings import SearchSettings
from linkages.app.answer.document import make_document
from linkages.app.answer.verdict import judge
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from tests.maps import map_of

Z = (0, 0, 1)
FOUR_BAR = ((0, 0, 0), (0.5, 1.0, 0), (2, 1.4, 0), (2.2, 0, 0))
PARALLELOGRAM = ((0, 0, 0), (0, 1, 0), (2, 1, 0), (2, 0, 0))
SETTINGS = SearchSettings(starts=60, charts=100)


def revolutes(places, prefix, bodies):
    pairs = list(itertools.pairwise(bodies))
    return [
        Joint(f"{prefix}{k}", "revolute", pairs[k], place, Z)
        for k, place in enumerate(places)
    ]


def beside_a_slide(places):
    """A loop of parallel axes, the last of which also slides, as does another joint."""
    bodies = ("frame", "crank", "rod", "rocker")
    joints = revolutes(places[:3], "R", bodies)
    joints.append(Joint("C", "cylindrical", ("rocker", "nut"), places[3], Z))
    joints.append(Joint("S", "prismatic", ("nut", "frame"), None, Z))
    return Mechanism(tuple(joints))


def two_on_one_frame(one, other):
    joints = revolutes(one, "A", ("frame", "a1", "a2", "a3", "frame"))
    joints += revolutes(other, "B", ("frame", "b1", "b2", "b3", "frame"))
    return Mechanism(tuple(joints))


@pytest.mark.parametrize(("places", "forms"), [(FOUR_BAR, 1), (PARALLELOGRAM, 2)])
@pytest.mark.parametrize("seed", range(2))
def test_a_form_beside_a_free_slide_is_a_product(places, forms, seed):
    atlas = map_of(beside_a_slide(places), settings=SETTINGS, seed=seed)
    assert len(atlas.surfaces) == forms
    for surface in atlas.surfaces:
        form, slide = sorted(surface.factors, key=lambda factor: not factor.is_closed)
        assert form.is_closed
        assert [atlas.names[k] for k in slide.unknowns] == ["C.slide", "S"]
    sentence = judge(atlas).sentence
    assert "the product of 1 closed curve and 1 open curve" in sentence
    assert "Charts ran out" not in sentence


@pytest.mark.parametrize("seed", range(2))
def test_forms_of_loops_that_share_a_body_multiply(seed):
    mechanism = two_on_one_frame(FOUR_BAR, PARALLELOGRAM)
    atlas = map_of(mechanism, settings=SETTINGS, seed=seed)
    assert len(atlas.surfaces) == 2
    sentence = judge(atlas).sentence
    assert "mobility 2 in 2 components, each the product of 2 closed curves" in sentence


def test_a_loop_of_cylindrical_joints_is_a_form_and_what_slides():
    bodies = ("frame", "crank", "rod", "rocker", "frame")
    joints = [
        Joint(f"C{k}", "cylindrical", bodies[k : k + 2], place, Z)
        for k, place in enumerate(FOUR_BAR)
    ]
    atlas = map_of(Mechanism(tuple(joints)), settings=SETTINGS)
    (component,) = atlas.surfaces
    assert component.dimension == 4
    assert sorted(factor.dimension for factor in component.factors) == [1, 3]
    (form,) = [one for one in make_document(atlas)["forms"] if one["dimension"] == 4]
    unknowns = {len(factor["unknowns"]) for factor in form["factors"]}
    assert unknowns == {4}
