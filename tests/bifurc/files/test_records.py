"""What JSON says of an atlas, by the table of variables."""

import json

import numpy as np

from bifurc.files.layout import RECORDS, TABLES, records_of


def test_records_are_values_of_json_by_the_keys_of_their_columns(atlas):
    for owner, table in TABLES.items():
        keys = {column.key for column in table.columns if column.key}
        records = records_of(atlas, owner)
        assert len(records) == len(RECORDS[owner](atlas))
        assert all(record.keys() == keys for record in records)
        json.dumps(records, allow_nan=False)


def test_unknowns_stand_by_their_names_and_forms_by_theirs(atlas):
    (miss, *_), (event, *_) = records_of(atlas, "near_miss"), atlas.near_misses
    assert miss["u"] == dict(zip(atlas.names, event.u.tolist(), strict=True))
    assert miss["form"] == atlas.forms[event.form].name


def test_what_is_infinite_or_not_known_is_null(atlas):
    periods = [record["period"] for record in records_of(atlas, "joint")]
    assert [period is None for period in periods] == np.isinf(atlas.periods).tolist()
    stretches = records_of(atlas, "stretch")
    known = [stretch.unstable for stretch in atlas.diagram.stretches]
    assert [one["unstable"] for one in stretches] == [
        None if count < 0 else count for count in known
    ]
