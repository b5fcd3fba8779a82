"""What stands in docs/errata.md: every misprint with source, equation, print,
correction and measured amounts.  ``python -m studies.pages errata`` writes it.
"""

from __future__ import annotations

from linkages.errata.misprints import misprints, word_errata

HEAD = """# Misprints in the sources

Each row is measured by the program: by how much the printed equation fails, and what the corrected one leaves. For
closed forms the amount is the closure defect max |T_1 ... T_n - I| (median over input angles for the print, largest for
the correction). For geometric conditions it is the smallest singular value at the rigid assemblies of the loop built
by them, or the smallest closure residual with joint 1 held at 1 rad; 0 means that the loop moves. Equations between
numbers or matrices are evaluated as they stand. Where the root of a form changes, the amount is the gap in its angles
there; of formulas lost in the copy it is for what stands in their place. Scanned copies were used: a slip may be the
scanner's. `bifurc verify NAME` measures the rows of one linkage again.

| source | equation | linkage | printed | correct | print fails by | correction leaves |
|---|---|---|---|---|---|---|
"""


WORDS_HEAD = """
# Wrong in words

Statements that do not hold, or only for some linkages, and what the program finds.

| source | place | says | what holds | seen |
|---|---|---|---|---|
"""


def errata_page() -> str:
    """The page as Markdown."""
    return HEAD + _misprints() + WORDS_HEAD + _words()


def _words() -> str:
    rows = []
    for erratum in word_errata():
        texts = (
            erratum.source,
            erratum.place,
            erratum.printed,
            erratum.corrected,
            erratum.see(),
        )
        rows.append(f"| {' | '.join(texts)} |")
    return "\n".join(rows) + "\n"


def _misprints() -> str:
    rows = []
    for erratum in misprints():
        printed, corrected = erratum.measure()
        texts = (
            erratum.source,
            erratum.equation,
            erratum.linkage,
            erratum.printed,
            erratum.corrected,
        )
        cells = [text.replace("|", r"\|") for text in texts]
        cells += [f"{printed:.1g}", _remainder(corrected)]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def _remainder(amount: float) -> str:
    """What a correct equation leaves, without digits that are rounding."""
    if amount == 0:
        return "0"
    return "below 1e-11" if amount < 1e-11 else f"{amount:.0e}"
