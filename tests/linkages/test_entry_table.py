"""Tables of the catalogue: what they may hold, and that table and models agree."""

from importlib import resources

import pytest

from linkages import entry_table
from linkages.entry import Condition, ParameterKind, RelationKind
from linkages.entry_table import Model, read_entries, read_records
from linkages.families.wohlhart import wohlhart_symmetric

TABLE = """
facts = {joints = 4, locked = {3 = 0.0}}

[parameters]
a = {length = "1.7 sin(30 deg)", range = [0.3, 3], meaning = "length of link a"}
alpha = {degrees = 90, range = [15, 110], meaning = "twist of link a"}

[conditions]
ratio = {text = "one ratio", equations = "a12 = a34"}

[[linkage]]
name = "one"
conditions = ["ratio", "in words", {equations = "R = 0"}]
relations = [{kind = "same linkage as", other = "two"}]

[[linkage]]
name = "two"
parameters = ["alpha"]
changes.alpha = {degrees = 45}
conditions = []
facts = {joints = 5}
"""


@pytest.fixture
def read(tmp_path, monkeypatch):
    """The records of a table with the text given."""
    monkeypatch.setattr(resources, "files", lambda package: tmp_path)

    def records(text):
        (tmp_path / "some.toml").write_text(text, encoding="utf-8")
        return read_records("some.package", "some", "linkage")

    return records


def test_a_table_says_what_a_linkage_is(read):
    one, two = read(TABLE)
    a, alpha = one["parameters"]
    assert (a.kind, alpha.kind) == (ParameterKind.LENGTH, ParameterKind.ANGLE)
    assert a.default == pytest.approx(0.85)
    assert alpha.default == pytest.approx(1.5707963267948966)
    assert one["conditions"] == (
        Condition("one ratio", "a12 = a34"),
        Condition("in words"),
        Condition("R = 0", "R = 0"),
    )
    (relation,) = one["relations"]
    assert (relation.kind, relation.other) == (RelationKind.SAME, "two")
    assert one["facts"] == {"joints": 4, "locked": {3: 0.0}}
    assert [p.default for p in two["parameters"]] == [pytest.approx(0.785398163397)]
    assert two["facts"] == {"joints": 5}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("degrees = 90", "grads = 100"),
        ("equations = ", "equation = "),
        ("same linkage as", "like"),
        ('["alpha"]', '["beta"]'),
    ],
)
def test_a_table_that_holds_something_else_is_refused(read, old, new):
    with pytest.raises((KeyError, TypeError, ValueError)):
        read(TABLE.replace(old, new, 1))


def test_every_linkage_of_a_table_has_a_model_and_no_other_one_has():
    model = Model(wohlhart_symmetric)
    with pytest.raises(ValueError, match="another"):
        read_entries("wohlhart", {"wohlhart-symmetric": model, "another": model})
    with pytest.raises(ValueError, match="wohlhart-symmetric"):
        entry_table.read_entries("wohlhart", {})
