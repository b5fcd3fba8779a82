"""Files that may hold anything are read, or refused with one reason."""

import pytest

from bifurc.files.text_file import TextFileError, read_text, read_toml

BROKEN = {
    "lists without end": (b"a = " + 20_000 * b"[", "too deep"),
    "a number of 5000 digits": (b"a = 1" + 5000 * b"0", "not valid TOML"),
    "UTF-16": ("a = 1".encode("utf-16"), "not UTF-8 text: byte 0"),
    "a zero byte": (b"a = 1\n\0", "line 2"),
    "two values of one key": (b"a = 1\na = 2\n", "line 2"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_file_is_refused_with_a_reason(what, tmp_path):
    content, reason = BROKEN[what]
    path = tmp_path / "a.toml"
    path.write_bytes(content)
    with pytest.raises(TextFileError, match=reason) as refused:
        read_toml(path)
    assert len(str(refused.value).splitlines()) == 1


def test_a_mark_of_byte_order_is_no_text(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert read_text(path) == "a = 1\n"
    assert read_toml(path) == {"a": 1}


def test_a_folder_and_nothing_are_no_files(tmp_path):
    with pytest.raises(TextFileError, match="is a folder"):
        read_text(tmp_path)
    with pytest.raises(TextFileError, match="no such file"):
        read_text(tmp_path / "nothing")
    (tmp_path / "printed.csv").touch()
    with pytest.raises(TextFileError, match=r"file; the nearest here: printed\.csv$"):
        read_text(tmp_path / "pirnted.csv")
