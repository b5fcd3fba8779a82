"""Mechanisms from the files of other programs, by the ending of their names."""

from __future__ import annotations

from pathlib import Path

from linkages.formats.assembly import Assembly
from linkages.formats.mechanism_of import mechanism_of_assembly
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError

MOST_BYTES = 50_000_000


def read_foreign_file(path: Path) -> Mechanism:
    """The mechanism in a file that ends with .world (CUIK), .xml or .mjcf (MJCF, or SDF
    where its first element says so), or .sdf.

    What is left out of the file, and how far its joints miss each other, is said in the
    log. Raises `GeometryError` for anything wrong in it, and `OSError`.
    """
    content = path.read_bytes()
    if len(content) > MOST_BYTES:
        allowed = f"at most {MOST_BYTES} bytes"
        raise GeometryError("size of the file", len(content), allowed)
    return mechanism_of_assembly(_assembly(path, content))


def _assembly(path: Path, content: bytes) -> Assembly:
    if path.suffix.lower() == ".world" and not content.lstrip().startswith(b"<"):
        from linkages.formats.cuik import read_world

        return read_world(_text(content), path.stem, path.parent)
    from linkages.formats.xml_tree import parse_xml

    root = parse_xml(content)
    if root.tag == "mujoco":
        from linkages.formats.mjcf_reading import read_mjcf

        return read_mjcf(root, path.stem)
    if root.tag == "sdf":
        from linkages.formats.sdf_reading import read_sdf

        return read_sdf(root, path.stem)
    allowed = "<mujoco> or <sdf>"
    raise GeometryError(f"first element, line {root.line}", f"<{root.tag}>", allowed)


def _text(content: bytes) -> str:
    """The text of a file; letters beyond ASCII stand in comments only."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")
