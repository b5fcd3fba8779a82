"""The base of all errors of these packages, and those that many modules raise."""

from __future__ import annotations


class BifurcError(Exception):
    """Base of all errors that `bifurc` and `linkages` raise."""


class ProblemError(BifurcError, ValueError):
    """A problem, a start or a setting that cannot be used.

    ``name`` is the offending thing, ``value`` what was given, ``allowed`` what it may
    be.
    """

    def __init__(self, name: str, value: object, allowed: str):
        self.name = name
        self.value = value
        self.allowed = allowed
        super().__init__(f"{name}: {value} is not allowed; it must be {allowed}")


class RouteError(BifurcError, LookupError):
    """There is no such form or surface, or no route from one to another."""


# What F over many digits raises beyond the rim of where it is defined.
NOT_DEFINED = (ZeroDivisionError, ValueError, OverflowError)
