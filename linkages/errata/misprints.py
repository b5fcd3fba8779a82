"""Misprints of the sources, each with a measure of by how much the printed equation
fails and the corrected one holds.

For closed forms the measure is the closure defect max |T_1 ... T_n - I|: the median
over input angles for the print, the largest for the correction. For conditions it is
the smallest singular value at the rigid assemblies of the loop built by them, or the
smallest closure residual with joint 1 held; 0 if the loop moves. Equations between
numbers and matrices are evaluated as they stand. Where the root of a form changes, the
measure is the gap in its angles there. Of formulas lost in the copy the amount is for
what stands in their place. Misprints that are not equations (numbers of figures,
words), and conditions that are only stricter than needed, are not listed.
"""

from __future__ import annotations

from linkages.errata.conditions import CONDITION_ERRATA
from linkages.errata.equations import EQUATION_ERRATA
from linkages.errata.erratum import Erratum
from linkages.errata.forms import FORM_ERRATA
from linkages.errata.matrices import MATRIX_ERRATA
from linkages.errata.mechanism import MECHANISM_ERRATA
from linkages.errata.switching import SWITCHING_ERRATA
from linkages.errata.symmetric import SYMMETRIC_ERRATA
from linkages.errata.tori import TORI_ERRATA

ERRATA: tuple[Erratum, ...] = (
    *CONDITION_ERRATA,
    *FORM_ERRATA,
    *EQUATION_ERRATA,
    *MATRIX_ERRATA,
    *MECHANISM_ERRATA,
    *SWITCHING_ERRATA,
    *SYMMETRIC_ERRATA,
    *TORI_ERRATA,
)


def errata_of(name: str) -> tuple[Erratum, ...]:
    """The misprints that concern the linkage called ``name``."""
    return tuple(erratum for erratum in ERRATA if erratum.linkage == name)
