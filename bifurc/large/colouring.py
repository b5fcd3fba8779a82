"""Columns of a sparse matrix in groups that share no row: one evaluation of a function
along a group gives all derivatives in its columns (Curtis, Powell and Reid 1974)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csr_array


def column_groups(pattern: csr_array) -> np.ndarray:
    """The number of the group (n,) of each column of a pattern (m, n), from 0 on.

    Each column joins the first group in which none shares a row with it.
    """
    counts = pattern.astype(np.int32)
    counts.data[:] = 1
    sharing = (counts.T @ counts).tocsr()
    groups = np.full(pattern.shape[1], -1)
    for column in range(len(groups)):
        row = slice(sharing.indptr[column], sharing.indptr[column + 1])
        taken = set(groups[sharing.indices[row]].tolist())
        group = 0
        while group in taken:
            group += 1
        groups[column] = group
    return groups
