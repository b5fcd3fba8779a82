"""Lattices of Bennett linkages: their closed form, and their one freedom."""

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from linkages.arrays.bennett_lattice import STATE, lattice, lattice_kinks
from linkages.closure.closure import Closure
from linkages.networks.assembly import assemble, motion_at
from linkages.networks.placement import PlacedNetwork


def placed(columns, rows, kinks):
    network = lattice(columns, rows)
    states = assemble(network, kinks)
    return PlacedNetwork(network, states[STATE], kinks), states


@pytest.mark.parametrize("shape", [(2, 2), (3, 2), (3, 4)])
def test_a_lattice_has_a_freedom_less_than_columns_and_rows(shape):
    network = lattice(*shape)
    kinks = lattice_kinks(*shape)
    states = assemble(network, kinks)
    for total in network.closures:
        assert np.abs(np.sin(network.sums(total, states) / 2)).max() < 1e-12
    assert motion_at(network, (), states[STATE]).mobility == sum(shape) - 1
    assert motion_at(network, tuple(kinks), states[STATE]).mobility == 1


def test_the_equations_hold_at_every_state_of_the_closed_form():
    network, states = placed(4, 3, lattice_kinks(4, 3))
    problem = Closure(network.mechanism)
    free = list(problem.structure.column_of)
    points = network.variables(states)[:, free]
    assert np.abs(problem.residuals(points)).max() < 1e-13
    jacobian = problem.jacobians(problem.reference[None])[0]
    sigma = np.linalg.svd(jacobian, compute_uv=False)
    assert sigma[-1] < 1e-13 < 1e-3 < sigma[-2]


def test_the_form_passes_all_states_of_the_closed_form():
    network, states = placed(4, 3, lattice_kinks(4, 3))
    problem = Closure(network.mechanism)
    branch = trace_branch(problem, problem.reference)
    assert branch.outcome is Outcome.CLOSED
    free = list(problem.structure.column_of)
    for point in network.variables(states)[:, free]:
        distance, _ = branch.nearest(point)
        assert distance < 1e-11
