"""The closure equations of mechanisms whose facts are known."""

import numpy as np
import pytest

from linkages.closure.closure import Closure
from tests.linkages.mechanisms.known_mechanisms import cases, mechanism_of_case


@pytest.mark.parametrize("name", cases())
def test_a_known_mechanism_has_the_counts_of_its_source(name):
    case = cases()[name]
    mechanism = mechanism_of_case(case)
    problem = Closure(mechanism)
    reference = problem.reference[None]
    assert np.abs(problem.residuals(reference)).max() < 1e-15
    rank = np.linalg.matrix_rank(problem.jacobians(reference)[0], 1e-8)
    assert problem.n - rank == case["nullity"]
    assert mechanism.gruebler == case["gruebler"]
    if "loops" in case:
        assert mechanism.independent_loops == case["loops"]
        assert len(mechanism.bodies) == case["bodies"]
