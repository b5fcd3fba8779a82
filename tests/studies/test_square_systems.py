"""The published counts of square systems are those that are found."""

import pytest
from click.testing import CliRunner

from studies.square_systems import count, load_systems, main
from tests.samples import one_in

LONG = {"stewgou40", "rps10"}  # minutes


@pytest.mark.parametrize(
    "system",
    one_in(7, (s for s in load_systems() if s.name not in LONG), lambda s: s.name),
)
def test_counts_are_those_that_are_published(system):
    found = count(system)
    assert (found.complex, found.real) == (system.complex, system.real)
    assert found.lost == 0


def test_a_system_that_is_not_there_is_refused():
    result = CliRunner().invoke(main, ["--only", "pumma"])
    assert result.exit_code == 2
    assert "there is no 'pumma'; there is puma" in result.output
