"""An atlas of a linkage as text: degrees, joints numbered from 1."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from bifurc.atlas import Atlas, MeetingPoint
from bifurc.routes.route import Route
from bifurc.torus import wrap
from linkages.app.verdict import judge
from linkages.entry import Entry

__all__ = [
    "describe_entry",
    "describe_geometry",
    "describe_route",
    "make_summary",
    "table",
]

SHOWN_SHARE = 0.5e-4 / 360  # of a turn, that four digits of a degree do not show
SHOWN = 12  # near misses and rigid assemblies beyond this number are only counted


def make_summary(atlas: Atlas) -> str:
    """What `bifurc map` shows: verdict, geometry, forms, singular points, completeness
    and time."""
    linkage = atlas.subject
    parts = [
        f"{linkage['name']}\n{judge(atlas).sentence}",
        describe_geometry(linkage["lengths"], linkage["twists"], linkage["offsets"]),
        _forms(atlas),
        _surfaces(atlas),
        _points("Bifurcations", atlas, atlas.bifurcations),
        _points("Rank drops (a single branch passes)", atlas, atlas.rank_drops),
        _points(
            "Changes of dimension (a surface is met)",
            atlas,
            [p for p in atlas.points if p.name.startswith("D")],
        ),
        _points(
            "Other singular points",
            atlas,
            [p for p in atlas.points if p.name.startswith("S")],
        ),
        _near_misses(atlas),
        _rigid(atlas),
        _certificates(atlas),
        f"Completeness ({atlas.completeness.level}): {atlas.completeness.statement}.",
        f"Explored in {atlas.provenance.seconds:.3f} s, seed {atlas.provenance.seed}.",
    ]
    return "\n\n".join(part for part in parts if part)


def _certificates(atlas: Atlas) -> str:
    certificates = [(form.name, form.certificate) for form in atlas.forms]
    rows = [
        (
            name,
            c.status,
            f"{c.points}",
            f"{c.bound:.3g}",
            f"{len(c.gaps)}",
            f"{len(c.reversals)}",
        )
        for name, c in certificates
        if c
    ]
    heads = ("name", "status", "points", "bound K", "gaps", "alarms")
    return (
        "Certificates (each form is one arc of solutions)\n" + table(heads, rows)
        if rows
        else ""
    )


def describe_entry(found: Entry) -> str:
    """Everything that the catalogue says of a linkage, angles in degrees."""
    rows = [
        (
            p.name,
            f"{math.degrees(p.default):.6g} deg"
            if p.kind == "angle"
            else f"{p.default:.6g}",
            p.kind,
            p.meaning,
        )
        for p in found.parameters
    ]
    parts = [
        f"{found.name}\n{found.title}\nSource: {found.source}",
        "Parameters\n" + table(("name", "default", "kind", "meaning"), rows),
        _listed("Conditions", [str(condition) for condition in found.conditions]),
        describe_geometry(*(values.tolist() for values in found.build().arrays)),
        _listed(
            "Published facts", [f"{key}: {value}" for key, value in found.facts.items()]
        ),
        _listed("Misprints in the source", found.errata),
    ]
    return "\n\n".join(part for part in parts if part)


def _listed(title: str, lines: Sequence[str]) -> str:
    return f"{title}\n" + "\n".join(f"  {line}" for line in lines) if lines else ""


def describe_geometry(
    lengths: Sequence[float], twists: Sequence[float], offsets: Sequence[float]
) -> str:
    """The Denavit-Hartenberg table, twists (rad) shown in degrees."""
    n = len(lengths)
    rows = [
        (
            f"{i + 1}",
            f"{i + 1}{'-' if n > 9 else ''}{(i + 1) % n + 1}",
            _number(lengths[i]),
            _degrees(twists[i]),
            _number(offsets[i]),
        )
        for i in range(n)
    ]
    return "Geometry\n" + table(
        ("joint", "link", "length", "twist (deg)", "offset"), rows
    )


def describe_route(atlas: Atlas, route: Route, start: str, goal: str) -> str:
    """A route as a table: along which form, to which singular point, how far each joint
    turns on the way."""
    n = len(atlas.names)
    points = {point.name: point.point.u for point in atlas.points}
    rows = []
    for number, leg in enumerate(route.legs, start=1):
        to = points[leg.at] if leg.at else route.path[-1]
        turning = [f"{np.degrees(x):.2f}" for x in leg.travel]
        rows.append(
            (
                str(number),
                leg.form,
                leg.at or "goal",
                *turning,
                _configuration(atlas, to),
            )
        )
    total = [f"{np.degrees(x):.2f}" for x in route.travel]
    rows.append(("", "total", "", *total, ""))
    heads = (
        "",
        "along",
        "to",
        *(f"turn {i + 1}" for i in range(n)),
        "configuration reached",
    )
    return (
        f"Route from {start} to {goal}: {len(route.legs)} legs, {np.degrees(route.length):.6g} deg in joint space\n"
        f"from {_configuration(atlas, route.path[0])}\n\n"
        + table(heads, rows)
        + "\n\nAll in degrees; a turn is the sum of a joint's movements both ways."
        + (
            " Over a surface the way is a geodesic."
            if any(leg.dimension > 1 for leg in route.legs)
            else ""
        )
    )


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Left-aligned columns, two spaces apart, without trailing spaces."""
    lines = [tuple(heads), *(tuple(row) for row in rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(heads))]
    return "\n".join(
        (
            "  "
            + "  ".join(
                cell.ljust(width) for cell, width in zip(line, widths, strict=True)
            )
        ).rstrip()
        for line in lines
    )


def _forms(atlas: Atlas) -> str:
    if not atlas.forms:
        return ""
    rows = []
    for i in sorted(range(len(atlas.forms)), key=lambda i: atlas.forms[i].name):
        form, branch = atlas.forms[i], atlas.forms[i].branch
        rows.append(
            (
                form.name,
                "yes"
                if branch.closed
                else branch.outcome.name.lower().replace("_", " "),
                f"{np.degrees(branch.length):.6g}",
                " ".join(f"{w:+d}" if w else "0" for w in branch.winding),
                _inactive(form.labels),
                form.labels["symmetry"] or "-",
                f"{form.min_singular_value:.3g}",
                f"{form.labels['max_residual']:.1e}",
            )
        )
    heads = (
        "name",
        "closed",
        "length (deg)",
        "winding",
        "inactive joints",
        "symmetry",
        "smallest s.v.",
        "residual",
    )
    return "Forms\n" + table(heads, rows)


def _surfaces(atlas: Atlas) -> str:
    if not atlas.surfaces:
        return ""
    rows = []
    for surface in atlas.surfaces:
        charts = surface.charts
        covering = charts.outcome.value if charts is not None else "none: only sampled"
        size = (
            (str(len(charts)), f"{charts.area:.6g}")
            if charts is not None
            else ("-", "-")
        )
        rows.append(
            (surface.name, str(surface.dimension), *size, covering, surface.note)
        )
    return "Surfaces\n" + table(
        ("name", "dimension", "charts", "area (rad^2)", "covering", "remark"), rows
    )


def _inactive(labels: Any) -> str:
    pairs = zip(labels["inactive_joints"], labels["inactive_angles"], strict=True)
    return ", ".join(f"{joint} at {_degrees(angle)}" for joint, angle in pairs) or "-"


def _points(title: str, atlas: Atlas, points: Sequence[MeetingPoint]) -> str:
    if not points:
        return ""
    rows = [
        (
            p.name,
            _configuration(atlas, p.point.u),
            str(p.point.rank),
            f"{p.point.error:.0e}",
            ", ".join(
                [
                    *(atlas.forms[i].name for i, _ in p.passes),
                    *(atlas.surfaces[k].name for k in p.surfaces),
                ]
            )
            or "-",
            p.kind.value + (f": {p.note}" if p.note else ""),
        )
        for p in points
    ]
    heads = ("name", "joint angles (deg)", "rank", "error", "forms", "kind")
    return f"{title}\n" + table(heads, rows)


def _near_misses(atlas: Atlas) -> str:
    if not atlas.near_misses:
        return ""
    closest = sorted(atlas.near_misses, key=lambda miss: miss.value)
    rows = [
        (
            _configuration(atlas, miss.u),
            f"{miss.value:.6g}",
            atlas.forms[miss.form].name,
        )
        for miss in closest[:SHOWN]
    ]
    heads = ("joint angles (deg)", "singular value", "form")
    return "Near misses (no bifurcation)\n" + table(heads, rows) + _more(len(closest))


def _rigid(atlas: Atlas) -> str:
    if not len(atlas.rigid):
        return ""
    rows = [(_configuration(atlas, theta),) for theta in atlas.rigid[:SHOWN]]
    return (
        "Rigid assemblies\n"
        + table(("joint angles (deg)",), rows)
        + _more(len(atlas.rigid))
    )


def _more(count: int) -> str:
    return f"\n  and {count - SHOWN} more" if count > SHOWN else ""


def _configuration(atlas: Atlas, theta: np.ndarray) -> str:
    wrapped = wrap(theta, atlas.periods, within=SHOWN_SHARE)
    return " ".join(f"{_degrees(x):>9}" for x in wrapped)


def _degrees(angle: float) -> str:
    return f"{np.degrees(angle) + 0.0:.4f}".replace("-0.0000", "0.0000")


def _number(value: float) -> str:
    return f"{float(value):.10g}"
