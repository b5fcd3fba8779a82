"""The command `bifurc route`: several ways, and what they avoid and pass."""

import json

import pytest

from tests.linkages.app.test_files import run

DSG = "special-double-subtractive-goldberg"


def test_routes_are_printed_and_written_as_json():
    plain = run("route", DSG, "Form III", "Form IV", "--best", 2)
    assert plain.exit_code == 0
    assert plain.stdout.startswith("1. Route from Form III")
    first, second = plain.stdout.split("\n2. ")
    assert first.splitlines()[3:6] != second.splitlines()[3:6]
    options = ("--avoid", "B2", "--cost", "travel", "--best", 2, "--json")
    result = run("route", DSG, "Form III", "Form IV", *options)
    routes = json.loads(result.stdout)["routes"]
    assert len(routes) == 2
    for route in routes:
        assert "B2" not in route["bifurcations"]
        assert [leg["at"] for leg in route["legs"]] == [*route["bifurcations"], ""]
        assert route["length"] == pytest.approx(
            sum(leg["length"] for leg in route["legs"])
        )
    travels = [max(route["travel"]) for route in routes]
    assert travels == sorted(travels) or travels[0] == pytest.approx(travels[1])


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (("--avoid", "B9"), 2, "singular point: B1, B2, B3, B4"),
        (("--avoid", "B1", "--through", "B1"), 2, "cannot be avoided and passed"),
        (("--avoid", "B1", "--avoid", "B4"), 4, "that avoids 'B1', 'B4'"),
        (("--cost", "time"), 2, "bifurcations"),
    ],
)
def test_wishes_that_cannot_be_met_are_said_in_one_line(options, code, message):
    result = run("route", DSG, "Form III", "Form IV", *options)
    assert result.exit_code == code
    assert message in result.stderr.splitlines()[-1]
