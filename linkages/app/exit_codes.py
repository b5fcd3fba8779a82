"""The exit codes of the command `bifurc`, and the error that carries one."""

from __future__ import annotations

from enum import IntEnum

from bifurc.errors import BifurcError


class ExitCode(IntEnum):
    """What the command `bifurc` tells its caller; ``meaning`` says it in words."""

    meaning: str

    def __new__(cls, value: int, meaning: str) -> ExitCode:
        member = int.__new__(cls, value)
        member._value_ = value
        member.meaning = meaning
        return member

    DONE = 0, "done; for map: the linkage moves; for solve: there are curves"
    BAD_INPUT = 2, "bad input, or a file that cannot be read or written"
    DOES_NOT_MOVE = (
        3,
        "for map: the linkage does not move; for solve: there is no curve",
    )
    NO_ROUTE = 4, "there is no route"
    NOT_IN_CATALOGUE = 5, "for identify: no linkage of the catalogue has this geometry"
    DOES_NOT_HOLD = (
        6,
        "for verify and check: something does not hold; for map --rigorous: something is "
        "not proved; for sweep: a member failed",
    )
    NOTHING_KNOWN = (
        7,
        "the budget of time ended before anything was known, or all that is known are "
        "singular points",
    )
    PARTS_MEET = 8, "for export: printed parts would meet on the way"
    INTERRUPTED = 130, "interrupted; what was found is shown and written"


class CommandError(BifurcError):
    """A command that ends with a message, and with the exit code ``code``."""

    def __init__(self, message: str, code: ExitCode = ExitCode.BAD_INPUT):
        self.code = code
        super().__init__(message)


def exit_code_table() -> str:
    """The exit codes as they stand below the help of a command."""
    lines = [f"  {code.value:<4} {code.meaning}" for code in ExitCode]
    return "\n".join(["\b", "Exit codes:", *lines])
