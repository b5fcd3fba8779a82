"""Every comparison of this package on which a count, a name or a word hangs: the table
``decisions.toml``; those of the search stand in `bifurc.decisions`."""

from __future__ import annotations

from pathlib import Path

from bifurc.decisions import by_name, read_decisions

TABLE = read_decisions(Path(__file__).with_name("decisions.toml"))
__getattr__ = by_name(TABLE)
