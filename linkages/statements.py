"""What is claimed of linkages, and what is in doubt: kinds, whose words stand in the table
beside."""

from __future__ import annotations

from collections.abc import Sequence

from bifurc.completeness import (
    Claim,
    ClaimKind,
    Completeness,
    DoubtKind,
    Kinds,
    Level,
    Scope,
)

LinkageClaim = Kinds(ClaimKind, __file__, "claims")
LinkageDoubt = Kinds(DoubtKind, __file__, "doubts")
ALL_ASSEMBLIES = (
    LinkageClaim.ALL_FOLLOWED,
    LinkageClaim.ALL_BUILT,
    LinkageClaim.ALL_OF_GROUPS,
    LinkageClaim.REGULAR_OF_GROUPS,
)


def random_assemblies() -> Claim:
    """The claim that isolated assemblies are as random starts reached them."""
    return LinkageClaim.RANDOM_ASSEMBLIES.claim(Scope.ASSEMBLIES, None)


def has_all_assemblies(completeness: Completeness) -> bool:
    """Whether it is claimed that no isolated assembly is missing."""
    is_claimed = any(
        kind.is_kind_of(claim)
        for claim in completeness.claims
        for kind in ALL_ASSEMBLIES
    )
    return is_claimed and not completeness.is_in_doubt


def estimated(kind: ClaimKind, **data: object) -> Claim:
    """A claim of motions that leaves open whether some are missing."""
    return kind.claim(Scope.MOTIONS, Level.ESTIMATED, **data)


def joint_names(joints: Sequence[int]) -> str:
    """Joints, counted from 0, in words."""
    names = [str(joint + 1) for joint in joints]
    if len(names) == 1:
        return f"joint {names[0]}"
    return f"joints {', '.join(names[:-1])} and {names[-1]}"
