"""Miura-ori of any size as the content of a FOLD file (Miura 1970)."""

from __future__ import annotations

from typing import Any

import numpy as np

from linkages.sheets.quad_mesh import straight_mesh

SECTOR = np.radians(70)  # angle of the parallelograms


def miura(columns: int, rows: int, fold: float = 0.0) -> dict[str, Any]:
    """The flat sheet of so many parallelograms, straight creases along x, zigzags along
    y, assigned as it folds, with fold angles, that of the zigzags ``fold`` (rad, 0 or
    more)."""
    along = (-1.0) ** np.arange(rows - 1) * np.cos(SECTOR)
    mesh = straight_mesh(along, -((-1.0) ** np.arange(columns - 1)))
    return mesh.crease_pattern(np.tan(0.5 * fold), f"Miura-ori {columns} x {rows}")
