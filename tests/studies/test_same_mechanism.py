"""The same map of a known mechanism, however it is given."""

from dataclasses import replace

import pytest
from click.testing import CliRunner

from bifurc.search.settings import SearchSettings
from studies.known_mechanisms import known_mechanisms
from studies.same_mechanism import (
    Answer,
    Run,
    compare_ways,
    describe,
    differences,
    fact_misses,
    main,
)

FEW = SearchSettings(starts=40, charts=0, certify=False)
# slides that leave their limits, a spherical vertex, several bodies on one axis, a cusp
# that doubles hardly place
SAMPLE = [
    "spatial RPRP, equal distances and opposite slopes",
    "Miura-ori, one vertex (spherical 4R)",
    "three equal parallel cranks, pivots on a line",
    "double Watt mechanism with perpendicular couplers (cusp 5/2)",
]


def own_answer():
    return Answer(
        forms=2,
        closed=2,
        points={"bifurcation": 1},
        surfaces=(),
        rigid=0,
        level="estimated",
        in_doubt=False,
        is_finished=True,
        lengths=(1.0, 2.0),
    )


@pytest.mark.parametrize("name", SAMPLE)
def test_maps_agree_from_another_start_and_in_every_way(name):
    mechanism = known_mechanisms()[name].mechanism
    runs = list(compare_ways(name, mechanism, 2, FEW))
    assert len(runs) == 8
    assert [run.lines for run in runs] == [()] * 8


@pytest.mark.parametrize("name", known_mechanisms())
def test_a_known_mechanism_is_closed_and_as_mobile_as_is_known(name):
    assert fact_misses(known_mechanisms()[name]) == ()


@pytest.mark.parametrize(
    "change",
    [
        {"forms": 3, "lengths": (1.0, 2.0, 2.0)},
        {"closed": 1},
        {"points": {"cusp": 1}},
        {"surfaces": (2,)},
        {"rigid": 1},
        {"level": "certified"},
        {"in_doubt": True},
        {"lengths": (1.0, 2.1)},
    ],
)
def test_every_difference_is_seen(change):
    other = replace(own_answer(), **change)
    (line,) = differences(own_answer(), other, same_measure=True)
    assert line.startswith(next(iter(change)))


def test_other_lengths_are_no_difference_where_angles_are_measured_from_elsewhere():
    other = replace(own_answer(), lengths=(1.0, 2.1))
    assert differences(own_answer(), other, same_measure=False) == ()


def test_wrong_facts_are_seen():
    known = known_mechanisms()["K(2,3)"]
    lines = fact_misses(replace(known, mobility=2, nullity=3))
    assert [line.split(":")[0] for line in lines] == ["mobility", "nullity"]


def test_a_summary_names_the_map_that_differs():
    run = Run("four-bar", "mirrored", 1.0, "2 forms", "certified", True, ("rigid: 1",))
    text = describe([replace(run, way="seed 0", lines=()), run], {"four-bar": ()})
    assert "four-bar, mirrored: rigid: 1" in text


def test_a_name_that_no_mechanism_holds_is_refused(tmp_path):
    result = CliRunner().invoke(main, ["no such", "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "'no such'" in result.output
    assert not (tmp_path / "out").exists()
