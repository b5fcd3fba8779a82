"""Parameters of a catalogue entry read off a table: the first guesses of
`linkages.identification.identify`.

Most parameters stand in the table as they are: `plain_parameters` finds out which and
where, by building two members. The others follow in closed form from the table in
normal form (lengths not negative, twists in [0, pi), offsets known by size only);
`HINTS` maps the name of an entry to a function of the rows (lengths, twists, offsets)
that returns every candidate for them. Candidates may be wrong: whoever uses them builds
the member and compares. Angles in rad. Source of the formulas: derived from the closure
conditions that the constructors state.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from functools import cache, partial
from math import pi

import numpy as np

from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link
from linkages.entry import Entry, Parameter
from linkages.families.tori import ENTRIES as TORI
from linkages.identification.collapsible_recovery import collapsible_hexagons
from linkages.identification.equivalence import table
from linkages.identification.recovery_angles import (
    half_tangents,
    kinks,
    twist_pairs,
    twists_of,
)
from linkages.identification.torus_recovery import torus_hint
from linkages.loop import GeometryError, Loop

__all__ = ["HINTS", "SCANS", "plain_guess", "plain_parameters"]

Rows = np.ndarray
Guesses = Iterator[dict[str, float]]
READ_AS: dict[str, Callable[[float], float]] = {
    "x": lambda x: x,
    "-x": lambda x: -x,
    "pi - x": lambda x: pi - x,
}


def plain_parameters(entry: Entry) -> dict[str, tuple[int, int, str]]:
    """Row and column of the table where each parameter stands as it is, and as what:
    "x", "-x" or "pi - x"."""
    return _plain_parameters(entry.construct, entry.parameters)


@cache
def _plain_parameters(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...]
) -> dict[str, tuple[int, int, str]]:
    members = []
    for nudge in (0.011, 0.023):
        values = {
            p.name: p.default * (1 + nudge * (i + 1) / (i + 2))
            for i, p in enumerate(parameters)
        }
        members.append((values, table(construct(**values))))
    found: dict[str, tuple[int, int, str]] = {}
    n = members[0][1].shape[1]
    for p, row, column, form in itertools.product(
        parameters, range(3), range(n), READ_AS
    ):
        wrong_row = (row == 1) != (p.kind == "angle") or (row != 1 and form != "x")
        if p.name in found or wrong_row:
            continue
        gaps = [READ_AS[form](values[p.name]) - t[row, column] for values, t in members]
        if max(abs(np.sin(gap)) if row == 1 else abs(gap) for gap in gaps) < 1e-13:
            found[p.name] = (row, column, form)
    return found


def plain_guess(entry: Entry, form: Rows) -> dict[str, float]:
    """The parameters that stand in the table ``form`` (3, n), which is in normal
    form."""
    out = {}
    for name, (row, column, read_as) in plain_parameters(entry).items():
        value = float(form[row, column])
        out[name] = value if read_as == "x" else (-value) % pi
    return out


def _type_one(kind: str) -> Callable[[Rows], Guesses]:
    """Links a*c, b, d, a+c, d, b, the two composite ones with the signs of ``kind``."""

    def hint(form: Rows) -> Guesses:
        (a, t, _), ratio = form, form[0, 1] / np.sin(form[1, 1])
        if kind == "mixed":
            pairs = [
                ((t[0] + t[3]) / 2 + k, ((t[3] - t[0]) / 2 + k) % pi)
                for k in (0, pi / 2)
            ]
        else:
            pairs = twist_pairs(t[0], a[0] / ratio, 1 if kind == "goldberg" else -1)
        for alpha, gamma in pairs:
            yield {"alpha": alpha % pi, "gamma": gamma, "a": ratio * np.sin(alpha % pi)}

    return hint


def _double_goldberg(sign: int, special: bool) -> Callable[[Rows], Guesses]:
    """Links a+c, d, b, a+c, b, d, or with the difference of a and c."""

    def hint(form: Rows) -> Guesses:
        a, t, _ = form
        ratio = a[1] / np.sin(t[1])
        for alpha, gamma in twist_pairs(t[0], a[0] / ratio, sign):
            both = {"a": ratio * np.sin(alpha), "alpha": alpha}
            yield both if special else {**both, "gamma": gamma}

    return hint


def _difference(name: str, of: int, other: int) -> Callable[[Rows], Guesses]:
    """The twist ``name`` when that in column ``of`` is it added to, or subtracted from,
    that in column ``other``, or the opposite: a link c - b reads b - c where that is
    longer."""

    def hint(form: Rows) -> Guesses:
        whole, part = form[1, of], form[1, other]
        yield from (
            {name: twist % pi} for twist in (whole - part, part - whole, whole + part)
        )

    return hint


def _back_to_back(sign: int) -> Callable[[Rows], Guesses]:
    def hint(form: Rows) -> Guesses:
        a, t, _ = form
        for beta, delta in twist_pairs(t[1], a[1] * np.sin(t[0]) / a[0], sign):
            yield from ({"beta": beta}, {"beta": delta})

    return hint


def _generalized_goldberg(form: Rows) -> Guesses:
    for kink in kinks(form[1, 4], form[1, 3], form[1, 1]):
        yield {"kink": kink}


def _syncopated(side: int, alpha: int, gamma: int) -> Callable[[Rows], Guesses]:
    """tan(beta/2) tan((delta - beta)/2) = tan(alpha/2) tan(gamma/2), the side being
    delta - beta."""

    def hint(form: Rows) -> Guesses:
        t = form[1]
        for tangent in half_tangents(t[side]):
            product = np.tan(t[alpha] / 2) * np.tan(t[gamma] / 2)
            yield from (
                {"beta": beta}
                for beta in twists_of(product / tangent if tangent else np.inf)
            )

    return hint


def _syncopated_serial(form: Rows) -> Guesses:
    """A quadratic equation for tan(beta/2), from elementary symmetric functions of the
    other three tangents."""
    side, others = form[1, 0], np.tan(form[1, 3:6] / 2)
    e1, e3 = others.sum(), others.prod()
    e2 = (e1**2 - (others**2).sum()) / 2
    for tangent in half_tangents(side):
        roots = np.roots(
            [tangent * (e1 - e3), -(e1 * e2 - e3), tangent * e3 * (1 - e2)]
        )
        yield from ({"beta": beta} for beta in twists_of(roots))


def _yu_baker(form: Rows) -> Guesses:
    """A cubic equation for tan(beta/2): delta is beta less the twist of link 56,
    epsilon beta plus that of link 12."""
    t = form[1]
    a, c = float(np.tan(t[5] / 2)), float(np.tan(t[3] / 2))
    for s, r in itertools.product(
        *(half_tangents(t[k]) + half_tangents(-t[k]) for k in (0, 4))
    ):
        x, one = np.poly1d([1.0, 0.0]), np.poly1d([1.0])
        delta = (x - r, one + r * x)  # numerator and denominator of tan(delta/2)
        left = (a * c * delta[1] + x * delta[0]) * (a + c) * (one - s * x)
        right = (x + s) * (a * delta[0] + c * x * delta[1]) * (1 - a * c)
        for beta in twists_of(np.roots((left - right).coeffs)):
            yield {
                "beta": beta,
                "delta": 2 * np.arctan(np.tan(beta / 2 - np.arctan(r))) % pi,
            }


def _waldron(form: Rows) -> Guesses:
    """Links b, a, [b d], c, d, [c a]: kinks from the twists, the shift from a length or
    an offset, linear in it."""
    a, t, offsets = form
    for kink_1, kink_2 in itertools.product(
        kinks(t[0], t[4], t[2]), kinks(t[3], t[1], t[5])
    ):
        try:
            at, past = (
                composite_link(Link(a[0], t[0]), Link(a[4], t[4]), kink_1, shift)
                for shift in (0.0, a[0])
            )
        except GeometryError:
            continue
        lines = [
            (at.link.length, past.link.length, a[2]),
            (at.before[0], past.before[0], offsets[2]),
        ]
        zero, one, size = max(lines, key=lambda line: abs(line[1] - line[0]))
        for target in (size, -size):
            yield {
                "kink_1": kink_1,
                "kink_2": kink_2,
                "shift": a[0] * (target - zero) / (one - zero),
            }


def _generalized_double_goldberg(form: Rows) -> Guesses:
    """Links b, [a c], b, d, [a c], d: sum and product of the cosines of alpha and gamma
    are linear in the rest."""
    a, t, offsets = form
    ratio = a[0] / np.sin(t[0])
    for twist, sign in itertools.product((t[1], t[1] + pi), (1, -1)):
        total = sign * a[1] / ratio / np.tan(twist / 2)
        shear = offsets[1] / ratio * (1 + np.cos(twist))
        product = (np.cos(twist) ** 2 + shear**2 - 1 + total**2) / (
            2 * (1 + np.cos(twist))
        )
        root = np.sqrt(max(total**2 / 4 - product, 0.0))
        if abs(total / 2) + root >= 1:
            continue
        for gamma, alpha in itertools.permutations(
            np.arccos([total / 2 + root, total / 2 - root])
        ):
            for one, two in itertools.product(
                kinks(alpha, gamma, t[1]), kinks(alpha, gamma, t[4])
            ):
                yield {
                    "a": ratio * np.sin(alpha),
                    "alpha": alpha,
                    "gamma": gamma,
                    "kink_1": one,
                    "kink_2": two,
                }


def _octahedral(form: Rows) -> Guesses:
    """Twists of links of no length have no sign of their own, so all are tried."""
    t = form[1]
    for s2, s3, s4, s6 in itertools.product((1, -1), repeat=4):
        alpha23 = t[1] if s2 > 0 else pi - t[1]
        yield {
            "alpha23": alpha23,
            "alpha34": s3 * t[2],
            "alpha45": s4 * t[3],
            "alpha61": s6 * t[5],
        }


HINTS: dict[str, Callable[[Rows], Guesses]] = {
    "generalized-goldberg-5r": _generalized_goldberg,
    "syncopated-goldberg-5r": _syncopated(0, 4, 3),
    "syncopated-serial-goldberg-6r": _syncopated_serial,
    "syncopated-l-shape-goldberg-6r": _syncopated(2, 5, 3),
    "serial-goldberg-variant-6r": _difference("gamma", 1, 5),
    "l-shape-goldberg-variant-6r": _difference("delta", 0, 3),
    "wohlhart-double-goldberg": _double_goldberg(1, special=False),
    "double-subtractive-goldberg": _double_goldberg(-1, special=False),
    "special-wohlhart-double-goldberg": _double_goldberg(1, special=True),
    "special-double-subtractive-goldberg": _double_goldberg(-1, special=True),
    "generalized-double-goldberg": _generalized_double_goldberg,
    "yu-baker": _yu_baker,
    "yu-baker-two-ratios": _yu_baker,
    "waldron-hybrid": _waldron,
    "bricard-octahedral-plane-symmetric": _octahedral,
    "bricard-octahedral-doubly-collapsible": collapsible_hexagons,
    "torus-4r": lambda form: iter(
        [{"r1": form[0, 0], "s1": form[0, 1], "chi1": form[1, 0], "theta1": 0.0}]
    ),
}
for _kind, _name in (
    ("mixed", "mixed-double"),
    ("goldberg", "double"),
    ("subtractive", "double-subtractive"),
):
    HINTS[f"{_name}-goldberg-type-i"] = _type_one(_kind)
    for _order in ("ii", "iii", "iv"):
        HINTS[f"{_name}-goldberg-type-{_order}"] = _difference("gamma", 1, 5)
for _word, _sign in (("sum", 1), ("difference", -1)):
    HINTS[f"back-to-back-double-goldberg-{_word}"] = _back_to_back(_sign)
    HINTS[f"isomerized-back-to-back-double-goldberg-{_word}"] = _back_to_back(_sign)
for _torus in TORI:
    if isinstance(_torus.construct, partial):
        HINTS[_torus.name] = torus_hint(_torus.construct.keywords)

_CIRCLE = np.linspace(-pi, pi, 72, endpoint=False) + 0.01
SCANS: dict[str, dict[str, np.ndarray]] = {
    "reconfigurable-bricard-1": {"kink": _CIRCLE},
    "reconfigurable-bricard-2": {"kink": _CIRCLE},
    "generalized-serial-goldberg-6r": {"kink_1": _CIRCLE[::6], "kink_2": _CIRCLE[::6]},
    "generalized-l-shape-goldberg-6r": {"kink_1": _CIRCLE[::6], "kink_2": _CIRCLE[::6]},
}
