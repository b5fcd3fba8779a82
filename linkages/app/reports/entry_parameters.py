"""The parameters of a linkage that a table is, as text."""

from __future__ import annotations

import math

from linkages.entry import ParameterKind
from linkages.identification.match import Match


def parameters_text(match: Match) -> str:
    """All parameters with their values, angles in degrees."""
    kinds = {parameter.name: parameter.kind for parameter in match.entry.parameters}
    parts = []
    for name, value in match.parameters.items():
        if kinds[name] is ParameterKind.ANGLE:
            parts.append(f"{name} = {math.degrees(value):.8g} deg")
        else:
            parts.append(f"{name} = {value:.8g}")
    return ", ".join(parts)


def member_text(match: Match) -> str:
    """The linkage with its parameters, as ``bennett(a = 1, alpha = 100 deg, beta = 40
    deg)``."""
    return f"{match.entry.name}({parameters_text(match)})"
