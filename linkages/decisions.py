"""Every comparison of this package on which a count, a name or a word hangs: the table
``decisions.toml``; those of the search stand in `bifurc.decisions`."""

from __future__ import annotations

from pathlib import Path

from bifurc.decisions import Decision, read_decisions

TABLE = read_decisions(Path(__file__).with_name("decisions.toml"))


def __getattr__(name: str) -> Decision:
    """The decision of this name in code."""
    try:
        return TABLE[name]
    except KeyError:
        raise AttributeError(f"there is no decision {name!r}") from None
