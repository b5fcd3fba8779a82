"""The commands `map` and `route` where surfaces of configurations are on the way."""

from __future__ import annotations

import re

import numpy as np
import pytest
from click.testing import CliRunner

from linkages.app.cli import main

SARRUS = f"""
name = "Sarrus with folded legs"
angles = "deg"
lengths = [{np.sqrt(1.25)}, {np.sqrt(1.25)}, 0, {np.sqrt(1.49)}, {np.sqrt(1.49)}, 0]
twists = [0, 0, 90, 0, 0, 90]
offsets = [0, 0, 0, 0, 0, 0]
"""


def bifurc(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A linkage file and its map."""
    folder = tmp_path_factory.mktemp("sarrus")
    (folder / "sarrus.toml").write_text(SARRUS)
    result = bifurc("map", folder / "sarrus.toml", "--out", folder)
    assert result.exit_code == 0, result.output
    return folder


def test_map_lists_surfaces_and_the_points_where_forms_meet_them(folder):
    summary = (folder / "summary.txt").read_text()
    assert re.search(r"surface 1 +2 +\d+ +\S+ +complete: every part", summary)
    assert (
        len(
            re.findall(
                r"^ +D\d .*Form \d, surface 1 +dimension change", summary, re.MULTILINE
            )
        )
        == 4
    )


@pytest.mark.parametrize("source", ["sarrus.toml", "atlas.nc"])
def test_a_route_leads_over_a_surface(folder, source):
    result = bifurc("route", folder / source, "Form 1", "Form 2")
    assert result.exit_code == 0, result.output
    assert "Route from Form 1 to Form 2: 3 legs" in result.stdout
    # on the torus theta4 and theta6 turn by half a turn each, all others stand still
    assert re.search(
        r"2 +surface 1 +D\d +0\.00 +0\.00 +0\.00 +180\.00 +0\.00 +180\.00",
        result.stdout,
    )
    assert result.stdout.rstrip().endswith("Over a surface the way is a geodesic.")


def test_a_surface_is_a_start_or_goal_by_its_name(folder):
    result = bifurc("route", folder / "atlas.nc", "surface 1", "Form 2")
    assert (
        result.exit_code == 0
        and "Route from surface 1 to Form 2: 2 legs" in result.stdout
    )
    unknown = bifurc("route", folder / "atlas.nc", "surface 2", "Form 2")
    assert (
        unknown.exit_code == 2
        and "it must be one of 'Form 1', 'Form 2', 'surface 1'" in unknown.stderr
    )


def test_there_is_no_route_over_what_is_only_sampled(tmp_path):
    (tmp_path / "free.toml").write_text(
        'angles = "deg"\nlengths = [1, 1.2, 0.9, 1.3, 1.1, 0.8, 1, 1, 1]\n'
        "twists = [0, 0, 0, 0, 0, 0, 0, 0, 0]\noffsets = [0, 0, 0, 0, 0, 0, 0, 0, 0]"
    )
    result = bifurc(
        "route", tmp_path / "free.toml", "surface 1", "surface 1", "--starts", 30
    )
    assert (
        result.exit_code == 4
        and "surface 1 (dimension 6): it is only sampled" in result.stderr
    )
