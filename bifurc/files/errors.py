"""The error of a file that holds no atlas."""

from __future__ import annotations

from collections.abc import Iterable

from bifurc.errors import BifurcError


class AtlasFileError(BifurcError, ValueError):
    """A dataset or file that holds no atlas.

    ``source`` names it, ``missing`` lists the variables and attributes that it lacks.
    """

    def __init__(self, source: str, reason: str, missing: Iterable[str] = ()):
        self.source = source
        self.missing = tuple(missing)
        super().__init__(f"{source}: {reason}")
