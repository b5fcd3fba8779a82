"""What an atlas says of a linkage is written and read back by one type."""

import json
import math

import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from linkages.catalogue import entry
from linkages.labels import FormLabels, NoLinkageError, Symmetry, loop_of, subject_of
from tests.maps import map_of


def circle(u):
    return np.array([u[0] ** 2 + u[1] ** 2 - 1.0])


@pytest.fixture(scope="module")
def map_of_a_circle():
    return explore(FunctionProblem(circle, bounds=[(-2, 2), (-2, 2)]))


@pytest.fixture(scope="module")
def parallelogram():
    return map_of("parallelogram")


def with_subject(atlas: Atlas, **changes):
    subject = {**atlas.subject, **changes}
    return type(atlas)(**{**vars(atlas), "subject": subject})


def test_the_loop_of_an_atlas_is_the_one_that_was_mapped(parallelogram):
    assert loop_of(parallelogram) == entry("parallelogram").build()
    assert loop_of(parallelogram).name == "parallelogram"
    subject = subject_of(loop_of(parallelogram))
    assert json.loads(json.dumps(subject)) == parallelogram.subject


def test_an_atlas_of_something_else_is_refused(map_of_a_circle):
    with pytest.raises(NoLinkageError, match="not of a linkage: its subject has no"):
        loop_of(map_of_a_circle)


@pytest.mark.parametrize("lengths", [None, 3.0, [1.0], ["a"] * 4])
def test_an_atlas_of_a_damaged_linkage_is_refused(parallelogram, lengths):
    with pytest.raises(NoLinkageError, match=r"lengths|number of joints"):
        loop_of(with_subject(parallelogram, lengths=lengths))


def test_labels_of_a_form_are_read_as_they_were_written(parallelogram):
    for form in parallelogram.forms:
        labels = FormLabels.of(form)
        assert labels.as_values() == form.labels
        assert labels.symmetry is Symmetry(form.labels["symmetry"])
        assert json.loads(json.dumps(labels.as_values())) == form.labels


def test_a_form_without_labels_says_nothing(map_of_a_circle):
    labels = FormLabels.of(map_of_a_circle.forms[0])
    assert labels.inactive_joints == labels.inactive_angles == ()
    assert labels.symmetry is Symmetry.NONE
    assert math.isnan(labels.max_residual)


@pytest.mark.parametrize("step", range(1, 7))
def test_a_symmetry_is_the_text_of_its_equation(step):
    equal, opposite = Symmetry.of_step(step, 1), Symmetry.of_step(step, -1)
    assert equal == f"theta_i = theta_{{i+{step}}}"
    assert opposite == f"theta_i = -theta_{{i+{step}}}"
