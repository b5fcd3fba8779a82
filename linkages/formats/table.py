"""The formats of files with mechanisms, one record each: how a file is recognised, what
reads it and what writes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from linkages.values import GeometryError

if TYPE_CHECKING:
    from linkages.formats.assembly import Assembly
    from linkages.formats.xml_tree import Element
    from linkages.mechanisms.mechanism import Mechanism

MOST_BYTES = 50_000_000  # of a file of another program


class FileFormat(NamedTuple):
    """A format of files whose names have one of these ``endings``.

    ``read`` takes the path of a file, and raises `GeometryError`, `OSError` or
    `bifurc.files.text_file.TextFileError`; without it files are TOML of this project,
    read by `linkages.file`. ``write`` gives the text of one. An XML file is told by its
    first element, and read by ``read_root``, whatever its ending.
    """

    endings: tuple[str, ...]
    read: Callable[[Path], Mechanism] | None = None
    write: Callable[[Mechanism], str] | None = None
    root: str = ""
    read_root: Callable[[Element, str], Assembly] | None = None


def format_of(path: Path) -> FileFormat | None:
    """The format of files with the ending of ``path``, if there is one."""
    ending = path.suffix.lower()
    return next((one for one in FORMATS if ending in one.endings), None)


def mechanism_text(mechanism: Mechanism, path: Path) -> str:
    """The text of a file of this name that describes a mechanism."""
    one = format_of(path)
    assert one is not None and one.write is not None
    return one.write(mechanism)


# --- readers --------------------------------------------------------------------------


def _read_fold(path: Path) -> Mechanism:
    from bifurc.files.text_file import read_text
    from linkages.files.fold import read_fold

    return read_fold(read_text(path), path.stem)


def _read_xml(path: Path) -> Mechanism:
    return _read_content(path, _content(path))


def _read_world(path: Path) -> Mechanism:
    """A world of the CUIK suite, or one of Gazebo."""
    from linkages.formats.cuik import read_world
    from linkages.formats.mechanism_of import mechanism_of_assembly

    content = _content(path)
    if content.lstrip().startswith(b"<"):
        return _read_content(path, content)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # letters beyond ASCII stand in comments only
    return mechanism_of_assembly(read_world(text, path.stem, path.parent))


def _read_content(path: Path, content: bytes) -> Mechanism:
    """The mechanism in an XML file."""
    from linkages.formats.mechanism_of import mechanism_of_assembly
    from linkages.formats.xml_tree import parse_xml

    root = parse_xml(content)
    for one in FORMATS:
        if one.read_root is not None and one.root == root.tag:
            return mechanism_of_assembly(one.read_root(root, path.stem))
    allowed = " or ".join(f"<{one.root}>" for one in FORMATS if one.root)
    raise GeometryError(f"first element, line {root.line}", f"<{root.tag}>", allowed)


def _content(path: Path) -> bytes:
    content = path.read_bytes()
    if len(content) > MOST_BYTES:
        allowed = f"at most {MOST_BYTES} bytes"
        raise GeometryError("size of the file", len(content), allowed)
    return content


def _read_mjcf(root: Element, name: str) -> Assembly:
    from linkages.formats.mjcf_reading import read_mjcf

    return read_mjcf(root, name)


def _read_sdf(root: Element, name: str) -> Assembly:
    from linkages.formats.sdf_reading import read_sdf

    return read_sdf(root, name)


# --- writers --------------------------------------------------------------------------


def _toml_text(mechanism: Mechanism) -> str:
    from linkages.files.toml_text import mechanism_toml

    return mechanism_toml(mechanism)


def _mjcf_text(mechanism: Mechanism) -> str:
    from linkages.formats.mjcf_writing import mechanism_mjcf

    return mechanism_mjcf(mechanism)


def _sdf_text(mechanism: Mechanism) -> str:
    from linkages.formats.sdf_writing import mechanism_sdf

    return mechanism_sdf(mechanism)


FORMATS = (
    FileFormat((".toml",), write=_toml_text),
    FileFormat((".xml", ".mjcf"), _read_xml, _mjcf_text, "mujoco", _read_mjcf),
    FileFormat((".sdf",), _read_xml, _sdf_text, "sdf", _read_sdf),
    FileFormat((".world",), _read_world),
    FileFormat((".fold",), _read_fold),
)
ENDINGS = tuple(ending for one in FORMATS for ending in one.endings)
WRITTEN = tuple(ending for one in FORMATS if one.write for ending in one.endings)
