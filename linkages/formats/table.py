"""The formats of files with mechanisms, one record each: how a file is recognised, what
reads it and what writes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, NamedTuple

from bifurc.files.text_file import read_text
from linkages.values import GeometryError, require

if TYPE_CHECKING:
    from linkages.loop import Loop
    from linkages.mechanisms.mechanism import Mechanism

SRDF = ".srdf"
MOST_BYTES = 50_000_000  # of a file of another program


class FileFormat(NamedTuple):
    """A format of files whose names have one of these ``endings``; ``words`` is what
    the help of commands says of it, if anything.

    ``read`` takes the path of a file, and raises `GeometryError`, `OSError` or
    `bifurc.files.text_file.TextFileError`; by these ``options`` it takes besides the path
    of a file of ``closures``, or whether panels are ``triangulated``. Without it files are
    TOML of this project, read by `linkages.file`. An XML file is told by its first
    element, the ``root``, whatever its ending. ``write`` and ``read_root`` name functions: the text of a
    mechanism, and the assembly of a root and a name.
    """

    endings: tuple[str, ...]
    words: str = ""
    read: Callable[..., Loop | Mechanism] | None = None
    options: tuple[str, ...] = ()
    write: str = ""
    root: str = ""
    read_root: str = ""


def format_of(path: Path) -> FileFormat | None:
    """The format of files with the ending of ``path``, if there is one."""
    ending = path.suffix.lower()
    return next((one for one in FORMATS if ending in one.endings), None)


def mechanism_text(mechanism: Mechanism, path: Path) -> str:
    """The text of a file of this name that describes a mechanism."""
    one = format_of(path)
    assert one is not None and one.write
    text: str = resolve_name(one.write)(mechanism)
    return text


# --- readers -----------------------------------------------------------------------------


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
        if one.root == root.tag:
            return mechanism_of_assembly(resolve_name(one.read_root)(root, path.stem))
    allowed = " or ".join(f"<{one.root}>" for one in FORMATS if one.root)
    raise GeometryError(f"first element, line {root.line}", f"<{root.tag}>", allowed)


def _content(path: Path) -> bytes:
    content = path.read_bytes()
    is_small = len(content) <= MOST_BYTES
    allowed = f"at most {MOST_BYTES} bytes"
    require(is_small, "size of the file", len(content), allowed)
    return content


def _closures_beside(path: Path) -> Path | None:
    """The file that closes the loops of a robot, if there is one: a YAML file or an SRDF of
    the same name beside it, `BESIDE`, or an SRDF in the folder ``srdf`` beside its own."""
    from linkages.formats.urdf_reading import BESIDE

    semantic = path.with_suffix(SRDF)
    in_folder = path.parent.parent / "srdf" / semantic.name
    beside = (path.with_suffix(".yaml"), path.with_name(BESIDE), semantic, in_folder)
    return next((one for one in beside if one.is_file()), None)


def _read_robot(path: Path, closures: Path | None = None) -> Mechanism:
    """A robot in URDF, with the loops that a YAML file or an SRDF closes, if there is one."""
    from linkages.formats.mechanism_of import mechanism_of_assembly
    from linkages.formats.urdf_reading import closures_of_srdf, read_urdf
    from linkages.formats.xml_tree import parse_xml

    closures = closures or _closures_beside(path)
    root = parse_xml(_content(path))
    require(root.tag == "robot", f"line {root.line}", f"<{root.tag}>", "<robot>")
    content: object = None
    if closures is not None and closures.suffix.lower() == SRDF:
        content = closures_of_srdf(parse_xml(_content(closures)))
    elif closures is not None:
        content = _read_yaml(closures) or {}
    return mechanism_of_assembly(read_urdf(root, path.stem, content))


def _read_yaml(path: Path) -> object:
    """The content of a YAML file; raises `GeometryError` with the line."""
    import yaml

    try:
        return yaml.safe_load(read_text(path))
    except yaml.YAMLError as error:
        reason = " ".join(str(error).split())
        raise GeometryError(path.name, reason, "a YAML file") from None


def _read_fold(path: Path, triangulated: bool = False) -> Mechanism:
    from linkages.files.fold import read_fold

    return read_fold(read_text(path), path.stem, triangulated)


def _read_cp(path: Path, triangulated: bool = False) -> Mechanism:
    from linkages.files.cp import read_cp

    return read_cp(read_text(path), path.stem, triangulated)


def _read_svg(path: Path, triangulated: bool = False) -> Mechanism:
    from linkages.files.svg import read_svg
    from linkages.formats.xml_tree import parse_xml

    root = parse_xml(_content(path))
    is_svg = root.tag.removeprefix("svg:") == "svg"
    require(is_svg, f"first element, line {root.line}", f"<{root.tag}>", "<svg>")
    return read_svg(root, path.stem, triangulated)


def _read_csv(path: Path) -> Loop:
    from linkages.files.csv_table import read_csv

    return read_csv(read_text(path), path.stem)


TOML = FileFormat(
    (".toml",), ".toml", write="linkages.files.mechanism_file:mechanism_toml"
)
FORMATS = (
    TOML,
    FileFormat(
        (".xml", ".mjcf"),
        ".xml or .mjcf (MJCF)",
        read=_read_xml,
        write="linkages.formats.mjcf_writing:mechanism_mjcf",
        root="mujoco",
        read_root="linkages.formats.mjcf_reading:read_mjcf",
    ),
    FileFormat(
        (".sdf",),
        ".sdf",
        read=_read_xml,
        write="linkages.formats.sdf_writing:mechanism_sdf",
        root="sdf",
        read_root="linkages.formats.sdf_reading:read_sdf",
    ),
    FileFormat(
        (".urdf",),
        ".urdf",
        read=_read_robot,
        options=("closures",),
        root="robot",
        read_root="linkages.formats.urdf_reading:read_urdf",
    ),
    FileFormat((".world",), ".world (CUIK)", read=_read_world),
    FileFormat((".fold",), read=_read_fold, options=("triangulated",)),
    FileFormat((".cp",), read=_read_cp, options=("triangulated",)),
    FileFormat((".svg",), read=_read_svg, options=("triangulated",)),
    FileFormat((".csv",), read=_read_csv),
)
ENDINGS = tuple(ending for one in FORMATS for ending in one.endings)
WRITTEN = tuple(ending for one in FORMATS if one.write for ending in one.endings)
READ_WORDS = ", ".join(one.words for one in FORMATS if one.words)
WRITTEN_WORDS = ", ".join(one.words for one in FORMATS if one.write)
