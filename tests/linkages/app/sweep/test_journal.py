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
