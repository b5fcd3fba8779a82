"""Equal parallel legs between congruent plates: every translation that keeps a leg's
length closes, and F' has a lower rank at all of them."""

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.app.answer.document import make_document
from linkages.app.texts.summary import make_summary
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from tests.samples import one_in

ANGLES = np.radians([0.0, 20.0, 120.0, 140.0, 240.0, 260.0])


def platform():
    """Six legs of height 1 on a circle of radius 1, none of which changes its length."""
    joints = []
    for k, angle in enumerate(ANGLES):
        foot = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
        head = (foot[0], foot[1], 1.0)
        joints.append(Joint(f"B{k}", "spherical", ("base", f"leg{k}"), foot))
        joints.append(Joint(f"P{k}", "spherical", (f"leg{k}", "plate"), head))
    return Mechanism(tuple(joints))


@pytest.mark.parametrize("seed", one_in(2, range(2)))
def test_the_translations_are_a_surface_and_the_twist_is_a_form(seed):
    settings = SearchSettings(starts=60, certify=False)
    atlas = linkages.map_linkage(platform(), settings=settings, seed=seed)
    (surface,) = atlas.surfaces
    assert surface.dimension == 2
    assert surface.complete
    (form,) = atlas.forms
    assert form.branch.closed
    assert "misses the equations" not in atlas.completeness.statement
    assert "F' has a lower rank all over it" in surface.note
    # where all legs lie in the planes of the plates, the rank is lower once more
    assert "singular points of rank 5 form 1 closed curve" in surface.note
    assert not atlas.points
    document = make_document(atlas)
    assert document["forms"][-1]["note"] == surface.note
    assert not document["other_singular_points"]
    assert surface.note in make_summary(atlas)
