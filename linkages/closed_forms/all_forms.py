"""Every closed form, by the name of its linkage. Imports sympy when the first one is
asked for."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from linkages.closed_forms.closed_form import ClosedForm

__all__ = ["all_closed_forms", "closed_forms"]

MODULES = (
    "linkages.closed_forms.goldberg",
    "linkages.closed_forms.double_goldberg",
    "linkages.closed_forms.mixed",
    "linkages.closed_forms.bricard",
)


@cache
def all_closed_forms() -> tuple[ClosedForm, ...]:
    """All closed forms, in the order of the families."""
    return tuple(found for module in MODULES for found in import_module(module).FORMS)


def closed_forms(name: str) -> tuple[ClosedForm, ...]:
    """The closed forms of the linkage called ``name``; none for a linkage whose sources
    give none."""
    return tuple(found for found in all_closed_forms() if found.linkage == name)
