"""Networks of four equal Bennett loops: the map against the closed form."""

import numpy as np
import pytest
from click.testing import CliRunner

from studies.special_bennett_networks import main, map_network, mapped, predicted

TWISTS = np.radians(35.0), np.radians(81.0)


@pytest.mark.parametrize(
    ("kinks", "counts"), [((40, -40), (2, 2, 0)), ((40, 40), (1, 0, 0))]
)
def test_the_map_has_what_the_closed_form_has(kinks, counts):
    first, second = np.radians(kinks)
    assert predicted(*TWISTS, (first, second)) == counts
    assert mapped(map_network(*TWISTS, (first, second), np.inf)) == counts


def test_forms_meet_under_opposite_kinks_alone():
    kinks = np.radians(np.arange(-170, 180, 20))
    meeting = {
        (first, second)
        for first in kinks
        for second in kinks
        if predicted(*TWISTS, (first, second)).bifurcations
    }
    assert meeting == {(kink, -kink) for kink in kinks}


def test_folded_networks_have_a_surface():
    assert predicted(*TWISTS, (np.pi, np.pi)) == (0, 0, 1)


def test_kinks_that_leave_no_configuration_are_a_row():
    run = CliRunner().invoke(main, ["180/40"])
    assert run.exit_code == 0
    assert "cannot be assembled" in run.output
    assert "0 forms, 0 bifurcations" in run.output


def test_what_are_no_kinks_is_one_line():
    run = CliRunner().invoke(main, ["40"])
    assert run.exit_code == 2
    assert run.output.splitlines()[-1] == (
        "Error: Invalid value: '40' is not allowed; write two kinks as 40/-40"
    )
