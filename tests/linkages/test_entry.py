"""What an entry states: its conditions hold for its members and tell by how much a
table breaks them; a wrong parameter is an error of usage."""

import numpy as np
import pytest

from bifurc.errors import BifurcError
from linkages.catalogue import catalogue, entry
from linkages.entry import Condition, UnknownParameterError
from linkages.identification.equivalence import as_loop, table
from linkages.identification.identify import identify
from linkages.values import GeometryError


@pytest.mark.parametrize("name", list(catalogue()))
def test_conditions_that_are_equations_hold_for_random_members(name):
    found, rng = entry(name), np.random.default_rng(0)
    members = [found.defaults, *(found.draw(rng) for _ in range(5))]
    for values in members:
        try:
            loop = found.build(**values)
        except GeometryError:
            continue
        for condition in found.conditions:
            residual = condition.residual(table(loop))
            assert residual is None or residual < 1e-12, condition.text


def test_a_third_of_the_conditions_and_more_are_equations_in_the_numbers_of_the_table():
    conditions = [c for found in catalogue().values() for c in found.conditions]
    assert sum(bool(c.equations) for c in conditions) >= len(conditions) // 3


def test_a_condition_that_is_an_equation_fails_for_a_table_of_other_numbers():
    rng = np.random.default_rng(1)
    for found in catalogue().values():
        n = found.build().n
        for condition in found.conditions:
            if condition.equations:
                assert condition.residual(rng.uniform(0.2, 1.5, (3, n))) > 1e-6


def test_a_condition_in_words_has_no_residual():
    condition = Condition("links a, b, a, b, twists likewise")
    assert condition.residual(np.ones((3, 4))) is None
    assert str(condition) == "links a, b, a, b, twists likewise"


def test_an_equation_without_a_value_is_left_out():
    """The ratio sin(twist)/length of a link of no length."""
    values = table(entry("dietmaier").build())
    values[0] = 0
    assert entry("dietmaier").conditions[0].residual(values) is None


def test_a_broken_condition_is_told_with_its_residual():
    values = table(entry("dietmaier").build())
    values[2, 1] *= 1.001  # R2 = R6
    match = identify(
        as_loop(values), entries=[entry("dietmaier")], locking=False
    ).nearest[0]
    sizes = dict(match.conditions)
    assert sizes["R1 = R4 = 0, R2 = R6, R3 = R5"] == pytest.approx(
        3.1e-4 / as_loop(values).characteristic_length
    )
    assert sizes["a23 = a56, alpha23 = alpha56"] < 1e-15


def test_an_unknown_parameter_is_an_error_of_usage_that_names_the_known_ones():
    with pytest.raises(UnknownParameterError, match="alpha, beta") as caught:
        entry("bennett").build(delta=1.0)
    assert caught.value.name == "delta"
    assert caught.value.linkage == "bennett"
    assert caught.value.parameters == ("a", "alpha", "beta")
    assert isinstance(caught.value, BifurcError)
    assert not isinstance(caught.value, GeometryError)
