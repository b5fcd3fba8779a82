"""What a subdivision of the bounds says of the branches of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.curves.certificate import Certificate, CertificateStatus
from bifurc.search.findings import TracedBranch
from bifurc.search.subdivision import Subdivision
from bifurc.seeds import Audit, Level

WIDTH = 1e-6  # of the length: of the gap in a certificate where a branch is refuted


def audit_of(division: Subdivision) -> Audit:
    """What a complete subdivision says: nothing is missing; next to singular points
    that is not claimed."""
    nowhere = np.empty((0, division.left.shape[1]))
    text = (
        f"the bounds were divided into {division.count} boxes, and each one holds no "
        "solution, or a single arc of a form listed here"
    )
    if not division.beside:
        return Audit(Level.PROVED, text, nowhere)
    text += (
        f"; next to singular points, within {division.beside:.1g} of a quarter of the "
        "region in which solutions were found, nothing is claimed"
    )
    return Audit(Level.CERTIFIED, text, nowhere)


def refuted_at(traced: TracedBranch, s: float) -> TracedBranch:
    """The branch with a gap in its certificate about arclength ``s``, where it
    solves nothing."""
    certificate = traced.certificate
    if certificate is None:
        nothing = np.empty((0, 2))
        status = CertificateStatus.NOT_CERTIFIED
        certificate = Certificate(status, nothing, nothing, points=0, bound=np.inf)
    half = WIDTH * traced.branch.length
    gap = np.clip([[s - half, s + half]], 0.0, traced.branch.length)
    return replace(traced, certificate=certificate.with_gaps(gap))
