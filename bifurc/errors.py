"""The base of all errors of these packages, and those that many modules raise."""

from __future__ import annotations

from pathlib import Path


class BifurcError(Exception):
    """Base of all errors that `bifurc` and `linkages` raise."""


class ValueNotAllowed(BifurcError, ValueError):
    """What cannot be used: ``name`` is the offending thing, ``value`` what was given,
    ``allowed`` what it may be."""

    def __init__(self, name: str, value: object, allowed: str):
        self.name = name
        self.value = value
        self.allowed = allowed
        super().__init__(f"{name}: {value} is not allowed; it must be {allowed}")


class ProblemError(ValueNotAllowed):
    """A problem, a start or a setting that cannot be used."""


class PathError(BifurcError, ValueError):
    """A file or a folder that cannot be used: ``path``, and a ``message`` of what in it
    is wrong."""

    def __init__(self, path: Path | str, message: str):
        self.path = str(path)
        self.message = message
        super().__init__(f"{path}: {message}")


class UnknownNameError(BifurcError, KeyError):
    """There is nothing of that ``name``; ``nearest`` are the names most like it."""

    def __init__(self, name: str, nearest: tuple[str, ...]):
        self.name = name
        self.nearest = nearest
        super().__init__(name)


class OutOfTimeError(BifurcError):
    """The time was over, or Ctrl-C pressed (``is_interrupted``), at a ``stage`` before
    which nothing is known."""

    def __init__(self, stage: str, is_interrupted: bool):
        self.stage = stage
        self.is_interrupted = is_interrupted
        end = "it was interrupted" if is_interrupted else "the time was over"
        super().__init__(f"{end} {stage}; whether it moves is not known")


class RouteError(BifurcError, LookupError):
    """There is no such form or surface, or no route from one to another."""


# What F over many digits raises beyond the rim of where it is defined.
NOT_DEFINED = (ZeroDivisionError, ValueError, OverflowError)
