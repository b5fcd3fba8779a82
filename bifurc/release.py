"""The version of the package that is installed."""

from __future__ import annotations


def installed_version() -> str:
    """The version; "unknown" where the package is used without being installed."""
    # it takes as long to import as all that a small problem needs of numpy
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("bifurc")
    except PackageNotFoundError:
        return "unknown"
