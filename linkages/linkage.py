"""From a name of the catalogue or a file to a linkage to be mapped."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bifurc.files.text_file import missing_file
from linkages.arrays.entries import MECHANISMS
from linkages.catalogue import UnknownLinkageError, entry
from linkages.entry import Linkage
from linkages.file import ATLAS_ENDING, LinkageFileError, read_file
from linkages.formats.table import ENDINGS
from linkages.loop import Loop
from linkages.networks.entries import NETWORKS
from linkages.sheets.entries import SHEETS
from linkages.values import GeometryError, check_number, quoted, require

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism


def load(
    source: str | Path,
    *,
    closures: str | Path | None = None,
    triangulated: bool = False,
    **parameters: float,
) -> Linkage | Mechanism:
    """The linkage, the network, the sheet or the array called ``source`` in the catalogue, or the linkage or
    the mechanism read from a file: TOML, FOLD, CP, SVG, MJCF, SDF, URDF or a CUIK
    world.

    ``parameters`` are those of a family, angles in rad, the others at their defaults; a
    file takes none. ``closures`` is a YAML file that closes the loops of a robot in
    URDF. Panels of a crease pattern bend along diagonals where they are
    ``triangulated``. Raises `UnknownLinkageError` with the nearest names,
    `LinkageFileError` for a file that cannot be used, `UnknownParameterError` for a parameter that the family
    does not have, and `GeometryError` for values that make no linkage.

    >>> import linkages
    >>> linkages.load("bennett", a=1.0, alpha=1.5, beta=0.5).loop.n
    4
    """
    if not isinstance(source, str | Path):
        allowed = "a name of the catalogue or the path of a file"
        raise GeometryError("linkage", repr(source), allowed)
    if is_linkage_file(source):
        if parameters:
            names = ", ".join(parameters)
            allowed = "left out with a file, which holds the whole geometry"
            raise GeometryError(f"parameters of {source}", names, allowed)
        content = read_file(source, closures, triangulated)
        return Linkage(content) if isinstance(content, Loop) else content
    if closures is not None:
        allowed = "left out with a name of the catalogue"
        raise GeometryError("closures", quoted(str(closures)), allowed)
    if triangulated:
        allowed = "a crease pattern: a sheet by name, or a FOLD, CP or SVG file"
        require(str(source) in SHEETS, "triangulated", quoted(str(source)), allowed)
        return SHEETS[str(source)].build(True, **parameters)
    if str(source) in NETWORKS:
        return _load_network(str(source), parameters)
    if str(source) in MECHANISMS:
        return MECHANISMS[str(source)].build(**parameters)
    return _load_entry(str(source), parameters)


def load_linkage(source: str | Path, **parameters: float) -> Linkage:
    """What `load` returns, where that is a single loop; raises `GeometryError` for a
    mechanism as well.

    >>> import linkages
    >>> linkages.load_linkage("four-bar", d=3.4).loop.arrays.lengths.tolist()
    [1.0, 2.4, 2.0, 3.4]
    """
    linkage = load(source, closures=None, triangulated=False, **parameters)
    if not isinstance(linkage, Linkage):
        allowed = "a single loop of revolute joints, given as a table or as axes"
        raise GeometryError(str(source), "a mechanism", allowed)
    return linkage


def is_linkage_file(source: str | Path) -> bool:
    """Whether ``source`` names a file: it is a path, it ends like one, with .toml or as
    those of other programs do, or there is a file."""
    if isinstance(source, Path):
        return True
    try:
        return source.lower().endswith(ENDINGS) or Path(source).is_file()
    except OSError:  # a text that no file can be called, such as one far too long
        return False


def _load_entry(name: str, parameters: dict[str, float]) -> Linkage:
    """The member of the family ``name`` with these parameters."""
    try:
        family = entry(name)
    except UnknownLinkageError as error:
        _check_for_files(name, error)
        raise
    values = family.complete(parameters)
    for key, value in parameters.items():
        check_number(f"parameter {key} of {name}", value)
    loop = family.build(**values)
    if family.patterns is None:
        return Linkage(loop)
    return Linkage(loop, family.patterns(**values))


def _load_network(name: str, parameters: dict[str, float]) -> Mechanism:
    """The member of a network with these parameters, nothing locked."""
    # it imports networkx, which a loop does not need
    from linkages.networks.mechanism import lock_network

    for key, value in parameters.items():
        check_number(f"parameter {key} of {name}", value)
    return lock_network(NETWORKS[name].build(**parameters), {})


def _check_for_files(name: str, error: UnknownLinkageError) -> None:
    """Raises an error that names the file or the folder that may be meant by a name
    that is not in the catalogue."""
    file = f"{name}.toml"
    if Path(file).is_file():
        raise UnknownLinkageError(name, (file, *error.nearest)) from None
    path = Path(name)
    if name and path.is_dir():
        reason = "is a folder, and a linkage is a file"
        for saved in sorted(path.glob(f"*{ATLAS_ENDING}"))[:1]:
            reason += f"; the map in it is {saved}"
        raise LinkageFileError(name, reason) from None
    if path.suffix or path.name != name:
        raise LinkageFileError(name, missing_file(path)) from None
