"""What the parts of a search share."""

from __future__ import annotations

from dataclasses import dataclass

from bifurc.limits import Deadline, HeldInterrupt
from bifurc.problem import Problem
from bifurc.search.findings import Findings
from bifurc.settings import SearchSettings


@dataclass(frozen=True)
class Run:
    """A search under way: what is searched, how, until when, and what is known so far.

    It stops at the ``deadline``. A Ctrl-C that ``interrupt`` holds makes the deadline
    pass, so that every step soon ends, and is raised between two of them.
    """

    problem: Problem
    settings: SearchSettings
    deadline: Deadline
    interrupt: HeldInterrupt
    findings: Findings

    @property
    def is_over(self) -> bool:
        """Whether the budget is used up."""
        return self.deadline.passed

    def is_over_now(self) -> bool:
        """The same, asked between two steps of something long: a Ctrl-C that was held
        is raised."""
        self.interrupt.check()
        return self.is_over
