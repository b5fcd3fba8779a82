"""What a linkage is, by its atlas: mobile, rigid, or without any real configuration;
and the exit code for it."""

from __future__ import annotations

from dataclasses import dataclass

from bifurc.atlas import Atlas
from bifurc.singular.point import Kind
from linkages.app.status import ExitCode

__all__ = ["Verdict", "counted", "judge"]


# closure gap, over the characteristic length, below which a condition is missed
# narrowly
NEARLY_CLOSED = 1e-2


@dataclass(frozen=True)
class Verdict:
    """One sentence on what the linkage is, and the exit code."""

    sentence: str
    code: ExitCode


def judge(atlas: Atlas) -> Verdict:
    """What the linkage of an atlas is. An interrupted search is said to be one,
    whatever it found."""
    if atlas.provenance.interrupted:
        found = f"{counted(len(atlas.forms), 'form')} and {counted(len(atlas.bifurcations), 'bifurcation')}"
        return Verdict(
            f"The search was interrupted; {found} were found by then.",
            ExitCode.INTERRUPTED,
        )
    if atlas.forms or atlas.surfaces:
        return Verdict(_mobile(atlas), ExitCode.MAPPED)
    isolated = sum(1 for point in atlas.points if point.kind is Kind.ISOLATED)
    rigid = _rigid(len(atlas.rigid), isolated)
    gap = f"{atlas.closure_gap:.3g} of the characteristic length"
    if 0.0 < atlas.closure_gap < NEARLY_CLOSED:
        sentence = f"The linkage nearly moves, but along the way its loop misses closure by {gap}. {rigid}"
    elif len(atlas.rigid) or isolated:
        sentence = f"The linkage is rigid. {rigid}"
    else:
        sentence = (
            f"The linkage has no real configuration: its loop stays open by {gap}."
        )
    return Verdict(sentence.strip(), ExitCode.DOES_NOT_MOVE)


def _mobile(atlas: Atlas) -> str:
    if atlas.surfaces:
        dimension = max(surface.dimension for surface in atlas.surfaces)
        sentence = f"The linkage moves with mobility {dimension}"
        if atlas.forms:
            sentence += f", and has {counted(len(atlas.forms), 'form')} of mobility 1"
        return sentence + "."
    return (
        f"The linkage moves with mobility 1: {counted(len(atlas.forms), 'form')} in "
        f"{counted(atlas.components, 'component')}, {counted(len(atlas.bifurcations), 'bifurcation')}."
    )


def _rigid(regular: int, isolated: int) -> str:
    if not regular + isolated:
        return ""
    shaky = f", {isolated} of them shaky (of lower rank)" if isolated else ""
    return f"It closes in {counted(regular + isolated, 'isolated assembly')}{shaky}, and does not move from there."


def counted(number: int, noun: str) -> str:
    """``number`` and the noun in its number: "1 form", "2 assemblies"."""
    if number != 1:
        noun = noun[:-1] + "ies" if noun.endswith("y") else noun + "s"
    return f"{number} {noun}"
