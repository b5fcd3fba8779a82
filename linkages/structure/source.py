"""What a method of completeness is to a search: starts, and a judge of what is traced
from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

import numpy as np

from bifurc.branch import Branch
from bifurc.problem import Problem
from bifurc.seeds import Audit
from linkages.structure.structure import Structure


class Source(Protocol):
    """Points ``starts`` (k, n) near solutions, and how sure it is that ``branches`` are
    all motions, judged in about so many ``seconds``."""

    @property
    def starts(self) -> np.ndarray:
        """Points near solutions."""

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """What is said of the branches."""


# The source of a problem of a structure, drawn with a generator beside so many random
# starts; None where the method says nothing of such a mechanism.
ForSubject: TypeAlias = Callable[
    [Problem, Structure, np.random.Generator, int], Source | None
]
