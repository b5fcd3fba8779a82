"""What a file describes as a family, whose parameters are its numbers."""

from __future__ import annotations

from pathlib import Path

from linkages.entry import Entry, Linkage
from linkages.file import read_content
from linkages.formats.table import TOML, format_of
from linkages.linkage import load
from linkages.mechanisms.mechanism import Mechanism
from linkages.parameters.mechanism_family import MechanismFamily
from linkages.parameters.table_family import family_of_table


def family_of_file(path: Path | str) -> Entry | MechanismFamily:
    """The family of the linkage or the mechanism in a file: by the entries of its table, by
    the lengths of its bars or the angles of its arcs, by the coordinates of its joints
    elsewhere. Raises `LinkageFileError`.

    >>> import linkages
    >>> from pathlib import Path
    >>> lines = ['fixed = ["A", "D"]', 'bars = [["A", "B", 1], ["B", "C"], ["C", "D"]]']
    >>> lines += ["[points]", "A = [0, 0]", "B = [0, 1]", "C = [2, 2]", "D = [3, 0]"]
    >>> _ = Path("mine.toml").write_text("\\n".join(lines))
    >>> family = linkages.family_of_file("mine.toml")
    >>> [parameter.name for parameter in family.parameters][:3]
    ['A-B', 'B-C', 'C-D']
    >>> linkages.map_linkage(family.build(**{"A-B": 0.5})).components
    2
    """
    linkage = load(path)
    if isinstance(linkage, Linkage):
        return family_of_table(linkage.loop)
    return mechanism_family(path, linkage)


def mechanism_family(path: Path | str, mechanism: Mechanism) -> MechanismFamily:
    """The family of the ``mechanism`` that was read from a file; raises
    `LinkageFileError`."""
    # they import networkx, which a table does not need
    from linkages.files.arcs import assembled_arcs
    from linkages.files.bars import assembled_bars
    from linkages.files.mechanism_file import angle_unit
    from linkages.parameters.figure_family import ArcFamily, BarFamily
    from linkages.parameters.joint_family import JointFamily

    is_toml = format_of(Path(path)) in (None, TOML)
    content = read_content(Path(path)) if is_toml else {}
    if "joints" not in content and "bars" in content and mechanism.is_planar:
        return BarFamily(mechanism, assembled_bars(content)[0])
    if "joints" not in content and "arcs" in content:
        return ArcFamily(mechanism, assembled_arcs(content, angle_unit(content)))
    return JointFamily(mechanism)
