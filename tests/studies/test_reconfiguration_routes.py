"""Ways between all forms of a linkage, from the graph and from routes."""

from click.testing import CliRunner

from linkages import load, map_linkage
from studies.reconfiguration_routes import main, ways_of


def test_the_bennett_form_lies_on_the_way_between_the_forms_of_a_bricard_linkage():
    atlas = map_linkage(load("reconfigurable-bricard-1"))
    ways = {(way.start, way.goal): way for way in ways_of(atlas)}
    bennett = atlas.form("Bennett 4R form")
    others = [way for pair, way in ways.items() if bennett in pair]
    (between,) = (way for pair, way in ways.items() if bennett not in pair)
    assert [way.fewest for way in others] == [1, 1]
    assert between.fewest == 2
    assert sorted(between.bifurcations) == sorted(
        name for way in others for name in way.bifurcations
    )


def test_no_way_leads_between_forms_that_do_not_meet():
    (way,) = ways_of(map_linkage(load("reconfigurable-bricard-2")))
    assert (way.route, way.fewest) == (None, None)


def test_a_misspelt_name_is_one_line():
    run = CliRunner().invoke(main, ["nonsense"])
    assert run.exit_code == 1
    assert run.output == "Error: no linkage is called 'nonsense'; no name is like it\n"
