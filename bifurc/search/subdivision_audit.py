"""What a subdivision of the bounds says of the branches of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.completeness import Level, Scope
from bifurc.curves.certificate import Certificate, CertificateStatus
from bifurc.search.findings import TracedBranch
from bifurc.search.statements import SearchClaim
from bifurc.search.subdivision import Subdivision
from bifurc.seeds import Audit

WIDTH = 1e-6  # of the length: of the gap in a certificate where a branch is refuted


def audit_of(division: Subdivision) -> Audit:
    """What a complete subdivision says: nothing is missing; next to singular points
    that is not claimed."""
    nowhere = np.empty((0, division.left.shape[1]))
    kind, level = SearchClaim.BOXES, Level.PROVED
    if division.beside:
        kind, level = SearchClaim.BOXES_BESIDE_POINTS, Level.CERTIFIED
    data = {"boxes": int(division.count), "beside": float(division.beside)}
    return Audit((kind.claim(Scope.MOTIONS, level, **data),), nowhere)


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
