"""Tables of closed forms: what they may hold, and whose they are."""

from importlib import resources

import pytest

from linkages.catalogue import catalogue
from linkages.closed_forms.form_table import changed, closed_form, form_tables

FOLDER = resources.files("linkages.closed_forms") / "tables"
FAMILIES = [path.name.removesuffix(".toml") for path in FOLDER.iterdir()]


@pytest.mark.parametrize("family", FAMILIES)
def test_every_form_belongs_to_a_linkage_of_the_family_of_its_file(family):
    own = {name for name, found in catalogue().items() if found.family == family}
    assert form_tables(family).keys() <= own


def test_what_a_form_says_stands_in_place_of_what_it_is_like():
    table = form_tables("goldberg_5r")["goldberg-5r"][0]
    changes = {"constants": {"m_c": "2"}, "joints": {"4": "zero"}}
    other = changed(table, changes)
    assert other["constants"] == {**table["constants"], "m_c": "2"}
    assert other["joints"] == [*table["joints"][:3], "zero", table["joints"][4]]
    assert closed_form("goldberg-5r", other).half_tangents[3] == ((0, 1),)


def test_an_entry_that_a_form_has_not_is_refused():
    table = form_tables("bennett")["bennett"][0]
    with pytest.raises(ValueError, match="titel"):
        closed_form("bennett", {**table, "titel": "Bennett form"})
