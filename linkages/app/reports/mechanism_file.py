"""A mechanism as the text of a file, by the ending of its name."""

from __future__ import annotations

from pathlib import Path

from linkages.mechanisms.mechanism import Mechanism


def mechanism_text(mechanism: Mechanism, out: Path) -> str:
    """The text of TOML, SDF, or else MJCF, for the file ``out``."""
    match out.suffix.lower():
        case ".toml":
            from linkages.files.toml_text import mechanism_toml

            return mechanism_toml(mechanism)
        case ".sdf":
            from linkages.formats.sdf_writing import mechanism_sdf

            return mechanism_sdf(mechanism)
        case _:
            from linkages.formats.mjcf_writing import mechanism_mjcf

            return mechanism_mjcf(mechanism)
