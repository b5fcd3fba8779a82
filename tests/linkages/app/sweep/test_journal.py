"""The journal of a sweep survives its writer."""

import pytest

from linkages.app.sweep.journal import Journal, JournalError


def test_a_torn_last_line_is_dropped(tmp_path):
    path = tmp_path / "j"
    with Journal(path, {"sweep": 1}) as journal:
        journal.append({"member": 0})
    with path.open("ab") as file:
        file.write(b'{"member": 1, "fo')
    with Journal(path, {"sweep": 1}) as journal:
        assert list(journal.lines()) == [{"sweep": 1}, {"member": 0}]
        journal.append({"member": 1})
        assert list(journal.lines())[-1] == {"member": 1}


def test_the_journal_of_another_sweep_is_refused(tmp_path):
    Journal(tmp_path / "j", {"sweep": 1}).__exit__(None, None, None)
    with pytest.raises(JournalError, match="another sweep"):
        Journal(tmp_path / "j", {"sweep": 2})


def test_two_sweeps_cannot_write_one_journal(tmp_path):
    with (
        Journal(tmp_path / "j", {"sweep": 1}),
        pytest.raises(JournalError, match="is writing"),
    ):
        Journal(tmp_path / "j", {"sweep": 1})


@pytest.mark.parametrize("old, new", [(b"0.25", b"0.75"), (b"wise", b"wide")])
def test_a_line_that_was_changed_is_refused_by_its_number(tmp_path, old, new):
    path = tmp_path / "j"
    with Journal(path, {"sweep": 1}) as journal:
        journal.append({"member": 0, "gap": 0.25, "message": "otherwise", "x": 1e-300})
        assert list(journal.lines())[-1]["x"] == 1e-300
    path.write_bytes(path.read_bytes().replace(old, new))
    with (
        Journal(path, {"sweep": 1}) as journal,
        pytest.raises(JournalError, match="line 2 is damaged"),
    ):
        list(journal.lines())
