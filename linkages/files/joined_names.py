"""Names of bodies that are made of the names of their two ends."""

from __future__ import annotations

from collections.abc import Iterable

from linkages.values import GeometryError


def joined_name(first: str, second: str) -> str:
    """What a body between two points or joints is called: "A-B"."""
    return f"{first}-{second}"


def check_joined_names(noun: str, ends: Iterable[tuple[str, str]]) -> None:
    """Raise `GeometryError` where bodies, each a ``noun``, between different ``ends``
    have one name: "A-B" and "C" make the name of "A" and "B-C"."""
    owners: dict[str, tuple[str, str]] = {}
    for pair in ends:
        name = joined_name(*pair)
        other = owners.setdefault(name, pair)
        if other != pair:
            shown = " and ".join(
                f'"{first}" to "{second}"' for first, second in (other, pair)
            )
            allowed = "different; call their ends otherwise"
            raise GeometryError(f"names of {noun}s {shown}", f'"{name}"', allowed)
