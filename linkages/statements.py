"""What is claimed of linkages, in English: a kind each, with its words."""

from __future__ import annotations

from collections.abc import Sequence

from bifurc.completeness import Claim, ClaimKind, Completeness, Level, Scope


class LinkageClaim(ClaimKind):
    """What slices, paths, dyads and whole turns can claim of a linkage."""

    # --- complete slices of a loop
    SLICES_INCOMPLETE = (
        "{degenerate} of {slices} slices could not be made complete ({reason})"
    )
    SLICES_DIFFER = (
        "at some angles of {joints} the slices and the motions hold different "
        "configurations"
    )
    NO_MOTION = (
        "there is no motion: no angle of any joint but a few has a configuration"
    )
    SLICES = (
        "complete slices of all {joints} joints every {degrees} degrees: every motion in "
        "which some joint turns by more than {degrees} degrees is here; a smaller one has "
        "room in {room}"
    )
    COUNTED = "no motion is missing: at every angle {counts}"
    # --- isolated assemblies
    ALL_FOLLOWED = (
        "no isolated assembly of full rank is missing: the 16 paths that lead to all of "
        "them were followed"
    )
    PATHS_LOST = "isolated assemblies may be missing: {ends}"
    RANDOM_ASSEMBLIES = "isolated assemblies are those that random starts reached"
    # --- dyads
    ALL_BUILT = (
        "dyads build all configurations: there is no motion, and no assembly is missing"
    )
    ALL_OF_GROUPS = (
        "there is no motion, and no assembly is missing: {real} of {complex} complex "
        "assemblies are real, and all {complex} were followed (trace test {trace:.1g})"
    )
    DYADS = "complete slices, built of dyads: every motion is here {moves}"
    DYADS_MISSING = (
        "complete slices, built of dyads: every motion is here {moves}, and others may be "
        "missing"
    )
    # --- limits
    CUT_AT_LIMITS = (
        "every motion within the limits is part of one without them, and these were mapped "
        "and cut at the limits"
    )
    PARTS_NOT_LISTED = (
        "{count:part} of motions without limits, the longest of {longest:.1g} rad, lie "
        "within them and are not listed"
    )
    DOUBT_WITHOUT_LIMITS = "in doubt: {doubts}"
    FOLLOWED_FROM_TURNS = (
        "where limits cut a form off, it was followed from whole turns away"
    )
    # --- whole turns
    MORE_TURNS = (
        "at least {forms:form} in all: joints that advance may stand whole turns away "
        "within their limits, and not all of that was tried"
    )
    TURNS_TRIED = (
        "beside every form listed here others a whole turn of a joint away, which "
        "advances, were looked for within the limits"
    )
    UP_TO_TURNS = "{translates}"


ALL_ASSEMBLIES = (
    LinkageClaim.ALL_FOLLOWED,
    LinkageClaim.ALL_BUILT,
    LinkageClaim.ALL_OF_GROUPS,
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


def estimated(kind: LinkageClaim, **data: object) -> Claim:
    """A claim of motions that leaves open whether some are missing."""
    return kind.claim(Scope.MOTIONS, Level.ESTIMATED, **data)


def joint_names(joints: Sequence[int]) -> str:
    """Joints, counted from 0, in words."""
    names = [str(joint + 1) for joint in joints]
    if len(names) == 1:
        return f"joint {names[0]}"
    return f"joints {', '.join(names[:-1])} and {names[-1]}"
