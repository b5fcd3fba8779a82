"""A system of equations as a file says it: the problem, its parameter and its events."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from bifurc.atlas import Atlas
from bifurc.equations.symbolic import SymbolicFunction, SymbolicProblem
from bifurc.errors import BifurcError
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings

DEFAULT_SETTINGS = SearchSettings()


class EquationFileError(BifurcError, ValueError):
    """A file of equations that cannot be used: which file, and what in it is wrong."""

    def __init__(self, path: Path | str, message: str):
        self.path = str(path)
        self.message = message
        super().__init__(f"{path}: {message}")


@dataclass(frozen=True, eq=False)
class EquationSystem:
    """What a file of equations says.

    ``equations`` are their texts by their names, ``values`` the constants by theirs,
    ``events`` functions of the unknowns (n,) whose zeros are looked for. ``is_flow``:
    whether the equations are rates, so that stability is defined.
    """

    name: str
    problem: SymbolicProblem
    parameter: str | None
    equations: Mapping[str, str]
    values: Mapping[str, float]
    events: Mapping[str, SymbolicFunction]
    is_flow: bool

    def explore(
        self,
        *,
        settings: SearchSettings = DEFAULT_SETTINGS,
        seed: int = 0,
        progress: Callable[[str, int], None] | None = None,
    ) -> Atlas:
        """The atlas of the system, whose ``subject`` says what was solved; see
        `bifurc.explore`."""
        atlas = explore(
            self.problem,
            settings=settings,
            seed=seed,
            progress=progress,
            parameter=self.parameter,
            events=dict(self.events) or None,
            is_flow=self.is_flow,
        )
        subject = {
            "kind": "system",
            "name": self.name,
            "equations": dict(self.equations),
            "parameters": dict(self.values),
        }
        return replace(atlas, subject=subject)
