"""Verification: every linkage passes, failures are said, and the command tells them by
its exit code."""

import dataclasses
import json

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.app.reports.verify import (
    ErratumCheck,
    describe_network_verification,
    describe_verification,
    verify,
    verify_network,
)
from linkages.catalogue import catalogue, entry
from linkages.networks.entries import NETWORKS
from linkages.networks.network import Network
from tests.samples import one_in

WITH_CLOSED_FORM = [name for name, found in catalogue().items() if found.closed_forms]
WITHOUT = [name for name in catalogue() if name not in WITH_CLOSED_FORM]


@pytest.mark.parametrize("name", one_in(4, WITH_CLOSED_FORM))
def test_closed_form_is_the_traced_curve_of_random_members(name):
    checked = verify(name, members=4, points=1, seed=1)
    real = [member for member in checked.members if member.real]
    assert checked.failures == ()
    assert real and all(set(member.outcomes) == {"CLOSED"} for member in real)
    assert max(member.certain for member in real) < 1e-10
    assert max(member.closure for member in real) < 1e-12


@pytest.mark.parametrize("name", one_in(4, WITHOUT))
def test_linkage_without_closed_form_moves_as_stated(name):
    assert verify(name, members=1).failures == ()


def test_description_says_what_was_checked():
    text = describe_verification(verify("mixed-double-goldberg-type-i"))
    for word in (
        "condition",
        "proved exactly at 6 points",
        "1 by rank, 1 by tracing",
        "distance",
        "erratum",
    ):
        assert word in text
    assert "FAILED" not in text


def test_misprint_that_does_not_fail_is_a_failure():
    checked = verify("bennett")
    wrong = dataclasses.replace(checked, errata=(ErratumCheck("(1)", 0.0, 0.0),))
    assert wrong.failures == ("erratum (1): not reproduced",)
    assert "FAILED" in describe_verification(wrong)


def test_mobility_other_than_stated_is_a_failure():
    checked = verify("bennett")
    assert dataclasses.replace(checked, expected=2).failures == (
        "member 1: mobility 1, not 2",
    )


def test_command_prints_json_and_nothing_else():
    result = CliRunner().invoke(
        main, ["verify", "goldberg-5r", "--members", "2", "--json"]
    )
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document["closed_forms"][0]["proved"] and len(document["members"]) == 2


def test_command_ends_with_its_own_code_when_something_fails(monkeypatch):
    checked = dataclasses.replace(verify("bennett"), expected=2)
    monkeypatch.setattr("linkages.app.reports.verify.verify", lambda *_: checked)
    result = CliRunner().invoke(main, ["verify", "bennett"])
    assert result.exit_code == ExitCode.DOES_NOT_HOLD


# --- networks -------------------------------------------------------------------------


@pytest.mark.parametrize("name", NETWORKS)
def test_the_closed_form_of_a_network_closes_in_space_with_its_mobility(name):
    checked = verify_network(name, members=3, seed=1)
    assert checked.failures == ()
    for member in checked.members:
        assert not member.refused
        assert (member.mobility, member.by_closed_form) == (3, 3)
        assert member.configurations > 100
        # rounding of some thirty products of matrices
        assert member.closure < 1e-13


def test_a_wrong_closed_form_of_a_network_is_a_failure(monkeypatch):
    factors = Network.factors.func
    off = property(lambda network: factors(network) * (1.0 + 1e-9))
    monkeypatch.setattr(Network, "factors", off)
    checked = verify_network("serial-bennett-network")
    (failure,) = checked.failures
    assert "misses closure" in failure
    assert "FAILED" in describe_network_verification(checked)


def test_another_mobility_of_a_network_is_a_failure():
    checked = dataclasses.replace(verify_network("l-shape-bennett-network"), expected=2)
    assert checked.failures == (
        "member 1: mobility 3 by rank, not 2",
        "member 1: mobility 3 by closed form, not 2",
    )


def test_the_command_takes_a_network():
    arguments = ["verify", "four-bennett-network", "--members", "2"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0
    assert "3 by rank, 3 by closed form" in result.stdout
    document = json.loads(CliRunner().invoke(main, [*arguments, "--json"]).stdout)
    assert document["failures"] == [] and len(document["members"]) == 2


def test_a_network_that_is_asked_for_as_a_loop_is_no_unknown_name():
    with pytest.raises(KeyError) as error:
        entry("four-bennett-network")
    assert "it is a network of several loops" in str(error.value)
    assert "nearest" not in str(error.value)
