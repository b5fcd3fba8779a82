"""The studies that draw published figures anew: what the sources say holds, and the
figures are written."""

from importlib import import_module

import pytest
from click.testing import CliRunner

from studies.redrawing import HOLDS, Claim, judge

STUDIES = {
    "special_wohlhart_double_goldberg": "figure_5_4",
    "special_double_subtractive_goldberg": "figure_5_2_5",
    "wohlhart_double_goldberg": "figure_5_2_7",
    "zero_offset_line_symmetric_bricard": "figure_4_4_7",
    "first_reconfigurable_bricard": "figure_5_3_16",
}


@pytest.mark.parametrize("name", STUDIES)
def test_all_that_the_source_says_holds_on_the_computed_map(name):
    study = import_module(f"studies.{name}")
    claims = study.claims(study.compute())
    assert len(claims) >= 3
    for claim in claims:
        assert 0 <= claim.deviation < HOLDS, claim.sentence


def test_a_study_prints_its_tables_and_writes_its_figure(tmp_path):
    study = import_module("studies.special_wohlhart_double_goldberg")
    result = CliRunner().invoke(study.main, ["--out", str(tmp_path)])
    assert result.exit_code == 0
    assert "What the source says\n  holds" in result.stdout
    for ending in ("png", "svg"):
        assert (tmp_path / f"figure_5_4.{ending}").stat().st_size > 5000
    assert (tmp_path / "atlas.nc").exists()


def test_a_claim_that_does_not_hold_is_said_not_to():
    assert "is off by 0.3" in judge(Claim("all is well", 0.3))
