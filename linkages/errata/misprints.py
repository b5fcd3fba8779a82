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

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from linkages.closed_forms.closed_form import constant, joint
from linkages.errata.conditions import CONDITIONS, immobility
from linkages.errata.forms import (
    circle_direction,
    compare_closed_forms,
    cosine_multipliers,
    inverted_factor,
    line_symmetric_bennett,
    printed_denominator,
    printed_discriminant,
    printed_second_form,
    printed_type_one,
    special_length,
    triangle_offset,
    with_constant,
    with_joints,
)
from linkages.errata.matrices import MATRIX_ROWS
from linkages.errata.switching import SWITCHING_ROWS
from linkages.errata.symmetric import SYMMETRIC_ROWS
from linkages.errata.tori import TORI_ROWS

__all__ = ["ERRATA", "Erratum", "errata_of"]

HOLDS = 1e-11  # what a correct equation may leave in doubles


@dataclass(frozen=True)
class Erratum:
    """One misprint; ``measure`` returns the amounts by which the printed and the
    corrected equation fail."""

    source: str
    equation: str
    linkage: str
    printed: str
    corrected: str
    measure: Callable[[], tuple[float, float]]


def errata_of(name: str) -> tuple[Erratum, ...]:
    """The misprints that concern the linkage called ``name``."""
    return tuple(found for found in ERRATA if found.linkage == name)


P12, T13 = "Song and Chen 2012 (mixed)", "Song 2013"
TORI = "Bil and Budniak, Model of 5R spatial linkage in the geometry of tori"
S1, C1 = joint(1)
M3 = constant("m_3")

CLOSED: tuple[Erratum, ...] = (
    Erratum(
        T13 + "; " + P12,
        "(3.2.4); (2.4)",
        "subtractive-goldberg-5r",
        "tan(theta3/2) = m(alpha45, alpha12) tan(theta1/2)",
        "tan(theta3/2) = tan(theta1/2) / m(alpha45, alpha12)",
        partial(compare_closed_forms, "subtractive-goldberg-5r", 0, inverted_factor),
    ),
    Erratum(
        T13 + "; " + P12,
        "(3.4.4); (4.4)",
        "subtractive-goldberg-5r",
        "tan(theta2/2) = -m2 / tan(theta1/2)",
        "tan(theta2/2) = -m1 / tan(theta1/2), and -1/m6 for 1/m6 in tan(theta3/2)",
        partial(
            compare_closed_forms,
            "subtractive-goldberg-5r",
            0,
            lambda f: with_constant(f, m_a="(u_alpha + u_gamma)/(u_alpha - u_gamma)"),
        ),
    ),
    Erratum(
        T13 + "; " + P12,
        "(3.4.5); (4.5)",
        "goldberg-5r",
        "tan(theta2/2) = -m2 / tan(theta1/2), +m4 in tan(theta3/2)",
        "tan(theta2/2) = -m3 / tan(theta1/2), -m4 in tan(theta3/2)",
        partial(
            compare_closed_forms,
            "goldberg-5r",
            0,
            lambda f: with_constant(
                f,
                m_a="-(u_gamma + u_alpha)/(u_gamma - u_alpha)",
                m_c="(u_beta + u_gamma)/(u_beta - u_gamma)",
            ),
        ),
    ),
    Erratum(
        T13 + "; " + P12,
        "(3.4.8), (3.4.9); (4.8), (4.9)",
        "mixed-double-goldberg-type-i",
        "t2 = -m2/(m6 x), t4 = -m2/Q, t5 = m4 x, H = (m2 - m6 x^2)/((m2 + m6) x)",
        "t2 = m1/(m6 x), t4 = -m4/Q, t5 = -m3 Q, H = (m1 + m6 x^2)/((m1 - m6) x)",
        partial(
            compare_closed_forms, "mixed-double-goldberg-type-i", 0, printed_type_one
        ),
    ),
    Erratum(
        T13 + "; " + P12,
        "(3.4.16); (4.16)",
        "mixed-double-goldberg-type-iii",
        "tan(theta4/2) = -m3 tan(theta1/2)",
        "tan(theta4/2) = m3 tan(theta1/2)",
        partial(
            compare_closed_forms,
            "mixed-double-goldberg-type-iii",
            0,
            lambda f: with_joints(f, j4=(-M3 * S1, C1)),
        ),
    ),
    Erratum(
        T13,
        "(5.2.4)",
        "wohlhart-double-goldberg",
        "(1 - m1 m2) + sqrt(...)",
        "(1 - m1 m6) + sqrt(...)",
        partial(
            compare_closed_forms, "wohlhart-double-goldberg", 0, printed_discriminant
        ),
    ),
    Erratum(
        T13,
        "(5.2.5)",
        "wohlhart-double-goldberg",
        "denominator 2 m2 Q",
        "denominator 2 m6 Q",
        partial(
            compare_closed_forms, "wohlhart-double-goldberg", 0, printed_denominator
        ),
    ),
    Erratum(
        "Song and Chen 2012 (special)",
        "(5.13)",
        "special-wohlhart-double-goldberg",
        "Form II: P = m1/m2",
        "Form II: P = m2/tan(theta1/2)",
        partial(
            compare_closed_forms,
            "special-wohlhart-double-goldberg",
            1,
            printed_second_form,
        ),
    ),
    Erratum(
        T13,
        "(5.2.34)",
        "special-double-subtractive-goldberg",
        "b = 1.5072",
        "b = 1.0572 (a sin(beta)/sin(alpha))",
        special_length,
    ),
    Erratum(
        T13,
        "(5.2.21), (5.2.22)",
        "double-subtractive-goldberg",
        "sin(delta + gamma)/(sin(delta) - cos(gamma))",
        "sin(delta + gamma)/(sin(delta) - sin(gamma)), the multipliers being cos((delta + gamma)/2)",
        cosine_multipliers,
    ),
    Erratum(
        T13,
        "(5.3.2), (5.3.9), (5.3.18)",
        "reconfigurable-bricard-1",
        "R3 over sin(alpha31) sin(theta3)",
        "R3 over sin(alpha23) sin(theta2)",
        triangle_offset,
    ),
    Erratum(
        T13,
        "(5.3.6)",
        "reconfigurable-bricard-2",
        "cos((gamma + delta)/2) / cos((gamma - delta)/2)",
        "sin((gamma + delta)/2) / sin((gamma - delta)/2)",
        line_symmetric_bennett,
    ),
    Erratum(
        TORI,
        "(2.3)",
        "torus-5r-13-plus-plus",
        "+(c_zeta s_kappa c_phi + s_zeta s_phi) s_theta in y and z",
        "- in both rows; then the vector has length 1",
        circle_direction,
    ),
)

ERRATA: tuple[Erratum, ...] = (
    *(
        Erratum(
            *row[:5],
            partial(lambda x, y: (immobility(x()), immobility(y())), row[5], row[6]),
        )
        for row in CONDITIONS
    ),
    *CLOSED,
    *(
        Erratum(*row)
        for row in (*MATRIX_ROWS, *SWITCHING_ROWS, *SYMMETRIC_ROWS, *TORI_ROWS)
    ),
)
