"""Files are written whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from bifurc.files.atomic import replace_file, replace_files, require_replaceable


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def write_half_and_fail(error: BaseException):
    def write(part: Path) -> None:
        target = part / "a.txt" if part.is_dir() else part
        target.write_text("half")
        raise error

    return write


FAILURES = [
    KeyboardInterrupt(),
    ValueError("no good"),
    OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
]


def test_a_file_replaces_an_older_one(tmp_path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    assert replace_file(path, lambda part: part.write_text("new")) == path
    assert path.read_text() == "new"
    assert names(tmp_path) == ["a.txt"]


def test_a_file_has_the_permissions_of_any_new_file(tmp_path) -> None:
    path = replace_file(tmp_path / "a.txt", lambda part: part.write_text("new"))
    (tmp_path / "b.txt").write_text("usual")
    assert path.stat().st_mode == (tmp_path / "b.txt").stat().st_mode


@pytest.mark.parametrize("error", FAILURES)
def test_a_failure_leaves_the_older_file_and_nothing_else(tmp_path, error) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(type(error)):
        replace_file(path, write_half_and_fail(error))
    assert path.read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path, monkeypatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=r"No space left.*a\.txt") as caught:
        replace_file(tmp_path / "a.txt", lambda part: part.write_text("new"))
    assert caught.value.errno == errno.ENOSPC
    assert names(tmp_path) == []


def test_an_error_about_a_temporary_file_names_the_file_that_was_meant(
    tmp_path,
) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        replace_file(tmp_path / "a.txt", lambda part: None)
    assert caught.value.filename == str(tmp_path / "a.txt")


def test_an_error_about_another_file_keeps_its_name(tmp_path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        replace_file(tmp_path / "a.txt", lambda _: (tmp_path / "b.txt").read_text())
    assert str(caught.value.filename) == str(tmp_path / "b.txt")


def test_a_folder_in_place_of_the_file_is_refused_before_anything_is_written(
    tmp_path,
) -> None:
    with pytest.raises(IsADirectoryError, match=str(tmp_path)):
        replace_file(tmp_path, write_half_and_fail(AssertionError()))


def test_a_device_is_not_replaced() -> None:
    with pytest.raises(OSError, match="no file that can be replaced: '/dev/full'"):
        replace_file("/dev/full", write_half_and_fail(AssertionError()))
    assert Path("/dev/full").is_char_device()


def test_a_folder_that_does_not_exist_is_named(tmp_path) -> None:
    for replace in (replace_file, replace_files):
        with pytest.raises(NotADirectoryError, match="nowhere"):
            replace(tmp_path / "nowhere" / "a", write_half_and_fail(AssertionError()))


def test_files_of_a_folder_appear_together(tmp_path) -> None:
    (tmp_path / "a.txt").write_text("old")

    def write(stage: Path) -> None:
        (stage / "b.txt").write_text("b")
        (stage / "a.txt").write_text("a")
        assert "b.txt" not in names(tmp_path)

    paths = replace_files(tmp_path, write)
    assert paths == [tmp_path / "a.txt", tmp_path / "b.txt"]
    assert [path.read_text() for path in paths] == ["a", "b"]
    assert names(tmp_path) == ["a.txt", "b.txt"]


@pytest.mark.parametrize("error", FAILURES)
def test_a_failure_leaves_all_older_files_of_a_folder(tmp_path, error) -> None:
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(type(error)):
        replace_files(tmp_path, write_half_and_fail(error))
    assert (tmp_path / "a.txt").read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


def test_no_file_of_a_folder_is_replaced_where_one_cannot_be(tmp_path) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").mkdir()

    def write(stage: Path) -> None:
        for name in ("a.txt", "b.txt"):
            (stage / name).write_text("new")

    with pytest.raises(IsADirectoryError, match=r"b\.txt"):
        replace_files(tmp_path, write)
    assert (tmp_path / "a.txt").read_text() == "old"


def test_whether_a_file_can_be_replaced_is_found_out_without_touching_it(tmp_path):
    path = tmp_path / "file"
    require_replaceable(path)
    assert list(tmp_path.iterdir()) == []
    path.write_text("older")
    require_replaceable(path)
    assert path.read_text() == "older"
    for wrong in (tmp_path, tmp_path / "nowhere" / "file", Path("/dev/full")):
        with pytest.raises(OSError) as caught:
            require_replaceable(wrong)
        assert str(caught.value.filename) in str(wrong)
